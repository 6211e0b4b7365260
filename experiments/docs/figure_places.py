"""Places of performance figures in texts: which cell of data/figures.toml stands where.

check() lists the places that disagree with the data, write() brings them up to date. A figure is quoted with as many
digits as its place has.
"""
import re

from figure_tables import NONE
from figures import ROOT, load

TOP, STUDIES, RIVALS = "README.md", "experiments/README.md", "experiments/benchmarks/README.md"
DOCS, PAPER = "experiments/docs/", "paper/generated/"
NUMBER = r"(\d+(?:\.\d+)?(?:e[+-]?\d+)?)"
CRANK = (0.01, 0.4)  # μ, e of the headline

# (place, text there, cells): N is a number of the text, "_" any white space; a cell is (table, first cells of its row,
# column, factor). Every N has its cell, in the order of the text.
QUOTES = [
    (TOP, "takes_N µs,_N times_less_than_Siconos",
     [("step", CRANK, "Orthant, µs"), ("step", CRANK, "times")]),
    (TOP, "an error of 1e-9 rad takes_N ms", [("time_to_error", ("event-driven",), "1e-9")]),
    (TOP, "_N_of its time without friction,_N_without contacts,_N_without joints",
     [("content", (scene,), "of the whole") for scene in ("frictionless", "without contacts", "bodies alone")]),
    (TOP, r"Of_N_problems_`auto` solves_N_within_a_second.*?rival solves_N and",
     [("right", (), column) for column in ("problems", "auto", "best rival")]),
    (STUDIES, r"\| N complementarity_problems up to 300 rows.*?`auto` N, none wrong \| the best N; N to N wrong",
     [("right", (), column) for column in ("problems", "auto", "best rival", "wrong, least", "wrong, most")]),
    (STUDIES, r"geometric mean \| N; 1 to 3 rows N \|",
     [("virtual_best", ("all",), "time / virtual best"), ("virtual_best", ("1 to 3",), "time / virtual best")]),
    (STUDIES, r"e = 0\.4 \| N µs \| Siconos N µs, N times",
     [("step", CRANK, "Orthant, µs"), ("step", CRANK, "Siconos, µs"), ("step", CRANK, "times")]),
    (STUDIES, r"to 1\.4e-3 rad \| N ms \| Siconos N s;",
     [("error", (1.4e-3, "adaptive"), "s", 1e3), ("error", (1.4e-3, "Siconos"), "s")]),
    (STUDIES, r"to 1e-9 rad \| N ms", [("error", (1e-9, "event-driven"), "s", 1e3)]),
    (STUDIES, r"h = N µs it takes_N ms for an error of_N_rad",
     [("joints", ("symmetric",), column) for column in ("h, µs", "ms", "error")]),
    (STUDIES, r"classical treatment_takes_N ms with half that step for an error of_N_rad",
     [("joints", ("classical",), "ms"), ("joints", ("classical",), "error")]),
    (RIVALS, r"of the_N_up to 300_rows `auto` gets_N,_the best rival_N\.",
     [("right", (), column) for column in ("problems", "auto", "best rival")]),
    (RIVALS, r"worst of all six settings Orthant takes_N ms \(`adaptive`\) for 1e-2 and for 1e-3",
     [("time_to_error", ("adaptive",), "1e-2")]),
    (RIVALS, r"in the_geometric_mean \| N; N from 4 rows on \| one to three rows: N \|",
     [("virtual_best", (rows,), "time / virtual best") for rows in ("all", "all of 4 rows and more", "1 to 3")]),
    (STUDIES, r"crank_speed_of_N_rad/s_\(N without_friction\)",
     [("identify_contact_loss", ("Newton", mu), "rad/s") for mu in (0.01, 0)]),
    (DOCS + "choose_integrator.md", "selects its steps; N to N ms for the headline motion",
     [("time_to_error", ("adaptive",), "1e-2"), ("time_to_error", ("adaptive",), "1e-9")]),
    (DOCS + "choose_solver.md", r"`block-pivot` takes_N times_as long_as the linear_equation",
     [("obstacles", ("block-pivot",), "times the equation")]),
    (DOCS + "choose_solver.md", r"`block-pivot` \| N times the linear equation's cost",
     [("obstacles", ("block-pivot",), "times the equation")]),
    (PAPER + "numbers.tex", r"crank/adaptive_e3\\endcsname\{\\ensuremath\{N\}",
     [("time_to_error", ("adaptive",), "1e-3")]),
    (PAPER + "numbers.tex", r"crank/adaptive_e6\\endcsname\{\\ensuremath\{N\}",
     [("time_to_error", ("adaptive",), "1e-6")]),
    (PAPER + "numbers.tex", r"crank/event_driven_e9\\endcsname\{\\ensuremath\{N\}",
     [("time_to_error", ("event-driven",), "1e-9")]),
    (PAPER + "numbers.tex", r"crank/symmetric_e2\\endcsname\{\\ensuremath\{N\}",
     [("time_to_error", ("moreau-jean",), "1e-2")]),
    (PAPER + "numbers.tex", r"crank/symmetric_e3\\endcsname\{\\ensuremath\{N\}",
     [("time_to_error", ("moreau-jean",), "1e-3")]),
    (PAPER + "numbers.tex", r"solvers/best_certified\\endcsname\{\\ensuremath\{N\}",
     [("solvers", ("auto",), "certified")]),
    *((PAPER + "numbers.tex", rf"cones/{key}\\endcsname\{{\\ensuremath\{{N\}}", [("cones", (method,), column)])
      for key, method, column in (("solver_problems", "auto", "problems"), ("auto_right", "auto", "to 1e-08"),
                                  ("auto_time", "auto", "time, 1e-08"), ("rival_least", "siconos/vi-eg", "time, 1e-08"),
                                  ("rival_most", "siconos/prox", "time, 1e-08"))),
]

