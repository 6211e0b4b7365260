"""Performance figures of the texts agree with their one data file; each figure is then falsified in turn.

Data: experiments/docs/data/figures.toml. Places: experiments/docs/figure_places.py (READMEs, pages, the article).
"""
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "experiments/docs"))
import figure_pages  # noqa: E402
import figure_places  # noqa: E402
import figure_tables  # noqa: E402
import figures  # noqa: E402


def falsified(texts, tables):
    """(what, texts, tables): each quoted figure with another first digit, each cell of the data, each origin."""
    for place, start, end, table, first, column, _ in figure_places.places(texts):
        text = texts[place]
        quoted = text[start:end]
        if quoted[0].isdigit():
            digit = "7" if quoted[0] != "7" else "3"
            yield f"{place}: {quoted}", {**texts, place: text[:start] + digit + text[start + 1:]}, tables
        source = tables[table]
        at = source["columns"].index(column)
        rows = [[*row[:at], 777.7, *row[at + 1:]] if all(a == b for a, b in zip(first, row)) else row
                for row in source["rows"]]
        yield f"table {table}, row {first}, '{column}'", texts, {**tables, table: {**source, "rows": rows}}
    for place, words, table in figure_places.ORIGINS:
        for key in ("machine", "date"):
            yield f"{place}: {key} of table {table}", texts, {**tables, table: {**tables[table], key: "another"}}


def origins(tables):
    """Each table names command, machine, revision and date, and one measurement writes it."""
    made = [name for names, *_ in figures.MEASUREMENTS for name in names]
    for name, table in tables.items():
        if name not in made:
            yield f"figures.toml: no measurement writes table {name}"
        if not all(table.get(key) for key in ("command", "machine", "revision", "date")):
            yield f"figures.toml: table {name} does not name command, machine, revision and date"
        if any(len(row) != len(table["columns"]) for row in table["rows"]):
            yield f"figures.toml: table {name} has a row of another length"


def reading(program):
    """A measurement replaces its own table and no other: the output of a program, read and written again."""
    with tempfile.TemporaryDirectory() as folder:
        data, output = Path(folder) / "figures.toml", Path(folder) / "output.txt"
        before = figures.load()
        figures.save(before, data)
        if figures.load(data) != before or data.read_text(encoding="utf-8") != figures.DATA.read_text(encoding="utf-8"):
            yield "figures.toml is not as figures.py writes it"
        old = before["content"]
        before["content"] = {**old, "date": "2000-01-01", "rows": [[name, 0, 0] for name, *_ in old["rows"]]}
        figures.save(before, data)
        run = subprocess.run([program, "--repeats", "1"], capture_output=True, check=True)
        output.write_bytes(run.stdout)
        subprocess.run([sys.executable, "-s", "-E", "-B", ROOT / "experiments/docs/figures.py", "busy", "content",
                        "--from", output, "--data", data], check=True)
        after = figures.load(data)
        whole, own = after.pop("content"), before.pop("content")
        same_rows = [row[0] for row in whole["rows"]] == [row[0] for row in own["rows"]]
        if after != before or whole["columns"] != own["columns"] or not same_rows:
            yield "reading the output of scene_content does not replace the table 'content', or changes another one"
        busy = whole["machine"].endswith("with other work as well")
        if whole["date"] == own["date"] or not busy or whole["rows"] == own["rows"]:
            yield f"the new table has not its own origin: {whole}"


def pages(tables):
    """The site's tables are the data's."""
    with tempfile.TemporaryDirectory() as folder:
        figure_pages.pages(Path(folder), tables)
        with open(Path(folder) / "integrators.csv", encoding="utf-8") as stream:
            rows = {row[0]: row[1:] for row in csv.reader(stream)}
        number = figure_places.cell(tables, "time_to_error", ("event-driven",), "1e-9")
        if rows["`event-driven`"][3] != str(figure_tables.digits(number, 2)):
            yield f"the site's table of integrators has {rows['`event-driven`']}"
        if tables["time_to_error"]["date"] not in (Path(folder) / "integrators.txt").read_text(encoding="utf-8"):
            yield "the site's table of integrators has no date"


def main():
    texts, tables = figure_places.read(), figures.load()
    faults = [*figure_places.check(texts, tables), *origins(tables), *pages(tables), *reading(sys.argv[1])]
    count = 0
    if not faults:
        for what, changed, data in falsified(texts, tables):
            count += 1
            if not list(figure_places.check(changed, data)):
                faults.append(f"a false figure is not found: {what}")
        if count < 500:
            faults.append(f"only {count} figures were found")
    print("\n".join(faults) or f"all figures agree with their data; {count} ways to falsify one are seen")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
