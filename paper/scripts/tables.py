"""Every number and table of the article, from data/: writes generated/. Same data, same bytes."""
import re
import sys

import cones
import crank
import others
import schemes
import space
import spatial
import tilt
from data import GENERATED


def everything():
    numbers, tables = {}, {}
    for part in (cones, crank, others, schemes, space, spatial, tilt):
        part.numbers(numbers)
        part.tables(tables)
    return numbers, tables


def files():
    numbers, tables = everything()
    lines = [rf"\expandafter\def\csname R:{key}\endcsname{{{value}}}" for key, value in sorted(numbers.items())]
    head = "% Written by paper/scripts/tables.py from paper/data: not by hand.\n"
    yield "numbers.tex", head + "\n".join(lines) + "\n"
    for name, text in tables.items():
        yield f"table_{name}.tex", head + text


if __name__ == "__main__":
    GENERATED.mkdir(exist_ok=True)
    wanted = dict(files())
    for old in GENERATED.glob("*.tex"):
        if old.name not in wanted:
            old.unlink()
    for name, text in wanted.items():
        if not re.search(r"\S", text):
            sys.exit(f"tables.py: {name} would be empty")
        (GENERATED / name).write_text(text)
