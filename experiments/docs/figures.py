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
import csv
import datetime
import json
import math
import re
import statistics
import subprocess
import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
DATA = HERE / "data/figures.toml"
GROUPS = {"definite": "symmetric positive definite", "semidefinite": "positive semidefinite",
          "P-matrix": "P, not symmetric", "grid": "obstacles on grids, sparse", "friction": "contacts with friction",
          "infeasible": "without solution (proof required)", "other": "games, options, known hard ones"}
NOT_COUNTED = {"enumerate"}  # an oracle for small ones
BEST = 3
TARGETS = ("1e-2", "1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8", "1e-9")  # errors of θ₁(0.2 s) [rad]
WELL = 0.4  # restitution up to which the motion of the slider-crank is well conditioned
OURS = ("auto", "lemke")
CONES = """\
Contact problems with friction discs: two files of FCLIB and time steps of five scenes in space, by Orthant's solvers, by
Siconos (`siconos/…`) and by Pinocchio. One measure for all: the scale-free residual
(`core/lcp/judge/certify_cones.h`), recomputed by independent code. A method is run with its own tolerance at the
residual, then tenfold lower until the residual is met. The time is that of the loosest run that meets it.

![Share of problems solved within a factor of the best time](data/cone_profiles.svg)

{table}

*to 1e-8* counts the problems solved to that residual. *time* is the geometric mean of the method's time over the
fastest method's, on these problems. Problems that a method fails are kept in the picture: its curve ends below 1.

"""
FACETS = """\
### Pyramids instead of cones

Methods of linear problems take a pyramid of $n$ sides. Its strength lies between $\\cos(\\pi/n)$ and 1 times µ, by
direction. The error is that of the velocities, relative to the data, on random problems of full rank with a unique
velocity. The time is relative to that of `auto` with discs.

{table}

"""
NONE = "–"  # not reached


