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
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Rectangle

# Okabe & Ito: told apart by colour-blind readers too.
BLACK, ORANGE, GREEN, BLUE, RED, PINK, GREY = "#000000", "#E69F00", "#009E73", "#0072B2", "#D55E00", "#CC79A7", "#666666"
FREE, TOP, BOTTOM = 0, 1, 2
PHASES = {FREE: ("free flight", GREY), TOP: ("top contact", RED), BOTTOM: ("bottom contact", BLUE)}
WALL = {TOP: 1.0, BOTTOM: -1.0}  # [mm] where the slider's centre is when it touches
FRICTIONS = {0.0: GREEN, 0.01: ORANGE, 0.1: PINK}  # the trajectories, all of e = 0.4
TREATMENTS = {"moreau-jean:joints=position": "classical joints", "moreau-jean:joints=symmetric": "symmetric joints",
              "moreau-jean:joints=symmetric,form=full": "symmetric joints, full form"}
ERROR = "|error of θ₁(0.2 s)| [rad]"
STYLE = {
    "font.size": 9.5, "axes.titlesize": 10, "axes.titlelocation": "left", "axes.spines.top": False,
    "axes.spines.right": False, "axes.edgecolor": GREY, "axes.axisbelow": True, "axes.grid": True,
    "grid.color": "#e3e3e3", "grid.linewidth": 0.6, "lines.linewidth": 1.5, "legend.fontsize": 8.5,
    "legend.framealpha": 0.95, "legend.edgecolor": "#cccccc", "figure.titlesize": 12.5, "savefig.dpi": 170,
    "svg.hashsalt": "orthant",
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


def runs_of(mask):
    """[begin, end) of every run of true values."""
    return np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]]))).reshape(-1, 2)


def read_trajectory(folder, mu):
    """Adds the contact phases, and the lists impacts (record, phase, impulse [N s]), lasting (first, last record, phase).

    A touch of one or two records is an impact. A longer one lasts, and begins with an impact.
    """
    faces = {TOP: ("corner1", "corner2"), BOTTOM: ("corner3", "corner4")}
    parts = [corner + part for face in faces.values() for corner in face for part in (".gap", ".impulse_n")]
    path = read_table(folder / f"trajectory_mu{mu:g}_e0.4.csv", ["t", "slider.y", "crank.theta", "energy", *parts])
    path["ms"], path["turns"], path["mm"] = 1e3 * path["t"], path["crank.theta"] / (2 * np.pi), 1e3 * path["slider.y"]
    path["phase"] = np.full(path["t"].size, FREE)
    path["impacts"], path["lasting"] = [], []
    for phase, (left, right) in faces.items():
        impulse = path[left + ".impulse_n"] + path[right + ".impulse_n"]
        hit = impulse > 1e-12  # [N s]
        near = np.minimum(path[left + ".gap"], path[right + ".gap"]) < 1e-7  # [m] chatter does not end a contact
        for begin, end in runs_of(hit | near):
            if not hit[begin:end].any():
                continue
            begin, last = begin + np.flatnonzero(hit[begin:end])[[0, -1]]
            lasts = last - begin > 1
            path["impacts"].append((begin, phase, impulse[begin] if lasts else impulse[begin:last + 1].sum()))
            if lasts:
                path["lasting"].append((begin, last, phase))
                path["phase"][begin:last + 1] = phase
    return path


def style_of(integrator):
    """Label, colour and marker, the same in every figure."""
    looks = [(ORANGE, "o"), (BLUE, "s"), (GREEN, "^")]
    look = looks[list(TREATMENTS).index(integrator)] if integrator in TREATMENTS else (PINK, "D")
    return TREATMENTS.get(integrator, integrator), *look


def save(figure, folder, name, about):
    figure.text(0.995, 0.006, f"Orthant {about['revision']}, {about['cpu']}", ha="right", fontsize=6.5, color=GREY)
    figure.savefig(folder / f"{name}.png")
    figure.savefig(folder / f"{name}.svg", metadata={"Date": None})  # same data, same bytes
    plt.close(figure)


