"""What the article says of the slider-crank: the mechanism itself and the first study, convergence and cost."""
import math
import re
import tomllib
from statistics import median, quantiles

from data import PAPER, code, count, load, pick, rows, short, solved, tabular, tex, unit, unsolved, words
from schemes import numeral

CLASSICAL, SYMMETRIC = "moreau-jean:joints=position", "moreau-jean:joints=symmetric"
NEAR = (0.9e-5, 1.1e-5)  # [s]
CLEARLY = 0.5  # cheaper: at most that part of the time, which no noise of a machine makes; the text says "half"
NEAR_UNIT = 1e-4  # [rad] of the table of errors there
WELL = 0.4  # restitution up to which the motion is well conditioned
FIXED = (CLASSICAL, SYMMETRIC, "stewart-trinkle", "anitescu-potra", "paoli-schatzman", "generalized-alpha", "rattle")
STUDIES = ("slider_crank", "friction", "clearance", "conservation", "shootout")
TARGETS = tuple(f"1e-{k}" for k in range(2, 10))
FIGURES = PAPER.parent / "experiments/docs/data/figures.toml"


def mechanism():
    scene = tomllib.loads((PAPER.parent / "core/scenes/slider_crank.toml").read_text())
    return scene, {body["name"]: body for body in scene["body"]}, {c["name"]: c for c in scene["contact"]}


def time_to_error():
    """Milliseconds of each integrator to an error, from the one data file of performance figures; None: not reached."""
    table = tomllib.loads(FIGURES.read_text(encoding="utf-8"))["time_to_error"]
    return {SYMMETRIC if name == "moreau-jean" else name: {"integrator": SYMMETRIC if name == "moreau-jean" else name} |
            {k: None if x == "–" else x for k, x in zip(table["columns"][1:], cells)} for name, *cells in table["rows"]}


def reference():
    """What is said of the exact motion where it stands: (agreement [rad], time to which e = 0.9 is well conditioned
    [s], final theta1 by (mu, e))."""
    scenes = PAPER.parent / "core/scenes"
    said = re.sub(r"\n//\s*", " ", (scenes / "slider_crank_exact.h").read_text())
    agreement = re.search(r"two tolerance sets agree to ([\d.e-]+) rad", said).group(1)
    until = re.search(r"with e = 0\.9 to about ([\d.]+) s only", said).group(1)
    golden = re.search(r"kGolden\[\] = \{(.*?)\n\};", (scenes / "slider_crank_exact.cpp").read_text(), re.S).group(1)
    lines = [[float(x) for x in re.sub(r"//.*", "", line).strip(" {},").split(",")] for line in golden.split("\n")
             if line.strip().startswith("{")]
    return float(agreement), float(until), {(mu, e): theta1 for mu, e, theta1, *_ in lines}


def untimed(table):
    return pick(table, repeats=0, solver="lemke")


def near(table, integrator, mu, e):
    return max(row["error"] for row in pick(solved(untimed(table)), integrator=integrator, mu=mu, e=e,
                                            step=lambda h: NEAR[0] <= h <= NEAR[1]))


def fits(integrator, keep):
    return [fit for fit in load("slider_crank.orders") if fit["integrator"] == integrator and fit["solver"] == "lemke"
            and keep(fit["e"])]


