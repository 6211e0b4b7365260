"""Draws the slider-crank experiment: reads the tables slider_crank_sweep wrote into a folder, puts PNG and SVG there.

Usage: plot_slider_crank.py FOLDER
"""
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
BLACK, ORANGE, SKY, GREEN, BLUE, RED, PINK = "#000000", "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7"
GREY = "#666666"
FREE, TOP, BOTTOM = 0, 1, 2  # contact phases of the slider
PHASES = {FREE: ("free flight", GREY), TOP: ("top contact", RED), BOTTOM: ("bottom contact", BLUE)}
FRICTIONS = {0.0: GREEN, 0.01: ORANGE, 0.1: PINK}  # of the trajectories
CLEARANCE = 1.0  # [mm] on each side of the slider
TREATMENTS = {"moreau-jean:joints=position": "classical joints", "moreau-jean:joints=symmetric": "symmetric joints"}
TEXT_COLUMNS = {"integrator", "solver", "status"}
TINY_IMPULSE = 1e-12  # [N s]
STYLE = {
    "font.size": 9.5, "axes.titlesize": 10, "axes.titlelocation": "left", "axes.labelsize": 9.5,
    "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": GREY, "axes.axisbelow": True,
    "axes.grid": True, "grid.color": "#e3e3e3", "grid.linewidth": 0.6, "lines.linewidth": 1.5,
    "legend.fontsize": 8.5, "legend.framealpha": 0.95, "legend.edgecolor": "#cccccc",
    "figure.titlesize": 12.5, "savefig.dpi": 170, "svg.hashsalt": "orthant",
}


def read_table(path, columns):
    """The named columns of a CSV file as arrays; an empty number reads as nan."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        raise ValueError(f"{path}: no rows")
    for column in columns:
        if rows[0].get(column) is None:
            raise ValueError(f"{path}: no column '{column}'")
    kind = {c: str if c in TEXT_COLUMNS else (lambda x: float(x or "nan")) for c in columns}
    try:
        return {c: np.array([kind[c](row[c]) for row in rows]) for c in columns}
    except TypeError:
        raise ValueError(f"{path}: a row is cut short") from None


def select(table, keep):
    return {column: values[keep] for column, values in table.items()}


def runs_of(mask):
    """[begin, end) of every run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return edges.reshape(-1, 2)


def read_trajectory(folder, mu):
    """Adds contact phases and impacts: a contact shorter than three records is an impact, a longer one begins with one."""
    corners = [f"corner{i}.impulse_n" for i in (1, 2, 3, 4)]
    columns = ["t", "slider.x", "slider.y", "crank.theta", "energy"] + corners
    table = read_table(folder / f"trajectory_mu{mu:g}_e0.4.csv", columns)
    table["ms"], table["turns"] = 1e3 * table["t"], table["crank.theta"] / (2 * np.pi)
    table["phase"] = np.full(table["t"].size, FREE)
    table["impacts"] = []  # (record, phase, impulse [N s])
    table["lasting"] = []  # (first record, last record, phase)
    for phase, pair in ((TOP, corners[:2]), (BOTTOM, corners[2:])):
        impulse = table[pair[0]] + table[pair[1]]
        for begin, end in runs_of(impulse > TINY_IMPULSE):
            long = end - begin > 2
            table["impacts"].append((begin, phase, impulse[begin] if long else impulse[begin:end].sum()))
            if long:
                table["phase"][begin:end] = phase
                table["lasting"].append((begin, end - 1, phase))
    table["impacts"].sort()
    table["lasting"].sort()
    return table


def style_of(integrator, all_integrators):
    """Label, colour and marker, the same in every figure."""
    index = list(dict.fromkeys([*TREATMENTS, *all_integrators])).index(integrator)
    return (TREATMENTS.get(integrator, integrator), [ORANGE, BLUE, GREEN, PINK, RED, SKY, BLACK][index % 7],
            "os^Dvph"[index % 7])


def log_grid(axes):
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.grid(True, which="major")
    axes.minorticks_on()


