"""Draws the slider-crank experiment: reads the tables slider_crank_sweep wrote into a folder, puts PNG and SVG there."""
import argparse
import csv
import json
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

# Okabe & Ito: told apart by colour-blind readers too.
ORANGE, GREEN, BLUE, RED, PINK, BLACK, GREY = "#E69F00", "#009E73", "#0072B2", "#D55E00", "#CC79A7", "#000000", "#666666"
FREE, TOP, BOTTOM = 0, 1, 2
PHASES = {FREE: ("free flight", GREY), TOP: ("top contact", RED), BOTTOM: ("bottom contact", BLUE)}
FACES = {TOP: ("corner1", "corner2", 1.0), BOTTOM: ("corner3", "corner4", -1.0)}  # y of the touching slider's centre [mm]
FRICTIONS = {0.0: GREEN, 0.01: ORANGE, 0.1: PINK}  # the trajectories, all of e = 0.4
INTEGRATORS = {"moreau-jean:joints=position": ("classical joints", ORANGE, "o"),
               "moreau-jean:joints=symmetric": ("symmetric joints", BLUE, "s"),
               "moreau-jean:joints=symmetric,form=full": ("symmetric joints, full form", GREEN, "v")}
ERROR = "|error of θ₁(0.2 s)| [rad]"
STYLE = {
    "font.size": 9.5, "axes.titlesize": 10, "axes.titlelocation": "left", "axes.spines.top": False,
    "axes.spines.right": False, "axes.edgecolor": GREY, "axes.axisbelow": True, "axes.grid": True,
    "grid.color": "#e3e3e3", "grid.linewidth": 0.6, "legend.fontsize": 8.5, "legend.edgecolor": "#cccccc",
    "figure.titlesize": 12.5, "savefig.dpi": 170, "svg.hashsalt": "orthant",
}


