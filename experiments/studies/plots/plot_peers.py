"""Orthant and its rivals: reads results/peers/{lcp,slider_crank}; writes report.md, two pictures as PNG and SVG."""
import numpy as np

import matplotlib.pyplot as plt
from plot_lcp_shootout import draw_profile, looks, read
from plotting import BLUE, GREEN, GREY, ORANGE, PINK, RED, main, read_table, save, select

OURS, BEST = ("auto", "lemke"), "best rival"
COLOURS = {"siconos": ORANGE, "drake": PINK, "mujoco": BLUE, "exudyn": GREEN}
CASES = ((0.01, 0.4), (0, 0), (0, 0.4), (0.01, 0), (0.1, 0), (0.1, 0.4))  # μ, e: pointwise comparable; the first alone
TARGETS = (1e-1, 1e-2, 1e-3, 1e-6)


def is_rival(name):
    return "/" in name


def geometric_mean(ratios):
    return float(np.exp(np.mean(np.log(ratios)))) if len(ratios) else np.nan


def text(x, unit=1.0):
    return f"{x * unit:.3g}" if np.isfinite(x) else "–"


def times(table, name):
    """problem → seconds, of certified answers."""
    part = select(table, (table["solver"] == name) & (table["result"] == "certified"))
    return dict(zip(part["problem"], part["seconds"]))


def with_best_rival(table):
    """The table with one row more a problem: of rivals that got it right the fastest, chosen problem by problem."""
    rows = [np.flatnonzero((table["problem"] == problem) & (table["result"] == "certified")
                           & np.array([is_rival(solver) for solver in table["solver"]]))
            for problem in dict.fromkeys(table["problem"])]
    best = [row[np.argmin(table["seconds"][row])] for row in rows if row.size]
    virtual = select(table, best) | {"solver": np.full(len(best), BEST)}
    return {column: np.concatenate([table[column], virtual[column]]) for column in table}


def lcp_report(table):
    solvers, best = list(dict.fromkeys(table["solver"])), times(table, BEST)
    solvable = set(table["problem"][(table["result"] == "certified") & (table["group"] != "infeasible")])
    lines = [f"{len(set(table['problem']))} problems, {len(solvable)} of them solved by somebody. Time / best rival: "
             "geometric mean over the problems that both got right.", "",
             "| solver | takes | right | of these, in % | wrong | crashed, out of time | failed | time / best rival |",
             "|---|---|---|---|---|---|---|---|"]
    for solver in solvers:
        part = select(table, table["solver"] == solver)
        count = {result: int((part["result"] == result).sum())
                 for result in ("certified", "refused", "wrong", "crashed", "late", "failed", "skipped")}
        taken = len(part["problem"]) - count["refused"]
        own = times(table, solver)
        both = [own[problem] / best[problem] for problem in own if problem in best]
        if taken == 0:
            lines.append(f"| {solver} | absent |")
            continue
        lines.append(
            f"| {solver} | {taken} | {count['certified']} | {100 * count['certified'] / taken:.0f} | {count['wrong']} "
            f"| {count['crashed'] + count['late'] + count['skipped']} | {count['failed']} "
            f"| {text(geometric_mean(both))} |")
    return lines


def plot_profile(folder, about):
    table = with_best_rival(read(folder / "lcp"))
    (folder / "report.md").write_text("\n".join(["# Complementarity problems", "", *lcp_report(table), ""]))
    certified = {solver: len(times(table, solver)) for solver in dict.fromkeys(table["solver"])}
    shown = [solver for solver in (*OURS, BEST) if certified.get(solver)]
    for owner in dict.fromkeys(solver.split("/")[0] for solver in certified if is_rival(solver)):
        methods = [solver for solver in certified if solver.startswith(owner + "/") and certified[solver]]
        shown += sorted(methods, key=certified.get)[-2:]  # the two that get the most right
    part = select(table, np.isin(table["solver"], shown) & (table["group"] != "infeasible"))
    figure, axes = plt.subplots(figsize=(9.5, 6))
    draw_profile(axes, part, {solver: looks(part)[solver] for solver in shown}, "All kinds")
    axes.set_ylabel("share of problems solved, certified")
    figure.subplots_adjust(left=0.08, right=0.76, top=0.88, bottom=0.1)
    save(figure, folder / "lcp_profile", "Orthant and others: higher and further left is better", about)


