#!/usr/bin/python3
"""Performance profiles of the cone shoot-out: share of problems solved within a factor of the best time.

    plot_cone_shootout.py FOLDER    reads FOLDER/profiles.csv, writes FOLDER/profiles.svg
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def main():
    folder = pathlib.Path(sys.argv[1])
    curves = {}
    with open(folder / "profiles.csv", newline="") as file:
        for row in csv.DictReader(file):
            curve = curves.setdefault(float(row["tolerance"]), {}).setdefault(row["method"], ([], []))
            curve[0].append(float(row["factor"]))
            curve[1].append(float(row["share"]))
    figure, axes = plt.subplots(1, len(curves), figsize=(5 * len(curves), 4), sharey=True, squeeze=False)
    for axis, (tolerance, methods) in zip(axes[0], sorted(curves.items(), reverse=True)):
        for method, (factor, share) in methods.items():
            axis.semilogx(factor, share, drawstyle="steps-post", label=method, ls="--" if "/" in method else "-")
        axis.set_title(f"scale-free residual <= {tolerance:g}")
        axis.set_xlabel("time / best time of the problem")
        axis.set_ylim(0, 1.02)
        axis.grid(alpha=0.3)
    axes[0][0].set_ylabel("share of problems solved")
    axes[0][-1].legend(fontsize="x-small", loc="lower right")
    figure.tight_layout()
    figure.savefig(folder / "profiles.svg")


if __name__ == "__main__":
    main()
