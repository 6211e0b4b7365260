"""Every example runs, and says that it solved what it set out to."""

import os
import pathlib
import subprocess
import sys

import orthant
import pytest

EXAMPLES = pathlib.Path(__file__).parents[2] / "experiments" / "examples"


@pytest.mark.skipif(not EXAMPLES.exists(), reason="the tests stand alone here")
@pytest.mark.parametrize("name, says", [
    ("solve_lcp", "infeasible"), ("simulate_scene", "solved in"), ("obstacle", "touches within r = 0.699"),
    ("game", "gains 4.0 2.6667"), ("nonlinear", "solved prices"), ("american_put", "worth at S = 100: 6.08")])
def test_example(name, says):
    path = {**os.environ, "PYTHONPATH": str(pathlib.Path(orthant.__file__).parents[1])}
    run = subprocess.run([sys.executable, EXAMPLES / f"{name}.py"], capture_output=True, text=True, env=path)
    assert run.returncode == 0, run.stderr
    assert says in run.stdout


@pytest.mark.skipif(not EXAMPLES.exists(), reason="the tests stand alone here")
def test_all_are_listed_here():
    marks = {m.args[1][i][0] for m in test_example.pytestmark if m.name == "parametrize" for i in range(len(m.args[1]))}
    assert marks == {file.stem for file in EXAMPLES.glob("*.py")}
