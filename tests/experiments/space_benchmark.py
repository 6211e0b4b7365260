"""The comparison in space: its truth, Orthant's own rows, and the rule of its table. space_benchmark.py ORTHANT"""
import csv
import math
import subprocess
import sys
import tempfile
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "experiments/benchmarks/space/space.py"
sys.path.insert(0, str(SCRIPT.parent))
import space  # noqa: E402


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

    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, SCRIPT, "--quick", "--programs", "orthant", "--orthant", Path(orthant).parent,
                        "--output", folder], check=True, capture_output=True, timeout=300)
        with open(f"{folder}/space.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        assert (Path(folder) / "space.svg").exists() and (Path(folder) /
                                                          "space.md").read_text().count("| orthant |") == 6
    assert len(rows) == 24 and not any(r["failure"] for r in rows), rows
    finest = {(r["scene"], r["setting"]): float(r["error"]) for r in rows}  # the last of each
    for key, error in finest.items():
        assert error < (1e-7 if key[1] in ("adaptive", "event-driven") else 1e-4), (key, error)


if __name__ == "__main__":
    main(sys.argv[1])
    print("ok")
