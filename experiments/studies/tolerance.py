#!/usr/bin/python3
"""Error control in random scenes: how often `adaptive` errs by more than 100 times its rtol without a word.

    experiments/run tolerance [--scenes N] [--seed S] [--kinds K,…] [--rtol R,…] [--orthant PROGRAM] [--keep FOLDER]

Kinds: tumbling (three boxes and discs fall onto a floor and onto one another), polygons (two convex polygons), journals
(rods in bearings with clearance), linkages (a driven four-bar with a clearance pin and a stop). The reference is
`event-driven` at its defaults; where it is not within rtol of itself at rtol = 1e-11, accumulation = 1e-12, the motion
is too sensitive to be judged and is not counted. In space (kinds of tolerance_space.py: balls, solids, sliders,
pendulums) it is `adaptive` at rtol = 1e-10 and 1e-9, where neither crosses a crowd of events, to first order.
--witness counts the scenes that `moreau-jean` contradicts: at two steps it differs from the reference by more than its
own difference, ten times over.
A word: the run did not end solved, or says that it crossed crowds of events or that rigid bodies leave the motion open.
--keep writes the scenes that err silently.
"""
import argparse
import concurrent.futures
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "experiments/studies"))
import tolerance_space  # noqa: E402

REFERENCES = ("event-driven", "event-driven:rtol=1e-11,atol=1e-12,accumulation=1e-12")
IN_SPACE = ("adaptive:rtol=1e-10,atol=1e-13", "adaptive:rtol=1e-9,atol=1e-12")
ALLOWED = 100  # times rtol


def number(x):
    return repr(round(x, 12))


def vector(x, y):
    return f"[{number(x)}, {number(y)}]"


def list_of(corners):
    return "[" + ", ".join(vector(*corner) for corner in corners) + "]"


def table(element, **keys):
    words = {"kind": "type"}
    return f"[[{element}]]\n" + "".join(f"{words.get(key, key)} = {value}\n" for key, value in keys.items()) + "\n"


def quoted(*names):
    return "[" + ", ".join(f'"{name}"' for name in names) + "]"


def body(name, mass, inertia, place, angle=0.0, velocity=(0, 0), omega=0.0):
    return table("body", name=f'"{name}"', mass=number(mass), inertia=number(inertia), position=vector(*place),
                 angle=number(angle), velocity=vector(*velocity), omega=number(omega))


def law_of(draw):
    return {"mu": number(draw.choice([0, draw.uniform(0, 0.8)])), "e_n": number(draw.choice([0, draw.uniform(0, 0.9)]))}


def convex(draw, corners, size):
    """Corners on an ellipse, counterclockwise, about their centre; area and second moment per area."""
    turn = draw.uniform(0, 2 * math.pi)
    angles = sorted(turn + 2 * math.pi * (i + draw.uniform(-0.3, 0.3)) / corners for i in range(corners))
    flat = draw.uniform(0.5, 1)
    points = [(size * math.cos(a), size * flat * math.sin(a)) for a in angles]
    return centred(points)


def centred(points):
    area = sx = sy = 0.0
    pairs = list(zip(points, points[1:] + points[:1]))
    for (x0, y0), (x1, y1) in pairs:
        cross = x0 * y1 - x1 * y0
        area, sx, sy = area + cross / 2, sx + (x0 + x1) * cross / 6, sy + (y0 + y1) * cross / 6
    cx, cy = sx / area, sy / area
    points = [(x - cx, y - cy) for x, y in points]
    moment = sum((x0 * y1 - x1 * y0) * (x0 * x0 + x0 * x1 + x1 * x1 + y0 * y0 + y0 * y1 + y1 * y1)
                 for (x0, y0), (x1, y1) in zip(points, points[1:] + points[:1])) / 12
    return points, moment / area


