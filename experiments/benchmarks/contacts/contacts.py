#!/usr/bin/env python3
"""Contacts and joints beside other programs: a pile, a chain, a stack and a Kapla tower; time against what is achieved.

scenes.py has the four scenes, achieved.py what is measured, model_*.py each program's settings. A setting is swept over
its steps, in a process of its own with a limit of processor time for each of them; one that fails is a row that says
why. Seconds are processor time of the steps, per second of motion, and the median of three to nine runs where one takes
less than a second.

    pile    worse of two measures: law (what the last step's impulses miss of the laws of contact) and overlap
    chain   error of its end at .5 s against a reference, by Orthant's adaptive at rtol 1e-12
    stack, tower   the largest way of a corner: the exact motion is none

Writes contacts.csv, contacts.md and contacts.png, contacts.svg.

    build/peers/python/bin/python experiments/benchmarks/contacts/contacts.py --orthant build/release \\
      --output results/peers
"""
import argparse
import csv
import importlib
import json
import math
import os
import resource
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import achieved  # noqa: E402
from scenes import QUICK_SIZES, SCENES, SIZES  # noqa: E402

PROGRAMS = ["orthant", "mujoco", "drake", "dart", "bullet", "exudyn", "siconos", "pinocchio", "newton"]
HANGS = 30  # limits of wall time, in which a process that does not compute is given up
STEPS = [5e-2, 2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4]
COLUMNS = ["scene", "size", "program", "setting", "step", "seconds", "a_step", "error", "law", "overlap", "joints",
           "energy", "unexplained", "contacts", "failure"]
GOALS = {"pile": (1e-1, 1e-2, 1e-3, 1e-4), "chain": (1e-2, 1e-3, 1e-4, 1e-6), "stack": (1e-1, 1e-2, 1e-3, 1e-6),
         "tower": (1e-1, 1e-2, 1e-3, 1e-6)}
MEASURE = {"pile": "law or overlap", "chain": "error of the end / length", "stack": "way of a corner / edge",
           "tower": "way of a corner / least edge"}


def model(program, orthant):
    module = importlib.import_module(f"model_{program}")
    return module.Model(orthant) if program == "orthant" else module.Model()


def judge(name, scene, run, reference):
    """The measures of a run: the error that counts is the worst of the scene's own ones."""
    h, after = run["h"], run["after"]
    for part in (after.place, after.velocity):
        if not np.all(np.isfinite(part)):
            raise RuntimeError("the motion is not finite")
    row = {"seconds": run["seconds"] / scene.duration, "a_step": run["seconds"] / max(run["steps"], 1)}
    if scene.planes and run.get("contacts") is not None:
        row["contacts"] = len(run["contacts"])
        row["law"], row["unexplained"] = achieved.law(scene, run["before"], after, run["contacts"], h)
    if name == "pile":
        row["overlap"] = achieved.overlap(scene, after)
        row["error"] = max(row["overlap"], row.get("law") or 0.0)
    elif name == "chain":
        row["joints"], row["energy"] = achieved.joint_gaps(scene, after), achieved.energy_change(scene, after)
        row["error"] = float(np.linalg.norm(achieved.tip(after) - reference)) / scene.size
    else:
        row["error"] = achieved.moved(scene, after)
    return row


def several(run):
    """Runs again while it is cheap; the last one, with the median of the seconds."""
    seconds, told = [], None
    while not seconds or (len(seconds) < 3 and seconds[-1] < 1) or (len(seconds) < 9 and sum(seconds) < 0.3):
        told = run()
        seconds.append(told["seconds"])
    return told | {"seconds": statistics.median(seconds)}


def one_setting(question, orthant, limit):
    """In a process of its own: a row for each step, as JSON. What takes more than the limit ends the process."""
    reference = None if question["reference"] is None else np.array(question["reference"])
    for step in question["steps"]:
        resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(time.process_time() + limit), resource.RLIM_INFINITY))
        scene = SCENES[question["scene"]](question["size"])
        try:
            run = several(lambda: model(question["program"], orthant).run(scene, question["setting"], step))
            row = judge(question["scene"], scene, run, reference)
        except ImportError:
            raise
        except Exception as error:  # a rival that fails is a row of the table
            row = {"failure": last_words(error)}
            if row["failure"] == f"exit code {-signal.SIGXCPU}":  # a program of its own, which has the same limit
                os.kill(os.getpid(), signal.SIGXCPU)
        print("ANSWER " + json.dumps(row), flush=True)