FOUR = [(i + 1, target) for i, target in enumerate(("1e-2", "1e-3", "1e-6", "1e-9"))]
COUNTS = [(1, "certified"), (2, "refused"), (3, "failed"), (4, "wrong"), (5, "crashed"), (6, "time")]
JOINTS = [(1 + i, f"μ = {mu}, e = {e}") for i, (mu, e) in enumerate((mu, e) for mu in (0, 0.01, 0.1) for e in (0, 0.4))]
EIGHT = [(i + 1, f"1e-{2 + i}") for i in range(8)]
# (place, head of the Markdown table, table of the data, number of first cells that name the row, (cell, column))
TABLES = [
    (TOP, "| integrator | to 1e-2", "time_to_error", 1, FOUR),
    (STUDIES, "| integrator | to 1e-2", "time_to_error", 1, FOUR),
    (STUDIES, "| joints | μ = 0, e = 0", "joints", 1, JOINTS),
    (STUDIES, "| solver | certified", "solvers", 1, COUNTS),
    (STUDIES, "| 512² nodes", "obstacles", 1, [(1, "factorizations"), (2, "full"), (3, "times the equation")]),
    (STUDIES, "| search | μ", "identify_contact_loss", 2,
     [(2, "error"), (3, "runs"), (4, "runs with derivatives"), (5, "ms")]),
    (STUDIES, "| shot | method", "identify_shot", 2,
     [(2, "miss, m"), (3, "runs"), (4, "runs with derivatives"), (5, "ms")]),
    (DOCS + "derivatives.md", "| method | μ | e", "identify_fit", 1,
     [(1, "μ"), (2, "e"), (3, "c, mm"), (4, "cost"), (5, "runs"), (6, "runs with derivatives")]),
    (RIVALS, "| rows | problems", "virtual_best", 1, [(1, "problems"), (2, "time / virtual best")]),
    (RIVALS, "| µ | e |", "step", 2, [(2, "Siconos, µs"), (3, "Orthant, µs"), (4, "times"),
                                       (4, "times, one iteration")]),
    (RIVALS, "| error, rad", "error", 2, [(2, "s")]),
    (RIVALS, "| n | a rank-1 update", "pivots", 1,
     [(1, "rank-1 update, µs"), (2, "µs a pivot"), (3, "rank-1 updates a pivot")]),
    (RIVALS, "| scene | step, µs", "content", 1, [(1, "step, µs"), (2, "of the whole")]),
    (PAPER + "table_times.tex", r"error [rad] &", "time_to_error", 1, EIGHT),
]
# (place, text there, table): machine and date of the table stand in the text.
ORIGINS = [
    (TOP, r"measures it \((?P<machine>[^,]*?), (?P<date>[\d-]+)\);", "time_to_error"),
    (STUDIES, r"The table of times was measured on (?:an )?(?P<machine>[^,]*?), (?P<date>[\d-]+)", "time_to_error"),
    (STUDIES, r"The solvers were measured on (?:an )?(?P<machine>[^,]*?), (?P<date>[\d-]+)", "solvers"),
    (STUDIES, r"The joints were measured on (?:an )?(?P<machine>[^,]*?), (?P<date>[\d-]+)", "joints"),
    (STUDIES, r"The searches were measured on (?:an )?(?P<machine>[^,]*?), (?P<date>[\d-]+)", "identify_shot"),
    (RIVALS, r"Measured on an (?P<machine>[^,]*?), (?P<date>[\d-]+)", "step"),
]


def cell(tables, table, first, column, factor=1):
    """The number of the row that begins with these cells."""
    source = tables[table]
    for row in source["rows"]:
        if all(a == b for a, b in zip(first, row)):
            number = row[source["columns"].index(column)]
            return number if number == NONE else number * factor
    raise KeyError(f"table {table} has no row {first}")


def same(quoted, number):
    """Equal when the number is rounded to the digits that are quoted."""
    if NONE in (quoted, number):
        return quoted == number
    decimals = len(quoted.partition(".")[2]) if "e" not in quoted else None
    if decimals is not None and round(number, decimals) == float(quoted):
        return True
    return not decimals and float(f"{number:.2g}") == float(quoted)


