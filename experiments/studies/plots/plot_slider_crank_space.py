"""The ball in its socket: reads path_muX.csv (runs), sweep.csv and ideal.json; draws both as PNG, SVG.

Writes closing_rates.csv: the distance of the slider from that of the mechanism without clearance, and its order in the
clearance. With friction the limit is another motion: the ball's dry friction stays when the clearance goes to zero.
"""
import csv
import json

import matplotlib.pyplot as plt
import numpy as np

from plotting import BLUE, GREEN, GREY, RED, main, read_table, save, select

COLOURS = {0: BLUE, 0.1: GREEN, 0.3: RED}


def rotated_back(q, v):
    """Rᵀ v for rows of unit quaternions q = (w, x, y, z)."""
    w, u = q[:, :1], -q[:, 1:]
    return v + 2 * np.cross(u, np.cross(u, v) + w * v)


def contact_on_ball(path):
    """Direction of the contact point from the ball's centre, in the rod's frame; nan where the ball is free."""
    q = np.stack([path[f"rod.q{c}"] for c in "wxyz"], axis=1)
    ball = np.stack([path[f"rod.{c}"] for c in "xyz"], axis=1)
    back = np.stack([q[:, 0], *(-q[:, 1:].T)], axis=1)
    ball = ball + rotated_back(back, np.tile([0.15, 0, 0], (len(q), 1)))  # core/scenes/spatial_slider_crank.cpp
    way = ball - np.stack([path[f"slider.{c}"] for c in "xyz"], axis=1)
    way /= np.linalg.norm(way, axis=1)[:, None]
    on_ball = rotated_back(q, way)
    on_ball[path["socket.gap"] > 1e-9] = np.nan
    return on_ball


def plot_paths(folder, about):
    """Longitude about the rod's axis and angle from it: the map of the ball's surface."""
    files = sorted(folder.glob("path_mu*.csv"), key=lambda f: float(f.stem.removeprefix("path_mu")))
    page, axes = plt.subplots(1, len(files), figsize=(10, 3.6), sharey=True, squeeze=False)
    numbers = [*(f"rod.{c}" for c in ("x", "y", "z", "qw", "qx", "qy", "qz")), *(f"slider.{c}" for c in "xyz"), "t",
               "socket.gap"]
    for axis, file in zip(axes[0], files):
        path = read_table(file, [], numbers)
        at = contact_on_ball(path)
        longitude, angle = np.degrees(np.arctan2(at[:, 2], at[:, 1])), np.degrees(np.arccos(np.clip(at[:, 0], -1, 1)))
        dots = axis.scatter(longitude, angle, c=path["t"], s=3, cmap="viridis")
        axis.set(xlim=(-180, 180), ylim=(0, 180), xticks=(-180, -90, 0, 90, 180), yticks=(0, 45, 90, 135, 180),
                 xlabel="longitude about the rod [°]", title=f"μ = {file.stem.removeprefix('path_mu')}")
    axes[0][0].set_ylabel("angle from the rod's axis [°]")
    page.tight_layout(rect=(0, 0.03, 0.92, 0.93))
    page.colorbar(dots, cax=page.add_axes([0.94, 0.2, 0.012, 0.6]), label="t [s]")
    save(page, folder / "ball", "Contact point on the ball's surface (e = 0)", about)


def plot_closing(folder, about):
    sweep = read_table(folder / "sweep.csv", ["integrator"], ["clearance", "mu", "value"])
    closing = select(sweep, (sweep["integrator"] == "adaptive:rtol=1e-10") & ~np.isnan(sweep["clearance"]))
    ideal = json.loads((folder / "ideal.json").read_text())["final"]["slider.x"]
    page, axis = plt.subplots(figsize=(7, 4.4))
    rows = []
    for mu in sorted(set(closing["mu"])):
        of = closing["mu"] == mu
        order = np.argsort(closing["clearance"][of])
        clearance, x = closing["clearance"][of][order], closing["value"][of][order]
        rates = [float("nan"), *(np.diff(np.log(np.abs(x - ideal))) / np.diff(np.log(clearance)))]
        rows += [(mu, c, value, abs(value - ideal), rate) for c, value, rate in zip(clearance, x, rates)]
        axis.loglog(clearance, np.abs(x - ideal), "o-", ms=4, color=COLOURS.get(mu, GREY), label=f"μ = {mu:g}")
    axis.loglog(clearance, clearance * np.abs(ideal) * 10, "--", color=GREY, lw=0.8, label="first order")
    axis.set(xlabel="clearance [m]", ylabel="distance from the ideal slider at the end [m]")
    axis.legend()
    page.tight_layout(rect=(0, 0.03, 1, 0.93))
    save(page, folder / "closing", "The socket closes: distance from the mechanism without clearance", about)
    with open(folder / "closing_rates.csv", "w", newline="") as table:
        out = csv.writer(table, lineterminator="\n")
        out.writerow(["mu", "clearance", "x", "distance", "order"])
        out.writerows((f"{mu:g}", f"{c:g}", f"{x:.12g}", f"{d:.3g}", f"{rate:.3g}") for mu, c, x, d, rate in rows)


if __name__ == "__main__":
    main(__doc__, "results/slider_crank_space", [plot_paths, plot_closing])