def save(figure, folder, name, about):
    figure.text(0.995, 0.006, f"Orthant {about['revision']}, {about['cpu']}", ha="right", fontsize=6.5, color=GREY)
    for suffix, metadata in ((".png", {}), (".svg", {"Date": None})):
        figure.savefig(folder / (name + suffix), metadata=metadata)
    plt.close(figure)


def draw_mechanism(axes):
    """The linkage at a crank angle of 50°, to scale but for the clearance."""
    l1, l2, a, b, gap, theta = 153, 306, 50, 25, 14, np.radians(50)
    pin = np.array([l1 * np.cos(theta), l1 * np.sin(theta)])
    slider = np.array([pin[0] + np.sqrt(l2**2 - (pin[1] - 6) ** 2), 6])
    for side in (-1, 1):
        wall = side * (b + gap)
        axes.plot([130, 540], [wall, wall], color=BLACK, linewidth=1.8)
        axes.add_patch(Rectangle((130, min(wall, wall + side * 12)), 410, 12, hatch="////", fill=False,
                                 edgecolor="#aaaaaa", linewidth=0))
    axes.add_patch(Rectangle(slider - (a, b), 2 * a, 2 * b, facecolor="#d9ecf8", edgecolor=BLACK, linewidth=1.3))
    axes.plot(*zip((0, 0), pin), color=ORANGE, linewidth=5, solid_capstyle="round")
    axes.plot(*zip(pin, slider), color=GREEN, linewidth=4, solid_capstyle="round")
    for joint in ((0, 0), pin, slider):
        axes.add_patch(Circle(joint, 6, facecolor="white", edgecolor=BLACK, zorder=3))
    arc = np.linspace(0, theta, 30)
    axes.plot(60 * np.cos(arc), 60 * np.sin(arc), color=GREY, linewidth=0.9)
    axes.plot([0, 90], [0, 0], color=GREY, linewidth=0.9, linestyle=":")
    axes.text(68, 22, "θ₁", color=GREY)
    axes.text(20, 82, "crank\n153 mm", ha="right", color="#9a6a00")
    axes.text(240, 100, "rod 306 mm", color="#00694c")
    axes.text(slider[0] - 38, slider[1] - 18, "slider", ha="center", fontsize=8.5)
    axes.text(335, -92, "clearance 1 mm above and below (drawn wider)", ha="center", fontsize=8.5)
    axes.set(xlim=(-55, 560), ylim=(-110, 165), aspect="equal", title="Slider-crank with clearance")
    axes.axis("off")


def draw_path(axes, path, x, area):
    points = np.column_stack([path[x], 1e3 * path["slider.y"]])
    colours = [PHASES[p][1] for p in path["phase"][1:]]
    axes.add_collection(LineCollection(np.stack([points[:-1], points[1:]], axis=1), colors=colours, linewidths=1.6))
    for wall in (-CLEARANCE, CLEARANCE):
        axes.axhspan(wall, 1.2 * wall, color="#e6e6e6", linewidth=0)
        axes.axhline(wall, color=BLACK, linewidth=1.1)
    record, phase, impulse = zip(*path["impacts"]) if path["impacts"] else ([], [], [])
    record = np.array(record, dtype=int)
    axes.scatter(path[x][record], np.where(np.array(phase) == TOP, CLEARANCE, -CLEARANCE), s=area * np.array(impulse),
                 facecolor=[PHASES[p][1] for p in phase], edgecolor="white", linewidth=0.6, zorder=4, clip_on=False)
    axes.set(ylim=(-1.2, 1.2), yticks=(-1, -0.5, 0, 0.5, 1), ylabel="slider's centre y [mm]")