def ladder(runs, name, cases):
    """Settings from coarse to fine → (worst seconds, worst error, steps); a setting that failed on a case has error ∞,
    one that took too long on a case is none."""
    part = select(runs, runs["integrator"] == name)
    points = {}
    for setting in np.unique(part["setting"])[::-1]:
        same = select(part, part["setting"] == setting)
        chosen = [np.flatnonzero((same["mu"] == mu) & (same["e"] == e)) for mu, e in cases]
        rows = [row[0] for row in chosen if row.size]
        if len(rows) == len(cases) and not (same["status"][rows] == "time_limit").any():
            good = (same["status"][rows] == "solved").all()
            points[setting] = (same["seconds"][rows].max() if good else np.nan,
                               same["error"][rows].max() if good else np.inf, same["accepted"][rows].max())
    return points


def time_to(target, points):
    """Seconds of the cheapest setting from which on every finer one stays below the target."""
    seconds = np.inf
    for cost, error, _ in reversed(points.values()):
        if not error <= target:
            break
        seconds = min(seconds, cost)
    return seconds


def step_time(points, step=1e-5):
    near = [setting for setting in points if abs(np.log(setting / step)) < 0.5 and np.isfinite(points[setting][0])]
    return points[near[0]][0] / points[near[0]][2] if near else np.nan


def plot_slider_crank(folder, about):
    runs = read_table(folder / "slider_crank/runs.csv", ["integrator", "status"],
                      ["setting", "mu", "e", "error", "seconds", "accepted"])
    names = list(dict.fromkeys(runs["integrator"]))
    lines = [
        "# The slider-crank with clearance, 0.2 s", "",
        "Milliseconds until the error of θ₁(0.2 s) stays below a bound; first µ = 0.01, e = 0.4, then the worst of "
        "µ in {0, 0.01, 0.1}, e in {0, 0.4}. Steps: of about 1e-5 s, at µ = 0.01, e = 0.4.", "",
        "| | " + " | ".join(f"{target:g}"
                            for target in TARGETS) + " | " + " | ".join(f"worst, {target:g}"
                                                                        for target in TARGETS) + " | µs a step |",
        "|---" * (2 + 2 * len(TARGETS)) + "|"
    ]
    for name in names:
        one, worst = ladder(runs, name, CASES[:1]), ladder(runs, name, CASES)
        cells = [text(time_to(target, points), 1e3) for points in (one, worst) for target in TARGETS]
        fixed = not (name in ("adaptive", "event-driven") or name.endswith("/continuous"))
        lines.append(f"| {name} | " + " | ".join(cells) + f" | {text(step_time(one), 1e6) if fixed else '–'} |")
    for row in (folder / "slider_crank/time_to_error.csv").read_text().splitlines()[1:]:
        if row.split(",")[0] not in names:
            lines.append(f"| {row.split(',')[0]} | absent |")
    with open(folder / "report.md", "a") as report:
        report.write("\n".join(["", *lines, ""]))

    figure, grid = plt.subplots(1, 2, sharey=True, figsize=(12, 5.8))
    lines, marks = ("-", "--", ":"), "os^v"
    for axes, cases, title in ((grid[0], CASES[:1], "µ = 0.01, e = 0.4"),
                               (grid[1], CASES, "the worst of µ in {0, 0.01, 0.1}, e in {0, 0.4}")):
        seen = {}
        for name in names:
            points = [(cost, max(error, 1e-14)) for cost, error, _ in ladder(runs, name, cases).values()
                      if np.isfinite(cost) and error < 30]
            owner = name.split("/")[0] if is_rival(name) else "orthant"
            nth = seen[owner] = seen.get(owner, -1) + 1
            if points:
                look = {"color": COLOURS.get(owner, GREY), "linestyle": lines[nth % 3]} if is_rival(name) else {
                    "color": RED if name in ("adaptive", "event-driven") else "black", "linestyle": lines[nth % 3],
                    "linewidth": 2 if name in ("adaptive", "event-driven") else 1}
                axes.plot(*zip(*points), marker=marks[nth % 4], markersize=4,
                          label=name if is_rival(name) else f"Orthant: {name}", **look)
        axes.set(xscale="log", yscale="log", xlabel="time of the 0.2 s motion [s]", title=title)
    grid[0].set_ylabel("|error of θ₁(0.2 s)| [rad]")
    figure.tight_layout(rect=(0, 0.2, 1, 0.95))
    save(figure, folder / "slider_crank", "What an error costs: a point a step size or tolerance", about,
         grid[0].get_legend_handles_labels()[0], columns=5)


if __name__ == "__main__":
    main(__doc__, "results/peers", (plot_profile, plot_slider_crank), "lcp/manifest.json")
