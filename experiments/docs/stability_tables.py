"""Tables of numerical stability in space: of data/stability_space.csv, which `experiments/run stability --dimension 3
--time-limit 60` writes, into theory/stability_tables.md. --check: says whether the page has them, and writes nothing.
"""
import csv
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
PAGE, DATA = HERE / "theory/stability_tables.md", HERE / "data/stability_space.csv"
BEGIN, END = "<!-- tables in space: stability_tables.py -->\n", "<!-- end of tables in space -->\n"
UNITS = {"mass ratio": "m/s", "load ratio": "m", "step [s]": "m", "distance [m]": "m", "steps of a pendulum": "m"}
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def decade(text):
    """A power of ten, as the values of the studies are."""
    exponent = int(f"{float(text):e}".split("e")[1])
    return {0: "1", 1: "10", -1: "0.1", -2: "0.01"}.get(exponent, "10" + str(exponent).translate(RAISED))


def figure(x):
    if 0.01 <= x < 1000:
        return f"{x:.2g}"
    return "0" if x == 0 else f"{x:.1e}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def ranges(rows, what):
    """(first value, last value, what they have in common) of neighbours alike; what(row) is empty: left out."""
    groups = []
    for k, row in enumerate(rows):
        if not what(row):
            continue
        if groups and groups[-1][2] == what(row) and groups[-1][3] == k - 1:
            groups[-1][1], groups[-1][3] = row["value"], k
        else:
            groups.append([row["value"], row["value"], what(row), k])
    return [(decade(a) if a == b else f"{decade(a)} to {decade(b)}", common) for a, b, common, _ in groups]


def failures(rows):
    return "; ".join(f"{values}: `{end}`" for values, end in ranges(rows, lambda r: r["end"].replace("solved", "")))


def warnings(rows):
    """Of runs that ended as solved."""
    return ", ".join(values for values, _ in ranges(rows, lambda r: r["end"] == "solved" and r["warned"] == "yes"))


def line(integrator, rows, tells):
    solved = [row for row in rows if row["end"] == "solved"]
    ends = [figure(float(r["error"])) if r["end"] == "solved" else "–" for r in (rows[0], rows[-1])]
    worst = [figure(max((float(r[key]) for r in solved), default=0)) for key in ("error", "drift", "penetration")]
    seconds = figure(sum(float(r["seconds"]) for r in solved))
    cells = [f"`{integrator}`", *ends, *(worst if solved else ["–"] * 3), seconds if solved else "–"]
    return "| " + " | ".join([*cells, *([warnings(rows) or "–"] if tells else []), failures(rows) or "–"]) + " |\n"


def tables():
    studies = {}
    with DATA.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            studies.setdefault(row["study"], {}).setdefault(row["integrator"], []).append(row)
    text = ""
    for study, by_integrator in studies.items():
        values = [row["value"] for row in next(iter(by_integrator.values()))]
        first, last = decade(values[0]), decade(values[-1])
        title = study[0].upper() + study[1:]
        text += f"\n### {title}: {first} to {last}\n\n"
        text += f"| integrator | error at {first} | at {last} | worst [{UNITS.get(study, '1')}] | drift [m] | "
        tells = all(row["warned"] for rows in by_integrator.values() for row in rows)
        text += "penetration [m] | time [s] |" + (" warned |" if tells else "") + " not solved |\n"
        text += "|---|---|---|---|---|---|---|---|" + ("---|" if tells else "") + "\n"
        text += "".join(line(integrator, rows, tells) for integrator, rows in by_integrator.items())
    return text + "\n"


def main():
    page = PAGE.read_text(encoding="utf-8")
    head, rest = page.split(BEGIN)
    tail = rest.split(END)[1]
    new = head + BEGIN + tables() + END + tail
    if "--check" in sys.argv[1:]:
        if new != page:
            sys.exit(f"{PAGE.name}: the tables in space are not those of {DATA.name}: run stability_tables.py")
        return
    PAGE.write_text(new, encoding="utf-8")


if __name__ == "__main__":
    main()