def rows_of(file):
    with open(file, encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def digits(value, count=5):
    """Rounded: 140 and not 1.4e+02; an integer where it is one."""
    rounded = float(f"{value:.{count}g}")
    return int(rounded) if rounded.is_integer() and abs(rounded) < 1e15 else rounded


def time_to_error(folder):
    """Of each integrator the milliseconds to an error, as work_precision computes it, for eight targets."""
    cases = {}  # (integrator, μ, e): (error, seconds) from coarse to fine
    for row in rows_of(folder / "runs.csv"):
        if float(row["e"]) <= WELL:
            error = float(row["error"] or "inf") if row["status"] == "solved" else math.inf
            ladder = cases.setdefault(row["integrator"], {}).setdefault((row["mu"], row["e"]), [])
            ladder.append((error, float(row["seconds"])))
    table = []
    for name, runs in cases.items():
        cells = []
        for target in TARGETS:
            worst = 0
            for ladder in runs.values():
                reached = math.inf
                for error, seconds in reversed(ladder):
                    if error > float(target):
                        break
                    reached = min(reached, seconds)
                worst = max(worst, reached)
            cells.append(digits(1e3 * worst) if worst < math.inf else NONE)
        table.append([name, *cells])
    yield "time_to_error", ["integrator", *TARGETS], table


def shootout(folder):
    """The ranking by group of problems, and the count of every solver."""
    rows = [row for row in rows_of(folder / "shootout.csv") if row["solver"] not in NOT_COUNTED]
    fastest = {}  # of each problem
    for row in rows:
        if row["result"] == "certified":
            fastest[row["problem"]] = min(fastest.get(row["problem"], 1e300), float(row["seconds"]))
    table = []
    for group, words in GROUPS.items():
        part = [row for row in rows if row["group"] == group]
        ranking = []
        for solver in {row["solver"] for row in part}:
            times = [float(row["seconds"]) / fastest[row["problem"]] for row in part
                     if row["solver"] == solver and row["result"] == "certified"]
            if times:
                ranking.append((-len(times), statistics.median(times), solver))
        cells = [cell for right, time, solver in sorted(ranking)[:BEST] for cell in (solver, -right, digits(time, 2))]
        if part:
            table.append([words, len({row["problem"] for row in part}), *cells, *[""] * (3 * BEST - len(cells))])
    columns = [cell for i in range(BEST) for cell in (f"{i + 1}.", "right", "time")]
    yield "solvers_by_group", ["problems", "number", *columns], table
    if (folder / "summary.csv").exists():
        counted = ["problems", "certified", "refused", "failed", "wrong", "crashed"]
        table = []
        for row in rows_of(folder / "summary.csv"):
            row["failed"] = int(row["failed"]) + int(row["skipped"])
            table.append([row["solver"], *(int(row[key]) for key in counted),
                          digits(float(row["median_time_to_best"]))])
        table.sort(key=lambda row: (-row[2], row[0]))
        yield "solvers", ["solver", *counted, "time"], table


def regret(name):
    """Of each problem its fastest solver, the time of `auto` over that one's, and the seconds of every solver."""
    def read(folder):
        seconds, n = {}, {}
        for row in rows_of(folder / "shootout.csv"):
            n[row["problem"]] = int(row["n"])
            taken = digits(float(row["seconds"]), 2) if row["result"] == "certified" else NONE
            seconds.setdefault(row["problem"], {})[row["solver"]] = taken
        rows = {row["problem"]: row for row in rows_of(folder / "regret.csv")}
        solvers = sorted({solver for times in seconds.values() for solver in times} - NOT_COUNTED - {"auto"})
        table = []
        for problem, times in sorted(seconds.items()):
            row = rows.get(problem, {"fastest": NONE, "regret": ""})
            factor = digits(float(row["regret"]), 3) if row["regret"] else NONE
            table.append([problem, n[problem], row["fastest"], factor,
                          *(times.get(solver, NONE) for solver in ("auto", *solvers))])
        yield name, ["problem", "rows", "fastest", "regret", "auto", *solvers], table
    return read


def with_rivals(folder):
    """`auto` relative to the fastest right rival of each problem, and the count of right answers of each."""
    rows = rows_of(folder / "shootout.csv")
    ours, best, right = {}, {}, {}
    for row in rows:
        if row["result"] != "certified":
            continue
        right.setdefault(row["solver"], set()).add(row["problem"])
        if row["solver"] == "auto":
            ours[row["problem"]] = (int(row["n"]), float(row["seconds"]))
        elif row["solver"] not in OURS:
            best[row["problem"]] = min(best.get(row["problem"], math.inf), float(row["seconds"]))
    table = []
    for label, low, high in (("1 to 3", 1, 3), ("4 to 9", 4, 9), ("10 to 30", 10, 30), ("31 to 100", 31, 100),
                             ("101 to 300", 101, 300), ("all", 1, 300), ("all of 4 rows and more", 4, 300)):
        ratios = [seconds / best[p] for p, (n, seconds) in ours.items() if p in best and low <= n <= high]
        if ratios:
            table.append([label, len(ratios), digits(statistics.geometric_mean(ratios), 2)])
    yield "virtual_best", ["rows", "problems", "time / virtual best"], table
    rivals = {name: len(found) for name, found in right.items() if name not in OURS}
    wrong = [sum(row["result"] == "wrong" for row in rows if row["solver"] == name) for name in rivals]
    yield "right", ["problems", "auto", "best rival", "wrong, least", "wrong, most"], \
        [[len({row["problem"] for row in rows}), len(right["auto"]), max(rivals.values()), min(wrong), max(wrong)]]


def cones(folder):
    """Of every method and tolerance the problems solved and the mean factor; the profiles, a column a method."""
    rows = rows_of(folder / "cases.csv")
    tolerances = sorted({float(row["tolerance"]) for row in rows}, reverse=True)
    methods = list(dict.fromkeys(row["method"] for row in rows))
    reached, fastest = {}, {}
    for row in rows:
        if float(row["residual"]) <= float(row["tolerance"]):
            seconds = max(float(row["seconds"]), 1e-6)
            reached[row["method"], float(row["tolerance"]), row["problem"]] = seconds
            key = float(row["tolerance"]), row["problem"]
            fastest[key] = min(fastest.get(key, math.inf), seconds)
    table = []
    for method in methods:
        counts, means = [], []
        for tolerance in tolerances:
            factors = [seconds / fastest[tolerance, problem] for (name, t, problem), seconds in reached.items()
                       if name == method and t == tolerance]
            counts.append(len(factors))
            means.append(digits(statistics.geometric_mean(factors), 2) if factors else NONE)
        table.append([method, len({row["problem"] for row in rows}), *counts, *means])
    table.sort(key=lambda row: [-count for count in row[2:2 + len(tolerances)]])
    yield "cones", ["method", "problems", *(f"to {t:g}" for t in tolerances), *(f"time, {t:g}" for t in tolerances)], \
        table
    shares = {}
    for row in rows_of(folder / "profiles.csv"):
        shares.setdefault((float(row["tolerance"]), float(row["factor"])), {})[row["method"]] = float(row["share"])
    yield "cone_profiles", ["tolerance", "factor", *methods], \
        [[tolerance, digits(factor, 4), *(digits(share.get(method, 0), 3) for method in methods)]
         for (tolerance, factor), share in sorted(shares.items())]


def markdown(text):
    """The Markdown tables of a program's output: (head, rows)."""
    lines = [[cell.strip().strip("`") for cell in re.split(r"(?<!\\)\|", line)[1:-1]] if line.startswith("|") else None
             for line in text.splitlines()]
    at = 0
    while at < len(lines):
        if lines[at] is None:
            at += 1
            continue
        end = next((i for i in range(at, len(lines)) if lines[i] is None), len(lines))
        yield lines[at], [[value(cell) for cell in row] for row in lines[at + 2:end]]
        at = end


def value(text):
    try:
        return digits(float(text), 15)
    except ValueError:
        return text or NONE


def step_race(file):
    """Steps against Siconos by Newton to convergence and by one iteration; then the cheapest setting for an error."""
    steps, errors = (rows for _, rows in markdown(file.read_text(encoding="utf-8")))
    table = {}
    for mu, e, rival, theirs, ours, times in steps:
        table.setdefault((mu, e), {})["one" if "one" in rival else "all"] = (theirs, ours, times)
    yield "step", ["mu", "e", "Siconos, µs", "Orthant, µs", "times", "times, one iteration"], \
        [[mu, e, *row["all"], row.get("one", (NONE,) * 3)[2]] for (mu, e), row in table.items()]
    yield "error", ["error, rad", "who", "setting", "s"], [[row[0], row[1], row[2], row[4]] for row in errors]


def printed(name, columns=None):
    def read(file):
        head, rows = next(markdown(file.read_text(encoding="utf-8")))
        yield name, columns or head, rows
    return read


def chains(file):
    """Microseconds of a link and step, from Google Benchmark's CSV."""
    text = file.read_text(encoding="utf-8")
    rows = [row for row in csv.DictReader(text[text.index("name,"):].splitlines())
            if row["name"].startswith("chain_step/")]
    links = [int(row["name"].split("/")[1]) for row in rows]
    yield "chains", ["links", "µs a link and step"], \
        [[n, digits(float(row["cpu_time"]) / n, 2)] for n, row in zip(links, rows)]


def joints(folder):
    """The headline study: error and cost of both treatments of the joints, from the data of the article."""
    rows = [row for row in rows_of(folder / "slider_crank.csv")
            if row["solver"] == "lemke" and row["status"] == "solved" and float(row["e"]) <= WELL]
    orders = json.loads((folder / "slider_crank.orders.json").read_text(encoding="utf-8"))
    cases = [(mu, e) for mu in (0, 0.01, 0.1) for e in (0, WELL)]
    table = []
    for name, kind in (("classical", "position"), ("symmetric", "symmetric")):
        integrator = f"moreau-jean:joints={kind}"
        own = [row for row in rows if row["integrator"] == integrator]
        near = [row for row in own if row["repeats"] == "0" and 0.9e-5 <= float(row["step"]) <= 1.1e-5]
        errors = [max(float(row["error"]) for row in near if (float(row["mu"]), float(row["e"])) == case)
                  for case in cases]
        fits = [fit["order"] for fit in orders
                if fit["integrator"] == integrator and fit["solver"] == "lemke" and fit["e"] <= WELL]
        timed = [row for row in own if row["repeats"] != "0"]
        steps = [1e6 * float(row["seconds"]) * float(row["step"]) / 0.2 for row in timed]
        one = {row["step"]: row for row in timed if (float(row["mu"]), float(row["e"])) == (0.01, WELL)}
        h = "6.25e-06" if name == "symmetric" else "3.125e-06"
        table.append([name, *(digits(x) for x in (*errors, min(fits), max(fits), min(steps), max(steps), 1e6 * float(h),
                                                  float(one[h]["error"]), 1e3 * float(one[h]["seconds"])))])
    yield "joints", ["joints", *(f"μ = {mu}, e = {e}" for mu, e in cases), "order, least", "order, most",
                     "µs a step, least", "µs a step, most", "h, µs", "error", "ms"], table


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


def where_and_when(table):
    return f"Measured at revision `{table['revision']}`, {table['date']}, on {table['machine']}.\n"


def pages(to, tables=None):
    """The tables that pages of the site include, with the line of their origin."""
    tables = tables or load()
    to.mkdir(parents=True, exist_ok=True)

    def write(name, head, rows, source):
        with open(to / f"{name}.csv", "w", encoding="utf-8", newline="") as stream:
            csv.writer(stream, lineterminator="\n").writerows([head, *rows])
        (to / f"{name}.txt").write_text(where_and_when(source), encoding="utf-8")

    if source := tables.get("time_to_error"):
        shown = [i for i, column in enumerate(source["columns"]) if column in ("1e-2", "1e-3", "1e-6", "1e-9")]
        write("integrators", ["integrator", *(f"to {source['columns'][i]}" for i in shown)],
              [[f"`{row[0]}`", *(digits(row[i], 2) if row[i] != NONE else NONE for i in shown)]
               for row in source["rows"] if any(row[i] != NONE for i in shown)], source)
    for name in ("regret", "regret_sparse"):
        if source := tables.get(name):
            write(f"{name}_whole", source["columns"], source["rows"], source)
            write(name, *regret_by_family(source), source)
            if name == "regret":
                regret_picture(to / "regret.svg", source)
    texts = ["## Coulomb's cone\n"]
    for name, text in (("cones", CONES), ("facets", FACETS)):
        if source := tables.get(name):
            write(name, source["columns"], source["rows"], source)
            texts.append(text.format(table=f"```{{csv-table}}\n:file: data/{name}.csv\n:header-rows: 1\n```") +
                         where_and_when(source))
    if source := tables.get("cone_profiles"):
        cone_picture(to / "cone_profiles.svg", source)
    if len(texts) == 1:
        texts.append("Not measured yet.\n")
    (to / "cones.txt").write_text("\n".join(texts), encoding="utf-8")
    if source := tables.get("solvers_by_group"):
        write("solvers", source["columns"],
              [[f"`{cell}`" if i in (2, 5, 8) and cell else cell for i, cell in enumerate(row)]
               for row in source["rows"]], source)


def regret_by_family(source):
    """Head and rows: of each family how often `auto` takes at most twice the time of the fastest, and the worst."""
    families = {}
    for problem, n, fastest, times, *_ in source["rows"]:
        family = problem.split("-")[0] if "-" in problem and not problem.startswith("scalar") else "known"
        families.setdefault(family, []).append((problem, n, fastest, times))
    rows = []
    for family, part in sorted(families.items()):
        answered = [row for row in part if row[3] != NONE]
        if not answered:
            continue
        worst = max(answered, key=lambda row: row[3])
        open_ = sum(row[2] != NONE and row[3] == NONE for row in part)
        least, most = min(row[1] for row in part), max(row[1] for row in part)
        rows.append([family, f"{least} to {most}", len(answered), sum(row[3] <= 2 for row in answered),
                     digits(worst[3], 2), f"`{worst[0]}`", f"`{worst[2]}`", open_])
    return ["family", "rows", "problems", "within 2", "worst", "of", "fastest there", "open"], rows


def regret_picture(file, source):
    """Time of `auto` over that of the fastest solver, problem by problem."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    shown = [row for row in source["rows"] if row[3] != NONE]
    figure, axes = pyplot.subplots(figsize=(7.5, 4))
    axes.axhspan(1, 2, color="#e8e8e8", linewidth=0)
    axes.plot([row[1] for row in shown], [row[3] for row in shown], "o", markersize=3.5, alpha=0.6, markeredgewidth=0)
    for row in sorted(shown, key=lambda row: -row[3])[:6]:
        left = row[1] > 50  # of its point: the text stays within the frame
        axes.annotate(f"{row[0]} ({row[2]})", (row[1], row[3]), (-4 if left else 4, 3), textcoords="offset points",
                      fontsize=7, ha="right" if left else "left")
    axes.set(xscale="log", yscale="log", xlabel="rows", ylabel="time of auto / time of the fastest")
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})
    pyplot.close(figure)


def cone_picture(file, source):
    """Share of the problems that a method solves within a factor of the best time, one picture a tolerance."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    methods = source["columns"][2:]
    tolerances = sorted({row[0] for row in source["rows"]}, reverse=True)
    figure, axes = pyplot.subplots(1, len(tolerances), figsize=(4 * len(tolerances), 4), sharey=True, squeeze=False)
    for axis, tolerance in zip(axes[0], tolerances):
        rows = [row for row in source["rows"] if row[0] == tolerance]
        for i, method in enumerate(methods):
            axis.semilogx([row[1] for row in rows], [row[2 + i] for row in rows], drawstyle="steps-post", label=method,
                          linestyle="--" if "/" in method else "-", linewidth=2.5 if method == "auto" else 1)
        axis.set(title=f"residual ≤ {tolerance:g}", xlabel="time / best time", ylim=(0, 1.02))
        axis.grid(alpha=0.3)
    axes[0][0].set_ylabel("share of problems solved")
    axes[0][-1].legend(fontsize="x-small", loc="lower right")
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})
    pyplot.close(figure)


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
