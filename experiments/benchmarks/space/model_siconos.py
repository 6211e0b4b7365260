"""Siconos: called as siconos.cpp, a program of its own, built by experiments/benchmarks/setup."""
import os
import subprocess
from pathlib import Path

import numpy as np

from motions import REPEATS

PEERS = os.environ.get("ORTHANT_PEERS") or Path(__file__).resolve().parents[3] / "build/peers"
PROGRAM = Path(PEERS) / "space/siconos"
LONGEST = 600  # [s] of a run


class Siconos:
    settings = {"masse": {"nsgs": "step", "nsn-ac": "step"}, "slider_crank": {"moreau-jean": "step"},
                "bounces": {"nsgs": "step", "nsn-ac": "step"}}

    def __init__(self):
        if not PROGRAM.exists():
            raise ImportError(f"no {PROGRAM.name}: experiments/benchmarks/setup builds it")

    @staticmethod
    def run(scene, method, h):
        done = subprocess.run([PROGRAM, scene, method, repr(h)], capture_output=True, text=True, timeout=LONGEST,
                              env=os.environ | {"OPENBLAS_NUM_THREADS": "1"})
        words = done.stdout.strip().splitlines() + done.stderr.strip().splitlines()
        if done.returncode != 0:
            raise RuntimeError(words[-1] if words else f"exit code {done.returncode}")
        return Siconos.parse(done.stdout)

    @staticmethod
    def parse(text):
        """End and seconds, in the last line; messages of the library may come before."""
        seconds, *end = map(float, text.strip().splitlines()[-1].split())
        return np.array(end), seconds

    def best(self, scene, method, h):
        runs = [self.run(scene, method, h) for _ in range(REPEATS)]
        return runs[0][0], min(seconds for _, seconds in runs)

    def masse(self, method, h):
        return self.best("masse", method, h)

    def slider_crank(self, method, h):
        return self.best("slider_crank", method, h)

    def bounces(self, method, h):
        return self.best("bounces", method, h)
