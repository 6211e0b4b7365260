"""The article's numbers are computed: check.py passes as it is, and fails for each way in which a number could go
wrong."""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def edit(path, pattern, replacement):
    text = path.read_text()
    changed = re.sub(pattern, replacement, text, count=1)
    assert changed != text, f"{path.name} has no '{pattern}' any more"
    path.write_text(changed)


def cell_of_last_row(paper):
    """The last number of the last row of a table."""
    edit(paper / "generated/table_times.tex", r"(\d[\d.]*)(\} [^\n]*\n\\bottomrule)", r"7\1\2")


BREAKS = {
    "the number 3.7 is typed by hand": lambda p: edit(
        p / "sections/results.tex", r"Impacts fall", "Some 3.7 impacts fall"
    ),
    "the number 17 is typed by hand": lambda p: edit(
        p / "sections/results.tex", r"Impacts fall", "$h^{17}$: impacts fall"
    ),
    "the number 7 is typed by hand": lambda p: edit(
        p / "sections/results.tex", r"Impacts fall", "Of $7$ impacts most fall"
    ),
    "the number 4 is typed by hand": lambda p: edit(
        p / "sections/results.tex", r"Impacts fall", r"After $4\\,\\mathrm{ms}$ impacts fall"
    ),
    "the number 'twelve' is typed by hand": lambda p: edit(
        p / "sections/results.tex", r"Impacts fall", "Of twelve schemes some impacts fall"
    ),
    "the number 0.035 is typed by hand": lambda p: edit(
        p / "sections/results.tex", r"Impacts fall", r"By \\code{0.035} impacts fall"
    ),
    "the number 'eighty' is typed by hand": lambda p: edit(
        p / "sections/results.tex", r"Impacts fall", "Of eighty schemes some impacts fall"
    ),
    "the number 'fifth' is typed by hand": lambda p: edit(
        p / "sections/results.tex", r"Impacts fall", "A fifth of impacts fall"
    ),
    "the number 2 is typed by hand": lambda p: edit(
        p / "sections/integrators.tex", r"\\R\{orders/rattle\}", "$2$, $1$"
    ),
    "STRUCTURE has 'four-bar'": lambda p: [
        edit(f, "four-bar", "4-bar") for f in [p / "sections/results.tex"] * 4 if "four-bar" in f.read_text()
    ],
    "what order has rattle?": lambda p: edit(
        p / "scripts/schemes.py", "Order 2 on smooth motion and", "Order 3 on smooth motion and"
    ),
    "no number 'crank/no_such'": lambda p: edit(
        p / "sections/results.tex", r"Impacts fall", r"\\R{crank/no_such} fall"
    ),
    "is computed, but not used": lambda p: edit(p / "sections/results.tex", r"\\R\{solvers/wrong\}", "none"),
    "no table 'table_no_such'": lambda p: edit(
        p / "sections/results.tex", r"generated/table_near", "generated/table_no_such"
    ),
    "generated/numbers.tex is stale": lambda p: edit(p / "generated/numbers.tex", r"(\d)", r"9\1"),
    "generated/table_times.tex is stale": cell_of_last_row,
    "the number 3 is typed by hand": lambda p: edit(
        p / "sections/results.tex", r"Impacts fall", r"At $\\mu = 3$ impacts fall"
    ),
    "the number 'two where' is typed by hand": lambda p: edit(
        p / "sections/results.tex", r"Impacts fall", "In two where it matters impacts fall"
    ),
    "shootout.about.json: the study has changed since": lambda p: edit(
        p / "results", "--time-limit 1", "--time-limit 2"
    ),
    "facets.about.json: the study has changed since": lambda p: edit(p / "results", "facets --method auto", "facets"),
    "generated/table_cones.tex is stale": lambda p: edit(p / "data/pyramids.csv", r"(?m)^(4,.*),(\S+)$", r"\1,9\2"),
    "the path is not the exact one of the pyramid": lambda p: edit(p / "data/pyramids.csv", "0.098", "0.097"),
    "generated/table_plane.tex is stale": lambda p: edit(
        p / "data/plane_in_space.csv", r"(?m)^(0.1,0.4,rattle.*),(\S+)$", r"\1,9\2"
    ),
    "friction.about.json: the study has changed since": lambda p: edit(
        p / "data/friction.about.json", r'"asked": "', '"asked": "0'
    ),
    "references.bib has no 'Nobody1900'": lambda p: edit(
        p / "sections/results.tex", r"Impacts fall", r"\\citep{Nobody1900}"
    ),
    "is not cited": lambda p: edit(p / "references.bib", r"@", "@book{Nobody1900, title = {Nothing}}\n@"),
}


def check(paper):
    run = subprocess.run([sys.executable, "-s", "-E", "-B", paper / "scripts/check.py", paper], capture_output=True,
                         text=True)
    return run.returncode, run.stdout + run.stderr


def main():
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder)
        for part in ("core", "experiments", "integrators", "tests"):
            (tree / part).symlink_to(ROOT / part)
        paper = tree / "paper"
        shutil.copytree(ROOT / "paper", paper)
        code, text = check(paper)
        if code != 0:
            sys.exit("as it is:\n" + text)
        for words, spoil in BREAKS.items():
            shutil.rmtree(paper)
            shutil.copytree(ROOT / "paper", paper)
            spoil(paper)
            code, text = check(paper)
            if code == 0 or words not in text:
                sys.exit(f"'{words}' is not said, but (exit code {code}):\n{text}")
    print(f"the article as it is; {len(BREAKS)} ways to spoil it are seen")


if __name__ == "__main__":
    main()
