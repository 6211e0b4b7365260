"""What the article says of tilt, restitution and clearance: what converges, and what does not but stays near."""
import math
from functools import cache
from statistics import median

from critical import coupling, mechanism, rebound, stopping
from data import code, count, load, pick, plus_minus, rows, short, solved, tabular, tex, unit, words
from schemes import numeral

A, B = 0, -0.01  # omega3 of the two starts of the literature [rad/s]
USUAL = 0.001  # clearance [m]
NO_ORDER = 0.5  # below it an error does not fall to speak of
STATISTICS = (  # name, of a row, factor and unit in the table
    (r"$\theta_1$ at the end", lambda r: r["value"], 1, "rad"),
    ("energy lost", lambda r: None if r["energy_initial"] is None else r["energy_initial"] - r["energy_final"], 1, "J"),
    ("whole impulse", lambda r: r["impulse"], 1, r"N\,s"),
    ("first touch", lambda r: r["first_touch"], 1e3, "ms"),
    ("first release", lambda r: r["first_release"], 1e3, "ms"),
    ("last release", lambda r: r["last_release"], 1e3, "ms"),
)


OCTAVES = 3  # the finest, in which a statistic has to fall


def fit(errors):
    """(order, worst error of the finest octave) of errors by step in the finest octaves, as
    experiments/support/fit_order.h has it."""
    errors = {h: e for h, e in errors.items() if h <= 2**OCTAVES * min(errors) * (1 + 1e-9)}
    coarsest = max(errors)
    worst = {}
    for h, error in errors.items():
        octave = math.floor(math.log2(coarsest / h) + 1e-9)
        if octave not in worst or error > worst[octave][1]:
            worst[octave] = (h, error)
    xy = [(math.log(h), math.log(e)) for h, e in worst.values()]
    mean_x, mean_y = (sum(z) / len(xy) for z in zip(*xy))
    order = sum((x - mean_x) * (y - mean_y) for x, y in xy) / sum((x - mean_x) ** 2 for x, _ in xy)
    return order, worst[max(worst)][1]


@cache
def ladder(omega3, e, clearance=USUAL):
    return pick(rows("clearance"), repeats=0, omega3=omega3, e=e, clearance=clearance)


def exact(omega3, e, of):
    return of(pick(ladder(omega3, e), integrator="event-driven")[0])


def convergence(omega3, e, of):
    """By scheme (order, error); a scheme that anywhere lacks what the exact motion has, or has what it lacks, has
    none."""
    right, found = exact(omega3, e, of), {}
    for scheme in dict.fromkeys(row["integrator"] for row in ladder(omega3, e)):
        own = pick(ladder(omega3, e), integrator=scheme)
        if scheme == "event-driven":
            continue
        values = {row["step"]: of(row) if row["status"] == "solved" else None for row in own}
        errors = {h: abs(v - right) for h, v in values.items() if v is not None and right is not None and v != right}
        found[scheme] = fit(errors) if len(values) == sum(v is not None
                                                          for v in values.values()) and right is not None else None
    return found