def shapes_scene(draw, shapes, duration):
    """Shapes (corners, second moment per area) or (radius, …) one above the other over a floor, all of which may
    meet."""
    law = law_of(draw)
    text = f"gravity = [0, -9.81]\nduration = {duration}\nstep = {duration / 10}\n\n"
    contacts = ""
    height = 0.0
    for i, (shape, moment) in enumerate(shapes):
        disc = not isinstance(shape, list)
        reach = shape if disc else max(math.hypot(*corner) for corner in shape)
        height += reach + draw.uniform(0.01, 0.2)
        mass = draw.uniform(0.5, 2)
        text += body(f"b{i}", mass, mass * moment, (draw.uniform(-0.15, 0.15), height), draw.uniform(-3, 3),
                     (draw.uniform(-1, 1), draw.uniform(-2, 0)), draw.uniform(-5, 5))
        height += reach
        wall = '{normal = [0, 1]}'
        if disc:
            contacts += table("contact", kind='"disc-wall"', body=f'"b{i}"', radius=number(shape), wall=wall, **law)
        else:
            contacts += table("contact", kind='"polygon-wall"', body=f'"b{i}"', corners=list_of(shape), wall=wall,
                              **law)
        for j, (other, _) in enumerate(shapes[:i]):
            flat = isinstance(other, list)
            if disc and not flat:
                contacts += table("contact", kind='"disc-disc"', bodies=quoted(f"b{i}", f"b{j}"),
                                  radius_a=number(shape), radius_b=number(other), **law)
            elif disc or not flat:
                round_one, edged, radius, corners = (i, j, shape, other) if disc else (j, i, other, shape)
                contacts += table("contact", kind='"disc-polygon"', bodies=quoted(f"b{round_one}", f"b{edged}"),
                                  radius=number(radius), corners=list_of(corners), **law)
            else:
                contacts += table("contact", kind='"polygon-polygon"', bodies=quoted(f"b{i}", f"b{j}"),
                                  corners_a=list_of(shape), corners_b=list_of(other), **law)
    return text + contacts


def tumbling(draw):
    def shape():
        if draw.random() < 0.5:
            radius = draw.uniform(0.1, 0.3)
            return radius, radius * radius / 2
        x, y = draw.uniform(0.1, 0.3), draw.uniform(0.1, 0.3)
        return [(-x, -y), (x, -y), (x, y), (-x, y)], (x * x + y * y) / 3

    return shapes_scene(draw, [shape() for _ in range(3)], 1.0)


def polygons(draw):
    return shapes_scene(draw, [convex(draw, draw.randint(3, 6), draw.uniform(0.15, 0.35)) for _ in range(2)], 1.0)


def journals(draw):
    law = law_of(draw)
    text = "gravity = [0, -9.81]\nduration = 1\nstep = 0.1\n\n"
    contacts = ""
    x = y = last = 0.0
    for i in range(draw.randint(1, 3)):
        length, angle, radius = draw.uniform(0.2, 0.6), draw.uniform(-math.pi, math.pi), draw.uniform(0.005, 0.03)
        clearance = radius * 10 ** draw.uniform(-2.5, -0.5)
        middle = x + length / 2 * math.cos(angle), y + length / 2 * math.sin(angle)
        mass = draw.uniform(0.5, 2)
        text += body(f"rod{i}", mass, mass * length**2 / 12, middle, angle, omega=0 if i else draw.uniform(-3, 3))
        contacts += table("contact", kind='"journal"', bodies=quoted(f"rod{i}", f"rod{i - 1}" if i else "ground"),
                          centre_a=vector(-length / 2, 0), centre_b=vector(last, 0),
                          radius_a=number(radius), radius_b=number(radius + clearance), **law)
        x, y, last = x + length * math.cos(angle), y + length * math.sin(angle), length / 2
    return text + contacts


