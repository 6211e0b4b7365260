"""Draws the slider-crank sweep: reads the tables that experiments/run wrote into a folder; puts PNG, SVG there."""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from plotting import BLUE, GREEN, GREY, ORANGE, PINK, RED, main, read_table, save, select

FREE, TOP, BOTTOM = 0, 1, 2
PHASES = {FREE: ("free flight", GREY), TOP: ("top contact", RED), BOTTOM: ("bottom contact", BLUE)}
FACES = {TOP: ("corner1", "corner2", 1.0), BOTTOM: ("corner3", "corner4", -1.0)}  # corners, y of centre at contact [mm]
FRICTIONS = {0.0: GREEN, 0.01: ORANGE, 0.1: PINK}  # the trajectories, all of e = 0.4
INTEGRATORS = {"moreau-jean:joints=position": ("classical joints", ORANGE, "o"),
               "moreau-jean:joints=symmetric": ("symmetric joints", BLUE, "s")}
ERROR = "|error of θ₁(0.2 s)| [rad]"


def read_trajectory(folder, mu):
    """Adds contact phases and the list of touches: (first record, last record, phase, impulse on arrival [N s])."""
    parts = [corner + part for face in FACES.values() for corner in face[:2] for part in (".gap", ".impulse_n")]
    path = read_table(folder / f"trajectory_mu{mu:g}_e0.4.csv", [], ["t", "slider.y", "crank.theta", "energy", *parts])
    path |= {"ms": 1e3 * path["t"], "mm": 1e3 * path["slider.y"], "turns": path["crank.theta"] / (2 * np.pi)}
    path |= {"phase": np.full(path["t"].size, FREE), "touches": []}
    for phase, (left, right, _) in FACES.items():
        impulse = path[left + ".impulse_n"] + path[right + ".impulse_n"]
        hit = impulse > 1e-12  # [N s]
        touching = hit | (np.minimum(path[left + ".gap"], path[right + ".gap"]) < 2e-8)  # [m] chatter ends no contact
        edges = np.flatnonzero(np.diff(np.concatenate([[0], touching.astype(int), [0]])))
        for begin, end in edges.reshape(-1, 2):
            hits = begin + np.flatnonzero(hit[begin:end])
            if hits.size:
                path["touches"].append((hits[0], hits[-1], phase, impulse[hits[:2]].sum()))  # records may split it
                path["phase"][hits[0]:hits[-1] + 1] = phase
    return path


def draw_mechanism(axes):
    """The linkage at a crank angle of 50°, in mm and to scale except for the clearance."""
    for wall in (-38, 38):
        axes.fill_between([325, 475], wall, 1.3 * wall, color="#bbbbbb", linewidth=0)
    axes.fill([332, 432, 432, 332], [-21, -21, 29, 29], facecolor="#d9ecf8", edgecolor="black", linewidth=1.3)
    axes.plot([0, 98], [0, 117], color=ORANGE, linewidth=5)
    axes.plot([98, 382], [117, 4], color=GREEN, linewidth=4)
    axes.plot([0, 98, 382], [0, 117, 4], "o", markersize=8, color="white", markeredgecolor="black")
    arc = np.radians([*range(50, -1, -1)])
    axes.plot([*60 * np.cos(arc), 0, 90], [*60 * np.sin(arc), 0, 0], color=GREY, linewidth=0.9, zorder=0)
    for x, y, text in ((64, 24, "θ₁"), (-30, 78, "crank\n153 mm"), (225, 82, "rod 306 mm"), (438, 0, "slider"),
                       (70, -76, "clearance 1 mm above and below (drawn wider)")):
        axes.text(x, y, text)
    axes.set(xlim=(-35, 490), ylim=(-90, 140), aspect="equal", title="Slider-crank with clearance")
    axes.axis("off")


