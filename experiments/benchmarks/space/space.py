#!/usr/bin/env python3
"""Work and precision in space: three motions with known ends, by Orthant and other programs, their settings swept.

masse         a ball slides on a rough table along a parabola, then rolls: the place after 1 s (Coriolis)
slider_crank  the rigid spatial slider-crank of the IFToMM library: the slider after 5 s, published to 11 digits
bounces       a ball falls on a rough floor, e = .5: one impact slips, one ends the slip; the place after three impacts

Writes space.csv, space.md and space.png, space.svg. Times are processor times of the run alone, the best of REPEATS.
The models differ, as model_*.py say: contacts of MuJoCo, Drake and EXUDYN are soft, most of them regularize friction or
make it convex, MuJoCo's closed loop is soft, too; Siconos' contacts are rigid. With a stiffness that does not grow as
the step shrinks errors level off. A setting that fails is a row that says why; so is a program that is not there.

    build/peers/python/bin/python experiments/benchmarks/space/space.py --orthant build/release --output results/peers
"""
import argparse
import csv
import importlib
import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from motions import bounces_end, ends, masse_end, strike  # noqa: E402, F401

PROGRAMS = {"orthant": "Orthant", "mujoco": "Mujoco", "drake": "Drake", "exudyn": "Exudyn", "siconos": "Siconos"}
SCENES = ["masse", "slider_crank", "bounces"]
# steps that divide the durations: otherwise the end is another one
SWEEPS = {"step": [1e-2, 2.5e-3, 1e-3, 2.5e-4, 1e-4, 2.5e-5], "rtol": [1e-3, 1e-5, 1e-7, 1e-9, 1e-11],
          "accuracy": [1e-2, 1e-3, 1e-4, 1e-5, 1e-6]}
COLUMNS = ["scene", "program", "setting", "swept", "at", "seconds", "error", "failure"]


class Absent:
    """A program that is not installed: one failed run of each motion."""
    settings = {scene: {"": "step"} for scene in SCENES}

    def __init__(self, why):
        self.why = why

    def __getattr__(self, scene):
        def fail(setting, at):
            raise RuntimeError(self.why)
        return fail


def program(name, orthant):
    try:
        made = getattr(importlib.import_module(f"model_{name}"), PROGRAMS[name])
        return made(orthant) if name == "orthant" else made()
    except ImportError as error:
        return Absent(f"not installed: {error}")


def measure(programs, values, only):
    for scene, end in ends().items():
        if only and scene not in only:
            continue
        for name, program in programs.items():
            for setting, swept in program.settings[scene].items():
                for at in SWEEPS[swept][:values]:
                    row = dict.fromkeys(
                        COLUMNS, "") | {"scene": scene, "program": name, "setting": setting, "swept": swept, "at": at}
                    try:
                        got, seconds = getattr(program, scene)(setting, at)
                        row |= {"seconds": seconds, "error": float(np.linalg.norm(got - end))}
                        if not math.isfinite(row["error"]):
                            row |= {"error": "", "failure": "the end is not finite"}
                    except Exception as error:  # a rival that fails is a row of the table
                        row["failure"] = (str(error).splitlines() or [type(error).__name__])[0][:160]
                    yield row


def table(rows):
    """Least time to an error, of the values from which on all finer ones reach it; failures in words."""
    goals = (1e-2, 1e-3, 1e-4, 1e-6, 1e-9)
    lines = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        lines += [f"\n`{scene}`: milliseconds to an error of the end [m]\n", "| program | setting | least error | " +
                  " | ".join(f"to {g:g}" for g in goals) + " | failed |", "|---" * (len(goals) + 4) + "|"]
        own = [row for row in rows if row["scene"] == scene]
        for key in dict.fromkeys((row["program"], row["setting"]) for row in own):
            runs = [row for row in own if (row["program"], row["setting"]) == key]
            good = [row for row in runs if row["error"] != ""]
            cells = []
            for goal in goals:
                reached = []
                for row in sorted(runs, key=lambda row: row["at"]):  # the finest first
                    if row["error"] == "" or row["error"] > goal:
                        break
                    reached.append(row["seconds"])
                cells.append(f"{1e3 * min(reached):.3g}" if reached else "–")
            failed = sorted({row["failure"] for row in runs if row["failure"]})
            least = f"{min(row['error'] for row in good):.1e}" if good else "–"
            lines.append("| " + " | ".join([*key, least, *cells, f"{len(runs) - len(good)}" +
                                           (": " + "; ".join(failed) if failed else "")]) + " |")
    return "\n".join(lines).strip() + "\n"


STYLES = {"orthant": "o-", "mujoco": "s--", "drake": "^:", "exudyn": "v-.", "siconos": "d--"}


def draw(rows, folder):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    page, grid = plt.subplots(1, len(scenes), figsize=(5 * len(scenes), 6), squeeze=False)
    for axis, scene in zip(grid[0], scenes):
        own = [row for row in rows if row["scene"] == scene and row["error"] != ""]
        for key in dict.fromkeys((row["program"], row["setting"]) for row in own):
            points = sorted(
                (row["seconds"], max(row["error"], 1e-16)) for row in own if (row["program"], row["setting"]) == key)
            axis.loglog(*np.array(points).T, STYLES[key[0]], ms=4,
                        label=", ".join(key))
        axis.set(title=scene, xlabel="processor time [s]", ylabel="error of the end [m]")
        if axis.lines:
            axis.legend(fontsize=6, ncol=2, loc="upper center", bbox_to_anchor=(0.5, -0.13))
    page.tight_layout()
    page.savefig(folder / "space.png", dpi=150)
    page.savefig(folder / "space.svg", metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--orthant", default="build/release", help="folder of Orthant's programs")
    parser.add_argument("--output", type=Path, default=Path("results/peers"))
    parser.add_argument("--values", type=int, help="so many of the coarsest values of each setting; all if not given")
    parser.add_argument("--quick", action="store_const", const=4, dest="values", help="the same as --values 4")
    parser.add_argument("--programs", nargs="+", default=list(PROGRAMS), choices=PROGRAMS)
    parser.add_argument("--scenes", nargs="+", choices=SCENES)
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    rows = []
    with open(arguments.output / "space.csv", "w", newline="") as file:
        out = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        out.writeheader()
        programs = {name: program(name, arguments.orthant) for name in arguments.programs}
        for row in measure(programs, arguments.values, arguments.scenes):
            rows.append(row)
            out.writerow(row), file.flush()
    (arguments.output / "space.md").write_text(table(rows))
    sys.stdout.write(table(rows))
    draw(rows, arguments.output)


if __name__ == "__main__":
    main()