def read_table(path, columns):
    """The named columns of a CSV file as arrays; an empty number reads as nan."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        raise ValueError(f"{path}: no rows")
    for column in columns:
        if any(row.get(column) is None for row in rows):
            raise ValueError(f"{path}: no column '{column}', or a row is cut short")
    texts = {"integrator", "solver", "status"}
    return {c: np.array([r[c] if c in texts else float(r[c] or "nan") for r in rows]) for c in columns}


def select(table, keep):
    return {column: values[keep] for column, values in table.items()}


def read_trajectory(folder, mu):
    """Adds the contact phases, and the lists impacts (record, phase, impulse [N s]), lasting (first, last record, phase).

    A touch of one or two records is an impact. A longer one lasts, and begins with an impact.
    """
    parts = [corner + part for face in FACES.values() for corner in face[:2] for part in (".gap", ".impulse_n")]
    path = read_table(folder / f"trajectory_mu{mu:g}_e0.4.csv", ["t", "slider.y", "crank.theta", "energy", *parts])
    path |= {"ms": 1e3 * path["t"], "mm": 1e3 * path["slider.y"], "turns": path["crank.theta"] / (2 * np.pi)}
    path |= {"phase": np.full(path["t"].size, FREE), "impacts": [], "lasting": []}
    for phase, (left, right, _) in FACES.items():
        impulse = path[left + ".impulse_n"] + path[right + ".impulse_n"]
        hit = impulse > 1e-12  # [N s]
        touching = hit | (np.minimum(path[left + ".gap"], path[right + ".gap"]) < 2e-8)  # [m] chatter ends no contact
        edges = np.flatnonzero(np.diff(np.concatenate([[0], touching.astype(int), [0]])))
        for begin, end in edges.reshape(-1, 2):
            hits = begin + np.flatnonzero(hit[begin:end])
            if hits.size and hits[-1] - hits[0] > 1:
                path["lasting"].append((hits[0], hits[-1], phase))
                path["phase"][hits[0]:hits[-1] + 1] = phase
                path["impacts"].append((hits[0], phase, impulse[hits[0]]))
            elif hits.size:
                path["impacts"].append((hits[0], phase, impulse[hits].sum()))
    return path


def save(figure, folder, name, about):
    figure.text(0.995, 0.006, f"Orthant {about['revision']}, {about['cpu']}", ha="right", fontsize=6.5, color=GREY)
    figure.savefig(folder / f"{name}.png")
    figure.savefig(folder / f"{name}.svg", metadata={"Date": None})  # same data, same bytes
    plt.close(figure)


def draw_mechanism(axes):
    """The linkage at a crank angle of 50°, in mm and to scale but for the clearance."""
    for y in (-38, 38):
        axes.plot([325, 475], [y, y], color=BLACK, linewidth=1.8)
        axes.add_patch(Rectangle((325, y if y > 0 else y - 10), 150, 10, hatch="/////", facecolor="none",
                                 edgecolor="#aaaaaa", linewidth=0))
    axes.add_patch(Rectangle((332, -21), 100, 50, facecolor="#d9ecf8", edgecolor=BLACK, linewidth=1.3))
    axes.plot([0, 98], [0, 117], color=ORANGE, linewidth=5)
    axes.plot([98, 382], [117, 4], color=GREEN, linewidth=4)
    axes.plot([0, 98, 382], [0, 117, 4], "o", markersize=8, color="white", markeredgecolor=BLACK)
    arc = np.radians(np.linspace(50, 0, 30))
    axes.plot([*60 * np.cos(arc), 0, 90], [*60 * np.sin(arc), 0, 0], color=GREY, linewidth=0.9, zorder=0)
    for x, y, text in ((64, 24, "θ₁"), (-30, 78, "crank\n153 mm"), (225, 82, "rod 306 mm"), (438, 0, "slider"),
                       (215, -78, "clearance 1 mm above and below\n(drawn wider)")):
        axes.text(x, y, text)
    axes.set(xlim=(-35, 490), ylim=(-90, 140), aspect="equal", title="Slider-crank with clearance")
    axes.axis("off")


def draw_path(axes, path, x, area):
    ends = [0, *np.flatnonzero(np.diff(path["phase"])), path["t"].size - 1]
    for begin, end in zip(ends, ends[1:]):
        phase, piece = path["phase"][end], slice(begin, end + 1)
        axes.plot(path[x][piece], path["mm"][piece], color=PHASES[phase][1], linewidth=1.5 if phase == FREE else 3.5,
                  solid_capstyle="butt", zorder=3)
    for *_, wall in FACES.values():
        axes.axhspan(wall, 2 * wall, color="#e6e6e6", linewidth=0)
        axes.axhline(wall, color=BLACK, linewidth=1.1)
    for record, phase, impulse in path["impacts"]:
        axes.scatter(path[x][record], FACES[phase][2], s=area * impulse, color=PHASES[phase][1], linewidth=0, zorder=4)


def plot_slider_path(folder, about):
    path, area = read_trajectory(folder, 0.01), 1200  # [pt² per N s] of an impact's dot
    figure = plt.figure(figsize=(11, 6.8))
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.3), left=0.06, right=0.985, top=0.9, bottom=0.15, hspace=0.36,
                               wspace=0.16)
    draw_mechanism(figure.add_subplot(grid[0, 0]))
    first, whole = figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, :])
    draw_path(first, path, "ms", area)
    first.set(xlim=(0, 16.2), ylim=(0, 1.1), xlabel="time [ms]", ylabel="slider's centre y [mm]",
              title="First impacts, coming to rest, release (magnified)")
    for number, (record, phase, _) in enumerate(path["impacts"][:4], 1):
        first.annotate(str(number), (path["ms"][record], FACES[phase][2]), (0, -20), textcoords="offset points", ha="center")
    for begin, end, _ in path["lasting"][:1]:
        for at, text in ((path["ms"][begin], "after ever closer impacts\nat rest from {:.1f} ms"),
                         (path["ms"][end], "release\nat {:.1f} ms")):
            first.annotate(text.format(at), (at, 0.98), (at, 0.55), ha="center", annotation_clip=True,
                           arrowprops={"arrowstyle": "->", "color": GREY})
    draw_path(whole, path, "turns", area)
    whole.set(xlim=(0, path["turns"].max()), ylim=(-1.2, 1.2), xlabel="crank angle θ₁ [revolutions]",
              ylabel="slider's centre y [mm]", title="The whole motion, 0.2 s")
    handles = [Line2D([], [], color=colour, linewidth=2.5, label=label) for label, colour in PHASES.values()]
    handles += [Line2D([], [], color=GREY, marker="o", linewidth=0, markersize=np.sqrt(area * impulse), markeredgewidth=0,
                       label=f"impact of {impulse:g} N s") for impulse in (0.1, 0.01)]
    figure.legend(handles=handles, loc="lower center", ncol=5, bbox_to_anchor=(0.5, 0.02), frameon=False)
    figure.suptitle("The slider's way through its clearance: µ = 0.01, e = 0.4", x=0.06, ha="left")
    save(figure, folder, "slider_path", about)


def draw_errors(axes, runs, orders):
    """One problem: every run a dot, the worst of each octave of h a line, failed runs crosses at the top."""
    for integrator in dict.fromkeys(runs["integrator"]):
        label, colour, marker = INTEGRATORS.get(integrator, (integrator, PINK, "D"))
        part = select(runs, runs["integrator"] == integrator)
        failed, part = select(part, part["status"] != "solved"), select(part, part["error"] > 0)
        label += "".join(f": order {order:.2f}" for order in orders["order"][orders["integrator"] == integrator])
        label += f", {failed['h'].size} failed" if failed["h"].size else ""
        octave = np.floor(np.log2(part["h"].max(initial=0) * 1.001 / part["h"]))  # as the order was fitted
        worst = [np.flatnonzero(octave == o)[np.argmax(part["error"][octave == o])] for o in np.unique(octave)]
        axes.plot(1e6 * part["h"], part["error"], ".", markersize=3.5, color=colour, alpha=0.4, markeredgewidth=0)
        axes.plot(1e6 * part["h"][worst], part["error"][worst], marker=marker, markersize=4, color=colour, label=label)
        axes.plot(1e6 * failed["h"], 0.97 + 0 * failed["h"], "x", color=colour, transform=axes.get_xaxis_transform())


def plot_error_vs_step(folder, about):
    table = read_table(folder / "sweep.csv", ["integrator", "mu", "e", "h", "error", "seconds", "status"])
    table = select(table, np.isnan(table["seconds"]))
    orders = read_table(folder / "orders.csv", ["integrator", "mu", "e", "order"])
    errors = table["error"][table["error"] > 0]
    if not errors.size:
        raise ValueError(f"{folder / 'sweep.csv'}: no row without a time has an error")
    low, high = np.quantile(errors, 0.005) / 20, 300 * errors.max()  # the few luckiest runs set no scale; room on top
    frictions, restitutions, start = np.unique(table["mu"]), np.unique(table["e"]), 1e6 * table["h"].max() / 12
    figure, grid = plt.subplots(restitutions.size, frictions.size, sharex=True, sharey=True, squeeze=False, figsize=(11, 9.2))
    for (row, column), axes in np.ndenumerate(grid):
        mu, e = frictions[column], restitutions[row]
        draw_errors(axes, *(select(t, (t["mu"] == mu) & (t["e"] == e)) for t in (table, orders)))
        for order in (1, 2):
            axes.plot([start, 6 * start], [2 * low, 2 * low * 6**order], color=GREY, linewidth=0.9, linestyle="--")
            axes.text(6.2 * start, 2 * low * 6**order, f"order {order}", fontsize=7.5, color=GREY, va="center")
        axes.legend(loc="upper left", bbox_to_anchor=(0, 0.95), borderaxespad=0.2)
        axes.set(xscale="log", yscale="log", ylim=(low, high), facecolor="#f8f4ec" if e > 0.8 else "white",
                 xlabel="step size h [µs]", ylabel=ERROR,
                 title=f"µ = {mu:g}, e = {e:g}" + (" (ill-conditioned)" if e > 0.8 else ""))
        axes.label_outer()
    figure.suptitle("Error against step size", x=0.012, ha="left")
    figure.text(0.012, 0.012, f"Dots: every run ({np.sum(errors < low)} lie below the frame). Lines: the worst of each octave "
                "of h, to which the order is fitted, as single errors jump with h.\ne = 0.9: after about 0.14 s the motion "
                "itself magnifies small errors, so no clean order can be expected.", fontsize=8.5, color=GREY)
    figure.tight_layout(rect=(0, 0.045, 1, 1))
    save(figure, folder, "error_vs_step", about)


def plot_error_vs_time(folder, about):
    table = read_table(folder / "sweep.csv", ["integrator", "solver", "mu", "e", "h", "error", "seconds", "us_per_step", "status"])
    timed, others = select(table, table["seconds"] > 0), select(table, np.isnan(table["seconds"]) & (table["error"] > 0))
    if not timed["h"].size:
        raise ValueError(f"{folder / 'sweep.csv'}: no row has a time")
    mu, e = timed["mu"][0], timed["e"][0]
    figure, axes = plt.subplots(figsize=(9, 6.4))
    for integrator, solver in dict.fromkeys(zip(timed["integrator"], timed["solver"])):
        label, colour, marker = INTEGRATORS.get(integrator, (integrator, PINK, "D"))
        part, near = (select(t, (t["integrator"] == integrator) & (t["solver"] == solver) & (t["mu"] == mu) & (t["e"] == e))
                      for t in (timed, others))
        part = select(part, np.argsort(-part["h"], kind="stable"))
        failed, part = select(part, part["status"] != "solved"), select(part, part["error"] > 0)
        axes.plot(failed["seconds"], 0.97 + 0 * failed["h"], "x", color=colour, transform=axes.get_xaxis_transform(),
                  label=f"{label}, {solver}: {failed['h'].size} failed" if failed["h"].size else None)
        label += f", {solver}: {np.median(part['us_per_step']):.2g} µs a step" if part["h"].size else ""
        if part["h"].size > 1:
            axes.plot(part["seconds"], part["error"], marker=marker, markersize=5, color=colour, label=label)
            for i, (h, seconds, error) in enumerate(zip(part["h"], part["seconds"], part["error"])):
                alike = near["error"][np.abs(np.log2(near["h"] / h)) < 0.5]
                axes.vlines(seconds, *(alike.min(), alike.max()) if alike.size else (error, error), color=colour, alpha=0.3, linewidth=5)
                if i % 3 == 0:
                    axes.annotate(f"h = {1e6 * h:.4g} µs", (seconds, error), (8, 4), textcoords="offset points", fontsize=8)
        elif part["h"].size:
            axes.plot(part["seconds"], part["error"], {"pgs": "D", "enumerate": "^"}.get(solver, "v"), markersize=8,
                      color="none", markeredgecolor=BLACK, label=f"{label}, only h = {1e6 * part['h'][0]:.4g} µs")
    axes.set(xscale="log", yscale="log", xlabel="wall time of the 0.2 s motion [s]", ylabel=ERROR,
             title=f"What an error costs: µ = {mu:g}, e = {e:g}; one thread, fastest of three runs\n"
                   "Bars: errors of all runs whose h is within half an octave; a single error may be lucky")
    axes.margins(x=0.1, y=0.12)
    figure.legend(*axes.get_legend_handles_labels(), loc="lower left", ncol=2, bbox_to_anchor=(0.05, 0.025), frameon=False)
    figure.tight_layout(rect=(0, 0.13, 1, 1))
    save(figure, folder, "error_vs_time", about)


def plot_energy(folder, about):
    paths = {mu: read_trajectory(folder, mu) for mu in FRICTIONS}
    figure = plt.figure(figsize=(11.5, 5.8))
    grid = figure.add_gridspec(2, 2, width_ratios=(1.6, 1), height_ratios=(3, 1), left=0.07, right=0.985, top=0.88,
                               bottom=0.17, hspace=0.1, wspace=0.37)
    whole, first = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[:, 1])
    strips = figure.add_subplot(grid[1, 0], sharex=whole)
    for level, (mu, path) in enumerate(paths.items()):
        ms, energy = path["ms"], path["energy"]
        whole.plot(ms, energy, color=FRICTIONS[mu])
        first.plot(ms[ms <= 16], energy[ms <= 16], color=FRICTIONS[mu], label=f"µ = {mu:g}")
        whole.annotate(f"µ = {mu:g}: {energy[-1]:.2f} J", (ms[-1], energy[-1]), (4, -3), textcoords="offset points")
        for begin, end, phase in path["lasting"]:
            look = {"color": PHASES[phase][1], "linewidth": 0}
            strips.barh(level, ms[end] - ms[begin], 0.72, ms[begin], alpha=0.45, **look)
            for axes in (whole, first) if mu == 0.01 else ():
                axes.axvspan(ms[begin], min(ms[end], axes.get_xlim()[1]), alpha=0.1, **look)
        for record, phase, _ in path["impacts"]:
            strips.vlines(ms[record], level - 0.36, level + 0.36, color=PHASES[phase][1], linewidth=0.8)
    whole.set(ylabel="energy [J]", title="The whole motion", xlim=(0, ms[-1]))
    whole.tick_params(labelbottom=False)
    strips.set(yticks=range(len(paths)), yticklabels=[f"µ = {mu:g}" for mu in paths], xlabel="time [ms]")
    strips.invert_yaxis()
    strips.grid(False)
    first.set(xlim=(0, 16), xlabel="time [ms]", ylabel="energy [J]", title="First impacts (magnified)")
    first.legend(loc="lower left")
    handles = [Patch(color=PHASES[p][1], alpha=0.4, label=f"lasting {PHASES[p][0]}") for p in FACES]
    handles += [Line2D([], [], color=PHASES[p][1], marker="|", markersize=10, linewidth=0, label=f"impact, {side}")
                for p, side in ((TOP, "top"), (BOTTOM, "bottom"))]
    figure.legend(handles=handles, loc="lower center", ncol=4, bbox_to_anchor=(0.5, 0.02), frameon=False)
    figure.suptitle("Energy, lost at impacts and to friction: e = 0.4; shaded: lasting contact for µ = 0.01", x=0.07, ha="left")
    save(figure, folder, "energy", about)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="for example results/slider_crank")
    folder = parser.parse_args().folder
    plt.rcParams.update(STYLE)
    try:
        about = {"revision": "of unknown revision", "cpu": "", **json.loads((folder / "manifest.json").read_text())}
        for plot in (plot_slider_path, plot_error_vs_step, plot_error_vs_time, plot_energy):
            plot(folder, about)
    except (OSError, ValueError) as error:
        sys.exit(f"plot_slider_crank: {error}")


if __name__ == "__main__":
    main()