def draw_path(axes, path, x, area):
    ends = [0, *np.flatnonzero(np.diff(path["phase"])), path["t"].size - 1]
    for begin, end in zip(ends, ends[1:]):
        phase, piece = path["phase"][end], slice(begin, end + 1)
        axes.plot(path[x][piece], path["mm"][piece], color=PHASES[phase][1], linewidth=(1.6, 3.5, 3.5)[phase], zorder=3)
    for *_, wall in FACES.values():
        axes.axhspan(wall, 2 * wall, color="#e6e6e6", linewidth=0)
        axes.axhline(wall, color="black", linewidth=1.1)
    for first, _, phase, impulse in path["touches"]:
        axes.scatter(path[x][first], FACES[phase][2], s=area * impulse, color=PHASES[phase][1], linewidth=0, zorder=4)
    axes.set_ylabel("slider's centre y [mm]")


def plot_slider_path(folder, about):
    path, area = read_trajectory(folder, 0.01), 1200  # [pt² per N s] of an impact's dot
    figure, panels = plt.subplot_mosaic("mmmffff;wwwwwww", figsize=(11, 6.8))
    figure.subplots_adjust(left=0.06, right=0.985, top=0.9, bottom=0.15, hspace=0.36, wspace=0.9)
    first, whole = panels["f"], panels["w"]
    draw_mechanism(panels["m"])
    draw_path(first, path, "ms", area)
    first.set(xlim=(0, 16), ylim=(0, 1.1), xlabel="time [ms]", title="First impacts, rest, release (magnified)")
    for begin, end, *_ in [touch for touch in path["touches"] if touch[1] - touch[0] > 2][:1]:
        for at, text in ((path["ms"][begin], "impacts accumulate\nat about"), (path["ms"][end], "release\nat about")):
            first.annotate(f"{text} {at:.0f} ms", (at, 0.98), (min(at, 14.3), 0.55), ha="center",
                           arrowprops={"arrowstyle": "->", "color": GREY}, annotation_clip=True)
    draw_path(whole, path, "turns", area)
    whole.set(xlim=(0, path["turns"].max()), ylim=(-1.2, 1.2), xlabel="crank angle θ₁ [revolutions]",
              title="The whole motion, 0.2 s")
    handles = [Line2D([], [], color=colour, linewidth=2.5, label=label) for label, colour in PHASES.values()]
    handles += [Line2D([], [], color=GREY, marker="o", linewidth=0, markersize=np.sqrt(area * impulse),
                       markeredgewidth=0, label=f"impact of {impulse:g} N s") for impulse in (0.1, 0.01)]
    save(figure, folder / "slider_path", "The slider's way through its clearance: µ = 0.01, e = 0.4", about, handles)


def draw_errors(axes, runs, orders):
    """One problem: every run a dot, the worst of each octave of h a line, failed runs crosses at the top."""
    for integrator in INTEGRATORS:
        label, colour, marker = INTEGRATORS[integrator]
        part = select(runs, runs["integrator"] == integrator)
        failed, part = select(part, part["status"] != "solved"), select(part, part["error"] > 0)
        label += "".join(f": order {order:.2f}" for order in orders["order"][orders["integrator"] == integrator])
        label += f", {failed['step'].size} failed" if failed["step"].size else ""
        octave = np.floor(np.log2(part["step"].max(initial=0) * 1.001 / part["step"]))  # as the order was fitted
        worst = [np.flatnonzero(octave == o)[np.argmax(part["error"][octave == o])] for o in np.unique(octave)]
        axes.plot(1e6 * part["step"], part["error"], ".", markersize=3.5, color=colour, alpha=0.4, markeredgewidth=0)
        axes.plot(1e6 * part["step"][worst], part["error"][worst], marker=marker, markersize=4, color=colour,
                  label=label)
        axes.plot(1e6 * failed["step"], 0.97 + 0 * failed["step"], "x", color=colour,
                  transform=axes.get_xaxis_transform())


