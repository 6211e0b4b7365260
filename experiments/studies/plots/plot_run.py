#!/usr/bin/python3
"""Plot of a trajectory: columns of a CSV file over time, one axis a column.

    plot_run.py RUN.csv COLUMN… [--output PICTURE.png]
"""
import argparse
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from plotting import BLUE, STYLE


def columns(path, names):
    """The named columns as lists of numbers. Exits with a message that names a missing column and those there are."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file)
            rows, known = list(reader), reader.fieldnames or []
    except OSError as error:
        sys.exit(f"plot_run: {path}: {error.strerror}")
    for name in names:
        if name not in known:
            sys.exit(f"plot_run: {path}: no column '{name}'; there are {', '.join(known)}")
    return [[float(row[name] or "nan") for row in rows] for name in names]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", help="a trajectory that orthant simulate --output wrote as CSV")
    parser.add_argument("columns", nargs="+", metavar="column", help="such as door.theta")
    parser.add_argument("--output", default="run.png", help="the picture, PNG, SVG or PDF; default: %(default)s")
    a = parser.parse_args()
    t, *values = columns(a.run, ["t", *a.columns])
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(len(values), 1, sharex=True, squeeze=False, figsize=(7, 0.6 + 1.5 * len(values)))
        for axis, name, value in zip(axes[:, 0], a.columns, values):
            axis.plot(t, value, color=BLUE, linewidth=1.2)
            axis.set_title(name)
        axes[-1, 0].set_xlabel("t [s]")
        figure.tight_layout()
        figure.savefig(a.output)
    print(a.output)


if __name__ == "__main__":
    main()
