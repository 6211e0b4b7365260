"""What the article says of the studies of friction, solvers, conservation; and the table of notation."""
import csv
import math
import re

from critical import leaning, least
from data import PAPER, code, count, load, pick, rows, short, solved, tabular, tex, unit, unsolved, words
from schemes import numeral

FIXED = ("moreau-jean", "stewart-trinkle", "paoli-schatzman", "generalized-alpha", "rattle")


TURN = 2 * math.pi
TILT = -0.01  # [rad/s]


def per_turn(row):
    return TURN * (row["energy_initial"] - row["energy_final"]) / abs(row["value"])


def friction_numbers(n):
    table = rows("friction")
    schemes = pick(table, repeats=0)
    n["friction/schemes"] = numeral(len(FIXED))
    n["friction/runs"] = count(len(schemes))
    n["friction/mu_most"] = tex(max(row["mu"] for row in table), 1)
    n["friction/h"] = tex(1e6 * schemes[0]["step"], 2) + unit(r"\mu s")
    n["friction/h_solvers"] = tex(1e3 * pick(table, repeats=1)[0]["step"], 1) + unit("ms")
    one = {row["mu"]: row for row in pick(solved(schemes), integrator="moreau-jean", omega3=0)}
    quarter = 0.25
    n["friction/lost_none"], n["friction/lost_quarter"] = tex(per_turn(one[0.0])), tex(per_turn(one[quarter]))
    n["friction/quarter"] = tex(quarter)
    jammed = min(mu for mu, row in one.items() if row["value"] < TURN / 2)
    n["friction/jam_from"], n["friction/jam_before"] = tex(jammed, 3), tex(max(mu for mu in one if mu < jammed), 3)
    leant = {row["mu"]: row for row in pick(solved(schemes), integrator="moreau-jean", omega3=TILT)}
    n["friction/jam_tilted"] = tex(min(mu for mu, row in leant.items() if row["value"] < TURN / 2), 3)
    n["friction/jam_angle"] = tex(one[jammed]["value"], 2)
    n["friction/turns_none"] = tex(one[0.0]["value"] / TURN)
    n["friction/turns_before"] = tex(max((mu, row) for mu, row in one.items() if mu < jammed)[1]["value"] / TURN)
    n["friction/unsolved"] = unsolved(schemes)
    event = pick(schemes, integrator="event-driven")
    n["friction/event_runs"], n["friction/event_failed"] = count(len(event)), words(len(event) - len(solved(event)))
    fixed = [row for row in schemes if row["integrator"] in FIXED]
    n["friction/fixed_runs"], n["friction/fixed_failed"] = count(len(fixed)), words(len(fixed) - len(solved(fixed)))
    timed = pick(table, repeats=1)
    n["friction/h_solvers"] = tex(1e3 * timed[0]["step"], 1) + unit("ms")
    n["friction/values"] = count(len({row["mu"] for row in timed}))
    n["friction/tilt"] = tex(min(row["omega3"] for row in schemes), 1) + unit("rad/s")
    worst = {
        mu: [row["value"] for row in pick(solved(schemes), omega3=0, mu=mu) if row["integrator"] in FIXED]
        for mu in one
    }
    n["friction/spread_before"] = tex(max(max(v) - min(v) for mu, v in worst.items() if mu < jammed), 1) + unit("rad")
    n["friction/spread_jammed"] = tex(max(max(v) - min(v) for mu, v in worst.items() if mu >= jammed), 1) + unit("rad")
    tilted = {
        mu: [row["value"] for row in pick(solved(schemes), omega3=TILT, mu=mu) if row["integrator"] in FIXED]
        for mu in one
    }
    at, most = max(((mu, max(v) - min(v)) for mu, v in tilted.items()), key=lambda x: x[1])
    n["friction/spread_tilted"], n["friction/spread_at"] = tex(most, 1) + unit("rad"), tex(at, 3)
    ways = {name: pick(schemes, integrator=name, omega3=0, mu=0.0)[0] for name in ("moreau-jean", "stewart-trinkle")}
    share, impulse = (ways["stewart-trinkle"][key] / ways["moreau-jean"][key] for key in ("touching", "impulse"))
    n["friction/touch_share"] = rf"{tex(100 * share, 2)}\,\%"
    n["friction/impulse_apart"] = rf"{tex(100 * abs(impulse - 1), 1)}\,\%"
    cost = {
        mu: row["seconds"]
        for mu, row in {row["mu"]: row
                        for row in pick(solved(table), repeats=1, solver="lemke")}.items()
    }
    n["friction/dear"] = tex(max(cost.values()) / cost[0.0], 2)
    friction_modes(n)
    made = [row for row in solved(schemes) if row["energy_final"] > row["energy_initial"]]
    n["friction/made_by"] = ", ".join(
        f"{words(len(own))} by {code(name)} (up to {tex(max(row['energy_final'] for row in own), 2)}" + unit("J") + ")"
        for name in dict.fromkeys(row["integrator"] for row in made) if (own := pick(made, integrator=name))) or "none"
    fixed = [row for row in solved(schemes) if row["integrator"] in FIXED]
    most = max(fixed, key=lambda row: row["max_energy_rise"])
    n["friction/rise"], n["friction/rise_at"] = tex(most["max_energy_rise"], 1) + unit("J"), tex(most["mu"], 3)
    n["friction/rise_by"] = code(most["integrator"])
    n["friction/rise_below"] = tex(max(row["max_energy_rise"] for row in fixed if row["mu"] < jammed), 1) + unit("J")
    n["friction/energy"] = tex(schemes[0]["energy_initial"], 2) + unit("J")
    n["friction/single"], n["friction/flush"] = (tex(mu, 3) for mu in least())
    n["friction/leaning"] = tex(leaning(), 3)
    beyond = pick(event, mu=lambda mu: mu > least()[0])
    n["friction/beyond_runs"], n["friction/beyond_failed"] = (
        count(len(beyond)),
        words(len(beyond) - len(solved(beyond))),
    )


