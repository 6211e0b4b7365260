"""From the results of the studies what the article takes: reduce.py RESULTS DATA.

Columns that are used, numbers to five digits (nine where differences count); of each study a fingerprint of its sweep,
which build answered, on what machine.
"""
import csv
import hashlib
import json
import re
import sys
from collections import Counter
from pathlib import Path

STUDIES = Path(__file__).resolve().parents[2] / "experiments/studies"
COLUMNS = {
    "slider_crank": "integrator solver mu e step rtol repeats status error lcp_solves seconds slowest "
    "max_lcp_residual max_joint_residual",
    "friction": "integrator solver mu omega3 step repeats status value energy_initial energy_final "
    "max_energy_rise touching impulse seconds",
    "clearance": "integrator omega3 e clearance step repeats status value error energy_initial energy_final impulse "
    "first_touch first_release last_release",
    "conservation": "scene duration integrator collision.all.mu collision.all.e_n step rtol status why energy_initial "
    "energy_drift max_energy_rise momentum_drift spin_drift max_joint_residual max_penetration",
}
# Differences of these are looked at.
EXACT = ("value", "energy_initial", "energy_final", "impulse", "first_touch", "first_release", "last_release")
MACHINE = ("revision", "compiler", "flags", "cpu", "cores", "packages")


def rounded(text, digits=5):
    try:
        return f"{float(text):.{digits}g}"
    except ValueError:
        return text


def fingerprint(study):
    """Of what the study's file asks for; what its report shows does not matter."""
    text = (STUDIES / f"{study}.sweep.toml").read_text()
    asked = re.split(r"^\[\[(?:animation|figure)\]\]", text, flags=re.M)[0]
    return hashlib.sha256(asked.encode()).hexdigest()[:16]


def about(folder, **more):
    manifest = json.loads((folder / "manifest.json").read_text())
    return {key: manifest[key] for key in MACHINE if key in manifest} | more


def reduce_sweep(results, data, study):
    folder = results / study
    with open(folder / "sweep.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    columns = COLUMNS[study].split()
    with open(data / f"{study}.csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(columns)
        for row in rows:
            if "repeats" in row and row["repeats"] == "0":
                row["seconds"] = row["slowest"] = ""  # of runs in parallel: means nothing
            out.writerow([rounded(row.get(column, ""), 9 if column in EXACT else 5) for column in columns])
    orders = [{key: value for key, value in one.items() if key not in ("sweep", "worst")} |
              {"worst": [[float(rounded(x)) for x in pair] for pair in one["worst"]]}
              for one in json.loads((folder / "orders.json").read_text() or "[]")]
    if orders:
        (data / f"{study}.orders.json").write_text("[\n" + ",\n".join(json.dumps(one) for one in orders) + "\n]\n")
    if (folder / "modes.csv").exists():
        (data / f"{study}.modes.csv").write_text((folder / "modes.csv").read_text())
    made = about(folder, command=f"experiments/run {study}", asked=fingerprint(study))
    (data / f"{study}.about.json").write_text(json.dumps(made, indent=1) + "\n")


def reduce_shootout(folder, data):
    """Per solver and family: how often each result; per solver the median of time over the fastest."""
    (data / "shootout.summary.csv").write_text((folder / "summary.csv").read_text())
    with open(folder / "shootout.csv", newline="") as file:
        tally = Counter((row["solver"], row["family"], row["result"]) for row in csv.DictReader(file))
    with open(data / "shootout.families.csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["solver", "family", "result", "problems"])
        out.writerows([*key, number] for key, number in sorted(tally.items()))
    manifest = json.loads((folder / "manifest.json").read_text())
    made = about(folder, command="experiments/run shootout " + manifest["command"].split("lcp_shootout", 2)[-1].strip(),
                 options=manifest["options"])
    (data / "shootout.about.json").write_text(json.dumps(made, indent=1) + "\n")


def reduce_space(results, data):
    """The limits of the second study, and the comparison in space."""
    study = results / "slider_crank_space"
    if (study / "closing_rates.csv").exists():
        (data / "slider_crank_space.closing.csv").write_text((study / "closing_rates.csv").read_text())
        made = about(study, command="experiments/run slider_crank_space", asked=fingerprint("slider_crank_space"))
        (data / "slider_crank_space.about.json").write_text(json.dumps(made, indent=1) + "\n")
    peers = results / "peers/space.csv"
    if peers.exists():
        with open(peers, newline="") as file, open(data / "space_peers.csv", "w", newline="") as to:
            table = csv.DictReader(file)
            out = csv.DictWriter(to, table.fieldnames, lineterminator="\n")
            out.writeheader()
            out.writerows(row | {key: rounded(row[key]) for key in ("seconds", "error")} for row in table)
        made = {"command": "build/peers/python/bin/python experiments/benchmarks/space/space.py --output results/peers"}
        (data / "space_peers.about.json").write_text(json.dumps(made, indent=1) + "\n")


def reduce_pyramids(results, data):
    """How far pyramids bend the path of a block on a slope: the table of `exact_cases --dimension 3`."""
    found = results / "exact_cases/pyramids.md"
    if not found.exists():
        return
    table = [[cell.strip() for cell in line.strip("| \n").split("|")] for line in found.read_text().splitlines()
             if re.match(r"\| (disc|\d+ facets) ", line)]
    with open(data / "pyramids.csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["facets", "distance", "exact_distance", "angle", "exact_angle"])
        for friction, _, *numbers in table:
            out.writerow([0 if friction == "disc" else friction.split()[0], *map(rounded, numbers)])
    made = {"command": "experiments/run exact_cases --dimension 3 --cases S12 --solvers auto"}
    (data / "pyramids.about.json").write_text(json.dumps(made, indent=1) + "\n")


def main(results, data):
    for study in COLUMNS:
        if (results / study / "sweep.csv").exists():
            reduce_sweep(results, data, study)
    reduce_space(results, data)
    reduce_pyramids(results, data)
    if (results / "lcp_shootout/shootout.csv").exists():
        reduce_shootout(results / "lcp_shootout", data)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
