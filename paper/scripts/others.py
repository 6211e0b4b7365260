"""What the article says of studies 2 to 5: friction, tilt, solvers, conservation; and the table of notation."""
import math
import re
from statistics import median

from data import PAPER, code, count, load, pick, plus_minus, rows, short, solved, tabular, tex, unit, unsolved, words

FIXED = ("moreau-jean", "stewart-trinkle", "paoli-schatzman", "generalized-alpha", "rattle")


TURN = 2 * math.pi


def per_turn(row):
    return TURN * (row["energy_initial"] - row["energy_final"]) / abs(row["value"])


def friction_numbers(n):
    table = rows("friction")
    schemes = pick(table, repeats=0)
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
    made = [row for row in solved(schemes) if row["energy_final"] > row["energy_initial"]]
    n["friction/made_by"] = ", ".join(
        f"{words(len(own))} by {code(name)} (up to {tex(max(row['energy_final'] for row in own), 2)}" + unit("J") + ")"
        for name in dict.fromkeys(row["integrator"] for row in made) if (own := pick(made, integrator=name))) or "none"
    n["friction/energy"] = tex(schemes[0]["energy_initial"], 2) + unit("J")
    single = load("given")
    n["friction/single"], n["friction/flush"] = tex(single["single_corner"]["value"], 2), tex(single["flush_face"]["value"], 3)


def friction_tables(t):
    table = pick(rows("friction"), repeats=0)
    shown = (0, 0.25, 0.5, 1, 2, 3, 4.75, 6)
    lines = []
    for omega3, name in ((0, "upright"), (-0.01, "tilted")):
        for label, what in (("energy left [J]", lambda r: r["energy_final"]), (r"$\theta_1$ at the end [rad]", lambda r: r["value"]),
                            ("time in contact [ms]", lambda r: 1e3 * r["touching"])):
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
    t["friction"] = tabular("l" + len(shown) * "r", [r"$\mu$"] + [tex(mu, 3 if mu == 4.75 else 2 if mu % 1 else 1) for mu in shown],
                            lines[:-1])


def spread_of(table, integrator, column):
    values = [column(row) for row in pick(solved(table), integrator=integrator)]
    return plus_minus(median(values), (max(values) - min(values)) / 2)


