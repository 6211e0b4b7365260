"""What a user meets first: the import's cost, the docstrings' examples."""

import doctest
import importlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

import orthant
import pytest

DOCS = pathlib.Path(__file__).parents[2] / "experiments" / "docs"


def test_import_is_quick():
    path = {**os.environ, "PYTHONPATH": str(pathlib.Path(orthant.__file__).parents[1])}

    def seconds(code):
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True, env=path)
        return time.perf_counter() - begin

    assert min(seconds("import orthant") for _ in range(3)) < 0.5 + min(seconds("import numpy") for _ in range(3))


def test_examples_in_docstrings():
    for module in (orthant, orthant._scene, orthant._sweep):
        assert doctest.testmod(module, extraglobs=vars(orthant)).failed == 0


def test_everything_public_is_documented():
    for name in orthant.__all__:
        assert name.startswith("__") or name in ("revision", "LogEntry") or getattr(orthant, name).__doc__, name


def test_every_property_and_method_is_documented():
    bare = [f"{name}.{key}" for name in orthant.__all__ if isinstance(getattr(orthant, name), type)
            for key, member in vars(getattr(orthant, name)).items()
            if not key.startswith("_") and (isinstance(member, property) or callable(member)) and not member.__doc__]
    fields = [f"{one.__name__}.{field}" for one in (orthant.Delassus, orthant.McpResult) for field in one._fields]
    assert set(bare) <= set(fields)
    assert len(orthant.Result.nfev.__doc__) > 10


@pytest.mark.skipif(not DOCS.exists(), reason="the tests stand alone here")
def test_everything_public_is_in_the_reference():
    page = (DOCS / "reference" / "python.md").read_text(encoding="utf-8")
    missing = [name for name in orthant.__all__ if not re.search(rf":: orthant\.{name}\b", page)]
    assert missing == ["__version__", "revision"]


USE = """
import numpy as np
import numpy.typing as npt
import orthant

M, q = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-5.0, -6.0])
r = orthant.solve(M, [-5, -6], bounds=[(0, 1), (None, None)])
reveal_type(r.nit)
z = r.z + r.x + r.fun
first = {key: r[key] for key in r}
p = orthant.Problem(M, q, bounds=(0, np.inf), friction=[(1, 0, 0.5)])
many = orthant.solve_many([(M, q), p], threads=2)
reveal_type(orthant.solve_many(M, np.zeros((3, 2)), lower=0.0, start=[None, many[0], q])[0])
scene = orthant.Scene(gravity=[0, -9.81])
scene.add("body", name="a", mass=1.0)
run = orthant.simulate(scene, integrator="adaptive")
height: npt.NDArray[np.float64] = run["a.y"]


def sweeps(problem: orthant.Problem, start: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return start


orthant.register_solver("mine", sweeps)
mcp = orthant.solve_mcp(lambda x: x, lambda x: np.eye(2), [0.0, 0.0])
print(mcp.x, mcp["fun"], first, height)
"""