def numbers(n):
    """Figures about the slider-crank, in the order of the text: one list."""
    table = rows("slider_crank")
    scene, bodies, contacts = mechanism()
    agreement, conditioned, final = reference()
    n["mechanism/coordinates"] = count(3 * len(bodies))
    n["mechanism/joint_rows"] = count(2 * len(scene["joint"]))
    n["mechanism/omega1"] = tex(bodies["crank"]["omega"], 3)
    law = next(iter(contacts.values()))
    n["mechanism/conditioned"] = tex(conditioned) + unit("s")
    n["mechanism/mu"], n["mechanism/e"] = tex(law["mu"], 1), tex(law["e_n"], 1)
    n["mechanism/reference_agreement"] = tex(agreement) + unit("rad")
    n["crank/duration"] = tex(scene["duration"], 1)
    n["crank/turns"] = tex(final[law["mu"], law["e_n"]] / (2 * math.pi))
    n["crank/e_bad"] = tex(max(row["e"] for row in table), 1)
    n["crank/e_well"] = tex(WELL, 1)
    n["crank/near_unit"] = tex(NEAR_UNIT, 1) + unit("rad")
    n["crank/h_near"] = tex(1e6 * sum(NEAR) / 2, 2) + unit(r"\mu s")
    fixed_runs = [row for row in table if row["solver"] == "lemke"]
    n["crank/runs_lemke"] = count(len(fixed_runs))
    n["crank/unsolved_lemke"] = words(len(fixed_runs) - len(solved(fixed_runs)))
    moreau = [row for name in ("slider_crank", "friction") for row in rows(name)
              if row["solver"] == "lemke" and row["integrator"].startswith("moreau-jean")]
    n["crank/moreau_runs"], n["crank/moreau_failed"] = count(len(moreau)), words(len(moreau) - len(solved(moreau)))
    n["crank/joint_residual"] = tex(max(row["max_joint_residual"] for row in solved(fixed_runs)), 1)
    n["crank/lcp_residual"] = tex(max(row["max_lcp_residual"] for row in solved(fixed_runs)), 1)
    best = [
        min((row
             for row in pick(solved(table), integrator="event-driven", mu=mu, e=e)), key=lambda r: r["rtol"])["error"]
        for mu in (0, 0.01, 0.1) for e in (0, WELL)
    ]
    n["crank/adaptive_best"] = tex(
        max(
            min(row["error"] for row in pick(solved(table), integrator="adaptive", mu=mu, e=e)) for mu in (0, 0.01, 0.1)
            for e in (0, WELL)), 1) + unit("rad")
    n["crank/event_driven_best"] = tex(max(best), 1)
    ratios = [near(table, CLASSICAL, mu, e) / near(table, SYMMETRIC, mu, e) for mu in (0, 0.01, 0.1) for e in (0, WELL)]
    n["crank/ratio_least"], n["crank/ratio_most"] = tex(min(ratios)), tex(max(ratios))
    for name, integrator in (("classical", CLASSICAL), ("symmetric", SYMMETRIC)):
        bad = [near(table, integrator, mu, max(row["e"] for row in table)) for mu in (0, 0.01, 0.1)]
        n[f"crank/bad_{name}_least"], n[f"crank/bad_{name}_most"] = tex(min(bad), 1), tex(max(bad), 1)
    for name, integrator in (("classical", CLASSICAL), ("symmetric", SYMMETRIC), ("rattle", "rattle")):
        orders = [fit["order"] for fit in fits(integrator, lambda e: e <= WELL)]
        n[f"crank/order_{name}_least"], n[f"crank/order_{name}_most"] = tex(min(orders), 3), tex(max(orders), 3)
    common = pick(solved(table), integrator=SYMMETRIC, solver="lemke", e=WELL, repeats=0, step=1e-4)
    error = max(row["error"] for row in common)
    per_mu = abs(final[0.01, WELL] - final[0.0, WELL]) / 0.01
    n["crank/h_common"] = tex(1e3 * common[0]["step"], 1) + unit("ms")
    n["crank/error_common"], n["crank/as_mu"] = tex(error, 1) + unit("rad"), tex(error / per_mu, 1)
    inelastic = [fit["order"] for fit in fits("rattle", lambda e: e == 0)]
    n["crank/order_rattle_inelastic"] = tex(min(inelastic), 3)
    times = time_to_error()
    for target, name in (("1e-3", "e3"), ("1e-6", "e6")):
        n[f"crank/adaptive_{name}"] = tex(times["adaptive"][target]) + unit("ms")
    n["crank/event_driven_e9"] = tex(times["event-driven"]["1e-9"]) + unit("ms")
    cost = {(row["integrator"], row["mu"], row["e"], row["step"]): row["seconds"]
            for row in pick(solved(table), repeats=lambda n: n > 0, rtol=None)}
    pairs = sorted(cost[SYMMETRIC, *case] / seconds for (name, *case), seconds in cost.items()
                   if name == CLASSICAL and (SYMMETRIC, *case) in cost)
    low, middle, high = quantiles(pairs, n=4)
    n["crank/cost_ratio"], n["crank/cost_low"], n["crank/cost_high"] = tex(middle), tex(low), tex(high)
    scatter = [row["slowest"] / row["seconds"] - 1 for row in solved(table) if row["slowest"]]
    n["crank/scatter_median"], n["crank/scatter_most"] = (rf"{tex(100 * x, 1)}\,\%"
                                                          for x in (median(scatter), max(scatter)))
    slow, quick = ([row for name, row in times.items() if (name in FIXED) == fixed] for fixed in (True, False))
    cheapest = {
        k: [min((row[k] for row in some if row[k]), default=math.inf) for some in (slow, quick)]
        for k in TARGETS
    }
    wins = [
        k for i, k in enumerate(TARGETS)
        if all(quick <= CLEARLY * slow for slow, quick in (cheapest[j] for j in TARGETS[i:]))
    ]
    n["crank/tolerance_from"] = tex(float(wins[0]), 1) + unit("rad")
    n["crank/fixed_then"], n["crank/tolerance_then"] = (tex(ms) + unit("ms") for ms in cheapest[wins[0]])
    last = max(slow, key=lambda row: sum(row[k] is not None for k in TARGETS))
    n["crank/fixed_last"] = last["integrator"].split(":")[0]
    relaxed = [fit["order"] for fit in load("slider_crank.orders")
               if fit["integrator"] == "anitescu-potra" and fit["mu"] > 0 and fit["e"] > 0]
    n["crank/order_anitescu_most"] = tex(max(relaxed), 1)
    n["crank/repeats"] = numeral(int(max(row["repeats"] for row in table)))
    runner = (PAPER.parent / "experiments/sweep/case.cpp").read_text()
    n["crank/repeats_least"] = numeral(int(re.search(r"kLeast = (\d+);", runner).group(1)))
    n["crank/mus"] = numeral(len({mu for mu, e in final}))
    n["crank/es_well"] = numeral(len({e for mu, e in final if e <= WELL}))
    n["crank/near_share"] = rf"{tex(100 * (NEAR[1] - NEAR[0]) / sum(NEAR), 2)}\,\%"
    solver_share(n, table)
    n["crank/symmetric_e3"] = tex(times[SYMMETRIC]["1e-3"]) + unit("ms")
    timed = pick(solved(table), integrator=CLASSICAL, repeats=3)
    n["crank/classical_finest"] = tex(1e6 * min(row["step"] for row in timed), 2) + unit(r"\mu s")
    finest = pick(timed, step=min(row["step"] for row in timed))
    n["crank/classical_finest_error"] = tex(max(row["error"] for row in finest), 1)
    n["crank/symmetric_e2"] = tex(times[SYMMETRIC]["1e-2"]) + unit("ms")
    adaptive = max(row["lcp_solves"] for row in pick(solved(table), integrator="adaptive", rtol=1e-6))
    n["crank/adaptive_solves"] = count(int(adaptive))
    step = min(row["step"] for row in pick(table, integrator=SYMMETRIC, repeats=3))
    finest = pick(solved(table), integrator=SYMMETRIC, repeats=3, step=step)
    n["crank/symmetric_solves"] = count(int(max(row["lcp_solves"] for row in finest)))
    n["crank/symmetric_finest_error"] = tex(max(row["error"] for row in finest), 1)
    made = load("slider_crank.about")
    revisions = dict.fromkeys(load(f"{name}.about")["revision"] for name in STUDIES)
    n["machine/revision"] = " and ".join(code(revision) for revision in revisions)
    n["machine/cpu"] = re.sub(r"\((R|TM)\)", "", made["cpu"]).replace("@", "at").strip()
    n["machine/cores"] = count(made["cores"])
    n["machine/compiler"] = made["compiler"]
    figures = tomllib.loads(FIGURES.read_text(encoding="utf-8"))["time_to_error"]
    n["machine/times"] = figures["machine"]
    n["machine/times_date"], n["machine/times_revision"] = (
        figures["date"],
        code(figures["revision"].removesuffix("+changes")),
    )