def friction_modes(n):
    """How long faces slide and stick, by friction: time of both faces together."""
    modes = rows("friction.modes")
    critical = least()[0]
    locked = [
        max(pick(modes, mode="stick", mu=mu), key=lambda r: r["end"] - r["begin"]) for mu in {r["mu"]
                                                                                              for r in modes}
        if mu > critical
    ]
    n["modes/locked"] = tex(1e3 * max(row["begin"] for row in locked), 2) + unit("ms")
    n["modes/tilt_below"] = tex(max(row["tilt"] for row in modes if row["mu"] < critical), 1) + unit("rad")
    n["modes/tilt_beyond"] = tex(min(max(r["tilt"] for r in pick(modes, mu=row["mu"]))
                                     for row in locked), 1) + unit("rad")
    below = [row for row in modes if row["mu"] < critical]
    n["modes/stick_below"] = tex(
        1e3 *
        max(sum(r["end"] - r["begin"] for r in pick(below, mode="stick", mu=mu))
            for mu in {r["mu"]
                       for r in below}), 2) + unit("ms")


def friction_tables(t):
    table = pick(rows("friction"), repeats=0)
    shown = (0, 0.25, 0.5, 1, 2, 3, 4.75, 6)
    lines = []
    for omega3, name in ((0, "upright"), (TILT, "tilted")):
        for label, what in (("energy left [J]", lambda r: r["energy_final"]),
                            (r"$\theta_1$ at the end [rad]", lambda r: r["value"]), ("time in contact [ms]",
                                                                                     lambda r: 1e3 * r["touching"])):
            lines.append([f"{name}: {label}"] + [
                tex(what(pick(table, integrator="moreau-jean", omega3=omega3, mu=mu)[0]), 3) for mu in shown])
        spread = []
        for mu in shown:
            values = [row["value"] for row in pick(solved(table), omega3=omega3, mu=mu) if row["integrator"] in FIXED]
            spread.append(tex(max(values) - min(values), 1) if len(values) > 1 else "--")
        lines.append([rf"{name}: spread of $\theta_1$, fixed-step schemes"] + spread)
        ended = [f"{len(pick(solved(table), omega3=omega3, mu=mu))}" for mu in shown]
        lines.append([f"{name}: schemes that end solved"] + [rf"\ensuremath{{{x}}}" for x in ended])
        lines.append(r"\midrule")
    t["friction"] = tabular("l" + len(shown) * "r",
                            [r"$\mu$"] + [tex(mu, 3 if mu == 4.75 else 2 if mu % 1 else 1) for mu in shown], lines[:-1])


