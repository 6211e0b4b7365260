"""Tables and pictures of contacts.csv: time to what is achieved, each program compared with Orthant."""
import csv
import math

GOALS = {"pile": (1e-1, 3e-2, 1e-2, 1e-3), "chain": (1e-2, 1e-3, 1e-4, 1e-6), "stack": (1e-1, 1e-2, 1e-3, 1e-6),
         "tower": (1e-1, 1e-2, 1e-3, 1e-6)}
MEASURE = {"pile": "law or overlap / radius", "chain": "error of the end / length",
           "stack": "way of a corner / edge", "tower": "way of a corner / least edge"}
FURTHER = {"pile": ("law", "overlap"), "chain": ("joints", "energy"), "stack": ("law",), "tower": ("law",)}
NAMES = {"orthant": "Orthant", "mujoco": "MuJoCo", "drake": "Drake", "dart": "DART", "bullet": "Bullet",
         "exudyn": "EXUDYN", "siconos": "Siconos", "pinocchio": "Pinocchio", "newton": "Newton"}
COLOURS = {"orthant": "black", "mujoco": "tab:red", "drake": "tab:blue", "dart": "tab:orange", "bullet": "tab:green",
           "exudyn": "tab:brown", "siconos": "tab:purple", "pinocchio": "tab:cyan", "newton": "tab:gray"}
MARKERS = {"orthant": "o", "mujoco": "s", "drake": "^", "dart": "P", "bullet": "X", "exudyn": "v", "siconos": "d",
           "pinocchio": "p", "newton": "*"}
NONE = "–"
AHEAD = 2  # times
LEAST = 1e-12  # of errors in pictures: what is below is rounding
NUMBERS = ("step", "seconds", "a_step", "error", "law", "overlap", "joints", "energy", "unexplained", "contacts")


def read(file):
    """Numbers as numbers, "" where there is none."""
    with open(file, encoding="utf-8", newline="") as stream:
        return [row | {k: float(row[k]) for k in NUMBERS if row[k] != ""} for row in csv.DictReader(stream)]


def unique(values):
    return list(dict.fromkeys(values))


def cheapest(runs, goal):
    """Of one setting the run with the least time, of the steps that reach the goal and whose finer ones do, too."""
    reached = []
    for row in sorted(runs, key=lambda row: row["step"]):
        if row["error"] == "" or row["error"] > goal:
            if row["failure"].startswith("more than"):
                continue  # too fine a step to end is no evidence against a coarser one
            break
        reached.append(row)
    return min(reached, key=lambda row: row["seconds"], default=None)


def best(rows, program, goal):
    """Of all settings of a program."""
    own = [row for row in rows if row["program"] == program]
    runs = [cheapest([row for row in own if row["setting"] == setting], goal) for setting in
            unique(row["setting"] for row in own)]
    return min((run for run in runs if run is not None), key=lambda row: row["seconds"], default=None)


def least(rows, column):
    return min((row[column] for row in rows if row[column] != ""), default=None)


def cell(run, own):
    if run is None:
        return NONE
    times = f" (× {run['seconds'] / own['seconds']:.2g})" if own is not None and run is not own else ""
    return f"{1e3 * run['seconds']:.3g}{times}, {run['setting']}, {1e3 * run['step']:g}"


def table(rows):
    """A row a program."""
    name = rows[0]["scene"]
    lines = [f"| {name} of {rows[0]['size']} | least error | " +
             " | ".join([*(f"to {goal:g}" for goal in GOALS[name]), *(f"least {c}" for c in FURTHER[name])]) + " |",
             "|---" * (len(GOALS[name]) + len(FURTHER[name]) + 2) + "|"]
    for program in unique(row["program"] for row in rows):
        own = [row for row in rows if row["program"] == program]
        if all(row["error"] == "" for row in own):
            why = "; ".join(unique(row["failure"].split(":")[-1].strip() for row in own))
            lines.append(f"| {NAMES[program]} | {why} " + "| " * (len(GOALS[name]) + len(FURTHER[name])) + "|")
            continue
        figures = [f"{value:.1e}" if (value := least(own, column)) is not None else NONE
                   for column in ("error", *FURTHER[name])]
        lines.append("| " + " | ".join([NAMES[program], figures[0], *(
            cell(best(rows, program, goal), best(rows, "orthant", goal)) for goal in GOALS[name]), *figures[1:]]) +
                     " |")
    return "\n".join(lines) + "\n"