def as_quoted(number, quoted):
    if number == NONE or quoted == NONE:
        return number if number == NONE else f"{number:g}"
    if "e" in quoted:
        mantissa = quoted.partition("e")[0]
        text = f"{number:.{len(mantissa.partition('.')[2])}e}"
        return re.sub(r"e([+-])0*", lambda m: "e" + m[1].strip("+"), text)
    decimals = len(quoted.partition(".")[2])
    return f"{number:.{decimals}f}" if decimals else f"{float(f'{number:.2g}') if number >= 1000 else number:.0f}"


def pattern(text):
    return re.compile(re.sub(r"\bN\b|(?<=_)N|N(?=_)", lambda _: NUMBER, text).replace("_", r"\s+")
                      if "endcsname" not in text else text.replace("{N", "{" + NUMBER), re.S)


def rows_below(text, head):
    """(start, cells with their places) of the rows of a table, Markdown's or LaTeX's."""
    tex = head.endswith("&")
    at = text.index("\n", text.index(head)) + 1
    for line in text[at:].splitlines(keepends=True):
        start, at = at, at + len(line)
        if line.startswith(r"\bottomrule") or not (tex or line.lstrip().startswith("|")):
            break
        if line.strip() == r"\midrule" or re.match(r"\s*\|-", line):
            continue
        ends = [-1, *(m.start() for m in re.finditer("&", line)), line.index(r"\\")] if tex else \
            [m.start() for m in re.finditer(r"\|", line)]
        yield [(start + a + 1, start + b) for a, b in zip(ends, ends[1:])]


def name_of(text):
    """The first cell of a row, without marks and remarks."""
    text = re.sub(r"\\code\{([^}]*)\}", r"\1", text).strip().replace("`", "")
    text = re.sub(r" \(.*\)$|:.*|, symmetric$|, h = .*", "", text) if not text.startswith("walls") else text
    text = text.replace("10 000", "10000")
    try:
        return float(text)
    except ValueError:
        return text


def places(texts):
    """(place, start, end, table, row, column, factor) of every figure that a text quotes."""
    for place, words, cells in QUOTES:
        match = pattern(words).search(texts[place])
        if match is None or len(match.groups()) != len(cells):
            raise LookupError(f"{place}: no text '{words}' with {len(cells)} figures")
        for group, (table, first, column, *factor) in enumerate(cells, 1):
            yield place, *match.span(group), table, first, column, *(factor or [1])
    for place, head, table, count, columns in TABLES:
        text, before, found = texts[place], [], 0
        if head not in text:
            raise LookupError(f"{place}: no table '{head}'")
        for spans in rows_below(text, head):
            first = [name_of(text[a:b]) for a, b in spans[:count]]
            first = [before[i] if name == "" and i < len(before) else name for i, name in enumerate(first)]
            before, found = first, found + 1
            numbers = {}
            for index, column in columns:
                numbers.setdefault(index, []).append(column)
            for index, names in numbers.items():
                a, b = spans[index]
                quoted = list(re.finditer(NUMBER + "|–|--", text[a:b]))
                for m, column in zip(quoted, names, strict=True):
                    yield place, a + m.start(), a + m.end(), table, tuple(first), column, 1
        if not found:
            raise LookupError(f"{place}: the table '{head}' is empty")


def check(texts, tables):
    """Lists each place that disagrees with the data."""
    try:
        for place, start, end, table, first, column, factor in places(texts):
            quoted, number = texts[place][start:end].replace("--", NONE), cell(tables, table, first, column, factor)
            if not same(quoted, number):
                yield f"{place}: {quoted}, but {number:.5g} in table {table}, row {first}, '{column}'" \
                    if number != NONE else f"{place}: {quoted}, but not reached in table {table}, row {first}"
    except (LookupError, ValueError) as error:
        yield str(error.args[0])
    for place, words, table in ORIGINS:
        match = re.search(words.replace(" ", r"\s+"), texts[place])
        if match is None:
            yield f"{place}: no text '{words}'"
        elif match["machine"] not in tables[table]["machine"] or match["date"] != tables[table]["date"]:
            yield f"{place}: {match['machine']}, {match['date']}, but table {table} is of " \
                f"{tables[table]['machine']}, {tables[table]['date']}"


def read():
    return {place: (ROOT / place).read_text(encoding="utf-8") for place in
            {entry[0] for entry in (*QUOTES, *TABLES, *ORIGINS)}}


def write(tables):
    """Writes each figure into its place; the article's are made by paper/scripts/tables.py."""
    texts = read()
    changes = {}
    for place, start, end, *where in places(texts):
        if not place.startswith(PAPER):
            old, number = texts[place][start:end], cell(tables, *where)
            if not same(old, number):
                changes.setdefault(place, []).append((start, end, as_quoted(number, old)))
    for place, edits in changes.items():
        text = texts[place]
        for start, end, new in sorted(edits, reverse=True):
            text = text[:start] + new + text[end:]
        (ROOT / place).write_text(text, encoding="utf-8")
        print(f"figures: {place}: {len(edits)} figures written")


if __name__ == "__main__":
    print("\n".join(check(read(), load())) or "all figures agree")