def solvers(t, n):
    summary, families = rows("shootout.summary"), rows("shootout.families")
    about = load("shootout.about")
    crank = pick(rows("slider_crank"), integrator="moreau-jean:joints=symmetric", repeats=0, e=0.4)
    crank = [row for row in crank if row["step"] > 0.99e-4 and row["step"] < 1.01e-4]
    friction = pick(rows("friction"), repeats=1)

    def tally(solver, keep):
        own = [row for row in families if row["solver"] == solver and keep(row["family"])]
        return sum(int(r["problems"]) for r in own if r["result"] == "certified"), sum(int(r["problems"]) for r in own)

    lines = []
    for row in sorted(summary, key=lambda r: -r["certified"]):
        name = row["solver"]
        good, asked = tally(name, lambda f: f == "steps")
        runs = pick(crank, solver=name)
        jam = pick(friction, solver=name)
        lines.append([
            code(name), *(count(int(k))
                          for k in (row["certified"], row["refused"], row["failed"] + row["skipped"], row["wrong"])),
            tex(row["median_time_to_best"]), rf"\ensuremath{{{good}/{asked}}}",
            rf"\ensuremath{{{len(solved(runs))}/{len(runs)}}}" if runs else "--",
            rf"\ensuremath{{{len(solved(jam))}/{len(jam)}}}" if jam else "--"
        ])
    t["solvers"] = tabular("lrrrrrrrr",
                           ["solver", "certified", "refused", "failed", "wrong", "time", "steps", "runs", "jam"], lines)
    n["solvers/scenes"] = numeral(
        len(about["options"]["scenes"]) if isinstance(about["options"]["scenes"], list
                                                      ) else len(about["options"]["scenes"].split()))
    n["solvers/problems"] = count(int(summary[0]["problems"]))
    n["solvers/solvers"] = count(len(summary))
    n["solvers/largest"] = count(int(about["options"]["largest"]))
    n["solvers/time_limit"] = tex(about["options"]["time_limit"], 1) + unit("s")
    n["solvers/wrong"] = words(sum(int(row["wrong"]) for row in summary))
    n["solvers/crashed"] = words(sum(int(row["crashed"]) for row in summary))
    n["solvers/steps"] = count(tally("lemke", lambda f: f == "steps")[1])
    n["solvers/crank_h"] = tex(1e3 * crank[0]["step"], 1) + unit("ms")
    best = max(summary, key=lambda r: r["certified"])
    n["solvers/best"], n["solvers/best_certified"] = code(best["solver"]), count(int(best["certified"]))
    steps = {row["solver"]: tally(row["solver"], lambda f: f == "steps") for row in summary}
    n["solvers/all_steps"] = ", ".join(code(name) for name, (good, asked) in steps.items() if good == asked)
    n["solvers/lemke_steps"] = count(steps["lemke"][0])
    jams = {name: pick(friction, solver=name) for name in dict.fromkeys(row["solver"] for row in friction)}
    n["solvers/all_jams"] = ", ".join(code(name) for name, own in jams.items() if len(solved(own)) == len(own))
    for name in ("auto", "lemke", "path", "newton-min", "newton-fb"):
        n[f"solvers/{name}_time"] = tex(pick(summary, solver=name)[0]["median_time_to_best"])
    for name in ("lemke", "pgs", "newton-min", "newton-fb"):
        n[f"solvers/{name}"] = count(int(pick(summary, solver=name)[0]["certified"]))


def slope(points):
    """Of the logarithm of the drift in that of the step, by least squares."""
    xy = [(math.log(x), math.log(y)) for x, y in points if y > 1e-12]
    if len(xy) < 2:
        return None
    mean_x, mean_y = (sum(z) / len(xy) for z in zip(*xy))
    return sum((x - mean_x) * (y - mean_y) for x, y in xy) / sum((x - mean_x) ** 2 for x, _ in xy)