def last_words(error):
    return (str(error).strip().splitlines() or [type(error).__name__])[0]


def started(arguments, question):
    """(answers of a process of its own to `question` (JSON), why it ended before the last one or None)."""
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "PYTHONWARNINGS": "ignore"}
    command = [sys.executable, __file__, "--orthant", arguments.orthant, "--time-limit", str(arguments.time_limit),
               "--case", json.dumps(question)]
    late = f"more than {arguments.time_limit:g} s"
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment) as one:
        try:
            said, words = one.communicate(timeout=HANGS * arguments.time_limit)
        except subprocess.TimeoutExpired:
            one.kill()
            said, words = one.communicate()
    answers = [json.loads(line[7:]) for line in said.splitlines() if line.startswith("ANSWER ")]
    if one.returncode == 0:
        return answers, None
    if one.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return answers, late
    return answers, (words.strip().splitlines() or [f"exit code {one.returncode}"])[-1][:160]


def measure_setting(arguments, base, setting, reference):
    """Rows of a setting, from coarse steps to fine ones."""
    steps = STEPS[:arguments.values]
    while steps:
        answers, fault = started(arguments, base | {"setting": setting, "steps": steps, "reference": reference})
        if len(answers) < len(steps):
            answers.append({"failure": fault or "no answer"})
        for step, answer in zip(steps, answers):
            yield base | {"setting": setting, "step": step} | {k: v for k, v in answer.items() if v is not None}
        steps = steps[len(answers):]
        if fault and fault.startswith("more than"):  # with finer steps it would be later
            yield from (base | {"setting": setting, "step": step, "failure": fault} for step in steps)
            return


def measure(arguments, sizes):
    for name in arguments.scenes:
        reference = None
        if name == "chain":
            (reference,), fault = started(arguments, {"chain of": sizes["chain"]})
        for program in arguments.programs:
            base = {"scene": name, "size": sizes[name], "program": program}
            settings, fault = started(arguments, {"settings": program, "scene": name})
            if fault:
                yield base | {"setting": "", "step": "", "failure": fault}
            for setting in settings[0] if settings else []:
                yield from measure_setting(arguments, base, setting, reference)


def cheapest(runs, goal):
    """The least time of the steps that reach the goal and whose finer ones do, too."""
    reached = []
    for row in sorted(runs, key=lambda row: row["step"]):
        if row["error"] == "" or row["error"] > goal:
            if row["failure"].startswith("more than"):
                continue  # too fine a step to end is no evidence against a coarser one
            break
        reached.append(row)
    return min(reached, key=lambda row: row["seconds"], default=None)


def cell(row, own):
    if row is None:
        return "–"
    times = f", × {row['seconds'] / own['seconds']:.2g}" if own is not None and row["program"] != "orthant" else ""
    return f"{1e3 * row['seconds']:.3g} ({1e6 * row['a_step']:.3g} µs{times})"


def table(rows):
    lines = []
    for name in dict.fromkeys(row["scene"] for row in rows):
        own, goals = [row for row in rows if row["scene"] == name], GOALS[name]
        best = {goal: min((c for s in {row["setting"] for row in own if row["program"] == "orthant"}
                           if (c := cheapest([row for row in own if (row["program"], row["setting"]) == ("orthant", s)],
                                             goal))), key=lambda row: row["seconds"], default=None) for goal in goals}
        extra = {"pile": ["law", "overlap"], "chain": ["joints", "energy"]}.get(name, ["law"])
        lines += [f"\n`{name}` of {own[0]['size']}: milliseconds a second of motion (of a step; times Orthant's best) "
                  f"to an error ({MEASURE[name]})\n",
                  "| program | setting | least error | " + " | ".join(f"to {g:g}" for g in goals) + " | least " +
                  " | least ".join(extra) + " | failed |", "|---" * (len(goals) + len(extra) + 4) + "|"]
        for key in dict.fromkeys((row["program"], row["setting"]) for row in own):
            runs = [row for row in own if (row["program"], row["setting"]) == key]
            good = [row for row in runs if row["error"] != ""]
            least = [f"{min(values):.1e}" if (values := [row[c] for row in good if row[c] != ""]) else "–"
                     for c in ("error", *extra)]
            failed = sorted({row["failure"] for row in runs if row["failure"]})
            lines.append("| " + " | ".join([*key, least[0], *(cell(cheapest(runs, goal), best[goal]) for goal in goals),
                                           *least[1:], f"{len(runs) - len(good)}" +
                                           (": " + "; ".join(failed) if failed else "")]) + " |")
    return "\n".join(lines).strip() + "\n"


