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
    "slider_crank_space": "integrator solver mu e guide clearance at_crank step rtol repeats status value error "
    "energy_initial energy_final impulse lcp_solves seconds",
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
    """Limits and contact phases of the second study, and the comparison in space."""
    for table, name in (("closing_rates", "closing"), ("ball_phases", "ball")):
        found = results / "slider_crank_space" / f"{table}.csv"
        if found.exists():
            (data / f"slider_crank_space.{name}.csv").write_text(found.read_text())
    peers = results / "peers/space.csv"
    if peers.exists():
        with open(peers, newline="") as file, open(data / "space_peers.csv", "w", newline="") as to:
            table = csv.DictReader(file)
            out = csv.DictWriter(to, table.fieldnames, lineterminator="\n")
            out.writeheader()
            out.writerows(row | {key: rounded(row[key]) for key in ("seconds", "error")} for row in table)
        made = {"command": "build/peers/python/bin/python experiments/benchmarks/space/space.py --output results/peers"}
        (data / "space_peers.about.json").write_text(json.dumps(made, indent=1) + "\n")


EXACT_CASES = "experiments/run exact_cases --dimension 3 --solvers auto"


def reduce_exact_cases(folder, data):
    """`exact_cases --dimension 3`: a line for each case, integrator and solver; how far pyramids bend the path of a
    block on a slope, and what its motion costs with them."""
    if not (folder / "pyramids.md").exists():
        return
    made = json.dumps(about(folder, command=EXACT_CASES), indent=1) + "\n"
    with open(data / "exact_space.csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["case", "title", "integrator", "solver", "error", "order", "milliseconds", "verdict"])
        for cells in markdown_rows(folder / "table.md", r"\| S\d+ "):
            case, _, title = cells[0].partition(" ")
            integrator, solvers, _, error, order, ms, *_, verdict = cells[1:]
            for solver in solvers.split():
                out.writerow([case, title, integrator.strip("`"), solver, error, order, ms, verdict])
    (data / "exact_space.about.json").write_text(made)
    with open(folder / "runs.csv", newline="") as file:  # the block by moreau-jean at its smallest step
        block = [row for row in csv.DictReader(file) if row["case"] == "S12" and row["integrator"] == "moreau-jean"]
    finest = min(float(row["setting"]) for row in block)
    with open(data / "pyramids.csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["facets", "distance", "exact_distance", "angle", "exact_angle", "step", "milliseconds"])
        for friction, _, *numbers in markdown_rows(folder / "pyramids.md", r"\| (disc|\d+ facets) "):
            facets = "0" if friction == "disc" else friction.split()[0]
            times = [float(row["seconds"]) for row in block if float(row["setting"]) == finest and
                     (row["solver"].partition("facets=")[2] or "0") == facets]
            out.writerow([facets, *numbers, rounded(finest), rounded(1e3 * min(times), 3)])
    (data / "pyramids.about.json").write_text(made)


def markdown_rows(path, start):
    """The cells of the rows that begin so."""
    return [[cell.strip() for cell in line.strip("| \n").split(" | ")] for line in path.read_text().splitlines()
            if re.match(start, line)]


def reduce_facets(folder, data):
    """Random contact problems with discs and with pyramids: every solve."""
    if not (folder / "facets.csv").exists():
        return
    with open(folder / "facets.csv", newline="") as file, open(data / "facets.csv", "w", newline="") as to:
        out = csv.writer(to, lineterminator="\n")
        out.writerow(["contacts", "sides", "status", "error", "seconds", "disc_seconds"])
        for row in csv.DictReader(file):
            numbers = (rounded(row[key], 3) for key in ("error", "seconds", "disc_seconds"))
            out.writerow([row["problem"].split("-")[0], row["sides"], row["status"], *numbers])
    made = about(folder, command="experiments/run facets --method auto --output results/facets")
    (data / "facets.about.json").write_text(json.dumps(made, indent=1) + "\n")


def main(results, data):
    for study in COLUMNS:
        if (results / study / "sweep.csv").exists():
            reduce_sweep(results, data, study)
    reduce_space(results, data)
    reduce_exact_cases(results / "exact_cases", data)
    reduce_facets(results / "facets", data)
    if (results / "lcp_shootout/shootout.csv").exists():
        reduce_shootout(results / "lcp_shootout", data)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