def conservation(t, n):
    table = rows("conservation")
    scenes = ("chain", "n_four_bar", "slider_crank_ideal")
    schemes = list(dict.fromkeys(row["integrator"] for row in table))
    lines = []
    for integrator in schemes:
        line = [short(integrator)]
        for scene in scenes:
            own = sorted(pick(solved(table), scene=scene, integrator=integrator), key=lambda r: r["step"]
                         if r["rtol"] is None else r["rtol"])
            power = slope([(r["step"], r["energy_drift"]) for r in own]) if own and own[0]["rtol"] is None else None
            line += [tex(own[0]["energy_drift"], 1) if own else "--", tex(power, 2) if power else "--"]
        for scene in ("bouncing_ball", "slider_crank"):
            own = sorted(pick(solved(table), scene=scene, integrator=integrator), key=lambda r: r["step"])
            line.append(tex(own[0]["energy_drift"], 1) if own else "--")
        lines.append(line)
    t["energy"] = tabular(
        "lrlrlrlrr",
        ["scheme", *(x for s in ("chain", "four-bar", "crank") for x in (s, "power")), "ball", "crank, $e = 1$"],
        lines,
    )
    box = [row for row in table if "floating_box" in row["scene"]]
    lines = []
    for integrator in schemes:
        own = pick(solved(box), integrator=integrator)
        if not own:
            continue
        finest = min(row["step"] for row in own)
        fine = pick(own, step=finest)
        smooth = pick(own, **{"collision.all.mu": 0, "collision.all.e_n": 1})
        spin = None if integrator == "adaptive" else slope([
            (row["step"], row["spin_drift"]) for row in pick(own, **{"collision.all.mu": 0.3, "collision.all.e_n": 0.8})
        ])
        lines.append([
            short(integrator),
            tex(max(row["momentum_drift"] for row in own), 1),
            tex(max(row["spin_drift"] for row in fine), 1),
            tex(spin, 2) if spin else "--",
            tex(max(row["energy_drift"] for row in smooth), 1),
            tex(max(row["max_energy_rise"] for row in fine), 1),
            tex(max(row["max_penetration"] for row in fine), 1)
        ])
    t["box"] = tabular("lrrrrrr",
                       ["scheme", "momentum", "spin", "power", r"energy, $\mu=0$, $e=1$", "energy rise", "penetration"],
                       lines)
    n["conservation/runs"], n["conservation/failed"] = count(len(table)), words(len(table) - len(solved(table)))
    for name, scene in (("long", "chain"), ("short", "slider_crank_ideal"), ("longest", "bouncing_ball")):
        n[f"conservation/{name}"] = tex(pick(table, scene=scene)[0]["duration"], 3) + unit("s")
    n["conservation/joints"] = tex(max(row["max_joint_residual"] for row in solved(table)), 1)
    for name, joints in (("classical", ":joints=position"), ("symmetric", "")):
        bars = pick(table, scene="n_four_bar", integrator="moreau-jean" + joints)
        n[f"conservation/{name}_power"] = tex(slope([(r["step"], r["energy_drift"]) for r in bars]), 2)
    folded = pick(solved(table), scene="n_four_bar", integrator="rattle")
    n["conservation/folded"] = tex(max(r["energy_drift"] for r in folded), 2) + unit("J")
    n["conservation/unsolved"] = unsolved(table)
    classical = pick(table, scene="slider_crank_ideal", integrator="moreau-jean:joints=position")
    symmetric = pick(table, scene="slider_crank_ideal", integrator="moreau-jean")
    least = min((r["step"], r["energy_drift"]) for r in classical)
    n["conservation/classical_drift"] = tex(least[1], 1) + unit("J")
    n["conservation/symmetric_drift"] = tex(min((r["step"], r["energy_drift"]) for r in symmetric)[1], 1) + unit("J")
    n["conservation/h"] = tex(1e6 * least[0], 3) + unit(r"\mu s")
    n["conservation/energy"] = tex(classical[0]["energy_initial"], 3) + unit("J")
    rubbing = max(pick(box, **{"collision.all.mu": lambda mu: mu > 0}), key=lambda r: r["max_energy_rise"])
    n["conservation/rise"], n["conservation/rise_by"] = (
        tex(rubbing["max_energy_rise"], 1) + unit("J"),
        code(rubbing["integrator"]),
    )
    smooth = pick(box, integrator=rubbing["integrator"], **{"collision.all.mu": 0})
    n["conservation/rise_smooth"] = tex(max(r["max_energy_rise"] for r in smooth), 1) + unit("J")
    n["conservation/rise_event"] = tex(max(r["max_energy_rise"]
                                           for r in pick(box, integrator="event-driven")), 1) + unit("J")
    for name, integrator in (("event", "event-driven"), ("adaptive", "adaptive")):
        n[f"conservation/spin_{name}"] = tex(max(r["spin_drift"] for r in pick(solved(box), integrator=integrator)), 1)
    ball = pick(table, scene="bouncing_ball", integrator="moreau-jean")
    n["conservation/ball"] = tex(max(r["energy_drift"] for r in ball), 1) + unit("J")


def notation(t):
    """notation.csv, which the documentation shows as well; its formulas are LaTeX."""
    with open(PAPER / "notation.csv", newline="") as file:
        header, *lines = csv.reader(file)

    def plain(text):
        return re.sub(r"`([^`]*)`", lambda m: code(m.group(1)), text.replace("²", r"\textsuperscript{2}"))

    t["notation"] = tabular(r"lp{0.18\textwidth}p{0.36\textwidth}p{0.12\textwidth}l", header,
                            [[plain(cell) for cell in line] for line in lines])


def numbers(n):
    friction_numbers(n)
    solvers({}, n)
    conservation({}, n)


def tables(t):
    friction_tables(t)
    solvers(t, {})
    conservation(t, {})
    notation(t)
