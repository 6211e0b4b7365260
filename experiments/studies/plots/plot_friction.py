"""Contact modes over time: reads modes_muX.csv, trajectories, from a folder; puts modes.csv and a picture as PNG, SVG
there."""
import csv

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Patch

from plotting import BLUE, GREY, RED, main, read_table, save

FACES = {"top": ("corner1", "corner2"), "bottom": ("corner3", "corner4")}
OPEN, SLIP, STICK = "open", "slip", "stick"
COLOURS = {OPEN: "#eeeeee", SLIP: BLUE, STICK: RED}
BRIDGED = 5  # steps without force that end no contact: experiments/sweep/case.cpp


def modes_of(path, mu, face):
    """(begin, end, mode, largest tilt of the slider) of one face: open; slip, where every corner that presses slides;
    stick."""
    impulses = [(path[corner + ".impulse_n"], np.abs(path[corner + ".impulse_t"])) for corner in FACES[face]]
    presses = [normal > 0 for normal, _ in impulses]
    slides = [tangent >= (1 - 1e-6) * mu * normal for normal, tangent in impulses]
    modes = np.full(path["t"].size, OPEN, dtype="<U5")
    modes[presses[0] | presses[1]] = SLIP
    modes[(presses[0] & ~slides[0]) | (presses[1] & ~slides[1])] = STICK
    edges = [0, *(np.flatnonzero(modes[1:] != modes[:-1]) + 1), modes.size]
    pieces = []
    for begin, end in zip(edges, edges[1:]):
        mode = modes[begin]
        if mode == OPEN and end - begin <= BRIDGED and pieces and end < modes.size:
            mode = pieces[-1][2]
        if pieces and pieces[-1][2] == mode:
            pieces[-1][1] = end
        else:
            pieces.append([begin, end, mode])
    times = path["t"]
    tilt = np.abs(path["slider.theta"])
    return [(times[max(0, begin - 1)], times[end - 1], mode, tilt[begin:end].max()) for begin, end, mode in pieces]


def plot_modes(folder, about):
    files = sorted(folder.glob("modes_mu*.csv"), key=lambda f: float(f.stem.removeprefix("modes_mu")))
    columns = [f"{corner}.impulse_{way}" for face in FACES.values() for corner in face for way in "nt"]
    rows = []
    for file in files:
        mu = float(file.stem.removeprefix("modes_mu"))
        path = read_table(file, [], ["t", "slider.theta", *columns])
        rows += [(mu, face, *piece) for face in FACES for piece in modes_of(path, mu, face)]
    with open(folder / "modes.csv", "w", newline="") as table:
        out = csv.writer(table, lineterminator="\n")
        out.writerow(["mu", "face", "begin", "end", "mode", "tilt"])
        out.writerows([mu, face, f"{begin:.6g}", f"{end:.6g}", mode, f"{tilt:.3g}"]
                      for mu, face, begin, end, mode, tilt in rows)
    page, axes = plt.subplots(figsize=(9, 5.6))
    draw_modes(axes, rows)
    page.tight_layout(rect=(0, 0.09, 1, 0.95))
    save(page, folder / "contact_modes", "Contact modes over time, by friction (e = 0.4)", about,
         [Patch(color=colour, label=mode) for mode, colour in COLOURS.items()])


def draw_modes(axes, rows):
    """A pair of strips for each friction: the slider's top face above its bottom face."""
    values = sorted({mu for mu, *_ in rows})
    for mu, face, begin, end, mode, _ in rows:
        low = values.index(mu) + (0.02 if face == "top" else -0.38)
        axes.broken_barh([(1e3 * begin, 1e3 * (end - begin))], (low, 0.36), color=COLOURS[mode],
                         zorder=1 + (mode != OPEN),
                         linewidth=0 if mode == OPEN else 0.7)  # an impact of one step is seen, too
    for i in range(len(values)):
        for low, face in ((0.2, "top"), (-0.2, "bottom")):
            axes.text(1.005, i + low, face, transform=axes.get_yaxis_transform(), va="center", fontsize=6.5, color=GREY)
    axes.set_yticks(range(len(values)), [f"{mu:g}" for mu in values])
    axes.set(xlabel="time [ms]", ylabel="friction µ", xlim=(0, 1e3 * max(end for *_, end, _, _ in rows)))
    axes.grid(visible=False)


if __name__ == "__main__":
    main(__doc__, "results/friction", (plot_modes,))
