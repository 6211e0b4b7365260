"""Draws hard cases with exact answers: reads runs.csv, which exact_cases wrote into a folder; puts PNG and SVG
there."""
import textwrap

import matplotlib.pyplot as plt
import numpy as np

from plot_work_precision import INTEGRATORS
from plotting import main, read_table, save, select

COLUMNS = 5
FLOOR = 1e-17  # errors of 0 are drawn here


def of_first_solver(runs):
    first = dict(zip(runs["title"][::-1], runs["solver"][::-1]))  # of each case, the last to be written stays
    return select(runs, np.array([first[title] == solver for title, solver in zip(runs["title"], runs["solver"])]))


def label(case, title, width):
    return textwrap.fill(f"{case} {title}", width)


def draw_case(axes, runs):
    """Error against wall time; a cross above the frame's middle for what was not solved."""
    for integrator, (colour, marker) in INTEGRATORS.items():
        part = select(runs, runs["integrator"] == integrator)
        solved = part["status"] == "solved"
        axes.plot(part["seconds"][solved], np.maximum(part["error"][solved], FLOOR), marker=marker, markersize=3.5,
                  linewidth=0.8, linestyle="-" if solved.sum() < 8 else "none", color=colour, label=integrator)
        if not solved.all():
            axes.plot([0.5], [0.97 - 0.06 * list(INTEGRATORS).index(integrator)], marker="x", color=colour,
                      transform=axes.transAxes, clip_on=False)
    axes.set(xscale="log", yscale="log")
    axes.xaxis.set_minor_formatter("")  # within a decade its labels would run into each other
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 1e-9), max(high, 1e-6))
    axes.tick_params(labelsize=7)


def draw_instants(axes, runs):
    """What one step decides: a column a case, a mark an integrator."""
    names = list(dict.fromkeys(zip(runs["case"], runs["title"])))
    for k, (integrator, (colour, marker)) in enumerate(INTEGRATORS.items()):
        for x, (case, title) in enumerate(names):
            part = select(runs, (runs["integrator"] == integrator) & (runs["title"] == title))
            at = x + (k - len(INTEGRATORS) / 2) * 0.09
            for status, error in zip(part["status"], part["error"]):
                axes.plot([at], [max(error, FLOOR) if status == "solved" else 30], color=colour, linestyle="none",
                          marker=marker if status == "solved" else "x", markersize=5)
    axes.axhline(3, color="0.6", linewidth=0.8)
    axes.text(-0.6, 30, "no answer", va="center", ha="right", fontsize=8)
    axes.set(yscale="log", ylabel="error", xlim=(-0.6, len(names) - 0.4), ylim=(FLOOR / 5, 200))
    # Upright and of two lines at the most, or they run into each other.
    axes.set_xticks(range(len(names)), [label(case, title, max(30, len(title) // 2 + 10)) for case, title in names],
                    rotation=90, fontsize=6.5)
    axes.grid(axis="x", alpha=0.3)


def plot_exact_cases(folder, about):
    runs = of_first_solver(
        read_table(folder / "runs.csv", ["case", "title", "motion", "integrator", "solver", "status"],
                   ["setting", "error", "seconds"]))
    instant = runs["motion"] == "instant"
    laddered = select(runs, ~instant)
    names = list(dict.fromkeys(zip(laddered["case"], laddered["title"])))
    rows = max(1, -(-len(names) // COLUMNS))
    figure = plt.figure(figsize=(13, 2.6 * rows + 6))
    upper, lower = figure.subfigures(2, 1, height_ratios=(2.6 * rows, 6))
    for part in (upper, lower):
        part.set_facecolor("none")  # lest it cover the figure's title and legend
    grid = upper.subplots(rows, COLUMNS, squeeze=False)
    for axes in grid.flat[len(names):]:
        axes.remove()
    for axes, (case, title) in zip(grid.flat, names):
        draw_case(axes, select(laddered, laddered["title"] == title))
        axes.set_title(label(case, title, 34), fontsize=8)
    for axes in grid[:, 0]:
        axes.set_ylabel("error", fontsize=8)
    upper.supxlabel("wall time of the run [s]", fontsize=8)
    upper.subplots_adjust(left=0.06, right=0.99, top=0.91, bottom=0.07, wspace=0.28, hspace=0.55)
    if instant.any():
        draw_instants(lower.subplots(), select(runs, instant))
        lower.subplots_adjust(left=0.1, right=0.99, top=0.97, bottom=0.5)
    handles = [
        plt.Line2D([], [], color=colour, marker=marker, label=name) for name, (colour, marker) in INTEGRATORS.items()
    ]
    save(figure, folder / "exact_cases", "Hard cases with exact answers: errors against exact answers", about, handles,
         columns=8)


if __name__ == "__main__":
    main(__doc__, "results/exact_cases", (plot_exact_cases,))