def statistics_table(t, n):
    es = sorted({row["e"] for row in rows("clearance")} - {0})
    lines = []
    for e in es:
        falling = {}
        for name, of, factor, unit_name in STATISTICS:
            line = [rf"{name} [{unit_name}]"]
            for start in (A, B):
                right, found = exact(start, e, of), convergence(start, e, of)
                good = [f for f in found.values() if f and f[0] >= NO_ORDER]
                if start == B:
                    falling[name] = len(good)
                known = [f[1] for f in found.values() if f]
                line += ["--" if right is None else rf"\ensuremath{{{factor * right:.{3 if factor > 1 else 5}f}}}"]
                line += [rf"\ensuremath{{{len(good)}}}"] if right is not None else ["--"]
                line += [
                    rf"{tex(factor * min(known), 1)} \dots\ {tex(factor * max(known), 1)}"
                    if known and right is not None else "--"
                ]
            lines.append(line)
        schemes = len(convergence(B, e, STATISTICS[0][1]))
        key = f"tilt/falling_{es.index(e)}"
        n[key] = ", ".join(f"{name} by {numeral(k) if k < schemes else 'all'}"
                           for name, k in sorted(falling.items(), key=lambda x: -x[1]) if k) or "none"
        if e == es[0]:
            n["tilt/all_0"] = ", ".join(name for name, k in falling.items() if k == schemes) or "none"
        n[f"tilt/floor_{es.index(e)}"] = ", ".join(name for name, k in falling.items() if not k) or "none"
        n[f"tilt/e_{es.index(e)}"] = tex(e, 1)
        lines.append(r"\midrule")
    n["tilt/b_falls"] = words(
        max(
            sum(f is not None and f[0] >= NO_ORDER for f in convergence(B, e, lambda row: row["value"]).values())
            for e in es))
    n["tilt/schemes"], n["tilt/octaves"] = numeral(schemes), numeral(OCTAVES)
    lines = lines[:len(STATISTICS)] + [r"\midrule"] + lines[len(STATISTICS) + 1:-1]
    head = ["", r"exact", "falls", "errors, finest steps", r"exact", "falls", "errors, finest steps"]
    t["statistics"] = tabular("lrrlrrl", head, lines).replace(
        r"\toprule", r"\toprule & \multicolumn{3}{l}{A, upright} & \multicolumn{3}{l}{B, $\omega_3 = " + tex(B, 1) +
        r"\,\mathrm{rad/s}$} \\")
    for index, e in enumerate(es):
        for (name, of, factor, unit_name), key in zip(STATISTICS,
                                                      ("theta", "energy", "impulse", "touch", "release", "last")):
            a, b = exact(A, e, of), exact(B, e, of)
            if key in ("energy", "impulse"):
                n[f"tilt/jump_{key}_{index}"] = rf"{tex(100 * abs(a - b) / abs(b), 1)}\,\%"
            if key == "theta":
                n[f"tilt/jump_{index}"] = tex(abs(a - b), 1) + unit("rad")
            if key == "last" and index == 0:  # the text has it of the first e
                n["tilt/jump_last"] = tex(1e6 * abs(a - b), 1) + unit(r"\mu s")


def orders_table(t, n):
    orders = [f for f in load("clearance.orders") if f["clearance"] == USUAL]
    tilts, es = sorted({f["omega3"] for f in orders}, key=lambda w: (abs(w), w)), sorted({f["e"] for f in orders})
    schemes = list(dict.fromkeys(f["integrator"] for f in orders))
    lines = []
    for scheme in schemes:
        for e in es:
            fits = [pick(orders, integrator=scheme, omega3=w, e=e) for w in tilts]
            lines.append([short(scheme) if e == es[0] else "", tex(e, 1)] +
                         [f"{tex(f[0]['order'], 2)} ({tex(f[0]['worst'][-1][1], 1)})" if f else "--" for f in fits])
        lines.append(r"\addlinespace")
    t["tilt"] = tabular("ll" + len(tilts) * "l", ["scheme", "$e$"] + [rf"$\omega_3 = {tex(w, 1)}$" for w in tilts],
                        lines[:-1])
    tilted = [f for f in orders if f["omega3"] != 0 and f["e"] > 0]
    rest = [f for f in orders if f["omega3"] == 0 or f["e"] == 0]
    good = [f for f in rest if f["e"] <= 0.4]
    n["tilt/settings"], n["tilt/below"] = count(len(tilted)), count(len([f for f in tilted if f["order"] < NO_ORDER]))
    n["tilt/greatest"] = tex(max(f["order"] for f in tilted), 2)
    n["tilt/finest_least"] = tex(min(f["worst"][-1][1] for f in tilted), 1) + unit("rad")
    n["tilt/good_settings"], n["tilt/good_least"] = count(len(good)), tex(min(f["order"] for f in good), 2)
    upright = [f for f in rest if f["e"] > 0.4]
    n["tilt/bouncy"], n["tilt/bouncy_below"] = (
        count(len(upright)),
        numeral(len([f for f in upright if f["order"] < NO_ORDER])),
    )
    n["tilt/bouncy_least"] = tex(min(f["order"] for f in upright), 2)
    n["tilt/bouncy_falls"] = words(sum(f is not None and f[0] >= NO_ORDER for f in
                                       convergence(A, max(es), lambda row: row["value"]).values()))
    n["tilt/no_order"] = tex(NO_ORDER, 1)


