#!/usr/bin/python3
"""Draws the solver comparison: reads the table lcp_shootout wrote into a folder; puts PNG and SVG there."""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from plotting import BLUE, GREEN, GREY, ORANGE, PINK, RED, main, read_table, save, select

# Solvers are distinguished by place in the table: colours first, then line styles and marks with each round of colours.
COLOURS = (BLUE, ORANGE, GREEN, RED, PINK, "#56B4E9", "black", "#8C6D1F")
LINES, MARKS = ("-", (0, (4, 1.5)), (0, (1, 1.2)), "-."), ("o", "s", "^", "D")
LEAST, MOST = 1e-17, 1e3  # residuals below are drawn in a band, a line for each solver; those above at the edge
GROUPS = {"definite": "definite, dense", "semidefinite": "semidefinite", "P-matrix": "P-matrices, not definite",
          "grid": "grids (K-matrices, sparse)", "friction": "contacts with friction",
          "other": "games, known small problems", "own": "your own files"}


def read(folder):
    return read_table(folder / "shootout.csv", ["problem", "family", "group", "solver", "result", "status"],
                      ["seconds", "relative_residual"])


def looks(table):
    """Per solver its colour, line and mark."""
    names = dict.fromkeys(table["solver"])
    return {solver: (COLOURS[i % len(COLOURS)], LINES[i // len(COLOURS) % 4], MARKS[i // len(COLOURS) % 4])
            for i, solver in enumerate(names)}


def spread(heights, gap):
    """The heights moved apart to at least `gap`, order kept, and none above 1 where there is room."""
    order = np.argsort(heights, kind="stable")
    moved = np.array(heights, dtype=float)[order]
    for i in range(1, moved.size):
        moved[i] = max(moved[i], moved[i - 1] + gap)
    if moved.size and moved[-1] > 1:
        moved[-1] = 1
        for i in range(moved.size - 2, -1, -1):
            moved[i] = min(moved[i], moved[i + 1] - gap)
    moved[order] = moved.copy()
    return moved


def draw_profile(axes, table, look, title):
    """Share of problems a solver had certified within a factor of the fastest, and its name where its curve ends."""
    problems = np.unique(table["problem"])
    seconds = {}
    for solver in look:
        part = select(table, (table["solver"] == solver) & (table["result"] == "certified"))
        times = dict(zip(part["problem"], part["seconds"]))
        seconds[solver] = np.array([times.get(problem, np.inf) for problem in problems])
    best = np.min(list(seconds.values()), axis=0)
    count = max(int(np.isfinite(best).sum()), 1)
    ratios = {s: np.sort(t[np.isfinite(t)] / best[np.isfinite(t)]) for s, t in seconds.items()}
    ratios = {solver: ratio for solver, ratio in ratios.items() if ratio.size}
    right = 2 * max((ratio[-1] for ratio in ratios.values()), default=1)
    ends = {solver: ratio.size / count for solver, ratio in ratios.items()}
    heights = spread(list(ends.values()), 0.035)
    for (solver, ratio), height in zip(ratios.items(), heights):
        colour, line, _ = look[solver]
        x, y = np.concatenate([[1], ratio, [right]]), np.arange(ratio.size + 1) / count
        axes.step(x, np.append(y, y[-1]), where="post", color=colour, linestyle=line, linewidth=1.7)
        axes.annotate(f"{solver}  {100 * ends[solver]:.0f} %", (1, ends[solver]), (1.05, height), va="center",
                      xycoords=axes.get_yaxis_transform(), textcoords=axes.get_yaxis_transform(), fontsize=8.5,
                      color=colour, arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.6,
                                                "linestyle": line, "relpos": (0, 0.5), "shrinkA": 1,
                                                "shrinkB": 0},
                      annotation_clip=False)
    axes.set(xscale="log", xlim=(1, right), ylim=(0, 1.02), xlabel="time / time of the fastest solver",
             title=f"{title}: {count} problems that somebody solved")
    axes.yaxis.set_major_formatter(lambda share, _: f"{100 * share:.0f} %")


def plot_profiles(folder, about):
    table = read(folder)
    look = looks(table)
    friction, own = table["group"] == "friction", table["group"] == "own"
    solvable = table["group"] != "infeasible"
    parts = [(solvable & ~friction & ~own, "Without friction"), (friction, "With friction")]
    parts = [(part, title) for part, title in [*parts, (own, "Your own files")] if part.any()]
    figure, panels = plt.subplots(1, len(parts), figsize=(6.5 * len(parts), 6.2), squeeze=False)
    for axes, (part, title) in zip(panels[0], parts):
        draw_profile(axes, select(table, part), look, title)
    panels[0][0].set_ylabel("share of problems solved, certified")
    left = 0.12 / len(parts)
    figure.subplots_adjust(left=left, right=1 - 2 * left, top=0.88, bottom=0.15, wspace=0.42)
    figure.text(
        left, 0.02, "A curve's left end: how often that solver is the fastest; its right end: how many it solves\n"
        "at all (refused problems count as not solved).", fontsize=8.5, color=GREY)
    save(figure, folder / "performance_profiles", "Performance profiles: higher and further left is better", about)


def plot_work_precision(folder, about):
    table = read(folder)
    look = looks(table)
    answered = (table["seconds"] > 0) & (table["relative_residual"] >= 0) & (table["result"] != "refused")
    claimed = np.isin(table["status"], ("solved", "infeasible"))
    table = select(table, answered & ((table["status"] == "solved") | ~claimed))
    shown = {group: title for group, title in GROUPS.items() if group != "own" or (table["group"] == "own").any()}
    lines = -(-len(shown) // 3)
    figure, grid = plt.subplots(lines, 3, sharex=True, sharey=True, figsize=(13, 3.9 * lines))
    for axes in grid.flat[len(shown):]:
        axes.set_visible(False)
    for i, (axes, (group, title)) in enumerate(zip(grid.flat, shown.items())):
        for level, (solver, (colour, _, mark)) in enumerate(look.items()):
            part = select(table, (table["group"] == group) & (table["solver"] == solver))
            zero = LEAST * 10 ** (-4 * (level + 1) / (len(look) + 1))
            error = np.where(part["relative_residual"] < LEAST, zero, np.minimum(part["relative_residual"], MOST))
            good = part["result"] == "certified"
            bad = part["result"] == "wrong"
            axes.plot(part["seconds"][good], error[good], mark, markersize=3, color=colour, alpha=0.35,
                      markeredgewidth=0)
            failed = ~good & ~bad
            axes.plot(part["seconds"][failed], error[failed], "x", markersize=3.5, color=colour, alpha=0.35)
            axes.plot(part["seconds"][bad], error[bad], "*", markersize=12, color="red", zorder=4)
            if good.any():
                middle = [np.quantile(x[good], 0.5, method="lower") for x in (part["seconds"], error)]
                axes.plot(*middle, mark, markersize=9, color=colour, markeredgecolor="white", zorder=3)
        axes.set(xscale="log", yscale="log", ylim=(3e-5 * LEAST, 2 * MOST), title=title,
                 yticks=10.0**np.arange(-15, 4, 3))
        axes.set(xlabel="processor time of a solve [s]", ylabel="residual / (1 + max |q|)")
        axes.axhspan(3e-5 * LEAST, LEAST, color="#f2f2f2", linewidth=0, zorder=0)
        axes.label_outer()
        if i + 3 >= len(shown):  # the lowest of its column
            axes.tick_params(labelbottom=True)
            axes.set_xlabel("processor time of a solve [s]")
    handles = [Line2D([], [], color=colour, marker=mark, linewidth=0, markersize=8, markeredgecolor="white",
                      label=solver) for solver, (colour, _, mark) in look.items()]
    handles += [Line2D([], [], color=GREY, marker=mark, linewidth=0, markersize=size, label=label)
                for mark, size, label in (("o", 8, "median of the certified"), ("o", 3, "a certified answer"),
                                          ("x", 4, "an honest failure"))]
    handles.append(Line2D([], [], color="red", marker="*", linewidth=0, markersize=11, label="a wrong claim"))
    figure.subplots_adjust(left=0.06, right=0.82, top=0.9, bottom=0.09, hspace=0.16, wspace=0.08)
    figure.legend(handles=handles, loc="center left", bbox_to_anchor=(0.83, 0.5))
    figure.text(0.06, 0.012, f"Residuals by a second judge in extended precision; those below {LEAST:g} are drawn in "
                "the grey band, a line for each solver.", fontsize=8.5, color=GREY)
    save(figure, folder / "work_precision", "Time against achieved residual", about)


def plot_heat(folder, about):
    """Solver × family: share certified of those not refused; a wrong claim is red whatever else is there."""
    table = read(folder)
    solvers, families = list(dict.fromkeys(table["solver"])), {}
    for group in dict.fromkeys((*GROUPS, *table["group"])):
        families |= dict.fromkeys(table["family"][table["group"] == group])
    families = list(families)
    figure, axes = plt.subplots(figsize=(2.6 + 0.46 * len(families), 2.3 + 0.34 * len(solvers)))
    colours = plt.get_cmap("YlGnBu")
    for row, solver in enumerate(solvers):
        for column, family in enumerate(families):
            results = table["result"][(table["solver"] == solver) & (table["family"] == family)]
            wrong, taken = int(np.sum(results == "wrong")), results[results != "refused"]
            share = np.mean(taken == "certified") if taken.size else np.nan
            colour = "red" if wrong else "#f2f2f2" if np.isnan(share) else colours(0.08 + 0.8 * share)
            axes.add_patch(plt.Rectangle((column - 0.5, row - 0.5), 1, 1, facecolor=colour, edgecolor="white"))
            text = f"{wrong}!" if wrong else "–" if np.isnan(share) else f"{100 * share:.0f}"
            axes.text(column, row, text, ha="center", va="center", fontsize=8, weight="bold" if wrong else None,
                      color=GREY if np.isnan(share) else "white" if wrong or share > 0.55 else "black")
    axes.set(xlim=(-0.5, len(families) - 0.5), ylim=(len(solvers) - 0.5, -0.5), xticks=range(len(families)),
             yticks=range(len(solvers)), yticklabels=solvers)
    axes.set_xticks(range(len(families)), families, rotation=45, ha="left", rotation_mode="anchor")
    axes.tick_params(top=True, labeltop=True, bottom=False, labelbottom=False, length=0)
    axes.grid(False)
    axes.spines[:].set_visible(False)
    width, height = figure.get_size_inches()
    figure.subplots_adjust(left=1.3 / width, right=1 - 0.5 / width, top=1 - 1.35 / height, bottom=0.75 / height)
    handles = [Patch(facecolor=colours(0.08 + 0.8 * share), label=f"{100 * share:.0f} %") for share in (0, 0.5, 1)]
    handles += [Patch(facecolor="#f2f2f2", label="refuses them all"),
                Patch(facecolor="red", label="wrong claims, how many")]
    figure.text(1.3 / width, 0.02, "Problems not tried, because a smaller one of the kind took too long, count as not "
                "certified.", fontsize=8.5, color=GREY)
    save(figure, folder / "certified_share", "Share of answers certified, in % of the problems a solver takes", about,
         handles, low=0.25 / height)


def plot_regret(folder, about):
    """Time of auto over that of the fastest solver, problem by problem."""
    if not (folder / "regret.csv").exists():
        return
    table = read_table(folder / "regret.csv", ["problem", "family", "fastest"], ["n", "seconds", "auto", "regret"])
    figure, axes = plt.subplots(figsize=(9, 5.2))
    known = np.isfinite(table["regret"])
    small = known & (table["seconds"] < 1e-4)
    axes.axhspan(1, 2, color="#f2f2f2", linewidth=0, zorder=0)
    for part, colour, label in ((small, GREY, "the fastest takes less than 0.1 ms"), (known & ~small, BLUE, "longer")):
        axes.plot(table["n"][part], table["regret"][part], "o", markersize=4, alpha=0.6, color=colour, label=label,
                  markeredgewidth=0)
    for at in np.flatnonzero(known & ~small)[:6]:
        if table["regret"][at] > 2:
            axes.annotate(f"{table['problem'][at]} ({table['fastest'][at]})", (table["n"][at], table["regret"][at]),
                          (4, 4), textcoords="offset points", fontsize=8)
    axes.set(xscale="log", yscale="log", xlabel="rows", ylabel="time of auto / time of the fastest solver")
    axes.set_title(f"{np.sum(table['regret'][known] <= 2)} of {known.size} problems within a factor of 2, "
                   f"{np.sum(~known)} not solved by auto", fontsize=10)
    axes.legend(loc="upper right")
    save(figure, folder / "regret", "Regret of auto", about)


if __name__ == "__main__":
    main(__doc__, "results/lcp_shootout", (plot_profiles, plot_work_precision, plot_heat, plot_regret))
