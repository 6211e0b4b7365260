#!/usr/bin/python3
"""The decision tables of the documentation, from what an experiment measured, and a line that says where and when.

    tables.py solvers results/lcp_shootout quiet           # or busy: did the machine do other work meanwhile?
    tables.py integrators results/work_precision quiet

writes data/solvers.csv and data/solvers.txt (integrators likewise) beside this file; a fourth argument is another folder.
"""
import csv
import json
import statistics
import sys
from pathlib import Path

GROUPS = {"definite": "symmetric positive definite", "semidefinite": "positive semidefinite",
          "P-matrix": "P, not symmetric", "grid": "obstacles on grids, sparse", "friction": "contacts with friction",
          "infeasible": "without solution (proof asked for)", "other": "games, options, known hard ones"}
NOT_COUNTED = {"enumerate"}  # an oracle for small ones
BEST = 3


def solvers(folder):
    """Of each group the solvers that certified most of its problems, by time among equals."""
    with open(folder / "shootout.csv", encoding="utf-8") as stream:
        rows = [row for row in csv.DictReader(stream) if row["solver"] not in NOT_COUNTED]
    fastest = {}  # of each problem
    for row in rows:
        if row["result"] == "certified":
            fastest[row["problem"]] = min(fastest.get(row["problem"], 1e300), float(row["seconds"]))
    yield ["problems", "number", *(cell for i in range(BEST) for cell in (f"{i + 1}.", "right", "time"))]
    for group, words in GROUPS.items():
        part = [row for row in rows if row["group"] == group]
        count = len({row["problem"] for row in part})
        if not count:
            continue
        ranking = []
        for solver in {row["solver"] for row in part}:
            times = [float(row["seconds"]) / fastest[row["problem"]] for row in part
                     if row["solver"] == solver and row["result"] == "certified"]
            if times:
                ranking.append((-len(times), statistics.median(times), solver))
        cells = []
        for right, time, solver in sorted(ranking)[:BEST]:
            cells += [f"`{solver}`", str(-right), f"{time:.2g}"]
        yield [words, str(count), *cells, *[""] * (3 * BEST - len(cells))]


def two_digits(value):
    """140 and not 1.4e+02."""
    text = f"{value:.2g}"
    return f"{float(text):.0f}" if "e+" in text else text


def integrators(folder):
    """Milliseconds that an error takes."""
    with open(folder / "time_to_error.csv", encoding="utf-8") as stream:
        table = list(csv.reader(stream))
    yield ["integrator", *(f"to {target.removeprefix('to_')}" for target in table[0][1:])]
    for name, *seconds in table[1:]:
        cells = [two_digits(1e3 * float(cell)) if cell and float(cell) < 1e300 else "–" for cell in seconds]
        if set(cells) != {"–"}:
            yield [f"`{name}`", *cells]


def origin(folder, state):
    """What the run's manifest says of it."""
    about = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    other = {"quiet": "no other work", "busy": "other work as well"}[state]
    return (f"Measured at revision `{about['revision']}`, {about['written'][:10]}, on {about['cores']} cores of "
            f"{about['cpu']} with {other}.\n")


def main():
    if len(sys.argv) not in (4, 5) or sys.argv[1] not in ("solvers", "integrators") or sys.argv[3] not in ("quiet", "busy"):
        sys.exit(__doc__)
    table, folder = sys.argv[1], Path(sys.argv[2])
    to = Path(sys.argv[4]) if len(sys.argv) == 5 else Path(__file__).parent / "data"
    rows = list((solvers if table == "solvers" else integrators)(folder))
    (to / f"{table}.txt").write_text(origin(folder, sys.argv[3]), encoding="utf-8")
    with open(to / f"{table}.csv", "w", encoding="utf-8", newline="") as stream:
        csv.writer(stream, lineterminator="\n").writerows(rows)


if __name__ == "__main__":
    main()
