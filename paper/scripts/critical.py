"""At which friction the slider-crank may jam, by its geometry and masses alone: critical.py prints it.

A contact that slides against a force of friction mu * Lambda_N accelerates in its normal direction by (A_NN - mu
|A_NT|) Lambda_N, in the worse direction of slip. Where that is not positive, no finite force holds it: Painleve's
paradox. Critical is mu = A_NN / |A_NT|, A = W M^-1 W^T in the mechanism's own coordinates theta1, theta2, theta3. One
corner: its own row. A flush face: the slider cannot turn, theta3 is held. A slider that leans has its corners
elsewhere.

And from the same matrix: what a face's restitution is where its corners strike in turn.
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
    wall = abs(scene["contact"][0]["wall"]["point"][1])
    play = math.asin(wall / math.hypot(x, y)) - math.atan2(y, x)  # opposite corners touch
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
    across = abs(sum(t * a for t, a in zip(tangent, answer)))
    return sum(n * a for n, a in zip(normal, answer)) / across if across > 1e-12 else math.inf


def inertia(theta1):
    """Mass matrix, and the velocity of the slider's pin by coordinate: the slider in the middle of its guide."""
    crank, rod, bodies, *_ = mechanism()
    theta2 = math.asin(-crank / rod * math.sin(theta1))
    pin = [[-crank * math.sin(theta1), -rod * math.sin(theta2), 0],
           [crank * math.cos(theta1), rod * math.cos(theta2), 0]]
    centres = [[[x[0] / 2, 0, 0] for x in pin], [[x[0], x[1] / 2, 0] for x in pin], pin]
    return [[sum(body["mass"] * sum(v[i] * v[j] for v in centre) for body, centre in zip(bodies, centres)) +
             (bodies[i]["inertia"] if i == j else 0) for j in range(3)] for i in range(3)], pin


def critical(theta1, theta3=0.0):
    """(one corner, the flush face)."""
    corners = [(x * math.cos(theta3) - y * math.sin(theta3), x * math.sin(theta3) + y * math.cos(theta3))
               for x, y in mechanism()[3]]
    mass, pin = inertia(theta1)
    single = min(ratio(mass, [*pin[1][:2], x], [*pin[0][:2], -y]) for x, y in corners)
    return single, ratio([row[:2] for row in mass[:2]], pin[1][:2], pin[0][:2])


def coupling(theta1):
    """c = A12 / sqrt(A11 A22) of the normals of the two corners of a flush face: at -1 one corner's impulse only turns
    the slider."""
    mass, pin = inertia(theta1)
    rows = [[*pin[1][:2], x] for x, y in mechanism()[3] if y > 0]
    a = [[sum(p * q for p, q in zip(row, solve(mass, other))) for other in rows] for row in rows]
    return a[0][1] / math.sqrt(a[0][0] * a[1][1])


def rebound(c, e):
    """Of a face whose corners strike in turn, without friction: (share of its approach with which it leaves, strikes).

    Struck in turn with approaches x_k, in units that make both diagonal entries 1, x_{k+1} = |c| (1 + e) x_k - e
    x_{k-1}: what the strike before has given this corner, less what it had rebounded with. It ends with the first that
    is not positive.
    """
    before, now, strikes = -1 / e, 1.0, 0  # both corners come with 1
    while now > 1e-12:
        before, now, strikes = now, abs(c) * (1 + e) * now - e * before, strikes + 1
    return max(0.0, (e * before - now) / 2), strikes


def stopping(c):
    """The greatest e with which such strikes never end: c^2 (1 + e)^2 = 4 e, where the recursion's roots cease to be
    real."""
    return ((1 - math.sqrt(1 - c * c)) / abs(c)) ** 2


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
    for theta1 in (0, 0.4):
        c = coupling(theta1)
        print(f"corners in turn, theta1 = {theta1}: c = {c:.4f}, the face stops up to e = {stopping(c):.3f}; "
              "it leaves with " + ", ".join(f"{rebound(c, e)[0]:.3f} (e = {e})" for e in (0.7, 0.8, 0.9, 0.95)))
