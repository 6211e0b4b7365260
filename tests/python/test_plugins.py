"""Python files as plugins of the command: names that they register, and errors in one line."""

import json
import os
import pathlib
import subprocess
import sys

import numpy as np
import orthant
import pytest

PLUGIN = """
import numpy as np
import orthant
from settings import STEPS


def sweeps(problem, start):
    z, M = start.copy(), problem.M if isinstance(problem.M, np.ndarray) else problem.M.toarray()
    for _ in range(STEPS):
        for i in range(len(z)):
            z[i] = np.clip(z[i] - (M[i] @ z + problem.q[i]) / M[i, i], problem.lower[i], problem.upper[i])
    return z


def falls(step):
    v = step.v + step.h * np.array([0, -10.0, 0])
    return step.q + step.h * v, v


orthant.register_solver("of-the-file", sweeps, "sweeps of a file")
orthant.register_solver("breaks", lambda problem, start: 1 / 0)
orthant.register_solver("short", lambda problem, start: start[1:])
orthant.register_integrator("falls", falls)
ball = orthant.Scene(gravity=[0, -10], duration=0.5, step=1e-2)
ball.add("body", name="ball", mass=1, inertia=0.1, position=[0, 1])
ball.add("contact", type="custom", name="floor", bodies=["ball", "ground"], gap=lambda a, b: a[1],
         rows=lambda a, b: [0, 1, 0, 0, 0, 0])
orthant.register_scene("ball_of_the_file", ball)
free = orthant.Scene(gravity=[0, -10], duration=0.5, step=1e-2)
free.add("body", name="a", mass=1, inertia=1)
orthant.register_scene("free_of_the_file", free)
"""


def command(folder, *words):
    path = {**os.environ, "PYTHONPATH": str(pathlib.Path(orthant.__file__).parents[1]), "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run([sys.executable, "-m", "orthant", *words], cwd=folder, capture_output=True, text=True,
                          env=path)


def test_a_python_file_is_a_plugin_of_the_command(tmp_path):
    (tmp_path / "mine.py").write_text(PLUGIN)
    (tmp_path / "settings.py").write_text("STEPS = 200\n")
    (tmp_path / "p.json").write_text('{"format": "orthant-lcp", "version": 1, "A": {"storage": "dense", "n": 2, '
                                     '"rows": [[2, 1], [1, 2]]}, "b": [-5, -6]}')
    assert "of-the-file\n      sweeps of a file" in command(tmp_path, "list", "solvers", "--plugin", "mine.py").stdout
    assert "of-the-file" not in command(tmp_path, "list", "solvers").stdout
    solved = command(tmp_path, "--plugin", "mine.py", "solve", "p.json", "--solver", "of-the-file", "--json")
    assert solved.returncode == 0 and np.allclose(json.loads(solved.stdout)["z"], [4 / 3, 7 / 3])

    run = command(tmp_path, "simulate", "ball_of_the_file", "--plugin=mine.py", "--solver", "of-the-file", "--json")
    assert run.returncode == 0 and json.loads(run.stdout)["lcp_solves"] > 2, run.stderr
    run = command(tmp_path, "simulate", "free_of_the_file", "--plugin", "mine.py", "--integrator", "falls", "--json")
    assert run.returncode == 0, run.stderr
    np.testing.assert_allclose(json.loads(run.stdout)["final"]["a.y"], -10 * 1e-4 * 50 * 51 / 2, rtol=1e-12)

    (tmp_path / "mine.sweep.toml").write_text(
        'question = "?"\nscene = "ball_of_the_file"\nmeasure = "ball.y"\n[[grid]]\nintegrator = ["moreau-jean"]\n'
        'solver = "of-the-file"\nstep = [1e-2, 5e-3]\n')
    swept = command(tmp_path, "sweep", "mine.sweep.toml", "--plugin", "mine.py", "--results", "r.sqlite")
    assert "2 cases in r.sqlite, 2 of them new, 0 not solved" in swept.stdout, swept.stderr


@pytest.mark.parametrize("file, text, words", [
    ("none.py", None, "--plugin 'none.py': must be a Python file that exists"),
    ("mine.so", "", "--plugin 'mine.so': must be a Python file, .py: compiled plugins need an orthant that was built"),
    ("text.py", "import orthant\n  x = (", "--plugin 'text.py': IndentationError: unexpected indent (text.py, line 2)"),
    ("fails.py", "def f():\n    return {}['key']\n\n\nf()\n",
     "--plugin 'fails.py': KeyError: 'key' (fails.py, line 2)\n"),
    ("exits.py", "import sys\nsys.exit(0)\n", "--plugin 'exits.py': SystemExit: 0 (exits.py, line 2)\n"),
    ("twice.py", "import orthant\northant.register_solver('lemke', print)\n",
     "--plugin 'twice.py': ValueError: solver 'lemke': is registered already (twice.py, line 2)\n"),
])
def test_a_plugin_that_cannot_be_loaded_is_an_error_of_one_line(tmp_path, file, text, words):
    if text is not None:
        (tmp_path / file).write_text(text)
    said = command(tmp_path, "list", "--plugin", file)
    assert said.returncode == 1 and said.stdout == ""
    assert said.stderr.startswith(f"orthant: {words}") and said.stderr.count("\n") == 1


@pytest.mark.parametrize("solver, words", [
    ("breaks", "ZeroDivisionError: division by zero (mine.py, line 21)\n"),
    ("short", "solver 'short': z has shape (1,): must be (2,), one entry a row"),
])
def test_a_function_of_a_plugin_that_fails_is_an_error_of_one_line(tmp_path, solver, words):
    (tmp_path / "mine.py").write_text(PLUGIN)
    (tmp_path / "settings.py").write_text("STEPS = 200\n")
    (tmp_path / "p.json").write_text('{"format": "orthant-lcp", "version": 1, "A": {"storage": "dense", "n": 2, '
                                     '"rows": [[2, 1], [1, 2]]}, "b": [-5, -6]}')
    said = command(tmp_path, "--plugin", "mine.py", "solve", "p.json", "--solver", solver)
    assert said.returncode == 1 and said.stderr.startswith(f"orthant: {words}") and said.stderr.count("\n") == 1
