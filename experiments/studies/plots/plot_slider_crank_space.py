"""The ball in its socket: reads path_muX.csv (runs), sweep.csv and ideal*.json; draws PNG and SVG.

ball: contact phases on the ball's surface; also ball_phases.csv, with the direction of the contact point from the
ball's centre in the rod's frame at each moment. closing: the slider's distance from its limit as clearances go to zero;
also closing_rates.csv, with the order in the clearance, from the distance and (change_order) from successive changes,
which needs no limit. With friction the limit is another motion: the ball's dry friction stays when the clearance goes
to zero.
"""
import csv
import json

import matplotlib.pyplot as plt
import numpy as np

from plotting import BLUE, GREY, RED, main, read_table, save, select

BALL, SOCKET = 0.01, 0.0105  # [m] radii, as in core/scenes/spatial_slider_crank.h
STICK = 1e-6  # [m/s] a slip below it is rounding


def rotated_back(q, v):
    """Rᵀ v for rows of unit quaternions q = (w, x, y, z)."""
    w, u = q[:, :1], -q[:, 1:]
    return v + 2 * np.cross(u, np.cross(u, v) + w * v)


def contact_phases(path):
    """Direction of the contact point from the ball's centre in the rod's frame; where the ball touches; where it
    slips."""
    q = np.stack([path[f"rod.q{c}"] for c in "wxyz"], axis=1)
    back = np.stack([q[:, 0], *(-q[:, 1:].T)], axis=1)
    three = lambda body, columns: np.stack([path[f"{body}.{c}"] for c in columns], axis=1)  # noqa: E731
    arm = rotated_back(back, np.tile([0.15, 0, 0], (len(q), 1)))  # core/scenes/spatial_slider_crank.cpp
    way = three("rod", ("x", "y", "z")) + arm - three("slider", ("x", "y", "z"))
    way /= np.linalg.norm(way, axis=1)[:, None]
    touches = path["socket.gap"] < 1e-9
    of_ball = three("rod", ("vx", "vy", "vz")) + np.cross(three("rod", ("wx", "wy", "wz")), arm + BALL * way)
    socket = three("slider", ("vx", "vy", "vz")) + np.cross(three("slider", ("wx", "wy", "wz")), SOCKET * way)
    slip = of_ball - socket
    slip -= np.sum(slip * way, axis=1)[:, None] * way
    return rotated_back(q, way), touches, touches & (np.linalg.norm(slip, axis=1) > STICK)


