#!/usr/bin/python3
"""Gallery of the built-in scenes: a picture each (outlines and centres of the bodies at a few times), and the page.

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

COMMON = ["--duration", "0.5", "--step", "1e-3", "--every", "100"]
OTHERWISE = {  # by scene
    "slider_crank": ["--duration", "0.05", "--step", "1e-5", "--every", "1000"],
    "slider_crank_ideal": ["--duration", "0.05", "--step", "1e-5", "--every", "1000"],
    "pile": [*COMMON, "--solver", "auto"],
    "pendulum": ["--duration", "1", "--step", "1e-3", "--every", "200"],
}
VTK_LINE, VTK_POLY_LINE = 3, 4


def numbers(element, name, kind):
    return [kind(x) for x in element.find(f".//DataArray[@Name='{name}']").text.split()]


def outlines(file):
    """(body, closed, points) of each cell; walls and the ground are body -1."""
    piece = ElementTree.parse(file).getroot()
    flat = numbers(piece, "position", float)
    points = list(zip(flat[0::3], flat[1::3]))
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


def write(orthant, output):
    listed = subprocess.run([orthant, "list", "scenes", "--json"], check=True, capture_output=True, text=True).stdout
    (output / "gallery").mkdir(parents=True, exist_ok=True)
    page = ["# Gallery of built-in scenes", "",
            "Outlines of the bodies and their centres of mass (dots) at a few times; later times are darker.",
            "Below each picture stands the command of its run. `orthant list scenes` has all parameters.", ""]
    with tempfile.TemporaryDirectory() as folder:
        for scene in json.loads(listed)["scenes"]:
            name = scene["name"]
            options = OTHERWISE.get(name, COMMON)
            for kind in ("pvd", "csv"):
                command = [orthant, "simulate", name, *options, "--output", f"{folder}/{name}.{kind}"]
                done = subprocess.run(command, check=False, capture_output=True, text=True)
                if done.returncode != 0:
                    sys.exit(f"gallery: {name}: {done.stderr}")
            frames = sorted(Path(folder, name).glob("*.vtu"), key=lambda file: int(file.stem.rpartition("_")[2]))
            draw(frames, centres(f"{folder}/{name}.csv"), output / "gallery" / f"{name}.png")
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