def linkages(draw):
    crank, coupler, rocker, base = (draw.uniform(*range_)
                                    for range_ in ((0.05, 0.12), (0.25, 0.4), (0.2, 0.3), (0.25, 0.35)))
    angle = draw.uniform(0, 2 * math.pi)
    ax, ay = crank * math.cos(angle), crank * math.sin(angle)
    dx, dy = base - ax, -ay
    far = math.hypot(dx, dy)
    along = (far * far + coupler**2 - rocker**2) / (2 * far)
    if coupler**2 <= along**2:
        return linkages(draw)
    up = math.sqrt(coupler**2 - along**2)
    bx, by = ax + (along * dx - up * dy) / far, ay + (along * dy + up * dx) / far
    law = law_of(draw)
    text = "gravity = [0, -9.81]\nduration = 0.5\nstep = 0.05\n\n"
    masses = [draw.uniform(0.3, 1.5) for _ in range(3)]
    text += body("crank", masses[0], masses[0] * crank**2 / 12, (ax / 2, ay / 2), angle, omega=draw.uniform(-15, 15))
    text += body("coupler", masses[1], masses[1] * coupler**2 / 12, ((ax + bx) / 2, (ay + by) / 2),
                 math.atan2(by - ay, bx - ax))
    text += body("rocker", masses[2], masses[2] * rocker**2 / 12, ((base + bx) / 2, by / 2), math.atan2(by, bx - base))
    for name, bodies, point_a, point_b in (("shaft", ("ground", "crank"), (0, 0), (-crank / 2, 0)),
                                           ("A", ("crank", "coupler"), (crank / 2, 0), (-coupler / 2, 0)),
                                           ("D", ("ground", "rocker"), (base, 0), (-rocker / 2, 0))):
        text += table("joint", kind='"revolute"', name=f'"{name}"', bodies=quoted(*bodies), point_a=vector(*point_a),
                      point_b=vector(*point_b))
    text += table("load", name='"motor"', body='"crank"', torque=number(draw.uniform(-1, 1)))
    radius = 0.01
    text += table("contact", kind='"journal"', name='"B"', bodies=quoted("coupler", "rocker"),
                  centre_a=vector(coupler / 2, 0), centre_b=vector(rocker / 2, 0), radius_a=number(radius),
                  radius_b=number(radius * (1 + 10**draw.uniform(-2.5, -1))), **law)
    if draw.random() < 0.5:
        text += table("contact", kind='"limit"', name='"stop"', joint='"D"',
                      lower=number(math.atan2(by, bx - base) - draw.uniform(0.05, 0.5)), e_n=law["e_n"])
    return text


KINDS = {"tumbling": tumbling, "polygons": polygons, "journals": journals, "linkages": linkages} | tolerance_space.KINDS


def scene_of(kind, seed):
    return KINDS[kind](random.Random(f"{kind} {seed}"))


def places_of(final):
    """Coordinates; in place of a quaternion, of which either sign is the same, the products of its numbers."""
    places = [value for name, value in final.items() if name.endswith((".x", ".y", ".z", ".theta"))]
    for name in final:
        if name.endswith(".qw"):
            q = [final[name[:-1] + part] for part in "wxyz"]
            places += [q[i] * q[j] for i in range(4) for j in range(i, 4)]
    return places


def run(program, file, integrator, limit, *more):
    """Coordinates at the end, or None where the run did not end solved; whether crowds were crossed, and whether the
    run says so or that rigid bodies leave the motion open."""
    command = [program, "simulate", str(file), "--integrator", integrator, "--time-limit", str(limit), "--json", *more]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    try:
        end = json.loads(done.stdout)
    except json.JSONDecodeError:
        return None, False, False
    if end["status"] != "solved":
        return None, False, False
    crossed = end["crossings"] > 0
    return places_of(end["final"]), crossed, crossed or end["undetermined_steps"] > 0


def contradicted(program, file, exact, limit):
    """Whether moreau-jean, at two steps, differs from `exact` by more than ten times what they differ by; None: no
    answer."""
    ends = [run(program, file, "moreau-jean", limit, "--step", step)[0] for step in ("2e-4", "5e-5")]
    if None in ends:
        return None
    return off(ends[1], exact) > 10 * off(*ends) + 1e-6


