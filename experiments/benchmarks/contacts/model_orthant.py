"""Orthant: rigid contacts with a friction disc, joints as constraints.

Fixed steps by its solver `auto` or sweeps to 1e-4 or 1e-6; the chain also by `adaptive`, with rtol = (step / 1 s)³.
"""
import json
import os
import subprocess
import tempfile

import numpy as np

from achieved import Contact, Pose
from scenes import toml

FIXED = {"moreau-jean, auto": ("moreau-jean", "auto"), "moreau-jean, psor 1e-4": ("moreau-jean", "psor:tolerance=1e-4"),
         "moreau-jean, nncg 1e-6": ("moreau-jean", "nncg:tolerance=1e-6"),
         "stewart-trinkle, auto": ("stewart-trinkle", "auto"),
         "stewart-trinkle, psor 1e-4": ("stewart-trinkle", "psor:tolerance=1e-4")}


class Model:
    def __init__(self, build):
        self.build = build

    @staticmethod
    def settings(scene):
        return ["moreau-jean, auto", "rattle", "adaptive"] if scene == "chain" else list(FIXED)

    def run(self, scene, setting, at):
        integrator, solver = FIXED.get(setting, (setting, "auto"))
        step = at
        if setting == "adaptive":
            integrator, step = f"adaptive:rtol={at**3!r}", scene.duration
        with tempfile.NamedTemporaryFile("w", suffix=".toml", delete=False) as file:
            file.write(toml(scene))
        try:
            done = subprocess.run([f"{self.build}/experiments/contact_record", file.name, integrator, solver,
                                   repr(step), repr(scene.duration)], capture_output=True, text=True)
        finally:
            os.unlink(file.name)
        if done.returncode != 0:
            raise RuntimeError((done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1])
        told = json.loads(done.stdout)
        pose = lambda x: Pose(*(np.array(x[part]) for part in ("place", "rotation", "velocity", "omega")))
        return {"h": step, "seconds": told["seconds"], "steps": told["steps"], "before": pose(told["before"]),
                "after": pose(told["after"]),
                "contacts": [Contact(a, b, *map(np.array, (on_a, n, r)), gap, np.array(on_b))
                             for a, b, on_a, on_b, n, r, gap in told["contacts"]]}