def plot_slider_path(folder, about):
    path = read_trajectory(folder, 0.01)
    area = 900  # [pt² per N s] of an impact's dot
    figure = plt.figure(figsize=(11, 6.8))
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.45), left=0.06, right=0.985, top=0.9, bottom=0.155,
                               hspace=0.42, wspace=0.14)
    draw_mechanism(figure.add_subplot(grid[0, 0]))
    first = figure.add_subplot(grid[0, 1])
    draw_path(first, path, "ms", 2 * area)
    first.set(xlim=(0, 16), xlabel="time [ms]", title="First impacts, coming to rest, release")
    for number, (record, phase, _) in enumerate([i for i in path["impacts"] if path["ms"][i[0]] < 16][:5], 1):
        first.annotate(str(number), (path["ms"][record], CLEARANCE if phase == TOP else -CLEARANCE), fontsize=8.5,
                       xytext=(0, -16 if phase == TOP else 10), textcoords="offset points", ha="center")
    for begin, end, phase in path["lasting"][:1]:
        wall = CLEARANCE if phase == TOP else -CLEARANCE
        for record, text in ((begin, "impacts accumulate\nat {:.2f} ms"), (end, "release\nat {:.2f} ms")):
            if path["ms"][record] < 16:
                first.annotate(text.format(path["ms"][record]), (path["ms"][record], wall), (path["ms"][record], 0.3 * wall),
                               ha="center", va="center", fontsize=8.5, arrowprops={"arrowstyle": "->", "color": GREY})
    whole = figure.add_subplot(grid[1, :])
    draw_path(whole, path, "turns", area)
    whole.set(xlim=(0, path["turns"].max()), xlabel="crank angle θ₁ [revolutions]", title="The whole motion, 0.2 s")
    handles = [Line2D([], [], color=colour, linewidth=2.5, label=label) for label, colour in PHASES.values()]
    handles += [Line2D([], [], color=GREY, marker="o", linewidth=0, markersize=np.sqrt(area * i), markeredgewidth=0,
                       label=f"impact of {i:g} N s") for i in (0.1, 0.01)]
    figure.legend(handles=handles, loc="lower center", ncol=5, bbox_to_anchor=(0.5, 0.02), frameon=False)
    figure.suptitle("The slider's way through its clearance: µ = 0.01, e = 0.4", x=0.06, ha="left")
    save(figure, folder, "slider_path", about)


def worst_of_octaves(h, error):
    """Worst sample of every octave of h, from the largest h down."""
    octave = np.floor(np.log2(h.max() / h) + 1e-3)
    best = [np.flatnonzero(octave == o)[np.argmax(error[octave == o])] for o in np.unique(octave)]
    return h[best], error[best]


def slope_guide(axes, order, h, error):
    ends = np.array([h, h * 6])
    axes.plot(ends, error * (ends / h) ** order, color=GREY, linewidth=0.9, linestyle=(0, (4, 2)))
    axes.annotate(f"order {order}", (ends[1], error * 6**order), (2, -1), textcoords="offset points", fontsize=7.5, color=GREY)


