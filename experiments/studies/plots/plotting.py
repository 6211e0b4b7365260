"""What the plot scripts share: one style, tables from CSV, pictures as PNG and SVG, the command line."""
import argparse
import csv
import json
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

# Okabe & Ito: distinct for colour-blind readers, too.
ORANGE, GREEN, BLUE, RED, PINK, GREY = "#E69F00", "#009E73", "#0072B2", "#D55E00", "#CC79A7", "#666666"
STYLE = {
    "font.size": 9.5, "axes.titlesize": 10, "axes.titlelocation": "left", "axes.spines.top": False,
    "axes.spines.right": False, "axes.edgecolor": GREY, "axes.axisbelow": True, "axes.grid": True,
    "grid.color": "#e3e3e3", "grid.linewidth": 0.6, "legend.fontsize": 8.5, "legend.frameon": False,
    "figure.titlesize": 12.5, "savefig.dpi": 170, "svg.hashsalt": "orthant", "lines.solid_capstyle": "butt",
}


def read_table(path, texts, numbers):
    """The named columns of a CSV file as arrays; an empty number reads as nan."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        raise ValueError(f"{path}: no rows")
    for column in (*texts, *numbers):
        if any(row.get(column) is None for row in rows):
            raise ValueError(f"{path}: no column '{column}', or a row is cut short")
    table = {column: np.array([row[column] for row in rows]) for column in texts}
    return table | {column: np.array([float(row[column] or "nan") for row in rows]) for column in numbers}


def select(table, keep):
    return {column: values[keep] for column, values in table.items()}


def save(figure, path, title, about, handles=(), columns=5, low=0.015):
    figure.suptitle(title, x=0.06, ha="left")
    if handles:
        figure.legend(handles=handles, loc="lower center", ncol=columns, bbox_to_anchor=(0.5, low))
    figure.text(0.995, 0.006, f"Orthant {about['revision']}, {about['cpu']}", ha="right", fontsize=6.5, color=GREY)
    figure.savefig(path.with_suffix(".png"))
    figure.savefig(path.with_suffix(".svg"), metadata={"Date": None})  # same data, same bytes
    plt.close(figure)


def main(about, example, plots, manifest="manifest.json"):
    """Calls each plot with the folder named on the command line and what its manifest holds."""
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("folder", type=Path, help=f"for example {example}")
    folder = parser.parse_args().folder
    plt.switch_backend("Agg")  # no display needed
    plt.rcParams.update(STYLE)
    try:
        made_by = {"revision": "of unknown revision", "cpu": "", **json.loads((folder / manifest).read_text())}
        for plot in plots:
            plot(folder, made_by)
    except (OSError, ValueError) as error:
        sys.exit(f"{Path(sys.argv[0]).stem}: {error}")
