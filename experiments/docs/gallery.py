#!/usr/bin/python3
"""Gallery of the built-in scenes: a picture each (outlines or surfaces of the bodies at a few times), and the page.

    gallery.py --orthant build/release/orthant --output DIR     writes DIR/gallery.md and DIR/gallery/NAME.png
build.py calls it, so that the pictures of the site are those of the present code.
"""
import argparse
import csv
import json
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

COMMON = ["--duration", "0.5", "--step", "1e-3", "--every", "100"]
OTHERWISE = {  # by scene
    "slider_crank": ["--duration", "0.05", "--step", "1e-5", "--every", "1000"],
    "slider_crank_ideal": ["--duration", "0.05", "--step", "1e-5", "--every", "1000"],
    "pile": [*COMMON, "--solver", "auto"],
    "pendulum": ["--duration", "1", "--step", "1e-3", "--every", "200"],
    "slider_crank_space": ["--duration", "0.01", "--step", "1e-5", "--every", "333"],
    "bricard": ["--duration", "1.2", "--step", "1e-2", "--every", "40"],
    "bennett": ["--duration", "1.2", "--step", "1e-2", "--every", "40"],
    "flyball": ["--duration", "0.3", "--step", "1e-3", "--every", "100"],
    "spatial_slider_crank": ["--duration", "0.6", "--step", "1e-3", "--every", "200"],
    "masse": ["--duration", "0.9", "--step", "1e-3", "--every", "180"],
    "robot_arm": ["--duration", "1.5", "--step", "1e-3", "--every", "500"],
    "top": ["--duration", "0.1", "--step", "1e-3", "--every", "100"],
}
LIGHT = np.array([0.35, -0.55, 0.76])
BODIES = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#B8860B", "#56A0D3", "#6B4FA0", "#8A4B2A"]
VTK_LINE, VTK_POLY_LINE = 3, 4


def numbers(element, name, kind):
    return [kind(x) for x in element.find(f".//DataArray[@Name='{name}']").text.split()]


def outlines(file, dimension=2):
    """(body, closed, points) of each cell; walls and the ground are body -1."""
    piece = ElementTree.parse(file).getroot()
    flat = numbers(piece, "position", float)
    points = list(zip(*(flat[i::3] for i in range(dimension))))
    corners, begin = numbers(piece, "connectivity", int), 0
    for end, shape, body in zip(*(numbers(piece, name, int) for name in ("offsets", "types", "body"))):
        yield body, shape not in (VTK_LINE, VTK_POLY_LINE), [points[i] for i in corners[begin:end]]
        begin = end


