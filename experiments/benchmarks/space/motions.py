"""Motions in space with known ends: their data, exact places, and the times of runs. Shared by model_*.py."""
import math
import sys
import time
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "slider_crank"))  # last: its models have the same names
from driver import damping_ratio, hunt_crossley  # noqa: E402, F401  restitution of springs and dampers

REPEATS = 2
G = 9.81
# masse: core/scenes/masse.h
RADIUS, MASS, MU = 0.028575, 0.17, 0.2
V, OMEGA = np.array([1.0, 0, 0]), np.array([-60.0, -100, 40])
# slider_crank: core/scenes/spatial_slider_crank.cpp
SLIDER = 0.24071957373  # [m] x(5 s)
PIN, END = np.array([0, 0.1, 0.2]), np.array([0.2, 0, 0])
AXIS = (END - PIN) / 0.3
SQUARE = np.array([0, 2, -1]) / math.sqrt(5)
TURN = np.array([1.92, -0.96, 0.48])  # [rad/s] of the rod, at 6 rad/s of the crank
# bounces: bounces.toml
DROP = dict(radius=0.1, mass=1.0, mu=0.25, e=0.5, height=0.4, v=(2.0, 1.0, 0.0), omega=(10.0, -20.0, 5.0))
FIRST_IMPACT = math.sqrt(2 * G * DROP["height"])  # [m/s]
DURATION = {"masse": 1.0, "slider_crank": 5.0, "bounces": 0.73}


def masse_end(duration=DURATION["masse"]):
    """The exact place: friction is constant while the ball slides, and ends with the slip."""
    slip = np.array([V[0] - RADIUS * OMEGA[1], V[1] + RADIUS * OMEGA[0]])
    rolls = 2 * np.linalg.norm(slip) / (7 * MU * G)
    pull = -MU * G * slip / np.linalg.norm(slip)
    sliding = min(duration, rolls)
    return V[:2] * sliding + pull * sliding**2 / 2 + (V[:2] + pull * sliding) * (duration - sliding)


def strike(v, omega, radius, mu, e):
    """Velocities after the impact of a ball on the floor z = 0: the slip keeps its direction, or ends."""
    slip = np.array([v[0] - radius * omega[1], v[1] + radius * omega[0]])
    size = np.linalg.norm(slip)
    # per mass; the slip falls by 7/2 of it
    push = -slip / size * min(mu * (1 + e) * -v[2], 2 / 7 * size) if size > 0 else np.zeros(2)
    return (np.array([*(v[:2] + push), -e * v[2]]), omega + 2.5 / radius * np.array([push[1], -push[0], 0]))


def bounces_end(duration=DURATION["bounces"]):
    """The exact centre, flight by flight; duration before the impacts accumulate, at 3 √(2 h/g)."""
    place = np.array([0, 0, DROP["radius"] + DROP["height"]])
    v, omega = np.array(DROP["v"]), np.array(DROP["omega"])
    while True:
        flight = (v[2] + math.sqrt(v[2]**2 + 2 * G * (place[2] - DROP["radius"]))) / G
        t = min(flight, duration)
        place = place + v * t - np.array([0, 0, G * t * t / 2])
        duration -= t
        if duration <= 0:
            return place
        place[2] = DROP["radius"]
        v, omega = strike(v - np.array([0, 0, G * t]), omega, DROP["radius"], DROP["mu"], DROP["e"])


def ends():
    return {"masse": masse_end(), "slider_crank": np.array([SLIDER]), "bounces": bounces_end()}


def stiff_rate(at, stepped):
    """[rad/s] of a contact's spring: 40 steps in a period, or by the tolerance, so that the motion can converge."""
    return 2 * math.pi / (40 * at) if stepped else min(1e3 / math.sqrt(at), 1e6)


def timed(run):
    """Its result, and the processor time of the fastest call."""
    best = math.inf
    for _ in range(REPEATS):
        begin = time.thread_time()
        result = run()
        best = min(best, time.thread_time() - begin)
    return result, best
