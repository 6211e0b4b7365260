"""At which friction the slider-crank may jam, by its geometry and masses alone: critical.py prints it.

A contact that slides against a force of friction mu * Lambda_N accelerates in its normal direction by (A_NN - mu |A_NT|) Lambda_N, in
the worse direction of slip. Where that is not positive, no finite force holds it: Painleve's paradox. Critical is
mu = A_NN / |A_NT|, A = W M^-1 W^T in the mechanism's own coordinates theta1, theta2, theta3. One corner: its own row. A flush
face: the slider cannot turn, theta3 is held. A slider that leans has its corners elsewhere.
"""
import math
import tomllib
from functools import cache

from data import PAPER

STEPS = 3600  # of a revolution


@cache
def mechanism():
    scene = tomllib.loads((PAPER.parent / "core/scenes/slider_crank.toml").read_text())
    bodies = [{b["name"]: b for b in scene["body"]}[name] for name in ("crank", "rod", "slider")]
    crank, rod = (2 * abs(joint["point_b"][0]) for joint in scene["joint"][:2])
    x, y = map(abs, scene["contact"][0]["point"])
    play = math.asin(abs(scene["contact"][0]["wall"]["point"][1]) / math.hypot(x, y)) - math.atan2(y, x)  # opposite corners touch
    return crank, rod, bodies, [contact["point"] for contact in scene["contact"]], play


def solve(matrix, right):
    """Gauss-Jordan elimination of a small definite system."""
    n = len(right)
    rows = [list(row) + [b] for row, b in zip(matrix, right)]
    for i in range(n):
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for j in range(n):
            if j != i:
                rows[j] = [x - rows[j][i] * y for x, y in zip(rows[j], rows[i])]
    return [row[n] for row in rows]


def ratio(mass, normal, tangent):
    answer = solve(mass, normal)
    coupling = abs(sum(t * a for t, a in zip(tangent, answer)))
    return sum(n * a for n, a in zip(normal, answer)) / coupling if coupling > 1e-12 else math.inf


def critical(theta1, theta3=0.0):
    """(one corner, the flush face), the slider in the middle of its guide."""
    crank, rod, bodies, corners, _ = mechanism()
    corners = [(x * math.cos(theta3) - y * math.sin(theta3), x * math.sin(theta3) + y * math.cos(theta3)) for x, y in corners]
    theta2 = math.asin(-crank / rod * math.sin(theta1))
    pin = [[-crank * math.sin(theta1), -rod * math.sin(theta2), 0], [crank * math.cos(theta1), rod * math.cos(theta2), 0]]
    centres = [[[x[0] / 2, 0, 0] for x in pin], [[x[0], x[1] / 2, 0] for x in pin], pin]  # velocities by coordinate
    mass = [[sum(body["mass"] * sum(v[i] * v[j] for v in centre) for body, centre in zip(bodies, centres)) +
             (bodies[i]["inertia"] if i == j else 0) for j in range(3)] for i in range(3)]
    single = min(ratio(mass, [*pin[1][:2], x], [*pin[0][:2], -y]) for x, y in corners)
    return single, ratio([row[:2] for row in mass[:2]], pin[1][:2], pin[0][:2])


@cache
def least():
    """The same over a revolution."""
    return tuple(min(values) for values in zip(*(critical(2 * math.pi * k / STEPS) for k in range(STEPS))))


@cache
def leaning():
    """Of one corner over a revolution, where the slider leans as far as its play lets it."""
    play = mechanism()[-1]
    return min(critical(2 * math.pi * k / STEPS, lean)[0] for k in range(0, STEPS, 10) for lean in (-play, play))


if __name__ == "__main__":
    print("one corner, flush face: mu = %.4f, %.4f" % least())
    print("one corner of a slider that leans by %.4f rad: mu = %.4f" % (mechanism()[-1], leaning()))
