"""The plugin petsc: answers of the command, words for what it does not take, no other output, time limits kept.

    plugin.py ORTHANT PETSC_SO
"""
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

orthant, plugin = sys.argv[1:]
kept = tempfile.TemporaryDirectory()  # until the end
folder = Path(kept.name)


def solve(problem, spec, *options):
    file = folder / "p.json"
    file.write_text(json.dumps({"format": "orthant-lcp", "version": 1, **problem}))
    return subprocess.run([orthant, "--plugin", plugin, "solve", str(file), "--solver", spec, "--json", *options],
                          capture_output=True, text=True, timeout=120)


def check(true, *words):
    if not true:
        sys.exit(f"plugin: {' '.join(map(str, words))}")


small = {"A": {"storage": "dense", "n": 2, "rows": [[2, 1], [1, 2]]}, "b": [-5, -6]}
for method in ("reduced-space", "semismooth"):
    done = solve(small, f"petsc:method={method}")
    check(done.returncode == 0 and done.stderr == "", method, done)
    answer = json.loads(done.stdout)
    check(answer["status"] == "solved", method, answer)
    check(abs(answer["z"][0] - 4 / 3) < 1e-9 and abs(answer["z"][1] - 7 / 3) < 1e-9, method, answer["z"])
    check(method == "semismooth" or answer["iterations"] == 1, "one block is enough", answer["iterations"])

none = solve({"A": {"storage": "dense", "n": 1, "rows": [[-1]]}, "b": [-1]}, "petsc")
check(json.loads(none.stdout)["status"] == "infeasible", "the proof is the command's", none.stdout)

unknown = solve(small, "petsc:pc=foo")
check(unknown.returncode == 1 and "option pc = 'foo': must be one of auto, jacobi" in unknown.stderr, unknown)
friction = solve({"A": {"storage": "dense", "n": 2, "rows": [[1, 0], [0, 1]]}, "b": [-1, 0], "lo": [0, "-inf"],
                  "hi": ["inf", "inf"], "friction": [{"normal": 0, "first": 1, "mu": 0.5}]}, "petsc")
check("unsupported" in friction.stdout and friction.returncode != 0, "friction", friction)

n = 900  # dense, unsymmetric: factorizations of a tenth of a second each
rows = [[((i * 7919 + j * 104729) % 1009) / 1009 - 0.5 + (n if i == j else 0) for j in range(n)] for i in range(n)]
begin = time.monotonic()
late = solve({"A": {"storage": "dense", "n": n, "rows": rows}, "b": [(-1) ** i for i in range(n)]}, "petsc",
             "--time-limit", "0.001")
check(json.loads(late.stdout)["status"] in ("time_limit", "solved"), late.stdout[:300])
check(time.monotonic() - begin < 60, "time limit", time.monotonic() - begin)
