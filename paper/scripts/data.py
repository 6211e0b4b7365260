"""The result files of the article as tables, and how a number looks in it."""
import csv
import json
import math
import re
from functools import cache
from pathlib import Path

PAPER = Path(__file__).resolve().parents[1]
DATA, GENERATED = PAPER / "data", PAPER / "generated"


@cache
def rows(name):
    with open(DATA / f"{name}.csv", newline="") as file:
        return [{key: number_or_text(value) for key, value in row.items()} for row in csv.DictReader(file)]


@cache
def load(name):
    return json.loads((DATA / f"{name}.json").read_text())


def number_or_text(text):
    if text == "":
        return None
    try:
        return float(text)
    except ValueError:
        return text


def pick(table, **wanted):
    """Rows with these values; a value may be a function of the row's."""
    for key, value in wanted.items():
        if callable(value):
            table = [row for row in table if value(row[key])]
        else:
            table = [row for row in table if row[key] == value]
    return table if wanted else list(table)


def solved(table):
    return pick(table, status="solved")


def tex(x, digits=2):
    """A number of so many digits; powers of ten where it is very small or large."""
    if x is None or not math.isfinite(x):
        return "--"
    if x == 0:
        return r"\ensuremath{0}"
    if 1e-3 <= abs(x) < 1e4:
        decimals = max(0, digits - 1 - math.floor(math.log10(abs(float(f"{x:.{digits - 1}e}")))))
        return rf"\ensuremath{{{x:.{decimals}f}}}"
    mantissa, exponent = f"{x:.{digits - 1}e}".split("e")
    return rf"\ensuremath{{{mantissa}\times10^{{{int(exponent)}}}}}" if digits > 1 or mantissa not in ("1",) else \
        rf"\ensuremath{{10^{{{int(exponent)}}}}}"


def rough(x):
    """A number of two digits where the last ones of a larger one mean nothing: times and their ratios."""
    return tex(float(f"{x:.2g}")) if x is not None else tex(x)


def unit(name):
    return rf"\ensuremath{{\,\mathrm{{{name}}}}}"


def count(n):
    return rf"\ensuremath{{{n:d}}}" if n < 10000 else rf"\ensuremath{{{n // 1000}\,{n % 1000:03d}}}"


def words(n):
    """A count as a sentence has it."""
    return "none" if n == 0 else "one" if n == 1 else count(n)


def plus_minus(middle, half_range):
    """Both to the decimals of the half range's first digit, but no more than five; a range that is less is left out."""
    decimals = min(5, max(0, -math.floor(math.log10(float(f"{half_range:.0e}"))))) if half_range > 0 else 3
    if half_range < 0.5 * 10**-decimals:
        return rf"\ensuremath{{{middle:.{decimals}f}}}"
    return rf"\ensuremath{{{middle:.{decimals}f} \pm {half_range:.{decimals}f}}}"


def code(name):
    return r"\code{" + name.replace("_", r"\_") + "}"


def tabular(columns, header, lines):
    body = [" & ".join(header) + r" \\", r"\midrule"] + \
           [" & ".join(line) + r" \\" if isinstance(line, list) else line for line in lines]
    return "\n".join([rf"\begin{{tabular}}{{@{{}}{columns}@{{}}}}", r"\toprule", *body, r"\bottomrule",
                      r"\end{tabular}"]) + "\n"


def short(integrator):
    """A name that distinguishes the two treatments of the joints of moreau-jean."""
    names = {
        "moreau-jean:joints=position": r"\code{moreau-jean}, classical",
        "moreau-jean:joints=symmetric": r"\code{moreau-jean}, symmetric",
        "moreau-jean": r"\code{moreau-jean}, symmetric"
    }
    return names.get(integrator) or code(re.sub(":.*", "", integrator))


def unsolved(table, by="integrator"):
    """In words: how many runs of which scheme, or which solver, did not end solved."""
    count_of = {i: len([r for r in table if r[by] == i and r["status"] != "solved"])
                for i in dict.fromkeys(row[by] for row in table)}
    named = [f"{words(number)} by {code(i)}" for i, number in count_of.items() if number]
    return ", ".join(named) or "none"
