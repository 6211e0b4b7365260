"""Siconos: rigid bodies with all coordinates, Moreau-Jean time stepping with θ = 1/2, exact cone, Bullet's collisions.

Called as siconos.cpp, a program of its own, built by experiments/benchmarks/setup. Its solvers by a tolerance of 1e-8
and at most 1000 iterations. Joints are constraints on velocities.
"""
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from achieved import Contact, Pose

PEERS = os.environ.get("ORTHANT_PEERS") or Path(__file__).resolve().parents[3] / "build/peers"
PROGRAM = Path(PEERS) / "contacts/siconos"


def rotation(q):
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def facing(normal):
    """A quaternion that turns z to the normal."""
    w = np.array([1 + normal[2], -normal[1], normal[0], 0])
    return w / np.linalg.norm(w) if normal[2] > -1 else np.array([0, 1, 0, 0])


def text(scene):
    line = lambda kind, *parts: " ".join([kind, *(repr(float(x)) for part in parts for x in np.atleast_1d(part))])
    lines = [line("scene", scene.mu, min(min(b.shape[1:]) for b in scene.bodies))] if scene.planes else []
    for b in scene.bodies:
        turn = [np.cos(b.turn / 2), 0, 0, np.sin(b.turn / 2)]
        shape = line(b.shape[0], b.shape[1:]) if b.shape[0] != "rod" else "rod"
        lines.append(line("body", b.mass, b.moments, b.place, turn, b.velocity, b.rotation.T @ b.omega) + " " + shape)
    lines += [line("plane", p, facing(n)) for p, n in scene.planes]
    lines += [line("joint", a, b, p) for a, b, p in scene.joints]
    return "\n".join(lines) + "\n"


class Model:
    def __init__(self):
        if not PROGRAM.exists():
            raise ImportError("no contacts/siconos: experiments/benchmarks/setup builds it")

    @staticmethod
    def settings(scene):
        return ["moreau-jean"] if scene == "chain" else ["nsgs", "nsn-ac", "admm"]

    def run(self, scene, setting, h):
        with tempfile.NamedTemporaryFile("w", suffix=".txt", delete=False) as file:
            file.write(text(scene))
        try:
            done = subprocess.run([PROGRAM, file.name, setting, repr(h), repr(scene.duration)], capture_output=True,
                                  text=True)
        finally:
            os.unlink(file.name)
        told = [line.split() for line in done.stdout.splitlines()]
        end = [words for words in told if words[:1] == ["seconds"]]
        if done.returncode != 0 or not end:
            words = done.stderr.strip().splitlines()
            raise RuntimeError(words[-1] if words else f"exit code {done.returncode}")
        of = lambda kind: np.array([list(map(float, words[1:])) for words in told if words[:1] == [kind]])
        contacts = [Contact(int(c[0]), int(c[1]), c[2:5], c[8:11], c[11:14], c[14], c[5:8]) for c in of("contact")]
        return {"h": h, "seconds": float(end[0][1]), "steps": int(end[0][3]), "before": self.pose(of("before")),
                "after": self.pose(of("after")), "contacts": contacts}

    @staticmethod
    def pose(rows):
        turned = np.array([rotation(row[3:7]) for row in rows])
        return Pose(rows[:, :3], turned, rows[:, 7:10], np.einsum("kij,kj->ki", turned, rows[:, 10:13]))
