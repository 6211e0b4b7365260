"""Draws the study of large sparse problems: reads sparse_lcps.csv, which sparse_lcps wrote into a folder; puts PNG,
SVG there."""
import matplotlib.pyplot as plt
import numpy as np

from plotting import BLUE, GREEN, ORANGE, PINK, RED, main, read_table, save, select

SOLVERS = {"multigrid": (RED, "o"), "block-pivot": (BLUE, "s"), "auto": ("black", "*"), "mprgp": (GREEN, "^"),
           "petsc/vinewton-rsls": (ORANGE, "D"), "petsc/vinewton-ssls": (PINK, "v")}
TITLES = {"ball": "membrane over a ball", "journal": "journal bearing", "torsion": "elastic-plastic torsion",
          "basket": "American option, two assets", "space": "obstacle in space"}


def plot_sparse_lcps(folder, about):
    table = read_table(folder / "sparse_lcps.csv", ["problem", "solver", "status"],
                       ["n", "holds", "iterations", "seconds", "megabytes"])
    problems = [p for p in TITLES if p in table["problem"]]
    figure, grid = plt.subplots(3, len(problems), squeeze=False, sharex="col", sharey="row",
                                figsize=(2.9 * len(problems), 8.2))
    for column, problem in enumerate(problems):
        for solver, (colour, marker) in SOLVERS.items():
            part = select(table, (table["problem"] == problem) & (table["solver"] == solver) & (table["holds"] == 1))
            if not len(part["n"]):
                continue
            style = {"marker": marker, "markersize": 5, "color": colour, "label": solver}
            grid[0][column].plot(part["n"], 1e6 * part["seconds"] / part["n"], **style)
            grid[1][column].plot(part["n"], np.maximum(part["iterations"], 1), **style)
            grid[2][column].plot(part["n"], 1e6 * part["megabytes"] / part["n"], **style)
        grid[0][column].set_title(TITLES[problem])
        grid[2][column].set_xlabel("rows n")
    for row, label in zip(grid, ("time [µs a row]", "cycles or iterations", "peak memory [bytes a row]")):
        row[0].set(yscale="log", ylabel=label)
        for axes in row:
            axes.set_xscale("log")
    figure.tight_layout(rect=(0, 0.07, 1, 0.95))
    handles = {text: line for axes in grid[0] for line, text in zip(*axes.get_legend_handles_labels())}
    save(figure, folder / "sparse_lcps", "Large sparse problems with bounds: right answers only", about,
         list(handles.values()), columns=4)


if __name__ == "__main__":
    main(__doc__, "results/sparse_lcps", (plot_sparse_lcps,))
