"""Orthant: the command simulate; processor time of the whole program less that of a run of one step."""
import json
import resource
import subprocess
from pathlib import Path

import numpy as np

from motions import DURATION, REPEATS

SCENES = {"masse": "masse", "slider_crank": "spatial_slider_crank", "bounces": Path(__file__).parent / "bounces.toml"}


class Orthant:
    settings = {"masse": {"moreau-jean": "step", "adaptive": "rtol", "event-driven": "rtol"},
                "slider_crank": {"moreau-jean": "step", "rattle": "step", "adaptive": "rtol"},
                "bounces": {"moreau-jean": "step", "adaptive": "rtol", "event-driven": "rtol"}}

    def __init__(self, build):
        self.build = build

    def simulate(self, scene, method, at, duration):
        stepped = self.settings[scene][method] == "step"
        command = [f"{self.build}/orthant", "simulate", str(SCENES[scene]),
                   "--integrator", method if stepped else f"{method}:rtol={at}", "--duration", str(duration), "--json",
                   "--step", str(at if stepped else duration)]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(command, capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode != 0:
            raise RuntimeError(
                done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"exit code {done.returncode}")
        return json.loads(done.stdout)["final"], after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def best(self, scene, method, at):
        tiny = at if self.settings[scene][method] == "step" else 1e-6  # start and end of the program alone
        start = min(self.simulate(scene, method, at, tiny)[1] for _ in range(REPEATS))
        runs = [self.simulate(scene, method, at, DURATION[scene]) for _ in range(REPEATS)]
        return runs[0][0], max(min(seconds for _, seconds in runs) - start, 1e-4)

    def masse(self, method, at):
        final, seconds = self.best("masse", method, at)
        return np.array([final["ball.x"], final["ball.y"]]), seconds

    def slider_crank(self, method, at):
        final, seconds = self.best("slider_crank", method, at)
        return np.array([final["slider.x"]]), seconds

    def bounces(self, method, at):
        final, seconds = self.best("bounces", method, at)
        return np.array([final[f"ball.{axis}"] for axis in "xyz"]), seconds
