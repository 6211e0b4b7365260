"""The article's figures, from data/: figures.py FOLDER. PDF, in the article's type; same data, same bytes."""
import math
import sys
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.patches import Patch

from critical import least
from data import PAPER, load, pick, rows, solved

sys.path.insert(0, str(PAPER.parent / "experiments/studies/plots"))
from plot_friction import COLOURS, draw_modes  # noqa: E402
from plotting import BLUE, GREEN, GREY, ORANGE, PINK, RED, STYLE  # noqa: E402

LOOK = {
    "moreau-jean:joints=position": (ORANGE, "s", "moreau-jean, classical"),
    "moreau-jean:joints=symmetric": (BLUE, "o", "moreau-jean, symmetric"), "moreau-jean": (BLUE, "o",
                                                                                           "moreau-jean, symmetric"),
    "stewart-trinkle": (GREEN, "^", "stewart-trinkle"), "anitescu-potra": ("#8C6D1F", "v", "anitescu-potra"),
    "paoli-schatzman": (PINK, "P", "paoli-schatzman"), "generalized-alpha": ("#56B4E9", "D", "generalized-alpha"),
    "rattle": (RED, "X", "rattle"), "adaptive": ("black", "*", "adaptive"), "event-driven": (GREY, "d", "event-driven")
}
ERROR = r"error of $\theta_1$ [rad]"


def line(axes, integrator, points, **more):
    colour, marker, label = LOOK[integrator]
    if points:
        axes.plot(*zip(*sorted(points)), color=colour, marker=marker, markersize=4, linewidth=1.1,
                  **{"label": label, **more})


def power_of_ten(x):
    """As the axes have it."""
    return f"{x:g}" if x == 0 or abs(x) >= 1e-2 else f"10^{{{round(math.log10(x))}}}"


def finish(figure, grid, folder, name, columns=5, room=0.105, each=False):
    """`each`: a legend below each of the axes, where the same mark says different things there."""
    for axes in grid:  # within a decade labels would run into each other
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_minor_formatter("")
    look = {"fontsize": 7, "columnspacing": 1.2, "handletextpad": 0.4}
    figure.tight_layout(rect=(0, room, 1, 1))
    if each:
        for axes in grid:
            centre = (axes.get_position().x0 + axes.get_position().x1) / 2
            figure.legend(*axes.get_legend_handles_labels(), loc="upper center", bbox_to_anchor=(centre, room),
                          ncol=columns, **look)
    else:
        handles = {h.get_label(): h for axes in grid for h in axes.get_legend_handles_labels()[0]}
        figure.legend(handles.values(), handles.keys(), loc="lower center", ncol=columns, **look)
    figure.savefig(folder / f"{name}.pdf", metadata={"CreationDate": None})
    plt.close(figure)


def convergence(folder):
    figure, grid = plt.subplots(1, 3, figsize=(7.2, 3.5), sharey=True)
    fits = load("slider_crank.orders")
    for axes, e in zip(grid, (0, 0.4, 0.9)):
        for fit in fits:
            if fit["mu"] == 0.01 and fit["e"] == e and fit["solver"] == "lemke" and fit["integrator"] in LOOK:
                line(axes, fit["integrator"], fit["worst"])
        axes.plot([1e-5, 1e-4], [3e-6, 3e-5], color=GREY, linestyle="--", linewidth=0.8)
        axes.text(1.1e-4, 3e-5, "order 1", fontsize=7, color=GREY, va="center")
        axes.set(xscale="log", yscale="log", xlabel="step size $h$ [s]", title=f"$\\mu = 0.01$, $e = {e:g}$")
    grid[0].set_ylabel(ERROR)
    finish(figure, grid, folder, "convergence")


def cost(folder):
    table = [row for row in solved(rows("slider_crank")) if row["repeats"] and row["error"]]
    figure, grid = plt.subplots(1, 2, figsize=(7.2, 3.6), sharey=True)
    for axes, x, label in zip(grid, ("seconds", "lcp_solves"),
                              ("processor time [s]", "complementarity problems solved")):
        for integrator in dict.fromkeys(row["integrator"] for row in table):
            own = pick(table, integrator=integrator)
            settings = {row["rtol"] or row["step"] for row in own}
            worst = []
            for s in settings:
                same = [row for row in own if (row["rtol"] or row["step"]) == s]
                worst.append((max(row[x] for row in same), max(row["error"] for row in same)))
            line(axes, integrator, worst)
        axes.set(xscale="log", yscale="log", xlabel=label)
    grid[0].set_ylabel(ERROR + ", worst case")
    finish(figure, grid, folder, "cost")


