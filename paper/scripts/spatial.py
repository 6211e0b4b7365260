"""What the article says of mechanics in space: the planar truth met there, exact cases, the spatial study."""
import csv
import math
import tomllib
from statistics import median

from data import PAPER, code, count, load, pick, rough, rows, short, solved, tabular, tex, unit, words
from schemes import ORDERS, numeral

FIXED = [name for name, (smooth, *_) in ORDERS.items() if smooth is not None]
STUDY = ("moreau-jean:joints=position", "moreau-jean:joints=symmetric", "stewart-trinkle", "anitescu-potra",
         "paoli-schatzman", "rattle")
FRICTION, REBOUND = (0.0, 0.1, 0.3), 0.4  # of the spatial study's tables
CLEARANCE = 5e-4  # [m] of the socket, the scene's default
TOLERANCES = (1e-3, 1e-6)
ORDER = 2.5  # one above it is that of steps too coarse to follow the motion
PHASES = ("free", "slides", "sticks")
# Cases of the table: number, how its title begins, its name in the article, where its truth comes from.
TRUTHS = (
    ("S15", "free", "free asymmetric body", "elliptic functions"),
    ("S3", "Lagrange", "heavy top, with cusps", "elliptic integrals"),
    ("S23", "four-bar", "redundant four-bar", "elliptic functions"),
    ("S4", "spatial slider-crank", "spatial slider-crank", "published"),
    ("S5", "Bricard", "Bricard's linkage", "published"),
    ("S11", "mass", "ball slides, then rolls", "closed form"),
    ("S12", "block", "block across a slope", "closed form"),
    ("S13", "ball on a turntable", "ball on a turntable", "closed form"),
    ("S19", "ball rolls", "ball in a cylinder", "closed form"),
    ("S16", "Euler", "Euler's disc", "closed form"),
    ("S16", "coin", "coin on a circle", "closed form"),
    ("S20", "domino", "domino strikes the next", "quadrature"),
    ("S17", "tippe-top", "tippe-top", "second method"),
    ("S18", "rattleback", "rattleback", "second method"),
)


def listed(parts):
    *first, last = parts
    return ", ".join(first) + " and " + last


def apart(a, b):
    """Largest difference of the crank angles of two placements, up to whole turns, of runs with the same settings."""
    return max(abs(math.remainder(x["angle"] - y["angle"], 2 * math.pi)) for x, y in zip(a, b, strict=True))


def placed(integrator):
    """Runs of the planar slider-crank by placement."""
    own = pick(rows("plane_in_space"), integrator=integrator)
    return {where: pick(own, placed=where) for where in ("plane", "space", "turned")}


def plane_integrators():
    return dict.fromkeys(row["integrator"] for row in rows("plane_in_space"))


def cost_in_space(runs):
    return median(y["seconds"] / x["seconds"] for x, y in zip(runs["plane"], runs["space"], strict=True))


def case(number, begins):
    """Rows of an exact case with discs."""
    return [row for row in rows("exact_space") if row["case"] == number and row["title"].startswith(begins)]


def best_fixed(table):
    return min((row for row in table if row["integrator"] in FIXED and row["error"] is not None),
               key=lambda row: row["error"])


def fit(integrator, mu, guide=None):
    return next(one for one in load("slider_crank_space.orders") if one["integrator"] == integrator
                and one["mu"] == mu and one["e"] == REBOUND and one.get("guide") == guide)


def timed(integrator, mu, **setting):
    return pick(rows("slider_crank_space"), integrator=integrator, repeats=lambda n: n > 0, mu=mu, e=REBOUND, **setting)


def socket(mu, e):
    """The motion with the scene's clearance, to a tolerance next to rounding."""
    return pick(rows("slider_crank_space"), integrator="adaptive:rtol=1e-10", repeats=0, guide=None, at_crank=None,
                clearance=CLEARANCE, mu=mu, e=e)[0]


def contact_path(mu):
    """(shares of the phases, way of the contact point over the ball while it touches, in radii)"""
    path = pick(rows("slider_crank_space.ball"), mu=mu)
    shares = {phase: len(pick(path, phase=phase)) / len(path) for phase in PHASES}
    way = 0
    for a, b in zip(path, path[1:]):
        if "free" not in (a["phase"], b["phase"]):
            way += math.acos(min(1, sum(a[c] * b[c] for c in "xyz") /
                                 math.hypot(*(a[c] for c in "xyz")) / math.hypot(*(b[c] for c in "xyz"))))
    return shares, way


def power(tolerance):
    return rf"\ensuremath{{10^{{{round(math.log10(tolerance))}}}}}"


def percent(share, digits=2):
    return rf"{tex(100 * share, digits)}\,\%"


def numbers(n):
    plane_numbers(n)
    exact_numbers(n)
    study_numbers(n)


