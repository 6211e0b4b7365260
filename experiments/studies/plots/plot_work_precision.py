"""Draws the work-precision experiment: reads runs.csv, which work_precision wrote into a folder; puts PNG, SVG
there."""
import matplotlib.pyplot as plt
import numpy as np

from plotting import BLUE, GREEN, GREY, ORANGE, PINK, RED, main, read_table, save, select

INTEGRATORS = {"moreau-jean": (BLUE, "s"), "stewart-trinkle": (ORANGE, "o"), "anitescu-potra": (PINK, "D"),
               "paoli-schatzman": (GREY, "v"), "generalized-alpha": ("#8c6d1f", "P"), "rattle": (GREEN, "^"),
               "adaptive": (RED, "X"), "event-driven": ("black", "*")}
PANELS = (("µ = 0.01, e = 0.4", lambda t: (t["mu"] == 0.01) & (t["e"] == 0.4)),
          ("the worst of µ in {0, 0.01, 0.1}, e in {0, 0.4}", lambda t: t["e"] < 0.5),
          ("the worst of µ in {0, 0.01, 0.1}, e = 0.9", lambda t: t["e"] > 0.5))


def draw(axes, runs):
    for integrator, (colour, marker) in INTEGRATORS.items():
        part = select(runs, runs["integrator"] == integrator)
        settings = np.unique(part["setting"])[::-1]
        points = []
        for setting in settings:
            same = select(part, part["setting"] == setting)
            if (same["status"] == "solved").all():  # else the setting is no use
                points.append((same["seconds"].max(), max(same["error"].max(), 1e-14)))
        if points:
            axes.plot(*zip(*points), marker=marker, markersize=5, color=colour, label=integrator)


def plot_work_precision(folder, about):
    runs = read_table(folder / "runs.csv", ["integrator", "status"], ["setting", "mu", "e", "error", "seconds"])
    figure, grid = plt.subplots(1, 3, sharey=True, figsize=(12, 5.4))
    for axes, (title, which) in zip(grid, PANELS):
        draw(axes, select(runs, which(runs)))
        axes.set(xscale="log", yscale="log", xlabel="wall time of the 0.2 s motion [s]", title=title)
    grid[0].set_ylabel("|error of θ₁(0.2 s)| [rad]")
    figure.tight_layout(rect=(0, 0.12, 1, 0.95))
    handles = grid[0].get_legend_handles_labels()[0]
    save(figure, folder / "work_precision", "What an error costs, by integrator: a point a step size or tolerance",
         about, handles, columns=4)


if __name__ == "__main__":
    main(__doc__, "results/work_precision", (plot_work_precision,))
