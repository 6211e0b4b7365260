"""Draws the figures of a report's sweeps for papers: reads report.html from a folder; puts PNG, SVG there."""
import json
import re

import matplotlib.pyplot as plt
import numpy as np

from plotting import BLUE, GREEN, GREY, ORANGE, PINK, RED, main, save

COLOURS = (BLUE, RED, GREEN, PINK, ORANGE, "#56B4E9", "#6b4fa0", GREY, "black")
LINES = list(zip(COLOURS, "sDo^vPX*d"))
LETTERS = {"mu": "µ", "omega3": "ω₃", "theta3": "θ₃", "e_n": "e"}
UNITS = {"clearance": " m", "omega3": " rad/s", "theta3": " rad"}
NOTHING = [(np.nan, np.nan)]


def rows_of(sweep):
    """As page.js has them: parameters are columns too, and the energy that was lost."""
    for values in zip(*sweep["rows"].values()):
        row = dict(zip(sweep["rows"], values))
        if row["energy_initial"] is not None:
            row["energy_lost"] = row["energy_initial"] - row["energy_final"]
            row["lost_per_turn"] = None  # of what turns by half a revolution at least
            if abs(row["value"] or 0) > np.pi:
                row["lost_per_turn"] = 2 * np.pi * row["energy_lost"] / abs(row["value"])
        yield json.loads(row["parameters"]) | row


def setting(row):
    return row["rtol"] or row["step"]


def worst_of_settings(rows, x, y):
    points = []
    for value in sorted({setting(row) for row in rows}, reverse=True):
        same = [row for row in rows if setting(row) == value]
        if all(row["status"] == "solved" and row[y] is not None for row in same):
            points.append((max(row[x] for row in same), max(row[y] for row in same)))
    return points


def draw_panel(axes, sweep, rows, figure, parameters):
    x, y = figure["x"], figure["y"]
    names = list(dict.fromkeys(sweep["rows"].get(figure["by"], [row[figure["by"]] for row in rows])))
    shown = list(dict.fromkeys(row[figure["by"]] for row in rows))
    for at, name in enumerate(shown):
        own = [row for row in rows if row[figure["by"]] == name]
        colour, marker = LINES[names.index(name) % len(LINES)]
        if figure.get("worst"):
            points = worst_of_settings(own, x, y)
        else:
            points = sorted((row[x], row[y]) for row in own if row["status"] == "solved" and row[y] is not None)
        if figure.get("octaves"):
            axes.plot(*zip(*points or NOTHING), ".", color=colour, markersize=3, alpha=0.4, markeredgewidth=0)
            fits = [o for o in sweep["orders"] if o["integrator"] == name and o["parameters"] == parameters]
            points = fits[0]["worst"] if fits else []
        axes.plot(
            *zip(*points or NOTHING),
            label=name,
            color=colour,
            marker=marker,
            markersize=6.5 - 3 * at / len(shown),  # coinciding marks are all seen
            linestyle="none" if figure.get("dots") else "-")


def beside_axes(row, figure):
    """The parameters that no axis shows, as text: a panel each."""
    parameters = json.loads(row["parameters"])
    axes = {figure["x"], figure["y"], figure["by"]} & set(parameters)
    if not axes:
        return row["parameters"]
    return json.dumps({name: value for name, value in parameters.items() if name not in axes})


def numbers_of(parameters):
    return [value for value in json.loads(parameters).values() if not isinstance(value, str)]


def in_words(name, value):
    if name == "scene":
        return value
    last = name.split(".")[-1]
    return f"{LETTERS.get(last, name)} = {value if isinstance(value, str) else f'{value:g}'}{UNITS.get(name, '')}"


def draw(sweep, rows, figure, folder, about):
    rows = [
        row
        for row in rows
        if ("timed" not in figure or (row["repeats"] > 0) == figure["timed"])
        and all(row[key] == figure.get(key, row[key]) for key in ("solver", "integrator"))
        and all(
            key not in row or row[key] in (wanted if isinstance(wanted, list) else [wanted])
            for key, wanted in figure.get("where", {}).items()
        )
        and row.get(figure["x"]) is not None
        and row.get(figure["y"]) is not None
        and not (figure["x"] == "step" and row["rtol"])
        and all(row[figure[axis]] > 0 for axis in figure.get("log", ""))
    ]  # nothing else has a place there
    panels = sorted(dict.fromkeys(beside_axes(row, figure) for row in rows), key=numbers_of)
    if figure.get("worst"):
        panels = [None]
    columns = min(3, len(panels))
    deep = -(-len(panels) // columns)
    size = (4 + 2.6 * columns, 2.6 + 2.4 * deep)  # [in]
    page, grid = plt.subplots(deep, columns, squeeze=False, sharex=True, sharey=True, figsize=size)
    for axes, parameters in zip(grid.flat, panels):
        own = [row for row in rows if parameters in (None, beside_axes(row, figure))]
        draw_panel(axes, sweep, own, figure, parameters or "{}")
        if parameters:
            words = json.loads(parameters).items()
            axes.set_title(", ".join(in_words(name, value) for name, value in words), fontsize=8.5)
        log = figure.get("log", "")
        axes.set(xlabel=figure.get("x_label", figure["x"]), ylabel=figure.get("y_label", figure["y"]),
                 xscale="log" if "x" in log else "linear", yscale="log" if "y" in log else "linear")
        for axis in (axes.xaxis, axes.yaxis):
            if axis.get_scale() == "linear":
                axis.get_major_formatter().set_useOffset(False)
        axes.label_outer()
    for axes in grid.flat[len(panels):]:
        axes.remove()
    for axes in grid[-2:-1, len(panels) - columns * (deep - 1):].flat:  # nothing below them
        axes.tick_params(labelbottom=True)
        axes.set_xlabel(figure.get("x_label", figure["x"]))
    handles = list({h.get_label(): h for axes in grid.flat for h in axes.get_legend_handles_labels()[0]}.values())
    page.tight_layout(rect=(0, (0.25 + 0.2 * -(-len(handles) // 3)) / page.get_figheight(), 1, 0.95))
    name = re.sub(r"[^a-z0-9]+", "_", figure["title"].lower()).strip("_")
    save(page, folder / name, figure["title"], about, handles, columns=3)


def plot_figures(folder, about):
    page = (folder / "report.html").read_text()
    data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S).group(1))
    for sweep in data["sweeps"]:
        rows = list(rows_of(sweep))
        for figure in sweep["figures"]:
            draw(sweep, rows, figure, folder, about)


if __name__ == "__main__":
    main(__doc__, "results/slider_crank", (plot_figures,))