def solver_share(n, table):
    """Solvers away from the one setting at which all of them are run: do they end, and with the same motion?"""
    others = [
        row for row in table
        if row["repeats"] == 0 and row["solver"] not in ("lemke", "ipopt", "nlopt") and row["e"] != WELL
    ]
    key = ("integrator", "mu", "e", "step")
    settings = {tuple(row[k] for k in key) for row in others}
    lemke = {tuple(row[k] for k in key): row["error"] for row in pick(solved(table), solver="lemke", repeats=0)}
    n["solvers/share_runs"], n["solvers/share_solvers"] = (
        count(len(others)),
        count(len({row["solver"] for row in others})),
    )
    n["solvers/share_settings"], n["solvers/share_schemes"] = (
        count(len(settings)),
        numeral(len({s[0] for s in settings})),
    )
    n["solvers/share_unsolved"] = unsolved(others, "solver")
    n["solvers/share_refused"] = words(len(pick(others, status="unsupported")))
    n["solvers/share_apart"] = tex(max(abs(row["error"] - lemke[at]) for row in solved(others)
                                       if (at := tuple(row[k] for k in key)) in lemke), 1) + unit("rad")


def tables(t):
    table = rows("slider_crank")
    scene, bodies, contacts = mechanism()
    half, crank, rod = contacts["corner2"]["point"], scene["joint"][0]["point_b"], scene["joint"][1]["point_b"]
    lines = [["crank", tex(2 * abs(crank[0]), 3), tex(bodies["crank"]["mass"]), tex(bodies["crank"]["inertia"])],
             ["rod", tex(2 * abs(rod[0]), 3), tex(bodies["rod"]["mass"]), tex(bodies["rod"]["inertia"])],
             ["slider", rf"{tex(2 * half[0], 1)} by {tex(2 * half[1], 1)}",
              tex(bodies["slider"]["mass"]), tex(bodies["slider"]["inertia"])]]
    wall = abs(contacts["corner2"]["wall"]["point"][1]) - half[1]
    lines.append([r"clearance, each side", tex(wall, 1), "", ""])
    t["parameters"] = tabular("llll", ["", "length [m]", "mass [kg]", r"inertia [kg\,m\textsuperscript{2}]"], lines)

    def in_units(x):  # one power of ten for all, so that they compare at a glance
        return rf"\ensuremath{{{float(f'{x:.2g}') / NEAR_UNIT:.6g}}}"

    lines = [[rf"{name}, $e = {tex(e, 1)}$"] + [in_units(near(table, i, mu, e)) for mu in (0, 0.01, 0.1)]
             for e in (0, 0.4, 0.9) for i, name in ((CLASSICAL, "classical"), (SYMMETRIC, "symmetric"))]
    lines[4:4], lines[2:2] = [r"\addlinespace"], [r"\addlinespace"]
    t["near"] = tabular("lrrr", ["joints"] + [rf"$\mu = {tex(mu, 1)}$" for mu in (0, 0.01, 0.1)], lines)

    lines = []
    for integrator in FIXED:
        line = [short(integrator)]
        for keep in (lambda e: e == 0, lambda e: e == WELL, lambda e: e > WELL):
            some = fits(integrator, keep)
            orders = [fit["order"] for fit in some]
            line += [
                rf"{tex(min(orders), 3)} \dots\ {tex(max(orders), 3)}",
                tex(max(fit["scatter"] for fit in some), 1)
            ]
        lines.append(line)
    es = [tex(e, 1) for e in (0, 0.4, 0.9)]
    t["orders"] = tabular("lllllll", ["scheme"] + [x for e in es for x in (rf"$e = {e}$", "scatter")], lines)

    lines = [[short(row["integrator"])] +
             ["--" if row[k] is None else tex(row[k]) for k in TARGETS] for row in time_to_error().values()
             if any(row[k] is not None for k in TARGETS)]
    t["times"] = tabular("l" + 8 * "r", ["error [rad]"] + [tex(float(k), 1) for k in TARGETS], lines)