def write_table(path, head, rows):
    with open(path, "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(head)
        out.writerows(rows)


def plot_ball(folder, about):
    """The two hemispheres of the ball, seen along the rod's axis."""
    files = [file for file in folder.glob("path_mu*.csv") if not file.stem.endswith(".events")]
    files.sort(key=lambda file: float(file.stem.removeprefix("path_mu")))
    page, grid = plt.subplots(2, len(files), figsize=(9, 6.2), squeeze=False)
    places = [f"{body}.{c}" for body in ("rod", "slider") for c in ("x", "y", "z", "vx", "vy", "vz", "wx", "wy", "wz")]
    numbers = [*places, *(f"rod.q{c}" for c in "wxyz"), "t", "socket.gap"]
    table = []
    for column, file in zip(grid.T, files):
        path = read_table(file, [], numbers)
        at, touches, slips = contact_phases(path)
        table += [(file.stem.removeprefix("path_mu"), f"{t:.6g}", *(f"{c:.5f}" for c in way),
                   "free" if not touch else "slides" if slip else "sticks")
                  for t, way, touch, slip in zip(path["t"], at, touches, slips)]
        for axis, outer in zip(column, (True, False)):
            here = touches & ((at[:, 0] >= 0) == outer)
            for latitude in (30, 60, 90):
                axis.add_patch(plt.Circle((0, 0), np.sin(np.radians(latitude)), fill=False, color=GREY, lw=0.6))
            axis.plot([-1, 1], [0, 0], color=GREY, lw=0.4)
            axis.plot([0, 0], [-1, 1], color=GREY, lw=0.4)
            for phase, colour, label in ((slips, BLUE, "slides"), (~slips, RED, "sticks")):
                axis.scatter(at[here & phase, 1], at[here & phase, 2], s=4, color=colour, label=label, zorder=3)
            share = np.mean(~touches)
            if outer:
                axis.set_title(f"μ = {file.stem.removeprefix('path_mu')}: free {share:.0%} of the time")
            axis.set(aspect="equal", xlim=(-1.05, 1.05), ylim=(-1.05, 1.05), xticks=(), yticks=())
            for side in axis.spines.values():
                side.set_visible(False)
    write_table(folder / "ball_phases.csv", ["mu", "t", "x", "y", "z", "phase"], table)
    for axis, label in zip(grid[:, 0], ("the end of the rod", "the side of the rod")):
        axis.set_ylabel(label)
    handles = [
        plt.Line2D([], [], ls="", marker="o", ms=4, color=c, label=n) for c, n in ((BLUE, "slides"), (RED, "sticks"))
    ]
    page.tight_layout(rect=(0, 0.06, 1, 0.93))
    page.legend(handles=handles, loc="lower left", ncol=2)
    save(page, folder / "ball", "Contact phases on the ball's surface (e = 0; circles every 30°)", about)


def with_orders(clearance, x, limit):
    """Rows (clearance, x, distance from the limit, its order, order of the changes), largest clearance first."""
    order = np.argsort(clearance)[::-1]
    clearance, x = clearance[order], x[order]
    distance, change = np.abs(x - limit), np.abs(np.diff(x))
    shrink = np.log(clearance[:-1] / clearance[1:])
    rates = [np.nan, *(np.log(distance[:-1] / distance[1:]) / shrink)]
    changes = [np.nan, np.nan, *(np.log(change[:-1] / change[1:]) / shrink[1:])]
    return list(zip(clearance, x, distance, rates, changes))


def plot_closing(folder, about):
    numbers = ["clearance", "mu", "e", "guide", "at_crank", "duration", "value"]
    sweep = read_table(folder / "sweep.csv", ["integrator"], numbers)
    inelastic = (sweep["integrator"] == "adaptive:rtol=1e-10") & (sweep["e"] == 0)
    closing = select(sweep, inelastic & ~np.isnan(sweep["clearance"]))
    limit = {
        name: json.loads((folder / f"{name}.json").read_text())["final"]["slider.x"]
        for name in ("ideal", "ideal_5s")
    }
    socket = np.isnan(closing["guide"]) & np.isnan(closing["at_crank"])
    guide = ~np.isnan(closing["guide"])
    families = [("socket at the slider", mu, "clearance", socket & (closing["mu"] == mu),
                 limit["ideal"] if mu == 0 else np.nan) for mu in sorted(set(closing["mu"][socket]))]
    families.append(
        ("channel", 0, "guide", guide & (closing["guide"] > 0), closing["value"][guide & (closing["guide"] == 0)][0]))
    families.append(("socket at the crank, 5 s", 0, "clearance", ~np.isnan(closing["at_crank"]), limit["ideal_5s"]))
    page, axis = plt.subplots(figsize=(7, 4.4))
    table = []
    for (name, mu, key, rows, end), marker in zip(families, "osD^v"):
        found = with_orders(closing[key][rows], closing["value"][rows], end)
        table += [(name, mu, *row) for row in found]
        if not np.isnan(end):
            axis.loglog([row[0] for row in found], [row[2] for row in found], marker + "-", ms=4,
                        label=f"{name}, μ = {mu:g}")
    ends = np.array([min(row[2] for row in table), max(row[2] for row in table)])
    axis.loglog(ends, ends, "--", color=GREY, lw=0.8, label="first order")
    axis.set(xlabel="clearance [m]", ylabel="distance of the slider from its limit [m]")
    axis.legend()
    page.tight_layout(rect=(0, 0.03, 1, 0.93))
    save(page, folder / "closing", "Clearances go to zero: distance from the mechanism without them", about)
    write_table(
        folder / "closing_rates.csv", ["family", "mu", "clearance", "x", "distance", "order", "change_order"],
        [(n, f"{mu:g}", f"{c:g}", f"{x:.12g}", f"{d:.3g}", f"{r:.3g}", f"{k:.3g}") for n, mu, c, x, d, r, k in table])


if __name__ == "__main__":
    main(__doc__, "results/slider_crank_space", [plot_ball, plot_closing])