def draw_mechanism(axes):
    """The linkage at a crank angle of 50°, in mm and to scale but for the clearance."""
    pin, slider, wall = np.array([98, 117]), np.array([382, 4]), 38
    for y in (-wall, wall):
        axes.plot([310, 475], [y, y], color=BLACK, linewidth=1.8)
        axes.add_patch(Rectangle((310, y if y > 0 else y - 10), 165, 10, hatch="/////", facecolor="none",
                                 edgecolor="#aaaaaa", linewidth=0))
    axes.add_patch(Rectangle(slider - (50, 25), 100, 50, facecolor="#d9ecf8", edgecolor=BLACK, linewidth=1.3))
    axes.plot([0, pin[0]], [0, pin[1]], color=ORANGE, linewidth=5)
    axes.plot([pin[0], slider[0]], [pin[1], slider[1]], color=GREEN, linewidth=4)
    for joint in ((0, 0), pin, slider):
        axes.add_patch(Circle(joint, 6, facecolor="white", edgecolor=BLACK, zorder=3))
    arc = np.radians(np.linspace(0, 50, 30))
    axes.plot(np.append(60 * np.cos(arc[::-1]), [0, 90]), np.append(60 * np.sin(arc[::-1]), [0, 0]), color=GREY, linewidth=0.9)
    for x, y, text in ((66, 22, "θ₁"), (-30, 78, "crank\n153 mm"), (225, 82, "rod 306 mm"), (440, 0, "slider")):
        axes.text(x, y, text)
    axes.text(482, -78, "clearance 1 mm above and below (drawn wider)", ha="right", fontsize=8.5)
    axes.set(xlim=(-35, 490), ylim=(-90, 140), aspect="equal", title="Slider-crank with clearance")
    axes.axis("off")


def draw_path(axes, path, x, area):
    points = np.column_stack([path[x], path["mm"]])
    ends = [0, *np.flatnonzero(np.diff(path["phase"])), len(points) - 1]
    lines = [points[a:b + 1] for a, b in zip(ends, ends[1:])]
    phases = path["phase"][ends[1:]]
    axes.add_collection(LineCollection(lines, colors=[PHASES[p][1] for p in phases], zorder=3,
                                       linewidths=np.where(phases == FREE, 1.5, 3.5), capstyle="butt"))
    for wall in WALL.values():
        axes.axhspan(wall, 2 * wall, color="#e6e6e6", linewidth=0)
        axes.axhline(wall, color=BLACK, linewidth=1.1)
    for record, phase, impulse in path["impacts"]:
        axes.scatter(path[x][record], WALL[phase], s=area * impulse, color=PHASES[phase][1], linewidth=0, zorder=4)
    axes.set(ylabel="slider's centre y [mm]")


def plot_slider_path(folder, about):
    path, area = read_trajectory(folder, 0.01), 900  # [pt² per N s] of an impact's dot
    figure = plt.figure(figsize=(11, 6.8))
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.3), left=0.06, right=0.985, top=0.9, bottom=0.15, hspace=0.36, wspace=0.16)
    draw_mechanism(figure.add_subplot(grid[0, 0]))
    first, whole = figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, :])
    draw_path(first, path, "ms", 2 * area)
    first.set(xlim=(0, 16), ylim=(0, 1.1), xlabel="time [ms]", title="First impacts, coming to rest, release (magnified)")
    early = [impact for impact in sorted(path["impacts"]) if impact[1] == TOP and path["ms"][impact[0]] < 16]
    for number, (record, _, _) in enumerate(early[:4], 1):
        first.annotate(str(number), (path["ms"][record], 1), (0, -20), textcoords="offset points", ha="center", fontsize=8.5)
    for begin, end, _ in [lasting for lasting in path["lasting"] if path["ms"][lasting[1]] < 16][:1]:
        for record, text in ((begin, "infinitely many impacts\nend at {:.2f} ms"), (end, "release\nat {:.2f} ms")):
            at = path["ms"][record]
            first.annotate(text.format(at), (at, 0.98), (at, 0.55), ha="center", arrowprops={"arrowstyle": "->", "color": GREY})
    draw_path(whole, path, "turns", area)
    whole.set(xlim=(0, path["turns"].max()), ylim=(-1.2, 1.2), xlabel="crank angle θ₁ [revolutions]", title="The whole motion, 0.2 s")
    handles = [Line2D([], [], color=colour, linewidth=1.5 if p == FREE else 3.5, label=label) for p, (label, colour) in PHASES.items()]
    handles += [Line2D([], [], color=GREY, marker="o", linewidth=0, markersize=np.sqrt(area * i), markeredgewidth=0,
                       label=f"impact of {i:g} N s (upper right: twice the area)") for i in (0.1, 0.01)]
    figure.legend(handles=handles, loc="lower center", ncol=5, bbox_to_anchor=(0.5, 0.02), frameon=False)
    figure.suptitle("The slider's way through its clearance: µ = 0.01, e = 0.4", x=0.06, ha="left")
    save(figure, folder, "slider_path", about)