def plot_error_vs_step(folder, about):
    table = read_table(folder / "sweep.csv", ["integrator", "mu", "e", "h", "error", "seconds", "status"])
    orders = read_table(folder / "orders.csv", ["integrator", "mu", "e", "order", "scatter"])
    table = select(table, np.isnan(table["seconds"]))
    if not table["h"].size:
        raise ValueError(f"{folder / 'sweep.csv'}: no rows without a time")
    integrators = list(dict.fromkeys(table["integrator"]))
    frictions, restitutions = np.unique(table["mu"]), np.unique(table["e"])
    figure, grid = plt.subplots(restitutions.size, frictions.size, sharex=True, sharey=True, squeeze=False,
                                figsize=(3.7 * frictions.size, 2.75 * restitutions.size + 1))
    usable = table["error"][table["error"] > 0]
    low, high = usable.min() / 2, usable.max() * 25  # room for the legends
    for (row, column), axes in np.ndenumerate(grid):
        mu, e = frictions[column], restitutions[row]
        log_grid(axes)
        if e > 0.8:
            axes.set_facecolor("#f6f2ea")
        for integrator in integrators:
            label, colour, marker = style_of(integrator, integrators)
            part = select(table, (table["integrator"] == integrator) & (table["mu"] == mu) & (table["e"] == e))
            good = (part["status"] == "solved") & (part["error"] > 0)
            failed = part["h"][part["status"] != "solved"]
            fit = select(orders, (orders["integrator"] == integrator) & (orders["mu"] == mu) & (orders["e"] == e))
            for order in fit["order"][:1]:
                label += f": order {order:.2f}"
            if good.any():
                h, error = part["h"][good], part["error"][good]
                axes.plot(1e6 * h, error, marker=".", linewidth=0, markersize=3, color=colour, alpha=0.35, markeredgewidth=0)
                h, error = worst_of_octaves(h, error)
                axes.plot(1e6 * h, error, marker=marker, markersize=4, color=colour, label=label)
            axes.plot(1e6 * failed, np.full(failed.size, 0.97), marker="x", linewidth=0, color=colour, markersize=5,
                      transform=axes.get_xaxis_transform(), label=f"failed: {failed.size}" if failed.size else None)
        h = 1e6 * table["h"].max() / 12
        slope_guide(axes, 1, h, low * 2.2)
        slope_guide(axes, 2, h, low * 2.2)
        axes.legend(loc="upper left", borderaxespad=0.2)
        axes.set(ylim=(low, high), title=f"µ = {mu:g}, e = {e:g}" + (" (ill-conditioned)" if e > 0.8 else ""))
        if row == restitutions.size - 1:
            axes.set_xlabel("step size h [µs]")
        if column == 0:
            axes.set_ylabel("|error of θ₁(0.2 s)| [rad]")
    figure.suptitle("Error against step size", x=0.012, ha="left")
    figure.text(0.012, 0.012, "Dots: every run. Lines: the worst of each octave of h, to which the order is fitted (the "
                "error is a sawtooth in h).\ne = 0.9: the motion itself magnifies small errors after about 0.14 s, so no "
                "clean order can be expected.", fontsize=8.5, color=GREY)
    figure.tight_layout(rect=(0, 0.055, 1, 0.995))
    save(figure, folder, "error_vs_step", about)


def plot_error_vs_time(folder, about):
    columns = ["integrator", "solver", "mu", "e", "h", "error", "seconds", "us_per_step", "status"]
    table = read_table(folder / "sweep.csv", columns)
    timed = select(table, np.isfinite(table["seconds"]))
    if not timed["h"].size:
        raise ValueError(f"{folder / 'sweep.csv'}: no row has a time")
    integrators = list(dict.fromkeys(timed["integrator"]))
    figure, axes = plt.subplots(figsize=(8.6, 5.8))
    log_grid(axes)
    single = []
    for integrator, solver in dict.fromkeys(zip(timed["integrator"], timed["solver"])):
        label, colour, marker = style_of(integrator, integrators)
        part = select(timed, (timed["integrator"] == integrator) & (timed["solver"] == solver))
        part = select(part, np.argsort(-part["h"], kind="stable"))
        good, bad = part["status"] == "solved", part["status"] != "solved"
        failed = part["seconds"][bad]
        axes.plot(failed, np.full(failed.size, 0.97), marker="x", linewidth=0, markersize=7, color=colour,
                  transform=axes.get_xaxis_transform(), label=f"{label}, {solver}: failed" if failed.size else None)
        part = select(part, good)
        if np.unique(part["h"]).size < 2:
            single += [(label, solver, part)] if part["h"].size else []
            continue
        cost = f"{np.median(part['us_per_step']):.2g} µs a step"
        axes.plot(part["seconds"], part["error"], marker=marker, markersize=5, color=colour, label=f"{label}, {solver}: {cost}")
        for i in range(0, part["h"].size, 3):
            axes.annotate(f"h = {1e6 * part['h'][i]:.3g} µs", (part["seconds"][i], part["error"][i]), (7, 5),
                          textcoords="offset points", fontsize=8, color=colour)
    for (label, solver, part), marker in zip(single, "D^vPX*"):
        axes.plot(part["seconds"], part["error"], marker=marker, markersize=8, linewidth=0, color="none",
                  markeredgecolor=BLACK, label=f"{label}, {solver}: {part['us_per_step'][0]:.2g} µs a step, "
                                               f"h = {1e6 * part['h'][0]:.3g} µs")
    axes.legend(loc="lower left")
    axes.set(xlabel="wall time of the 0.2 s motion [s]", ylabel="|error of θ₁(0.2 s)| [rad]",
             title=f"What an error costs: µ = {timed['mu'][0]:g}, e = {timed['e'][0]:g}; one thread, fastest of three runs")
    figure.tight_layout(rect=(0, 0.015, 1, 1))
    save(figure, folder, "error_vs_time", about)


