#!/usr/bin/env python3
"""Contacts and joints beside other programs: a pile, a chain, a stack and a Kapla tower; time against what is achieved.

scenes.py has the four scenes, achieved.py what is measured, model_*.py each program's settings. A setting is swept over
its steps, in a process of its own with a limit of processor time for each of them; one that fails is a row that says
why. Seconds are processor time of the steps, per second of motion, and the median of three to nine runs where one takes
less than a second.

    pile    worse of two measures: law (what the last step's impulses miss of the laws of contact) and overlap
    chain   error of its end at .5 s against a reference, by Orthant's adaptive at rtol 1e-12
    stack, tower   the largest way of a corner: the exact motion is none

Writes contacts.csv, contacts.md, and a picture of each scene, contacts_SCENE.png and .svg. Rows of contacts.csv that
are there of other scenes and programs stay: a program can be run again by itself. summary.py has tables and pictures.

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
import summary  # noqa: E402
from scenes import QUICK_SIZES, SCENES, SIZES  # noqa: E402

PROGRAMS = ["orthant", "mujoco", "drake", "dart", "bullet", "exudyn", "siconos", "pinocchio", "newton"]
HANGS = 30  # times the limit that a step may wait for a processor: then the process is given up
STEPS = [5e-2, 2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4]
COLUMNS = ["scene", "size", "program", "setting", "step", "seconds", "a_step", "error", "law", "overlap", "joints",
           "energy", "unexplained", "contacts", "failure"]


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
    seconds, measured = [], None
    while not seconds or (len(seconds) < 3 and seconds[-1] < 1) or (len(seconds) < 9 and sum(seconds) < 0.3):
        measured = run()
        seconds.append(measured["seconds"])
    return measured | {"seconds": statistics.median(seconds)}


def one_setting(question, orthant, limit):
    """In a process of its own: a row for each step, as JSON. What takes more than the limit ends the process."""
    reference = None if question["reference"] is None else np.array(question["reference"])
    program = model(question["program"], orthant)
    if hasattr(program, "prepare"):
        program.prepare(SCENES[question["scene"]](question["size"]))
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
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment) as one:
        try:
            said, words = one.communicate(timeout=HANGS * arguments.time_limit * len(question.get("steps", "1")))
        except subprocess.TimeoutExpired:
            one.kill()
            said, words = one.communicate()
    answers = [json.loads(line[7:]) for line in said.splitlines() if line.startswith("ANSWER ")]
    if one.returncode == 0:
        return answers, None
    if one.returncode == -signal.SIGXCPU:
        return answers, f"more than {arguments.time_limit:g} s"
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


def write(file, rows):
    """In the order of scenes and programs; returns them as they are read."""
    rows = sorted(rows, key=lambda row: (list(SCENES).index(row["scene"]), PROGRAMS.index(row["program"])))
    with open(file, "w", encoding="utf-8", newline="") as stream:
        out = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        out.writeheader()
        out.writerows({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows)
    return summary.read(file)


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
    file = arguments.output / "contacts.csv"
    rows = [row for row in (summary.read(file) if file.exists() else [])
            if not (row["scene"] in arguments.scenes and row["program"] in arguments.programs)]
    for row in measure(arguments, sizes):
        rows.append(dict.fromkeys(COLUMNS, "") | row)
        write(file, rows)
    rows = write(file, rows)
    (arguments.output / "contacts.md").write_text(summary.text(rows), encoding="utf-8")
    sys.stdout.write(summary.text(rows))
    for name, own in summary.by_scene(rows).items():
        for kind in ("png", "svg"):
            summary.draw(own, arguments.output / f"contacts_{name}.{kind}")


if __name__ == "__main__":
    main()
