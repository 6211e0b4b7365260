"""Performance figures on the pages of the site: tables as CSV files, with the line of their origin, and pictures."""
import csv

from figure_tables import NONE, digits

CONES = """\
Contact problems with friction discs: two files of FCLIB and time steps of five scenes in space, by Orthant's solvers,
by Siconos (`siconos/…`) and by Pinocchio. One measure for all: the scale-free residual
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


def where_and_when(table):
    return f"Measured at revision `{table['revision']}`, {table['date']}, on {table['machine']}.\n"


def pages(to, tables):
    """The tables that pages of the site include, with the line of their origin."""
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