def friction(folder):
    table = [row for row in solved(rows("friction")) if row["repeats"] == 0]
    figure, grid = plt.subplots(1, 3, figsize=(7.2, 3.4))
    turn = 2 * 3.141592653589793
    for axes, what, label in ((grid[0], lambda r: r["energy_final"], "energy left at the end [J]"),
                              (grid[1], lambda r: r["value"] / turn, "revolutions in the whole time"),
                              (grid[2], lambda r: 1e3 * r["touching"], "time in contact [ms]")):
        for integrator in dict.fromkeys(row["integrator"] for row in table):
            line(axes, integrator, [(r["mu"], what(r)) for r in pick(table, integrator=integrator, omega3=0)])
            line(axes, integrator, [(r["mu"], what(r)) for r in pick(table, integrator=integrator, omega3=-0.01)],
                 label=None, linestyle=":", alpha=0.6)
        for mu in least():
            axes.axvline(mu, color=GREY, linewidth=0.7, linestyle="--")
        axes.set(xlabel=r"friction $\mu$", ylabel=label)
    grid[0].set_ylim(-0.3, 1.05 * table[0]["energy_initial"])
    finish(figure, grid, folder, "friction")


def modes(folder):
    figure, axes = plt.subplots(figsize=(7.2, 3.6))
    draw_modes(axes, [(r["mu"], r["face"], r["begin"], r["end"], r["mode"], r["tilt"]) for r in rows("friction.modes")])
    figure.tight_layout(rect=(0, 0.07, 1, 1))
    figure.legend(handles=[Patch(color=colour, label=mode) for mode, colour in COLOURS.items()], loc="lower center",
                  ncol=3, fontsize=7)
    figure.savefig(folder / "modes.pdf", metadata={"CreationDate": None})
    plt.close(figure)


def tilt(folder):
    figure, grid = plt.subplots(1, 2, figsize=(7.2, 3.1))
    fits = [
        fit for fit in load("clearance.orders")
        if fit["e"] == 0.4 and fit["clearance"] == 0.001 and fit["integrator"] == "rattle"
    ]
    for fit, colour, marker in zip(fits, (BLUE, GREEN, ORANGE, RED, PINK), "os^vD"):
        grid[0].plot(*zip(*fit["worst"]), color=colour, marker=marker, markersize=4, linewidth=1.1,
                     label=rf"$\omega_3 = {power_of_ten(fit['omega3'])}$ rad/s")
    grid[0].set(xscale="log", yscale="log", xlabel="step size $h$ [s]", ylabel=ERROR)
    ensemble = [row for row in solved(rows("clearance")) if row["repeats"]]
    for integrator in dict.fromkeys(row["integrator"] for row in ensemble):
        line(grid[1], integrator, [(r["omega3"], r["value"]) for r in pick(ensemble, integrator=integrator)],
             linestyle="none")
    grid[1].ticklabel_format(useOffset=False)
    grid[1].set(xlabel=r"initial $\omega_3$ [rad/s]", ylabel=r"$\theta_1$ at the end [rad]")
    finish(figure, grid, folder, "tilt", 2, room=0.17, each=True)


def energy(folder):
    table = [row for row in solved(rows("conservation")) if row["rtol"] is None]
    figure, grid = plt.subplots(1, 3, figsize=(7.2, 3.4))
    for axes, scene, name in zip(grid, ("chain", "slider_crank_ideal", "floating_box"),
                                 ("double pendulum", "ideal slider-crank", "floating box: spin")):
        own = [row for row in table if scene in row["scene"]]
        if scene == "floating_box":
            own = pick(own, **{"collision.all.mu": 0.3, "collision.all.e_n": 0.8})
        y = "spin_drift" if scene == "floating_box" else "energy_drift"
        for integrator in dict.fromkeys(row["integrator"] for row in own):
            line(axes, integrator, [(r["step"], max(r[y], 1e-16)) for r in pick(own, integrator=integrator)])
        axes.set(xscale="log", yscale="log", xlabel="step size $h$ [s]", title=name)
    grid[0].set_ylabel(r"$\max|E - E_0|$ [J]")
    grid[2].set_ylabel(r"$\max|L - L_0|$ [N m s]")
    finish(figure, grid, folder, "energy")