def test_type_hints_hold(tmp_path):
    """mypy, strict, over the sources and the stub of the compiled part; and what the stub promises is there."""
    package = pathlib.Path(orthant.__file__).resolve().parent
    if package.parts[-3:] == ("experiments", "python",
                              "orthant") and shutil.which("mypy"):  # an installed one has neighbours
        run = subprocess.run(
            ["mypy", "--strict", "--ignore-missing-imports", "--cache-dir",
             str(tmp_path), "-p", "orthant"], cwd=package.parent, capture_output=True, text=True)
        assert run.returncode == 0, run.stdout
        (tmp_path / "use.py").write_text(USE, encoding="utf-8")
        run = subprocess.run(
            ["mypy", "--strict", "--ignore-missing-imports", "--cache-dir",
             str(tmp_path),
             str(tmp_path / "use.py")], cwd=package.parent, capture_output=True, text=True)
        assert re.findall(r'Revealed type is "(.*)"', run.stdout) == ["builtins.int",
                                                                      "orthant._orthant.Result"], run.stdout
        assert "error" not in run.stdout, run.stdout
    if package.parts[-3:] == ("experiments", "python", "orthant") and shutil.which("pyright"):
        run = subprocess.run(["pyright", "--pythonpath", sys.executable, "orthant"], cwd=package.parent,
                             capture_output=True, text=True)
        assert run.returncode == 0, run.stdout
    stub = (package / "_orthant.pyi").read_text(encoding="utf-8")
    promised = set(re.findall(r"^(?:def|class) (\w+)", stub, re.M)) | {"__version__", "revision"}
    promised |= set(re.findall(r"^(_\w+): ", stub, re.M))
    there = {name for name in dir(orthant._orthant) if not name.startswith("__") or name == "__version__"}
    assert promised == there
    for name in re.findall(r"^class (\w+)", stub, re.M):
        body = stub.split(f"class {name}:")[1].split("\nclass ")[0].split("\ndef ")[0]
        said, compiled = set(re.findall(r"def (\w+)", body)), getattr(orthant._orthant, name)
        assert said <= set(dir(compiled)), name
        if not name.startswith("_"):
            assert {key for key in vars(compiled) if not key.startswith("_")} <= said, name


@pytest.mark.skipif(not DOCS.exists(), reason="the tests stand alone here")
def test_decision_tables_name_what_there_is_and_come_from_a_run(tmp_path):
    """The tables of the documentation name registered solvers and integrators; figures.py reads the results of runs."""
    sys.path.insert(0, str(DOCS))
    figure_pages, figures = map(importlib.import_module, ("figure_pages", "figures"))

    def names(file):
        return set(re.findall(r"`([a-z-]+)`", (tmp_path / file).read_text(encoding="utf-8")))

    figure_pages.pages(tmp_path, figures.load())
    assert "auto" in names("solvers.csv") <= {entry.name for entry in orthant.solvers()}
    assert names("integrators.csv") <= {entry.name for entry in orthant.integrators()}
    (tmp_path / "shootout.csv").write_text(
        "problem,group,solver,result,seconds\n" + "".join(
            f"p{p},friction,{solver},{result},{seconds}\n" for p in range(2)
            for solver, result, seconds in (("lemke", "certified", 2e-6), ("pgs", "certified" if p else "failed", 1e-6),
                                            ("path", "certified", 4e-6), ("murty", "refused", 0))), encoding="utf-8")
    (tmp_path / "runs.csv").write_text(
        "integrator,setting,mu,e,status,error,seconds\n"
        "rattle,2e-4,0,0.4,solved,9e-4,0.01\nrattle,1e-4,0,0.4,solved,5e-3,0.1394\nrattle,5e-5,0,0.4,solved,1e-6,0.4\n"
        "rattle,1e-4,0,0.9,solved,1e-9,0.001\nnone,1e-4,0,0.4,failed,,0.1\n", encoding="utf-8")
    (tmp_path / "manifest.json").write_text(
        '{"revision": "abc", "cpu": "one", "cores": 2, "written": "2026-01-02T03:04:05Z"}', encoding="utf-8")

    def made(table, page):
        data = tmp_path / "figures.toml"
        command = [sys.executable, DOCS / "figures.py", "quiet", table, "--from", tmp_path, "--data", data]
        subprocess.run(command, check=True)
        figure_pages.pages(tmp_path, figures.load(data))
        assert (tmp_path / f"{page}.txt").read_text() == \
            "Measured at revision `abc`, 2026-01-02, on 2 cores of one with no other work.\n"
        return (tmp_path / f"{page}.csv").read_text(encoding="utf-8").splitlines()

    # A coarse step that is right by luck does not count: a finer one errs by 5e-3.
    assert made("time_to_error", "integrators") == \
        ["integrator,to 1e-2,to 1e-3,to 1e-6,to 1e-9", "`rattle`,10,400,400,–"]
    assert made("solvers_by_group", "solvers")[1] == "contacts with friction,2,`lemke`,2,1.5,`path`,2,3,`pgs`,1,1"
