"""Tables of performance figures, read from the results of measurements: a function yields (name, columns, rows)."""
import csv
import json
import math
import re
import statistics

GROUPS = {"definite": "symmetric positive definite", "semidefinite": "positive semidefinite",
          "P-matrix": "P, not symmetric", "grid": "obstacles on grids, sparse", "friction": "contacts with friction",
          "infeasible": "without solution (proof required)", "other": "games, options, known hard ones"}
NOT_COUNTED = {"enumerate"}  # an oracle for small ones
BEST = 3
TARGETS = ("1e-2", "1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8", "1e-9")  # errors of θ₁(0.2 s) [rad]
WELL = 0.4  # restitution up to which the motion of the slider-crank is well conditioned
OURS = ("auto", "lemke")
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


def identify(folder):
    """The three searches with derivatives and without: a row a method."""
    number = lambda text, factor=1: digits(factor * float(text), 6) if text not in ("-", "nan") else NONE  # noqa: E731
    counts = lambda row: [int(row["runs"]), int(row[with_derivatives])]  # noqa: E731
    with_derivatives = "runs with J"
    yield "identify_fit", ["method", "μ", "e", "c, mm", "cost", "runs", "runs with derivatives"], \
        [[row["method"], number(row["mu"]), number(row["e"]), number(row["c [m]"], 1e3), number(row["cost"]),
          *counts(row)] for row in rows_of(folder / "fit.csv")]
    with_derivatives = "runs with derivatives"
    yield "identify_contact_loss", ["method", "μ", "rad/s", "error", "runs", with_derivatives, "ms"], \
        [[row["method"], number(row["mu"]), float(row["crank speed [rad/s]"]), number(row["error"]), *counts(row),
          number(row["seconds"], 1e3)] for row in rows_of(folder / "contact_loss.csv")]
    yield "identify_shot", ["shot", "method", "miss, m", "runs", with_derivatives, "ms"], \
        [[row["shot"], row["method"], number(row["miss [m]"]), *counts(row), number(row["seconds"], 1e3)]
         for row in rows_of(folder / "shot.csv")]
