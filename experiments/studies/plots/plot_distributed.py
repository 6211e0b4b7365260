"""Models obstacle problems on many ranks of MPI: reads runs.csv and network.csv, which distributed wrote into a folder;
puts model.csv, PNG, SVG there.

Time of a Newton iteration on P ranks, for the rows a rank that were measured on 1 and 2 ranks:
  T(P) = T_local + (F_b bytes / bandwidth + F_m messages latency) + collectives ceil(log2 P) latency
T_local: processor time of one rank alone. bytes, messages, collectives of rank 0 of two, one Newton iteration; of two
ranks each has one neighbour and one side of its part is halo. On P ranks an inner rank has
  rows of the grid one after the other (strips):  2 neighbours, F_m = 2;  F_b = 2 sqrt(P / 2), as the sides grow
  nodes numbered square by square (blocks):       4 neighbours, F_m = 4;  F_b = 4 sqrt(m) / sqrt(2 m) = 2.83
and levels of the multigrid method add log4(P / 2) to those that two ranks have, each with messages and collectives of a
level of before.
"""
import csv
import math

import matplotlib.pyplot as plt
import numpy as np

from plotting import BLUE, GREEN, ORANGE, RED, main, read_table, save, select

# Assumed, not measured: a network of 100 Gbit/s with 1.5 µs a message.
CLUSTER = {"latency": 1.5e-6, "bandwidth": 12.5e9}
RANKS = [2, 4, 8, 16, 32, 64, 128, 256, 512, 1000]
COLOURS = {"ball": RED, "journal": BLUE, "torsion": GREEN, "space": ORANGE}
NUMBERS = ["side", "n", "ranks", "rows_per_rank", "iterations", "krylov", "cpu_s", "halo_entries", "messages", "bytes",
           "collectives", "memory_mb"]


def time_of_iteration(local, two, ranks, network, layout, rows):
    """[s]; `two`: of an iteration on two ranks."""
    coarse = math.log(max(ranks / 2, 1), 4)
    levels = max(math.log(2 * rows, 4), 1)
    deeper = 1 + coarse / levels
    factor_b = 2 * math.sqrt(ranks / 2) if layout == "strips" else 4 / math.sqrt(2)
    factor_m = 2 if layout == "strips" else 4
    if ranks == 2:
        factor_b = factor_m = 1
    halo = factor_b * two["bytes"] / network["bandwidth"] + factor_m * deeper * two["messages"] * network["latency"]
    return {"local_s": local, "halo_s": halo,
            "collectives_s": deeper * two["collectives"] * math.ceil(math.log2(ranks)) * network["latency"]}


def weak_pairs(table):
    """Runs on one rank and on two with the same rows a rank, within 2 %: the largest of each problem and method."""
    pairs = {}
    for k in np.flatnonzero((table["ranks"] == 1) & (table["status"] == "solved")):
        for l in np.flatnonzero((table["ranks"] == 2) & (table["status"] == "solved")):
            same = table["problem"][k] == table["problem"][l] and table["options"][k] == table["options"][l]
            if same and abs(table["rows_per_rank"][l] / table["rows_per_rank"][k] - 1) < 0.02:
                key = (table["problem"][k], table["options"][k])
                if key not in pairs or table["n"][k] > table["n"][pairs[key][0]]:
                    pairs[key] = (k, l)
    return pairs


def plot_distributed(folder, about):
    table = read_table(folder / "runs.csv", ["problem", "options", "status"], NUMBERS)
    measured = {row["quantity"]: float(row["value"]) for row in csv.DictReader(open(folder / "network.csv"))}
    machine = {"latency": measured["message of 8 bytes"], "bandwidth": measured["bandwidth"]}
    rows = []
    for (problem, options), (k, l) in weak_pairs(table).items():
        if problem == "space":
            continue  # halos of layers grow otherwise
        local = table["cpu_s"][k] / table["iterations"][k]
        two = {name: table[name][l] / table["iterations"][l] for name in ("bytes", "messages", "collectives")}
        for network, speeds in (("this machine", machine), ("100 Gbit/s, 1.5 us (assumed)", CLUSTER)):
            for layout in ("strips", "blocks"):
                for ranks in RANKS:
                    parts = time_of_iteration(local, two, ranks, speeds, layout, table["rows_per_rank"][k])
                    total = sum(parts.values())
                    rows.append({"problem": problem, "options": options, "network": network, "layout": layout,
                                 "ranks": ranks, "rows_per_rank": int(table["rows_per_rank"][k]), **parts,
                                 "total_s": total, "efficiency": local / total})
    with open(folder / "model.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]) if rows else ["problem"], lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: f"{value:.4g}" if isinstance(value, float) else value for key, value in row.items()}
                         for row in rows)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.4))
    for problem, colour in COLOURS.items():
        for ranks, marker in ((1, "o"), (2, "s")):
            part = select(table, (table["problem"] == problem) & (table["options"] == "") & (table["ranks"] == ranks))
            if len(part["n"]):
                order = np.argsort(part["n"])
                left.plot(part["n"][order], part["iterations"][order], color=colour, marker=marker, markersize=5,
                          label=f"{problem}, {ranks} rank{'s' * (ranks > 1)}")
        for layout, style in (("strips", ":"), ("blocks", "-")):
            part = [row for row in rows if row["problem"] == problem and row["options"] == ""
                    and row["layout"] == layout and row["network"] != "this machine"]
            if part:
                right.plot([row["ranks"] for row in part], [row["efficiency"] for row in part], style, color=colour,
                           label=f"{problem}, {layout}")
    left.set(xscale="log", xlabel="rows n", ylabel="Newton iterations, reduced space", ylim=(0, None))
    right.set(xscale="log", xlabel="ranks, equal rows each (model)", ylabel="efficiency of an iteration",
              ylim=(0, 1.05))
    left.legend()
    right.legend()
    figure.tight_layout(rect=(0, 0.03, 1, 0.95))
    save(figure, folder / "distributed", "Obstacle problems over the ranks of MPI", about)


if __name__ == "__main__":
    main(__doc__, "results/distributed", (plot_distributed,))