def clearance_table(t, n):
    orders = [
        f for f in load("clearance.orders") if f["omega3"] in (A, B) and f["integrator"] in ("moreau-jean", "rattle")
    ]
    gaps, es = sorted({f["clearance"] for f in orders}), sorted({f["e"] for f in orders})
    lines = []
    for scheme in ("moreau-jean", "rattle"):
        for start, name in ((A, "A"), (B, "B")):
            for e in es:
                fits = [pick(orders, integrator=scheme, omega3=start, e=e, clearance=g) for g in gaps]
                lines.append([code(scheme) if (start, e) == (A, es[0]) else "", name if e == es[0] else "", tex(e, 1)] +
                             [f"{tex(f[0]['order'], 2)} ({tex(f[0]['worst'][-1][1], 1)})" if f else "--" for f in fits])
        lines.append(r"\addlinespace")
    t["clearance"] = tabular("lll" + len(gaps) * "l",
                             ["scheme", "start", "$e$"] + [rf"${tex(1e3 * g, 2)}\,\mathrm{{mm}}$" for g in gaps],
                             lines[:-1])
    for name, gap in (("small", min(gaps)), ("large", max(gaps))):
        n[f"tilt/{name}_error"] = tex(max(f["worst"][-1][1] for f in pick(orders, clearance=gap)), 1) + unit("rad")
    n["tilt/clearance_least"] = tex(1e3 * min(gaps), 1) + unit("mm")
    n["tilt/clearance_most"] = tex(1e3 * max(gaps), 2) + unit("mm")
    for name, keep in (("upright", lambda f: f["omega3"] == A and f["e"] <= 0.4),
                       ("bouncy", lambda f: f["omega3"] == A and f["e"] > 0.4),
                       ("tilted", lambda f: f["omega3"] == B and f["e"] > 0)):
        own = [f for f in orders if keep(f)]
        n[f"tilt/clear_{name}"] = count(len(own))
        n[f"tilt/clear_{name}_below"] = words(len([f for f in own if f["order"] < NO_ORDER]))


def ensemble_table(t, n):
    ensemble = pick(rows("clearance"), repeats=1)
    tilted = pick(solved(ensemble), omega3=lambda w: w != 0)
    schemes = list(dict.fromkeys(row["integrator"] for row in ensemble))
    schemes.sort(key=lambda s: s != "event-driven")
    lines, apart = [], []
    for name, of, factor, unit_name in STATISTICS:
        ranges = {}
        line = [rf"{name} [{unit_name}]"]
        for scheme in schemes:
            values = [factor * of(row) for row in pick(tilted, integrator=scheme) if of(row) is not None]
            ranges[scheme] = (min(values), max(values))
            line.append(plus_minus(median(values), (max(values) - min(values)) / 2))
        low, high = ranges["event-driven"]
        looked = 1.01 * factor * tilted[0]["step"] if factor > 1 else 0  # times are ends of steps
        apart.append((name, sum(r[0] > high + looked or r[1] < low - looked for r in ranges.values())))
        lines.append(line)
    t["ensemble"] = tabular("l" + len(schemes) * "l", ["median, half of the range"] + [code(s) for s in schemes], lines)
    n["tilt/ensemble"] = count(len({row["omega3"] for row in tilted}))
    n["tilt/ensemble_most"] = tex(max(row["omega3"] for row in ensemble), 1) + unit("rad/s")
    n["tilt/ensemble_h"] = tex(1e6 * ensemble[0]["step"], 2) + unit(r"\mu s")
    n["tilt/apart"] = ", ".join(f"{name} by {numeral(k)}" for name, k in apart if k) or "none"
    n["tilt/together"] = ", ".join(name for name, k in apart if not k) or "none"


def corners_in_turn(n):
    """What a tilted face does where it first strikes, by masses and geometry; the crank has turned by omega t there,
    or a little less."""
    e = max(row["e"] for row in rows("clearance"))
    touch = exact(B, e, lambda row: row["first_touch"])
    c = coupling(mechanism()[2][0]["omega"] * touch)
    n["tilt/coupling"], n["tilt/stops_to"] = tex(c, 3), tex(stopping(c), 2)
    share, strikes = rebound(c, e)
    n["tilt/leaves"], n["tilt/strikes"] = tex(share, 2), count(strikes)


def everything(t, n):
    corners_in_turn(n)
    for part in (orders_table, statistics_table, clearance_table, ensemble_table):
        part(t, n)
    n["tilt/b"] = tex(B, 1) + unit("rad/s")
    n["tilt/looked"] = tex(1e6 * pick(rows("clearance"), integrator="event-driven", repeats=0)[0]["step"],
                           1) + unit(r"\mu s")
    n["tilt/runs"] = count(len(rows("clearance")))
    n["tilt/failed"] = words(len(rows("clearance")) - len(solved(rows("clearance"))))


def numbers(n):
    everything({}, n)


def tables(t):
    everything(t, {})
