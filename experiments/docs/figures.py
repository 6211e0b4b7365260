#!/usr/bin/python3
"""Performance figures: one data file, data/figures.toml, from which README, documentation and article take theirs.

    figures.py quiet                        runs every measurement, writes all figures; an hour (busy: with other work)
    figures.py quiet time_to_error step     only the measurements that make these tables
    figures.py quiet solvers --from results/lcp_shootout    no run: reads the results of one (step: its output, a file)
    figures.py --texts                      writes the figures into the texts (figure_places.py lists the places)

A table of the file has columns, rows, and its origin: command, machine, revision, date. A measurement replaces its
tables and leaves all others as they are. tests/experiments/figures.py compares every place with the file.
"""
import argparse
import datetime
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

from figure_tables import (
    chains, cones, identify, joints, printed, regret, shootout, step_race, time_to_error, with_rivals)

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
DATA = HERE / "data/figures.toml"


# (tables, command, what reads its result, folder of the results or None: what it prints)
PROGRAMS = "build/release/experiments/"
MEASUREMENTS = [
    (("time_to_error",), "./experiments/run work_precision", time_to_error, "results/work_precision"),
    (("joints",), "paper/results", joints, "paper/data"),
    (("solvers_by_group", "solvers"), "./experiments/run shootout --largest 100 --time-limit 1 "
     "--scenes slider_crank n_four_bar tower pile", shootout, "results/lcp_shootout"),
    (("regret",), "./experiments/run shootout --largest 330 --time-limit 0.5 "
     "--scenes slider_crank n_four_bar tower pile arch", regret("regret"), "results/lcp_shootout"),
    (("regret_sparse",), PROGRAMS + "lcp_shootout --families sparse string beam ball journal american --time-limit 20 "
     "--memory 6 --solvers auto path pgs psor interior-point block-pivot newton-min mprgp --output results/sparse",
     regret("regret_sparse"), "results/sparse"),
    (("virtual_best", "right"), PROGRAMS + "lcp_shootout --largest 300 --time-limit 1 --solvers auto "
     "--rivals build/peers/lcp --output results/rivals", with_rivals, "results/rivals"),
    (("cones", "cone_profiles"), "./experiments/run cone --problems tests/data/fclib --scenes kapla_tower:layers=8 "
     "box_pyramid:base=4 card_house:levels=3 capsules:count=40 dominoes --steps 3 --time-limit 2 "
     "--rivals build/peers/cone", cones, "results/cone_shootout"),
    (("facets",), PROGRAMS + "facets", printed("facets"), None),
    (("step", "error"), PROGRAMS + "step_race --finest 1e-7", step_race, None),
    (("content",), PROGRAMS + "scene_content", printed("content"), None),
    (("pivots",), PROGRAMS + "time_per_pivot --solvers lemke:form=tableau --sizes 64 128 256 512 1000",
     printed("pivots"), None),
    (("obstacles",), PROGRAMS + "obstacle_grids --grids 512", printed("obstacles"), None),
    (("identify_fit", "identify_contact_loss", "identify_shot"), "./experiments/run identify", identify,
     "results/identify"),
    (("chains",), PROGRAMS + "parts --benchmark_filter=chain_step --benchmark_format=csv", chains, None),
]


def origin(command, folder, state):
    """Command, machine, revision and date: of a run's manifest, or of this machine now."""
    other = {"quiet": "no other work", "busy": "other work as well"}[state]
    written = [path for name in ("manifest.json", "slider_crank.about.json")
               if folder is not None and (path := folder / name).exists()]
    if written:
        about = json.loads(written[0].read_text(encoding="utf-8"))
        about.setdefault("written", datetime.date.today().isoformat())
        return {"command": command, "machine": f"{about['cores']} cores of {about['cpu']} with {other}",
                "revision": about["revision"], "date": about["written"][:10]}
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    cpu = re.search(r"^model name\s*: (.*)", text, re.M)
    revision = subprocess.run(["git", "describe", "--always", "--dirty=+changes", "--abbrev=12", "--exclude=*"],
                              cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip() or "unknown"
    return {"command": command, "revision": revision, "date": datetime.date.today().isoformat(),
            "machine": f"{len(re.findall('^processor', text, re.M))} cores of "
            f"{cpu[1] if cpu else 'unknown'} with {other}"}


def load(file=DATA):
    return tomllib.loads(file.read_text(encoding="utf-8"))


def save(tables, file=DATA):
    quoted = lambda x: json.dumps(x, ensure_ascii=False)  # noqa: E731  strings and numbers of JSON are TOML as well
    lines = ["# Performance figures, each table with its origin: written by experiments/docs/figures.py.", ""]
    for name, table in tables.items():
        lines += [f"[{name}]", *(f"{key} = {quoted(table[key])}" for key in ("command", "machine", "revision", "date")),
                  f"columns = {quoted(table['columns'])}", "rows = [", *(f"  {quoted(row)}," for row in table["rows"]),
                  "]", ""]
    file.write_text("\n".join(lines).rstrip("\n") + "\n", encoding="utf-8")


def measure(names, state, result, file):
    tables = load(file) if file.exists() else {}
    for made, command, read, results in MEASUREMENTS:
        if names and not set(names) & set(made):
            continue
        folder = result or (ROOT / results if results else file.with_suffix(f".{made[0]}.txt"))
        if result is None:
            print(f"figures: {command}", flush=True)
            done = subprocess.run(command.split(), cwd=ROOT, check=False, stdout=None if results else subprocess.PIPE)
            if done.returncode != 0:
                sys.exit(f"figures: '{command}' ended with {done.returncode}; the figures stay as they are")
            if not results:
                folder.write_bytes(done.stdout)
        about = origin(command, folder if results else None, state)
        for name, columns, rows in read(folder):
            tables[name] = {**about, "columns": columns, "rows": rows}
        if result is None and not results:
            folder.unlink()
        save(tables, file)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    known = [name for made, *_ in MEASUREMENTS for name in made]
    parser.add_argument("state", nargs="?", choices=("quiet", "busy"), help="does the machine do other work meanwhile?")
    parser.add_argument("names", nargs="*", metavar="TABLE", help=", ".join(known))
    parser.add_argument("--from", dest="result", type=Path, help="folder, or file, that one measurement has left")
    parser.add_argument("--data", type=Path, default=DATA, help="default: %(default)s")
    parser.add_argument("--texts", action="store_true", help="write the figures into the texts")
    a = parser.parse_args()
    if unknown := [name for name in a.names if name not in known]:
        parser.error(f"table '{unknown[0]}': must be one of {', '.join(known)}")
    if a.result and len({made for made, *_ in MEASUREMENTS if set(made) & set(a.names)}) != 1:
        parser.error("--from: name the tables of one measurement")
    if a.state is None and not a.texts:
        parser.error("state: must be quiet or busy; or --texts")
    if a.state:
        measure(a.names, a.state, a.result, a.data)
    if a.texts:
        import figure_places

        figure_places.write(load(a.data))


if __name__ == "__main__":
    main()