def centres(file):
    """The path of each body's centre of mass; a point mass has no outline."""
    with open(file, encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    for name in (key[:-2] for key in rows[0] if key.endswith(".x") and key[:-2] + ".theta" in rows[0]):
        yield [(float(row[name + ".x"]), float(row[name + ".y"])) for row in rows]


def draw(frames, paths, picture):
    """Later times are darker. The view is that of the moving bodies: walls may be long."""
    figure, axis = plt.subplots(figsize=(4.2, 3.2))
    seen = []
    for number, file in enumerate(frames):
        shade = (number + 1) / len(frames)
        for body, closed, points in outlines(file):
            x, y = zip(*(points + points[:1] if closed else points))
            if body >= 0:
                seen += points
                axis.plot(x, y, color="#0072B2", alpha=shade, linewidth=1)
            elif number == 0:
                axis.plot(x, y, color="#666666", linewidth=1.5)
    times = list(zip(*paths))
    for number, points in enumerate(times):
        seen += points
        axis.plot(*zip(*points), "o", color="#D55E00", alpha=(number + 1) / len(times), markersize=2.5)
    (left, right), (low, high) = ((min(v), max(v)) for v in zip(*seen))
    margin = 0.08 * max(right - left, high - low, 0.1)
    wide, tall = right - left + 2 * margin, high - low + 2 * margin
    more = max(0, tall / 2 - wide) / 2, max(0, wide / 3 - tall) / 2  # room for the numbers of a narrow axis
    axis.set_xlim(left - margin - more[0], right + margin + more[0])
    axis.set_ylim(low - margin - more[1], high + margin + more[1])
    axis.set_aspect("equal")
    axis.set_xlabel("x [m]")
    axis.set_ylabel("y [m]")
    figure.savefig(picture, dpi=90, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)


def draw_in_space(frames, picture):
    """Shaded surfaces; later times are more opaque. The view is that of the bodies: planes are cut to it."""
    figure = plt.figure(figsize=(4.8, 3.6))
    axes = figure.add_subplot(projection="3d")
    moments = [list(outlines(file, 3)) for file in frames]
    seen = np.array([point for cells in moments for body, _, points in cells if body >= 0 for point in points])
    low, high = seen.min(axis=0), seen.max(axis=0)
    widest = max(high - low)
    wide = np.maximum(high - low, 0.3 * widest) + 0.08 * widest
    middle = (low + high) / 2
    low, high = middle - wide / 2, middle + wide / 2
    faces, colours = [], []
    for number, cells in enumerate(moments):
        shade = ((number + 1) / len(moments)) ** 2
        for body, _, points in cells:
            corners = np.array(points)
            if body < 0:
                if number == 0:
                    faces.append(np.clip(corners, low, high))
                    colours.append((0.4, 0.44, 0.48, 0.15))
                continue
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            length = np.linalg.norm(normal)
            lit = 0.45 + 0.55 * max(0, normal @ LIGHT / length) if length > 0 else 1
            faces.append(corners)
            colours.append(
                (*(lit * np.array(matplotlib.colors.to_rgb(BODIES[body % len(BODIES)]))), 0.12 + 0.83 * shade))
    axes.add_collection3d(Poly3DCollection(faces, facecolors=colours, linewidths=0))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]), xlabel="x [m]", ylabel="y [m]",
             zlabel="z [m]")
    for axis, length in zip((axes.xaxis, axes.yaxis, axes.zaxis), wide):
        axis.set_major_locator(matplotlib.ticker.MaxNLocator(3 if length < 0.5 * widest else 5))
    axes.set_box_aspect(wide)
    axes.view_init(elev=22, azim=-55)
    figure.savefig(picture, dpi=90, bbox_inches="tight", pad_inches=0.35, metadata={"Software": None})
    plt.close(figure)


def write(orthant, output):
    listed = subprocess.run([orthant, "list", "scenes", "--json"], check=True, capture_output=True, text=True).stdout
    (output / "gallery").mkdir(parents=True, exist_ok=True)
    page = [
        "# Gallery of built-in scenes", "",
        "Outlines of the bodies and their centres of mass (dots) at a few times; later times are darker. Bodies of",
        "scenes in space are shaded surfaces. Below each picture stands the command of its run.",
        "`orthant list scenes` has all parameters.", ""
    ]
    with tempfile.TemporaryDirectory() as folder:
        known = json.loads(listed)
        for scene in known["scenes"] + known["spatial_scenes"]:
            name = scene["name"]
            options = OTHERWISE.get(name, COMMON)
            for kind in ("pvd", "csv"):
                command = [orthant, "simulate", name, *options, "--output", f"{folder}/{name}.{kind}"]
                done = subprocess.run(command, check=False, capture_output=True, text=True)
                if done.returncode != 0:
                    sys.exit(f"gallery: {name}: {done.stderr}")
            frames = sorted(Path(folder, name).glob("*.vtu"), key=lambda file: int(file.stem.rpartition("_")[2]))
            picture = output / "gallery" / f"{name}.png"
            if scene in known["spatial_scenes"]:
                draw_in_space(frames, picture)
            else:
                draw(frames, centres(f"{folder}/{name}.csv"), picture)
            page += [f"## {name}", "", f"{scene['summary'][0].upper()}{scene['summary'][1:]}.", "",
                     f"![{scene['summary']}](gallery/{name}.png)", "", "```text",
                     f"orthant simulate {name} {' '.join(options)} --output {name}.pvd", "```", ""]
    (output / "gallery.md").write_text("\n".join(page), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--orthant", type=Path, default=Path("build/release/orthant"),
                        help="the program; default: %(default)s")
    parser.add_argument("--output", type=Path, required=True)
    a = parser.parse_args()
    write(a.orthant.resolve(), a.output)


if __name__ == "__main__":
    main()
