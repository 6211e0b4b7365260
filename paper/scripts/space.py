"""What the article says of space and of derivatives: limits of closing clearances, other programs, gradients of
steps."""
from data import code, pick, rows, tabular, tex, unit

FAMILIES = {"socket at the slider": ("socket", "ball in a socket of the slider"),
            "channel": ("channel", "slider in a channel"),
            "socket at the crank, 5 s": ("crank", "ball at the crank, published end")}
GOALS = (1e-2, 1e-3, 1e-4, 1e-6)
PROGRAMS = {"orthant": "Orthant", "mujoco": "MuJoCo", "drake": "Drake", "exudyn": "Exudyn", "siconos": "Siconos"}
SCENES = {"masse": "ball", "bounces": "bouncing ball", "slider_crank": "spatial slider-crank"}


def limits():
    """By family without friction: rows of (clearance, distance, order), the largest clearance first."""
    table = pick(rows("slider_crank_space.closing"), mu=0.0)
    return {key: pick(table, family=name) for name, (key, _) in FAMILIES.items()}


def least_time(runs, goal):
    """Of the setting from which on all finer ones reach it."""
    reached = []
    for row in sorted(runs, key=lambda row: row["at"]):
        if row["error"] is None or row["error"] > goal:
            break
        reached.append(row["seconds"])
    return min(reached) if reached else None


def scenes():
    """Those of the comparison that the data have."""
    return [scene for scene in SCENES if pick(rows("space_peers"), scene=scene)]


def settings(scene):
    own = pick(rows("space_peers"), scene=scene)
    return {key: [row for row in own if (row["program"], row["setting"]) == key]
            for key in dict.fromkeys((row["program"], row["setting"]) for row in own)}


def numbers(n):
    for key, found in limits().items():
        n[f"space/{key}_order"] = tex(found[-1]["order"], 2)
        n[f"space/{key}_clearance"] = tex(1e6 * found[-1]["clearance"], 3) + unit(r"\mu m")
        n[f"space/{key}_distance"] = tex(found[-1]["distance"], 2) + unit("m")
    by_step = {row["step"]: row for row in rows("gradients")}
    exact = by_step.pop(0.0)
    finest = by_step[min(by_step)]
    n["grad/h"] = tex(min(by_step), 1) + unit("s")
    n["grad/exact_clearance"] = tex(exact["clearance"], 4) + unit("rad/m")
    n["grad/theta_error"] = tex(abs(finest["theta"] - exact["theta"]), 1) + unit("rad")
    for key in ("mu", "e"):
        n[f"grad/exact_{key}"], n[f"grad/fixed_{key}"] = tex(exact[key], 4), tex(finest[key], 4)
        n[f"grad/off_{key}"] = tex(100 * abs(finest[key] / exact[key] - 1), 2) + r"\,\%"
    for scene in scenes():
        rivals = [r["error"] for (program, _), runs in settings(scene).items() for r in runs
                  if program != "orthant" and r["error"] is not None]
        n[f"space/{scene}_rival"] = tex(min(rivals), 2) + unit("m")
        if scene == "bounces":  # its time is that of the clock
            continue
        n[f"space/{scene}_adaptive"] = tex(1e3 * least_time(settings(scene)["orthant", "adaptive"], 1e-6),
                                           2) + unit("ms")


def tables(t):
    body = []
    for i, scene in enumerate(scenes()):
        body += [r"\midrule"] if i else []
        for (program, setting), runs in settings(scene).items():
            good = [row["error"] for row in runs if row["error"] is not None]
            cells = [least_time(runs, goal) for goal in GOALS]
            body.append([
                SCENES[scene], f"{PROGRAMS[program]}, {code(setting) if program == 'orthant' else setting}",
                tex(min(good), 1) if good else "--", *("--" if s is None else tex(1e3 * s, 2) for s in cells),
                str(len(runs) - len(good) or "--")
            ])
    t["space"] = tabular("llrrrrrr", ["motion", "by", "least [m]", *(f"to {tex(g, 1)}" for g in GOALS), "failed"], body)
    lines = []
    for name, (key, words) in FAMILIES.items():
        for row in limits()[key][-4:]:
            lines.append([words, tex(1e3 * row["clearance"], 3), tex(row["distance"], 2), tex(row["order"], 2)])
            words = ""
    t["closing"] = tabular("lrrr", ["clearance of", "[mm]", "distance [m]", "order"], lines)
