"""The comparison in space: its truth, Orthant's own rows, the others that are installed, and the rule of its table.

space_benchmark.py ORTHANT. The other programs run with the Python of experiments/benchmarks/setup, where it is.
"""
import csv
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "experiments/benchmarks/space/space.py"
PEERS = Path(os.environ.get("ORTHANT_PEERS", ROOT / "build/peers"))
sys.path.insert(0, str(SCRIPT.parent))
import model_siconos  # noqa: E402
import space  # noqa: E402

# error of the second coarsest value of a setting: of a first-order method, or of soft contact
OTHERS = {("masse", "mujoco", "defaults"): 4e-3, ("masse", "mujoco", "stiff"): 1e-2,
          ("bounces", "mujoco", "fitted"): 2e-2, ("masse", "exudyn", "trapezoidal-index-2"): 4e-3,
          ("slider_crank", "exudyn", "generalized-alpha"): 4e-4, ("bounces", "exudyn", "dopri5"): 1e-3,
          ("masse", "siconos", "nsgs"): 4e-2, ("masse", "siconos", "nsn-ac"): 4e-2,
          ("bounces", "siconos", "nsgs"): 4e-3, ("bounces", "siconos", "nsn-ac"): 4e-3,
          ("masse", "drake", "discrete, sap"): 4e-3, ("masse", "drake", "CENIC"): 1e-3,
          ("bounces", "drake", "discrete, similar"): 4e-2}


def row(at, error):
    return {
        "scene": "masse", "program": "x", "setting": "y", "swept": "step", "at": at, "seconds": 1 / at, "error": error,
        "failure": "" if error != "" else "it broke"
    }


def main(orthant):
    place = space.masse_end(0.6147302241381)  # where it begins to roll, and its velocity then: core/scenes/masse.h
    assert math.dist(place, (0.275969961, 0.150564996)) < 1e-8, place
    rolled = space.masse_end(1.6147302241381) - place
    assert math.dist(rolled, (-0.102142857, 0.489857143)) < 1e-8, rolled

    lines = space.table([row(1e-1, 1e-4), row(1e-2, 5e-2), row(1e-3, 5e-3), row(1e-4, "")]).splitlines()
    assert lines[-1] == "| x | y | 1.0e-04 | – | – | – | – | – | 1: it broke |", lines[-1]
    lines = space.table([row(1e-1, 1e-4), row(1e-2, 5e-2), row(1e-3, 5e-3), row(1e-4, 6e-4)]).splitlines()
    assert lines[-1] == "| x | y | 1.0e-04 | 1e+06 | 1e+07 | – | – | – | 0 |", lines[-1]

    truth_of_impacts()
    rows = run(sys.executable, orthant, "orthant")
    assert len(rows) == 36 and not any(r["failure"] for r in rows), rows
    finest = {(r["scene"], r["setting"]): float(r["error"]) for r in rows}  # the last of each
    for key, error in finest.items():
        least = 5e-4 if key[0] == "bounces" else 1e-4  # an impact is within a step
        assert error < (1e-7 if key[1] in ("adaptive", "event-driven") else least), (key, error)
    absent()
    others(orthant)


def truth_of_impacts():
    v, omega = space.strike((2, 1, -3), (10, -20, 5), radius=0.1, mu=0.1, e=0.5)  # slips to its end
    assert math.dist(v, (1.597507764050, 0.798753882025, 1.5)) < 1e-11, v
    assert math.dist(omega, (4.968847050625, -9.937694101251, 5)) < 1e-11, omega
    v, omega = space.strike((2, 1, -3), (10, -20, 5), radius=0.1, mu=0.3, e=0.5)  # 4.725 of slip could go, 4.472 is
    assert math.dist(v[:2], (0.1 * omega[1], -0.1 * omega[0])) < 1e-12, (v, omega)
    before, after = space.bounces_end(0.28), space.bounces_end(0.29)  # .4 m take .285569 s
    assert abs(before[2] - (0.5 - 9.81 / 2 * 0.28**2)) < 1e-12 and after[2] > 0.1, (before, after)
    assert math.dist(space.bounces_end(0.75), (1.0272572703238, 0.5136286351619, 0.1062492828913)) < 1e-12


def run(python, orthant, *programs, values="4"):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([python, SCRIPT, "--values", values, "--programs", *programs, "--orthant", Path(orthant).parent,
                        "--output", folder], check=True, capture_output=True, timeout=600,
                       env=os.environ | {"ORTHANT_PEERS": str(PEERS)})
        with open(f"{folder}/space.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        lines = (Path(folder) / "space.md").read_text().splitlines()
        keys = {(r["scene"], r["program"], r["setting"]) for r in rows}
        assert (Path(folder) / "space.svg").exists()
        assert len([line for line in lines if line.startswith("| ") and " least " not in line]) == len(keys), lines
    return rows


def absent():
    """A program that is not installed is a row that says so, and the answer of Siconos' driver is its last line."""
    gone = space.Absent("not installed: no module")
    rows = list(space.measure({"gone": gone}, values=4, only=["bounces"]))
    assert {row["failure"] for row in rows} == {"not installed: no module"} and len(rows) == 4, rows
    end, seconds = model_siconos.Siconos.parse("[kernel] a message\n0.25 1.5 -2\n")
    assert list(end) == [1.5, -2] and seconds == 0.25


def others(orthant):
    python = PEERS / "python/bin/python"
    if not python.exists():
        print("skipped: the other programs, which experiments/benchmarks/setup installs")
        return
    names = [name for name in space.PROGRAMS if name != "orthant"]
    rows = run(python, orthant, *names, values="2")
    missing = {r["program"] for r in rows if r["failure"].startswith("not installed")}
    for name in missing:
        print(f"skipped: {name}")
    for key, bound in OTHERS.items():
        runs = [r for r in rows if (r["scene"], r["program"], r["setting"]) == key]
        if key[1] not in missing:
            assert len(runs) == 2 and not runs[1]["failure"] and float(runs[1]["error"]) < bound, (key, runs)
    refused = {r["setting"]: r["failure"] for r in rows if (r["scene"], r["program"]) == ("slider_crank", "drake")}
    assert "drake" in missing or "constraints" in refused["CENIC"] and "constraints" in refused["continuous"], refused


if __name__ == "__main__":
    main(sys.argv[1])
    print("ok")