STYLES = {"orthant": "o-", "mujoco": "s--", "drake": "^:", "dart": "P--", "bullet": "X:", "exudyn": "v-.",
          "siconos": "d--", "pinocchio": "p-.", "newton": "*:"}


def draw(rows, folder):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    names = list(dict.fromkeys(row["scene"] for row in rows))
    page, grid = plt.subplots(1, len(names), figsize=(5 * len(names), 7), squeeze=False)
    for axis, name in zip(grid[0], names):
        own = [row for row in rows if row["scene"] == name and row["error"] != ""]
        for key in dict.fromkeys((row["program"], row["setting"]) for row in own):
            points = sorted((row["seconds"], max(row["error"], 1e-12)) for row in own
                            if (row["program"], row["setting"]) == key)
            axis.loglog(*np.array(points).T, STYLES[key[0]], ms=4, label=", ".join(key))
        axis.set(title=f"{name} of {own[0]['size']}" if own else name, ylabel=MEASURE[name],
                 xlabel="processor time a second of motion [s]")
        if axis.lines:
            axis.legend(fontsize=6, ncol=2, loc="upper center", bbox_to_anchor=(0.5, -0.1))
    page.tight_layout()
    page.savefig(folder / "contacts.png", dpi=150)
    page.savefig(folder / "contacts.svg", metadata={"Date": None})


def answer(arguments):
    """A process of its own: settings of a program, the reference of a chain, or the steps of a setting."""
    question = json.loads(arguments.case)
    try:
        if "settings" in question:
            said = list(model(question["settings"], arguments.orthant).settings(question["scene"]))
        elif "chain of" in question:
            run = model("orthant", arguments.orthant).run(SCENES["chain"](question["chain of"]), "adaptive", 1e-4)
            said = achieved.tip(run["after"]).tolist()
        else:
            return one_setting(question, arguments.orthant, arguments.time_limit)
    except ImportError as error:
        sys.exit(f"not installed: {error}")
    except Exception as error:
        sys.exit(last_words(error))
    print("ANSWER " + json.dumps(said))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--orthant", default="build/release", help="folder of Orthant's programs")
    parser.add_argument("--output", type=Path, default=Path("results/peers"))
    parser.add_argument("--values", type=int, help="so many of the coarsest steps; all if not given")
    parser.add_argument("--quick", action="store_true", help="small scenes")
    parser.add_argument("--programs", nargs="+", default=PROGRAMS[:-1], choices=PROGRAMS,
                        help="all but newton if not given: it compiles for minutes")
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), choices=SCENES)
    parser.add_argument("--time-limit", type=float, default=60, help="of a case [s of processor time]")
    for name in SCENES:
        parser.add_argument(f"--{name}", type=int, help=f"its size; {SIZES[name]}, with --quick {QUICK_SIZES[name]}")
    parser.add_argument("--case", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.case:
        return answer(arguments)
    sizes = QUICK_SIZES if arguments.quick else SIZES
    sizes = {name: getattr(arguments, name) or sizes[name] for name in SCENES}
    arguments.output.mkdir(parents=True, exist_ok=True)
    rows = []
    with open(arguments.output / "contacts.csv", "w", newline="") as file:
        out = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        out.writeheader()
        for row in measure(arguments, sizes):
            rows.append(row := dict.fromkeys(COLUMNS, "") | row)
            out.writerow(row), file.flush()
    (arguments.output / "contacts.md").write_text(table(rows))
    sys.stdout.write(table(rows))
    draw(rows, arguments.output)


if __name__ == "__main__":
    main()
