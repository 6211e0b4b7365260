"""A sweep over several scenes: what drifts and what does not, each scene's own duration, times to an error. drifts.py
ORTHANT"""
import csv
import io
import subprocess
import sys
import tempfile
from pathlib import Path

SCENES = Path(__file__).resolve().parents[2] / "experiments/studies/scenes"
SWEEP = f"""
[[grid]]
scene = "{SCENES}/floating_box.toml"
integrator = ["event-driven", "stewart-trinkle"]
duration = 2
[[grid]]
scene = ["chain", "pendulum"]
integrator = "rattle"
duration = 0.5
step = [1e-2, 5e-3]
repeats = 1
"""


def table(orthant, folder, *options):
    run = subprocess.run([orthant, *options], cwd=folder, capture_output=True, text=True, check=True)
    return list(csv.DictReader(io.StringIO(run.stdout)))


def main(orthant):
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "s.sweep.toml").write_text(SWEEP)
        subprocess.run([orthant, "sweep", "s.sweep.toml", "--results", "r.sqlite"], cwd=folder, capture_output=True,
                       check=True)
        rows = table(orthant, folder, "results", "r.sqlite", "--csv")
        assert [Path(row["scene"]).stem
                for row in rows] == 2 * ["floating_box"] + 2 * ["chain"] + 2 * ["pendulum"], rows
        assert all(row["status"] == "solved" for row in rows), rows
        exact, stepped, *held = rows
        for row in (exact, stepped):  # nothing acts from outside; friction and e < 1 inside
            assert (
                float(row["duration"]) == 2
                and float(row["momentum_drift"]) < 1e-13
                and float(row["energy_drift"]) > 0.1
            ), row
        assert float(exact["spin_drift"]) < 1e-9 < 1e-5 < float(stepped["spin_drift"]) < 0.1, (exact, stepped)
        for row in held:  # by the ground: only energy is kept
            assert row["momentum_drift"] == row["spin_drift"] == "" and float(row["duration"]) == 0.5, row
        for coarse, fine in zip(held[::2], held[1::2]):  # of second order
            assert 3 < float(coarse["energy_drift"]) / float(fine["energy_drift"]) < 5, (coarse, fine)
    print("drifts of energy, momentum and spin are told")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