def derivatives(folder):
    figure, axes = plt.subplots(figsize=(4.6, 3.4))
    table = rows("gradients")
    exact = pick(table, step=0.0)[0]
    for key, colour, marker, label in (("theta", GREY, "d", r"$\theta_1$"), ("mu", BLUE, "o",
                                                                             r"$\partial\theta_1/\partial\mu$"),
                                       ("e", GREEN, "^", r"$\partial\theta_1/\partial e$"),
                                       ("clearance", RED, "s", r"$\partial\theta_1/\partial c$")):
        points = [(row["step"], abs(row[key] / exact[key] - 1)) for row in table if row["step"] > 0]
        axes.plot(*zip(*points), color=colour, marker=marker, markersize=4, linewidth=1.1, label=label)
    axes.set(xscale="log", yscale="log", xlabel="step size $h$ [s]", ylabel="relative error")
    finish(figure, [axes], folder, "derivatives", 4, room=0.12)


def space_study(folder):
    table = pick(rows("slider_crank_space"), status="solved", e=0.4, guide=None, at_crank=None, clearance=None)
    figure, grid = plt.subplots(1, 3, figsize=(7.2, 3.3))
    grid[1].sharey(grid[0])
    for axes, mu in zip(grid, (0.0, 0.1)):
        for fit in load("slider_crank_space.orders"):
            if fit["mu"] == mu and fit["e"] == 0.4 and "guide" not in fit:
                line(axes, fit["integrator"], fit["worst"])
        axes.set(xscale="log", yscale="log", xlabel="step size $h$ [s]", title=f"$\\mu = {mu:g}$")
    for integrator in dict.fromkeys(row["integrator"] for row in table if row["repeats"]):
        own = pick(table, integrator=integrator, mu=0.1, repeats=lambda n: n > 0)
        line(grid[2], integrator, [(row["seconds"], row["error"]) for row in own if row["error"] > 1e-13])
    grid[2].set(xscale="log", yscale="log", xlabel="processor time [s]", title=r"$\mu = 0.1$")
    grid[0].set_ylabel("error of $x(0.5\\,\\mathrm{s})$ of the slider [m]")
    finish(figure, grid, folder, "space_study", 4, room=0.14)


def ball(folder):
    """The two hemispheres of the ball, seen along the rod's axis."""
    table = pick(rows("slider_crank_space.ball"), phase=lambda phase: phase != "free")
    mus = sorted({row["mu"] for row in table})
    figure, grid = plt.subplots(2, len(mus), figsize=(6, 4.3))
    for column, mu in zip(grid.T, mus):
        for axes, outer in zip(column, (True, False)):
            for latitude in (30, 60, 90):
                axes.add_patch(plt.Circle((0, 0), math.sin(math.radians(latitude)), fill=False, color=GREY, lw=0.5))
            for phase, colour in (("slides", BLUE), ("sticks", RED)):
                own = [row for row in pick(table, mu=mu, phase=phase) if (row["x"] >= 0) == outer]
                axes.plot([row["y"] for row in own], [row["z"] for row in own], linestyle="none", marker="o",
                          markersize=1.6, markeredgewidth=0, color=colour, label=phase)
            axes.set(aspect="equal", xlim=(-1.05, 1.05), ylim=(-1.05, 1.05), xticks=(), yticks=())
            axes.spines[:].set_visible(False)
        column[0].set_title(f"$\\mu = {mu:g}$", loc="center")
    grid[0, 0].set_ylabel("end of the rod")
    grid[1, 0].set_ylabel("side of the rod")
    finish(figure, list(grid.flat), folder, "ball", 2, room=0.05)


def main(folder):
    plt.switch_backend("Agg")
    plt.rcParams.update(
        STYLE | {
            "font.family": "serif", "font.serif": ["Latin Modern Roman", "DejaVu Serif"], "font.size": 8.5,
            "mathtext.fontset": "cm", "axes.titlesize": 9
        })
    folder.mkdir(parents=True, exist_ok=True)
    for draw in (convergence, cost, friction, modes, tilt, energy, space_study, ball, derivatives):
        draw(folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