def plane_numbers(n):
    table = rows("plane_in_space")
    with open(PAPER.parent / "tests/data/instructions.csv", newline="") as file:
        n["plane/instructions"] = next(count(int(row[2])) for row in csv.reader(file) if row[0] == "slider_crank")
    events = pick(table, integrator="event-driven")
    n["plane/cases"] = numeral(len({(row["mu"], row["e"]) for row in table}))
    n["plane/events"] = count(int(sum(row["events"] for row in pick(events, placed="space"))))
    n["plane/event_error"] = tex(max(row["event_error"] for row in events if row["placed"] != "plane"), 1)
    n["plane/angle_error"] = tex(max(row["error"] for row in events if row["placed"] != "plane"), 1) + unit("rad")
    fixed = [placed(name) for name in plane_integrators() if name in FIXED]
    n["plane/fixed_apart"] = tex(max(apart(r["plane"], r["space"]) for r in fixed), 1) + unit("rad")
    n["plane/turned_apart"] = tex(max(apart(r["space"], r["turned"]) for r in map(placed, plane_integrators())),
                                  1) + unit("rad")
    costs = [cost_in_space(runs) for runs in fixed]
    n["plane/cost_least"], n["plane/cost_most"] = tex(min(costs)), tex(max(costs))
    n["plane/step"] = tex(1e6 * pick(table, integrator="moreau-jean")[0]["step"], 2) + unit(r"\mu s")
    n["plane/rtol"] = tex(float(next(name.partition("rtol=")[2] for name in plane_integrators() if "rtol" in name)), 1)
    n["plane/machine"] = load("plane_in_space.about")["cpu"]
    n["plane/revision"] = code(load("plane_in_space.about")["revision"])


def exact_numbers(n):
    table = rows("exact_space")
    n["exact/cases"] = count(len({row["case"] for row in table}))
    series = {by: pick(table, integrator=by) for by in ("event-driven", "adaptive")}
    n["exact/series"], = {count(len(own)) for own in series.values()}
    n["exact/event_failed"], n["exact/adaptive_failed"] = (
        words(len([row for row in own if row["verdict"] != "pass"])) for own in series.values())
    shown = [case(number, begins) for number, begins, *_ in TRUTHS]
    n["exact/event_worst"] = tex(max(pick(t, integrator="event-driven")[0]["error"] for t in shown), 1)
    n["exact/adaptive_worst"] = tex(max(pick(t, integrator="adaptive")[0]["error"] for t in shown), 1)
    rolls = case("S19", "ball rolls")
    for by, name in (("rattle", "rattle"), ("event-driven", "event")):
        row = pick(rolls, integrator=by)[0]
        n[f"exact/rolls_{name}"] = tex(row["error"], 1) + unit("m")
        n[f"exact/rolls_{name}_ms"] = tex(row["milliseconds"]) + unit("ms")
    relaxed = [row["error"] for row in pick(case("S12", "block"), integrator="anitescu-potra")]
    n["exact/anitescu_error"] = tex(relaxed[0]) + unit("m")


def study_numbers(n):
    table = rows("slider_crank_space")
    n["study/runs"], n["study/unsolved"] = count(len(table)), words(len(table) - len(solved(table)))
    with open(PAPER.parent / "experiments/studies/slider_crank_space.sweep.toml", "rb") as file:
        n["study/duration"] = tex(tomllib.load(file)["duration"], 1) + unit("s")
    n["study/finest"] = tex(1e6 * min(row["step"] for row in table if row["step"]), 2) + unit(r"\mu s")
    n["study/e"] = tex(REBOUND, 1)
    n["study/mu"], n["study/mu_most"] = tex(FRICTION[1], 1), tex(FRICTION[2], 1)
    rubs = [fit(name, mu)["order"] for name in STUDY if name != "anitescu-potra" for mu in FRICTION[1:]]
    n["study/order_least"], n["study/order_most"] = tex(min(rubs), 2), tex(max(rubs), 2)
    rubbed = [fit(name, FRICTION[1])["worst_error_finest_octave"] for name in STUDY]
    n["study/spread"] = rough(max(rubbed) / min(rubbed))
    smooth = [fit(name, 0.0) for name in STUDY]
    n["study/smooth_order_most"] = tex(max(one["order"] for one in smooth), 2)
    n["study/smooth_error"] = tex(min(one["worst_error_finest_octave"] for one in smooth), 1) + unit("m")
    n["study/anitescu_error"] = tex(fit("anitescu-potra", FRICTION[2])["worst_error_finest_octave"], 1) + unit("m")
    channel = [fit(name, FRICTION[1], CLEARANCE)["order"] for name in STUDY[1:3]]
    n["study/channel_least"], n["study/channel_most"] = tex(min(channel), 2), tex(max(channel), 2)
    rattle = min(timed("rattle", FRICTION[1]), key=lambda row: row["step"])
    n["study/rattle_error"], n["study/rattle_ms"] = (
        tex(rattle["error"]) + unit("m"),
        rough(1e3 * rattle["seconds"]) + unit("ms"),
    )
    for mu, name in ((FRICTION[1], "rub"), (0.0, "smooth")):
        row = timed("adaptive", mu, rtol=TOLERANCES[0])[0]
        n[f"study/adaptive_{name}_error"] = tex(row["error"]) + unit("m")
        n[f"study/adaptive_{name}_ms"] = tex(1e3 * row["seconds"]) + unit("ms")
    n["study/rtol"] = power(TOLERANCES[0])
    paths = [contact_path(mu) for mu in FRICTION]
    n["study/free"] = listed([percent(shares["free"], 1) for shares, _ in paths])
    n["study/way"] = listed([tex(way) for _, way in paths])
    n["study/sticks"] = percent(paths[-1][0]["sticks"], 1)
    ends = {(mu, e): socket(mu, e) for mu in FRICTION for e in (0.0, REBOUND)}
    lost = [1 - ends[mu, 0.0]["energy_final"] / ends[mu, 0.0]["energy_initial"] for mu in FRICTION]
    n["study/lost"] = listed([percent(share) for share in lost])
    n["study/impulse"] = listed([tex(ends[mu, 0.0]["impulse"]) for mu in FRICTION]) + unit(r"N\,s")
    n["study/rebound"] = listed([tex(abs(ends[mu, REBOUND]["value"] - ends[mu, 0.0]["value"]), 1) for mu in FRICTION]
                                ) + unit("m")
    n["study/rub"] = listed([tex(abs(ends[mu, 0.0]["value"] - ends[0.0, 0.0]["value"]), 1) for mu in FRICTION[1:]]
                            ) + unit("m")
    n["study/clearance"] = tex(1e3 * CLEARANCE, 1) + unit("mm")
    closing = {mu: pick(rows("slider_crank_space.closing"), family="socket at the slider", mu=mu) for mu in FRICTION}
    n["study/closing_order"] = tex(closing[FRICTION[1]][-1]["change_order"])
    n["study/closing_change"] = tex(abs(closing[FRICTION[2]][-1]["x"] - closing[FRICTION[2]][-2]["x"]), 1) + unit("m")
    n["study/closing_before"] = tex(abs(closing[FRICTION[2]][-2]["x"] - closing[FRICTION[2]][-3]["x"]), 1) + unit("m")


