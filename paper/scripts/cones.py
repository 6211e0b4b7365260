"""What the article says of friction cones: pyramids against discs, error and cost; solvers of problems with discs."""
import math
import tomllib
from statistics import median

from crank import FIGURES
from data import code, count, pick, rough, rows, tabular, tex, unit, words

TURNED = "8, turned"  # pyramids that turn until an edge points along the slip
TOLERANCE = "1e-08"  # of the comparison of solvers, as figures.toml writes it
RIVALS = ("siconos/", "pinocchio/")


def by_sides(sides):
    return pick(rows("facets"), sides=sides)


def errors(sides):
    return [row["error"] for row in by_sides(sides) if row["status"] == "solved"]


def cost(sides, **wanted):
    """Time of a solve over that with discs, the median."""
    return median(row["seconds"] / row["disc_seconds"] for row in pick(by_sides(sides), **wanted))


def methods():
    """Those that solve problems with discs: name and cells by column; the revision that was measured."""
    table = tomllib.loads(FIGURES.read_text(encoding="utf-8"))["cones"]
    return {row[0]: dict(zip(table["columns"], row)) for row in table["rows"]}, table["revision"]


def numbers(n):
    table = rows("facets")
    sides = sorted({row["sides"] for row in table if row["sides"] != TURNED})
    least, most = sides[0], sides[-1]
    contacts = {row["contacts"] for row in table}
    n["cones/problems"] = count(len(by_sides(least)))
    n["cones/contacts_least"], n["cones/contacts_most"] = tex(min(contacts), 1), tex(max(contacts), 2)
    n["cones/unanswered"] = words(len(table) - len(pick(table, status="solved")))
    n["cones/most"] = tex(most, 2)
    n["cones/most_error"], n["cones/most_cost"] = tex(median(errors(most))), rough(cost(most))
    n["cones/order"] = tex(math.log(median(errors(least)) / median(errors(most))) / math.log(most / least))
    n["cones/turned_error"], n["cones/turned_cost"] = tex(max(errors(TURNED)), 1), rough(cost(TURNED))
    pyramids = [row for row in rows("pyramids") if row["facets"] > 0]
    n["cones/bend"] = tex(max(row["exact_angle"] for row in pyramids))
    n["cones/bend_finest"] = tex(pyramids[-1]["exact_angle"])
    n["cones/facets_finest"] = tex(pyramids[-1]["facets"])
    n["cones/block_step"] = tex(1e3 * pyramids[0]["step"]) + unit("ms")
    for row in pyramids:
        if row["distance"] != row["exact_distance"] or row["angle"] != row["exact_angle"]:
            raise SystemExit(f"pyramids.csv, {row['facets']:.0f} facets: the path is not the exact one of the pyramid")
    found, revision = methods()
    rivals = {name: row for name, row in found.items() if name.startswith(RIVALS)}
    whole = [row for row in rivals.values() if row[f"to {TOLERANCE}"] == row["problems"]]
    times = [row[f"time, {TOLERANCE}"] for row in whole]
    n["cones/solver_problems"] = tex(found["auto"]["problems"])
    n["cones/auto_right"], n["cones/auto_time"] = (
        tex(found["auto"][f"to {TOLERANCE}"]),
        tex(found["auto"][f"time, {TOLERANCE}"]),
    )
    n["cones/rivals"], n["cones/rivals_whole"] = tex(len(rivals), 1), tex(len(whole), 1)
    n["cones/rival_least"], n["cones/rival_most"] = tex(min(times)), tex(max(times))
    n["cones/revision"] = code(revision)
    n["cones/tolerance"] = tex(float(TOLERANCE), 1)


def tables(t):
    lines = []
    for row in rows("pyramids"):
        facets = row["facets"]
        solves = ["--", "--", tex(1, 1)] if facets == 0 else \
            [tex(median(errors(facets))), tex(max(errors(facets))), rough(cost(facets))]
        lines.append(["disc" if facets == 0 else f"{tex(facets, 2 if facets > 9 else 1)} facets", *solves,
                      tex(row["distance"]), tex(row["angle"]), rough(row["milliseconds"])])
    head = [r"& \multicolumn{3}{c}{contact problems} & \multicolumn{3}{c}{block on a slope} \\",
            r"\cmidrule(lr){2-4}\cmidrule(l){5-7}"]
    t["cones"] = tabular("lrrrrrr", ["friction", "error", "largest", "time over disc's", "stops off [m]", "off by [°]",
                                     "run [ms]"], lines).replace(r"\toprule", "\n".join([r"\toprule", *head]))