def plot_error_vs_step(folder, about):
    table = read_table(folder / "sweep.csv", ["integrator", "solver", "status"],
                       ["mu", "e", "step", "error", "repeats"])
    keep = np.isin(table["integrator"], list(INTEGRATORS)) & (table["repeats"] == 0) & (table["solver"] == "lemke")
    table = select(table, keep)
    orders = read_table(folder / "orders.csv", ["integrator"], ["mu", "e", "order"])
    errors = table["error"][table["error"] > 0]
    low, high = np.quantile(errors, 0.005) / 20, 300 * errors.max()  # the few luckiest runs set no scale; room on top
    mus, es, start = np.unique(table["mu"]), np.unique(table["e"]), 1e6 * table["step"].max() / 12
    figure, grid = plt.subplots(es.size, mus.size, sharex=True, sharey=True, squeeze=False, figsize=(11, 9.2))
    for (row, column), axes in np.ndenumerate(grid):
        mu, e = mus[column], es[row]
        draw_errors(axes, *(select(t, (t["mu"] == mu) & (t["e"] == e)) for t in (table, orders)))
        for order in (1, 2):
            axes.plot([start, 6 * start], [2 * low, 2 * low * 6**order], color=GREY, linewidth=0.9, linestyle="--")
            axes.text(6.2 * start, 2 * low * 6**order, f"order {order}", fontsize=7.5, color=GREY, va="center")
        axes.legend(loc="upper left", bbox_to_anchor=(0, 0.95), borderaxespad=0.2)
        axes.set(xscale="log", yscale="log", ylim=(low, high), xlabel="step size h [µs]", ylabel=ERROR,
                 title=f"µ = {mu:g}, e = {e:g}" + (" (ill-conditioned)" if e > 0.8 else ""))
        axes.label_outer()
    text = (f"Dots: every run, {np.sum(errors < low)} below the frame. Lines: worst of each octave of h, and its order."
            "\ne = 0.9: after about 0.14 s the motion itself magnifies small errors; no clean order can be expected.")
    figure.text(0.06, 0.015, text, fontsize=8.5, color=GREY)
    figure.tight_layout(rect=(0, 0.045, 1, 0.965))
    save(figure, folder / "error_vs_step", "Error against step size", about)


def plot_energy(folder, about):
    paths = {mu: read_trajectory(folder, mu) for mu in FRICTIONS}
    figure, panels = plt.subplot_mosaic(3 * "wwwwwww..fffff;" + "sssssss..fffff", figsize=(11.5, 5.8))
    figure.subplots_adjust(left=0.07, right=0.985, top=0.88, bottom=0.17, hspace=0.22, wspace=0.5)
    whole, first, strips = (panels[key] for key in "wfs")
    for level, (mu, path) in enumerate(paths.items()):
        ms, energy = path["ms"], path["energy"]
        whole.plot(ms, energy, color=FRICTIONS[mu])
        first.plot(ms[ms <= 16], energy[ms <= 16], color=FRICTIONS[mu], label=f"µ = {mu:g}")
        whole.annotate(f"µ = {mu:g}: {energy[-1]:.2f} J", (ms[-1], energy[-1]), (4, -3), textcoords="offset points")
        for begin, end, phase, _ in path["touches"]:
            strips.vlines(ms[begin], level - 0.36, level + 0.36, color=PHASES[phase][1], linewidth=0.8)
            strips.barh(level, ms[end] - ms[begin], 0.72, ms[begin], color=PHASES[phase][1], alpha=0.45, linewidth=0)
            for axes in (whole, first) if mu == 0.01 else ():
                axes.axvspan(ms[begin], ms[end], color=PHASES[phase][1], alpha=0.1, linewidth=0)
    whole.set(ylabel="energy [J]", title="The whole motion", xlim=(0, ms[-1]))
    whole.tick_params(labelbottom=False)
    strips.set(yticks=range(len(paths)), yticklabels=[f"µ = {mu:g}" for mu in paths], ylim=(2.5, -0.5),
               xlim=(0, ms[-1]), xlabel="time [ms]")
    first.set(xlim=(0, 16), xlabel="time [ms]", ylabel="energy [J]", title="First impacts (magnified)")
    first.legend(loc="lower left")
    handles = [Line2D([], [], color=PHASES[p][1], linewidth=9, alpha=0.45, label=PHASES[p][0]) for p in FACES]
    handles.append(Line2D([], [], color=GREY, marker="|", markersize=10, linewidth=0, label="impact"))
    title = "Energy, lost at impacts and to friction: e = 0.4; shaded where µ = 0.01 keeps contact"
    save(figure, folder / "energy", title, about, handles)


if __name__ == "__main__":
    main(__doc__, "results/slider_crank", (plot_slider_path, plot_error_vs_step, plot_energy))