def draw_errors(axes, runs, orders):
    """One problem: every run a dot, the worst of each octave of h a line, failed runs as crosses at the top."""
    for integrator in dict.fromkeys(runs["integrator"]):
        label, colour, marker = style_of(integrator)
        part = select(runs, runs["integrator"] == integrator)
        for order in orders["order"][orders["integrator"] == integrator]:
            label += f": order {order:.2f}"
        failed = 1e6 * part["h"][part["status"] != "solved"]
        label += f", {failed.size} failed" if failed.size else ""
        axes.plot(failed, np.full(failed.size, 0.97), "x", color=colour, markersize=5, transform=axes.get_xaxis_transform())
        part = select(part, (part["status"] == "solved") & (part["error"] > 0))
        octave = np.floor(np.log2(part["h"].max(initial=0) * 1.001 / part["h"]))
        worst = [np.flatnonzero(octave == o)[np.argmax(part["error"][octave == o])] for o in np.unique(octave)]
        axes.plot(1e6 * part["h"], part["error"], ".", markersize=3.5, color=colour, alpha=0.4, markeredgewidth=0)
        axes.plot(1e6 * part["h"][worst], part["error"][worst], marker=marker, markersize=4, color=colour, label=label)


def plot_error_vs_step(folder, about):
    table = read_table(folder / "sweep.csv", ["integrator", "mu", "e", "h", "error", "seconds", "status"])
    table = select(table, np.isnan(table["seconds"]))
    orders = read_table(folder / "orders.csv", ["integrator", "mu", "e", "order"])
    frictions, restitutions = np.unique(table["mu"]), np.unique(table["e"])
    usable = table["error"][table["error"] > 0]
    if not usable.size:
        raise ValueError(f"{folder / 'sweep.csv'}: no untimed row has an error")
    low, high = np.quantile(usable, 0.005) / 10, 1000 * usable.max()  # not to the luckiest runs; room for the legends
    figure, grid = plt.subplots(restitutions.size, frictions.size, sharex=True, sharey=True, squeeze=False, figsize=(11, 9.2))
    for (row, column), axes in np.ndenumerate(grid):
        mu, e = frictions[column], restitutions[row]
        draw_errors(axes, select(table, (table["mu"] == mu) & (table["e"] == e)),
                    select(orders, (orders["mu"] == mu) & (orders["e"] == e)))
        start = 1e6 * table["h"].max() / 12
        for order in (1, 2):
            axes.plot([start, 6 * start], [4 * low, 4 * low * 6**order], color=GREY, linewidth=0.9, linestyle="--")
            axes.text(6.2 * start, 4 * low * 6**order, f"order {order}", fontsize=7.5, color=GREY, va="center")
        axes.legend(loc="upper left", bbox_to_anchor=(0, 0.95), borderaxespad=0.2)
        axes.set(xscale="log", yscale="log", ylim=(low, high), facecolor="#f8f4ec" if e > 0.8 else "white",
                 title=f"µ = {mu:g}, e = {e:g}" + (" (ill-conditioned)" if e > 0.8 else ""))
        axes.label_outer()
        axes.set_xlabel("step size h [µs]" if row == restitutions.size - 1 else "")
        axes.set_ylabel(ERROR if column == 0 else "")
    figure.suptitle("Error against step size", x=0.012, ha="left")
    figure.text(0.012, 0.012, "Dots: every run" + (f", but {np.sum(usable < low)} lucky ones below the frame" if (usable < low).any() else "") +
                ". Lines: the worst of each octave of h, to which the order is fitted; single errors jump with h.\n"
                "e = 0.9: after about 0.14 s the motion itself magnifies small errors, so no clean order can be expected.",
                fontsize=8.5, color=GREY)
    figure.tight_layout(rect=(0, 0.045, 1, 1))
    save(figure, folder, "error_vs_step", about)