def behind(rows):
    """(scene, goal, program, time over Orthant's) where a program takes less than AHEAD times Orthant's time."""
    for name in unique(row["scene"] for row in rows):
        own = [row for row in rows if row["scene"] == name]
        for goal in GOALS[name]:
            ours = best(own, "orthant", goal)
            for program in unique(row["program"] for row in own if row["program"] != "orthant"):
                theirs = best(own, program, goal)
                if theirs is not None and (ours is None or theirs["seconds"] < AHEAD * ours["seconds"]):
                    yield name, goal, program, theirs["seconds"] / ours["seconds"] if ours is not None else None


def behind_table(rows):
    lines = ["| scene | to | program | its time / Orthant's |", "|---|---|---|---|"]
    lines += [f"| {name} | {goal:g} | {NAMES[program]} | {f'{times:.2g}' if times is not None else 'only it'} |"
              for name, goal, program, times in behind(rows)]
    return "\n".join(lines) + "\n"


def failures(rows):
    """A line a setting with runs that failed."""
    lines = ["| scene | program | setting | steps [ms] | why |", "|---|---|---|---|---|"]
    failed = [row for row in rows if row["failure"] and row["step"] != ""]
    for key in unique((row["scene"], row["program"], row["setting"], why_of(row)) for row in failed):
        steps = [row["step"] for row in failed if (row["scene"], row["program"], row["setting"], why_of(row)) == key]
        to = f" to {1e3 * min(steps):g}" if len(steps) > 1 else ""
        lines.append(f"| {key[0]} | {NAMES[key[1]]} | {key[2]} | {1e3 * max(steps):g}{to} | {key[3]} |")
    return "\n".join(lines) + "\n"


def why_of(row):
    """Without figures that differ from step to step."""
    why = row["failure"].split(" at t = ")[0].split(" at simulation time")[0]
    return why.removeprefix("step 1: ").replace("|", "/")


def front(points):
    """Of (time, error) those that no other one beats in both, by time."""
    kept, low = [], math.inf
    for seconds, error in sorted(points):
        if error < low:
            kept.append((seconds, error))
            low = error
    return kept


def draw(rows, file):
    """Work and precision of a scene: each run a point, the best of each program joined."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    name = rows[0]["scene"]
    figure, axes = pyplot.subplots(figsize=(8, 4.8))
    for program in unique(row["program"] for row in rows):
        points = [(row["seconds"], max(row["error"], LEAST)) for row in rows
                  if row["program"] == program and row["error"] != "" and row["error"] < 1e2]
        if not points:
            continue
        ours, colour = program == "orthant", COLOURS[program]
        axes.plot(*zip(*points), MARKERS[program], color=colour, markersize=3.5, alpha=0.3, markeredgewidth=0)
        axes.plot(*zip(*front(points)), MARKERS[program] + "-", color=colour, markersize=6 if ours else 5,
                  linewidth=2.5 if ours else 1.3, label=NAMES[program], zorder=3 if ours else 2)
    axes.set(xscale="log", yscale="log", xlabel="processor time for a second of motion [s]", ylabel=MEASURE[name],
             title=f"{name} of {rows[0]['size']}")
    axes.grid(alpha=0.3)
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    figure.tight_layout()
    figure.savefig(file, **({"dpi": 150} if str(file).endswith("png") else {"metadata": {"Date": None}}))
    pyplot.close(figure)


def by_scene(rows):
    return {name: [row for row in rows if row["scene"] == name] for name in unique(row["scene"] for row in rows)}


def text(rows):
    parts = [table(own) for own in by_scene(rows).values()]
    return "\n".join([*parts, f"Where Orthant is not ahead by {AHEAD} ×:\n", behind_table(rows), "Failed runs:\n",
                      failures(rows)])