def tilt(t, n):
    orders = [fit for fit in load("clearance.orders") if fit["clearance"] == 0.001]
    tilts, es = sorted({fit["omega3"] for fit in orders}), sorted({fit["e"] for fit in orders})
    lines = []
    for integrator in ("moreau-jean", "rattle"):
        for e in es:
            fits = [pick(orders, integrator=integrator, omega3=w, e=e) for w in tilts]
            lines.append([short(integrator) if integrator != "rattle" else code("rattle"), tex(e, 1)] +
                         [f"{tex(f[0]['order'], 2)} ({tex(f[0]['worst'][-1][1], 1)})" if f else "--" for f in fits])
    t["tilt"] = tabular("ll" + len(tilts) * "l", ["scheme", "$e$"] + [rf"$\omega_3 = {tex(w, 1)}$" for w in tilts], lines)
    ensemble = pick(rows("clearance"), repeats=1)
    lines = []
    for label, column in ((r"$\theta_1$ at the end [rad]", lambda r: r["value"]),
                          ("energy lost [J]", lambda r: r["energy_initial"] - r["energy_final"]),
                          (r"sum of normal impulses [N\,s]", lambda r: r["impulse"]),
                          ("first touch [ms]", lambda r: 1e3 * r["first_touch"])):
        lines.append([label] + [spread_of(ensemble, i, column) for i in ("event-driven", "moreau-jean", "rattle")])
    t["ensemble"] = tabular("llll", ["median, half of the range"] + [code(i) for i in ("event-driven", "moreau-jean", "rattle")],
                            lines)
    n["tilt/ensemble"] = count(len({row["omega3"] for row in ensemble}))
    n["tilt/ensemble_most"] = tex(max(row["omega3"] for row in ensemble), 1) + unit("rad/s")
    n["tilt/ensemble_h"] = tex(1e6 * ensemble[0]["step"], 2) + unit(r"\mu s")
    event = pick(solved(ensemble), integrator="event-driven")
    upright = [row["value"] for row in event if row["omega3"] == 0][0]
    tilted = [row["value"] for row in event if row["omega3"] != 0]
    n["tilt/jump"] = tex(min(abs(upright - value) for value in tilted), 1) + unit("rad")
    n["tilt/runs"] = count(len(rows("clearance")))
    n["tilt/failed"] = words(len(rows("clearance")) - len(solved(rows("clearance"))))
    clear = [fit for fit in load("clearance.orders") if fit["omega3"] == 0 and fit["e"] == 0.4]
    for name in ("moreau-jean", "rattle"):
        of = {fit["clearance"]: fit for fit in clear if fit["integrator"] == name}
        n[f"tilt/order_clearance_{name}_least"] = tex(min(f["order"] for f in of.values()))
        n[f"tilt/order_clearance_{name}_most"] = tex(max(f["order"] for f in of.values()))
    n["tilt/clearance_least"] = tex(1e3 * min(f["clearance"] for f in clear), 1) + unit("mm")
    n["tilt/clearance_most"] = tex(1e3 * max(f["clearance"] for f in clear), 2) + unit("mm")


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
        lines.append([code(name), *(count(int(k)) for k in (row["certified"], row["refused"], row["failed"] + row["skipped"], row["wrong"])),
                      tex(row["median_time_to_best"]), rf"\ensuremath{{{good}/{asked}}}",
                      rf"\ensuremath{{{len(solved(runs))}/{len(runs)}}}" if runs else "--",
                      rf"\ensuremath{{{len(solved(jam))}/{len(jam)}}}" if jam else "--"])
    t["solvers"] = tabular("lrrrrrrrr", ["solver", "certified", "refused", "failed", "wrong", "time", "steps", "runs", "jam"],
                           lines)
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
            own = sorted(pick(solved(table), scene=scene, integrator=integrator), key=lambda r: r["step"] if r["rtol"] is None else r["rtol"])
            power = slope([(r["step"], r["energy_drift"]) for r in own]) if own and own[0]["rtol"] is None else None
            line += [tex(own[0]["energy_drift"], 1) if own else "--", tex(power, 2) if power else "--"]
        for scene in ("bouncing_ball", "slider_crank"):
            own = sorted(pick(solved(table), scene=scene, integrator=integrator), key=lambda r: r["step"])
            line.append(tex(own[0]["energy_drift"], 1) if own else "--")
        lines.append(line)
    t["energy"] = tabular("lrlrlrlrr", ["scheme", *(x for s in ("chain", "four-bar", "crank") for x in (s, "power")), "ball",
                                        "crank, $e = 1$"], lines)
    box = [row for row in table if "floating_box" in row["scene"]]
    lines = []
    for integrator in schemes:
        own = pick(solved(box), integrator=integrator)
        if not own:
            continue
        finest = min(row["step"] for row in own)
        fine = pick(own, step=finest)
        smooth = pick(own, **{"collision.all.mu": 0, "collision.all.e_n": 1})
        spin = None if integrator == "adaptive" else slope([(row["step"], row["spin_drift"]) for row in pick(own, **{"collision.all.mu": 0.3, "collision.all.e_n": 0.8})])
        lines.append([short(integrator), tex(max(row["momentum_drift"] for row in own), 1),
                      tex(max(row["spin_drift"] for row in fine), 1), tex(spin, 2) if spin else "--",
                      tex(max(row["energy_drift"] for row in smooth), 1), tex(max(row["energy_rise"] for row in fine), 1),
                      tex(max(row["max_penetration"] for row in fine), 1)])
    t["box"] = tabular("lrrrrrr", ["scheme", "momentum", "spin", "power", r"energy, $\mu=0$, $e=1$", "energy rise", "penetration"],
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
    n["conservation/rise"] = tex(max(r["energy_rise"] for r in box), 1) + unit("J")
    n["conservation/rise_event"] = tex(max(r["energy_rise"] for r in pick(box, integrator="event-driven")), 1) + unit("J")
    for name, integrator in (("event", "event-driven"), ("adaptive", "adaptive")):
        n[f"conservation/spin_{name}"] = tex(max(r["spin_drift"] for r in pick(solved(box), integrator=integrator)), 1)
    ball = pick(table, scene="bouncing_ball", integrator="moreau-jean")
    n["conservation/ball"] = tex(max(r["energy_drift"] for r in ball), 1) + unit("J")


def notation(t):
    """The table of notes/notation.md, which the documentation shows as well, in LaTeX."""
    letters = {"θ": r"\theta", "Φ": r"\Phi", "γ": r"\gamma", "Λ": r"\Lambda", "μ": r"\mu", "ρ": r"\rho", "ε": r"\varepsilon",
               "∂": r"\partial ", "Σ": r"\sum", "ω": r"\omega", "ξ": r"\xi"}

    def maths(symbols):
        text = re.sub(r"_(\w+)", r"_{\1}", symbols)
        return "$" + "".join(letters.get(c, c) for c in text) + "$"

    def words(text):
        formulas = {"∂Φ/∂q": r"$\partial\Phi/\partial q$", "w = A z + b": "$w = A z + b$", "to z within": "to $z$ within",
                    "3N": "$3N$", "units of w": "units of $w$", "²": r"\textsuperscript{2}"}
        for plain, formula in formulas.items():
            text = text.replace(plain, formula)
        text = re.sub(r"\b(W_[NT]) v", lambda m: maths(m.group(0)), text)
        text = "".join(rf"\ensuremath{{{letters[c]}}}" if c in letters else c for c in text)
        return re.sub(r"`([^`]*)`", lambda m: code(m.group(1)), text)

    lines = []
    for line in (PAPER / "notes/notation.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if not line.startswith("|") or cells[0] in ("symbol", "---"):
            continue
        if cells[0] == "ρ":
            cells[2] = "rounding level of $w$, below which it is unknown"
        lines.append([", ".join(maths(s.strip()) for s in cells[0].split(",")), words(cells[1]), words(cells[2]), words(cells[3])])
    t["notation"] = tabular("llp{0.37\\textwidth}l", ["symbol", "in the program", "meaning", "size; unit"], lines)


def numbers(n):
    friction_numbers(n)
    tilt({}, n)
    solvers({}, n)
    conservation({}, n)


def tables(t):
    friction_tables(t)
    tilt(t, {})
    solvers(t, {})
    conservation(t, {})
    notation(t)