def plot_error_vs_time(folder, about):
    table = read_table(folder / "sweep.csv", ["integrator", "solver", "mu", "e", "h", "error", "seconds", "us_per_step", "status"])
    table = select(table, np.isfinite(table["seconds"]))
    if not table["h"].size:
        raise ValueError(f"{folder / 'sweep.csv'}: no row has a time")
    figure, axes = plt.subplots(figsize=(9, 6.4))
    text_of = lambda h: f"h = {1e6 * h:.0f} µs" if h > 1e-4 else f"h = {1e6 * h:.3g} µs"
    for integrator, solver in dict.fromkeys(zip(table["integrator"], table["solver"])):
        label, colour, marker = style_of(integrator)
        part = select(table, (table["integrator"] == integrator) & (table["solver"] == solver))
        part = select(part, np.argsort(-part["h"], kind="stable"))
        failed = select(part, part["status"] != "solved")
        axes.plot(failed["seconds"], np.full(failed["h"].size, 0.97), "x", color=colour, transform=axes.get_xaxis_transform(),
                  markersize=7, label=f"{label}, {solver}: {failed['h'].size} failed" if failed["h"].size else None)
        part = select(part, (part["status"] == "solved") & (part["error"] > 0))
        cost = f"{label}, {solver}: {np.median(part['us_per_step']):.2g} µs a step" if part["h"].size else None
        if np.unique(part["h"]).size > 1:
            axes.plot(part["seconds"], part["error"], marker=marker, markersize=5, color=colour, label=cost)
            for seconds, error, h in zip(*(part[c][::3] for c in ("seconds", "error", "h"))):
                axes.annotate(text_of(h), (seconds, error), (7, 5), textcoords="offset points", fontsize=8)
        elif cost:
            axes.plot(part["seconds"], part["error"], {"pgs": "D", "enumerate": "^"}.get(solver, "v"), markersize=8, color="none",
                      markeredgecolor=BLACK, label=f"{cost}, {text_of(part['h'][0])} only")
    axes.set(xscale="log", yscale="log", xlabel="wall time of the 0.2 s motion [s]", ylabel=ERROR,
             title=f"What an error costs: µ = {table['mu'][0]:g}, e = {table['e'][0]:g}; one thread, fastest of three runs")
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
    for (mu, path), level in zip(paths.items(), (2, 1, 0)):
        ms, energy = path["ms"], path["energy"]
        for axes in (whole, first):
            shown = slice(None) if axes is whole else ms <= 16
            axes.plot(ms[shown], energy[shown], color=FRICTIONS[mu], label=f"µ = {mu:g}")
        whole.annotate(f"µ = {mu:g}: {energy[-1]:.2f} J", (ms[-1], energy[-1]), (4, -3), textcoords="offset points", fontsize=9)
        for begin, end, phase in path["lasting"]:
            strips.broken_barh([(ms[begin], ms[end] - ms[begin])], (level - 0.36, 0.72), color=PHASES[phase][1], alpha=0.45, linewidth=0)
            for axes in (whole, first) if mu == 0.01 else ():
                axes.axvspan(ms[begin], ms[end], color=PHASES[phase][1], alpha=0.1, linewidth=0)
        for record, phase, _ in path["impacts"]:
            strips.vlines(ms[record], level - 0.36, level + 0.36, color=PHASES[phase][1], linewidth=0.8)
    whole.set(ylabel="energy [J]", title="The whole motion", xlim=(0, ms[-1]))
    whole.tick_params(labelbottom=False)
    strips.set(yticks=(2, 1, 0), yticklabels=[f"µ = {mu:g}" for mu in paths], ylim=(-0.6, 2.6), xlabel="time [ms]")
    strips.grid(False)
    first.set(xlim=(0, 16), xlabel="time [ms]", ylabel="energy [J]", title="First impacts (magnified)")
    first.legend(loc="best")
    handles = [Patch(color=PHASES[p][1], alpha=0.4, label=f"lasting {PHASES[p][0]}") for p in WALL]
    handles += [Line2D([], [], color=PHASES[p][1], marker="|", markersize=10, linewidth=0, label=f"impact, {text}")
                for p, text in ((TOP, "top"), (BOTTOM, "bottom"))]
    figure.legend(handles=handles, loc="lower center", ncol=4, bbox_to_anchor=(0.5, 0.02), frameon=False)
    figure.suptitle("Energy is lost at impacts and to friction: e = 0.4; shaded: lasting contact for µ = 0.01", x=0.07, ha="left")
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