def tables(t):
    lines = []
    for name in plane_integrators():
        runs = placed(name)
        in_space = [*runs["space"], *runs["turned"]]
        seconds = [median(row["seconds"] for row in runs[where]) for where in ("plane", "space")]
        lines.append([code(name.partition(":")[0]), tex(max(r["error"] for r in runs["plane"]), 2),
                      tex(max(row["error"] for row in in_space), 2), tex(apart(runs["plane"], runs["space"]), 1),
                      tex(apart(runs["space"], runs["turned"]), 1), *(rough(1e3 * s) for s in seconds),
                      rough(cost_in_space(runs))])
    head = ["scheme", "plane [rad]", "space [rad]", "apart", "turned", "plane [ms]", "space [ms]", "ratio"]
    t["plane"] = tabular("lrrrrrrr", head, lines)
    lines = []
    for number, begins, name, truth in TRUTHS:
        table = case(number, begins)
        event, best = pick(table, integrator="event-driven")[0], best_fixed(table)
        lines.append([name, truth, tex(event["error"], 1), tex(event["milliseconds"]), code(best["integrator"]),
                      tex(best["error"], 1), tex(best["order"] if best["order"] < ORDER else None),
                      tex(best["milliseconds"])])
    t["exact"] = tabular("llrrlrrr", ["motion", "truth", r"\code{event-driven}", "[ms]", "best fixed step", "error",
                                      "order", "[ms]"], lines)
    lines = []
    for name in STUDY:
        fits = [fit(name, mu) for mu in FRICTION]
        cells = [x for one in fits for x in (tex(one["order"]), tex(one["worst_error_finest_octave"], 1))]
        clocked = timed(name, FRICTION[1])
        finest = min(clocked, key=lambda row: row["step"]) if clocked else None
        lines.append([short(name), *cells, tex(finest["error"], 1) if finest else "--",
                      rough(1e3 * finest["seconds"]) if finest else "--"])
    lines.append(r"\addlinespace")
    for rtol in TOLERANCES:
        runs = [timed("adaptive", mu, rtol=rtol) for mu in FRICTION]
        cells = [x for run in runs for x in ("", tex(run[0]["error"], 1) if run else "--")]
        lines.append([rf"{code('adaptive')}, {power(rtol)}", *cells, tex(runs[1][0]["error"], 1),
                      tex(1e3 * runs[1][0]["seconds"])])
    head = ["", *(rf"\multicolumn{{2}}{{c}}{{$\mu = {tex(mu, 1)}$}}" for mu in FRICTION),
            r"\multicolumn{2}{c}{timed}"]
    t["space_orders"] = tabular("lrrrrrrrr", ["scheme", *3 * ["order", "error"], "error", "[ms]"], lines).replace(
        r"\toprule", "\n".join([r"\toprule", " & ".join(head) + r" \\",
                                r"\cmidrule(lr){2-3}\cmidrule(lr){4-5}\cmidrule(lr){6-7}\cmidrule(l){8-9}"]))