def plot_energy(folder, about):
    paths = {mu: read_trajectory(folder, mu) for mu in FRICTIONS}
    figure = plt.figure(figsize=(11, 5.8))
    grid = figure.add_gridspec(2, 2, width_ratios=(1.7, 1), height_ratios=(3, 1), left=0.065, right=0.985, top=0.88,
                               bottom=0.17, hspace=0.1, wspace=0.16)
    whole, first = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[:, 1])
    strips = figure.add_subplot(grid[1, 0], sharex=whole)
    for (mu, path), height in zip(paths.items(), (2, 1, 0)):
        colour = FRICTIONS[mu]
        for axes in (whole, first):
            axes.plot(path["ms"], path["energy"], color=colour, label=f"µ = {mu:g}")
        whole.annotate(f"µ = {mu:g}: {path['energy'][-1]:.2f} J", (path["ms"][-1], path["energy"][-1]), (-2, 6),
                       textcoords="offset points", ha="right", color=colour, fontweight="bold", fontsize=9)
        for begin, end, phase in path["lasting"]:
            span = path["ms"][begin], path["ms"][end] - path["ms"][begin]
            strips.broken_barh([span], (height - 0.36, 0.72), color=PHASES[phase][1], alpha=0.45, linewidth=0)
            if mu == 0.01:
                whole.axvspan(span[0], sum(span), color=PHASES[phase][1], alpha=0.09, linewidth=0)
                first.axvspan(span[0], sum(span), color=PHASES[phase][1], alpha=0.12, linewidth=0)
        for record, phase, _ in path["impacts"]:
            strips.plot([path["ms"][record]] * 2, [height - 0.36, height + 0.36], color=PHASES[phase][1], linewidth=0.8)
    whole.set(ylabel="energy [J]", title="The whole motion", xlim=(0, paths[0.01]["ms"][-1]))
    whole.tick_params(labelbottom=False)
    strips.set(yticks=(2, 1, 0), yticklabels=[f"µ = {mu:g}" for mu in paths], ylim=(-0.6, 2.6), xlabel="time [ms]")
    strips.grid(False)
    shown = np.concatenate([path["energy"][path["ms"] <= 16] for path in paths.values()])
    margin = 0.06 * np.ptp(shown)
    first.set(xlim=(0, 16), ylim=(shown.min() - margin, shown.max() + margin), xlabel="time [ms]", ylabel="energy [J]",
              title="First impacts")
    first.legend(loc="upper right")
    handles = [Patch(color=PHASES[p][1], alpha=0.4, label=f"lasting {PHASES[p][0]}") for p in (TOP, BOTTOM)]
    handles += [Line2D([], [], color=PHASES[p][1], marker="|", markersize=10, linewidth=0, label=f"impact, {PHASES[p][0].split()[0]}")
                for p in (TOP, BOTTOM)]
    figure.legend(handles=handles, loc="lower center", ncol=4, bbox_to_anchor=(0.5, 0.02), frameon=False)
    figure.suptitle("Energy: lost at impacts and to friction; e = 0.4, shading behind the curves for µ = 0.01", x=0.065, ha="left")
    save(figure, folder, "energy", about)


def main():
    parser = argparse.ArgumentParser(description="Draws the tables slider_crank_sweep wrote into FOLDER, as PNG and SVG.")
    parser.add_argument("folder", type=Path, metavar="FOLDER", nargs="?", default=Path("results/slider_crank"))
    folder = parser.parse_args().folder
    plt.rcParams.update(STYLE)
    try:
        about = {"revision": "", "cpu": "", **json.loads((folder / "manifest.json").read_text())}
        for plot in (plot_slider_path, plot_error_vs_step, plot_error_vs_time, plot_energy):
            plot(folder, about)
    except (OSError, ValueError) as error:
        sys.exit(f"plot_slider_crank: {error}")


if __name__ == "__main__":
    main()