def off(one, other):
    return max(abs(a - b) for a, b in zip(one, other)) / max(1, *map(abs, other))


def judge(program, reference, kind, seed, tolerances, limit, keep, witness=False):
    """By rtol: "ok", "word", "silent" or "unknown" (no reference); and the error."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "scene.toml"
        file.write_text(f"# {kind}, seed {seed}\n" + scene_of(kind, seed))
        references = IN_SPACE if kind in tolerance_space.KINDS else REFERENCES
        found = [run(reference, file, spec, limit) for spec in references]
        exact, near = (None if kind in tolerance_space.KINDS and crossed else place for place, crossed, _ in found)
        verdicts = []
        if (
            witness
            and exact is not None
            and near is not None
            and off(near, exact) < 1e-6
            and contradicted(program, file, exact, limit)
        ):
            print(f"{kind} {seed}: moreau-jean contradicts the reference", flush=True)
        for rtol in tolerances:
            if exact is None or near is None or off(near, exact) > rtol:
                verdicts.append(("unknown", 0.0))
                continue
            end, _, word = run(program, file, f"adaptive:rtol={rtol:g}", limit)
            error = math.inf if end is None else off(end, exact)
            silent = end is not None and not word and error > ALLOWED * rtol
            verdicts.append(("word" if end is None or word else "silent" if silent else "ok", error))
            if silent and keep:
                keep.mkdir(parents=True, exist_ok=True)
                (keep / f"{kind}_{seed}_{rtol:g}.toml").write_text(file.read_text())
        return verdicts


def main(arguments=None):
    """Prints the table. Returns the largest silent share, and the least share that could be judged, of all its rows."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=1000, help="of each kind")
    parser.add_argument("--seed", type=int, default=1, help="of the first scene")
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--rtol", default="1e-4,1e-6,1e-8")
    parser.add_argument("--orthant", default=str(ROOT / "build/release/orthant"), help="the command to judge")
    parser.add_argument("--reference", default="", help="the command that makes the references; default: the same")
    parser.add_argument("--limit", type=float, default=20, help="[s] of wall time of a run")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--witness", action="store_true", help="name the scenes that moreau-jean contradicts")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the scenes that err silently")
    arguments = parser.parse_args(arguments)
    tolerances = [float(rtol) for rtol in arguments.rtol.split(",")]
    worst_share, least_judged = 0.0, 1.0
    print(f"{'kind':10} {'rtol':>7} {'judged':>7} {'unknown':>8} {'word':>5} {'silent':>7} {'share':>8}"
          "  worst silent, seed")
    for kind in arguments.kinds.split(","):
        if kind not in KINDS:
            parser.error(f"--kinds: '{kind}': must be of {', '.join(KINDS)}")
        seeds = range(arguments.seed, arguments.seed + arguments.scenes)
        with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
            rows = list(
                pool.map(
                    lambda seed: judge(arguments.orthant, arguments.reference or arguments.orthant, kind, seed,
                                       tolerances, arguments.limit, arguments.keep, arguments.witness), seeds))
        for k, rtol in enumerate(tolerances):
            count = {verdict: sum(row[k][0] == verdict for row in rows)
                     for verdict in ("ok", "word", "silent", "unknown")}
            judged = len(rows) - count["unknown"]
            share = count["silent"] / max(1, judged)
            worst_share, least_judged = max(worst_share, share), min(least_judged, judged / len(rows))
            worst = max(((row[k][1], seed) for row, seed in zip(rows, seeds) if row[k][0] == "silent"), default=None)
            print(f"{kind:10} {rtol:7.0e} {judged:7} {count['unknown']:8} {count['word']:5} {count['silent']:7} "
                  f"{share:8.2%}  " + (f"{worst[0]:.1e}, {worst[1]}" if worst else "-"), flush=True)
    return worst_share, least_judged


if __name__ == "__main__":
    main()
