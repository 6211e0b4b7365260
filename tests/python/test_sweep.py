"""Sweeps from Python: the same rows as `orthant sweep` writes, by processes of this machine and by Dask."""

import pathlib
import shutil
import subprocess

import orthant
import pytest

pd = pytest.importorskip("pandas")
BALL = {"duration": 0.5, "measure": "ball.y", "reference": "event-driven:rtol=1e-10",
        "grid": {"integrator": ["moreau-jean", "rattle"], "step": [1e-2, 1e-3]}}
FIGURES = ["integrator", "step", "status", "value", "error"]


def test_every_combination_is_a_row_and_a_second_call_does_nothing(tmp_path):
    frame = orthant.sweep("bouncing_ball", results=tmp_path / "ball.sqlite", progress=False, **BALL)
    assert len(frame) == 4 and (frame["status"] == "solved").all()
    assert sorted(set(zip(frame["integrator"], frame["step"]))) == [
        ("moreau-jean", 1e-3), ("moreau-jean", 1e-2), ("rattle", 1e-3), ("rattle", 1e-2)]
    coarse, fine = (frame[(frame["integrator"] == "moreau-jean") & (frame["step"] == h)]["error"].iloc[0]
                    for h in (1e-2, 1e-3))
    assert 0 < abs(fine) < abs(coarse)
    before = (tmp_path / "ball.sweep.toml").stat().st_mtime_ns
    again = orthant.sweep("bouncing_ball", results=tmp_path / "ball.sqlite", progress=False, **BALL)
    assert again["seconds"].equals(frame["seconds"])  # times differ from run to run: nothing ran
    assert (tmp_path / "ball.sweep.toml").stat().st_mtime_ns == before


def test_the_command_gives_the_same(tmp_path):
    command = pathlib.Path(orthant.__file__).parents[2] / "orthant"
    if not command.exists():
        pytest.skip("the tests stand alone here")
    frame = orthant.sweep("bouncing_ball", results=tmp_path / "ball.sqlite", progress=False, **BALL)
    subprocess.run([command, "sweep", "ball.sweep.toml", "--results", "theirs.sqlite"], cwd=tmp_path, check=True,
                   capture_output=True)
    theirs = orthant._sweep._table(orthant._orthant._sweep_rows(tmp_path / "theirs.sqlite", "ball"))
    assert [c for c in FIGURES if c in frame] and all(frame[c].equals(theirs[c]) for c in FIGURES if c in frame)


def test_parameters_are_columns_and_the_bar_counts(tmp_path, capsys):
    pytest.importorskip("tqdm")
    frame = orthant.sweep("slider_crank", results=tmp_path / "s.sqlite", duration=0.002, measure="crank.theta",
                          grid=[{"integrator": "moreau-jean", "step": 1e-4, "set": {"mu": [0, 0.1]}}])
    assert list(frame["mu"]) == [0, 0.1]
    assert "2/2" in capsys.readouterr().err


def test_by_dask(tmp_path):
    distributed = pytest.importorskip("distributed")
    here = orthant.sweep("bouncing_ball", results=tmp_path / "here.sqlite", progress=False, **BALL)
    with distributed.Client(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as client:
        there = orthant.sweep("bouncing_ball", results=tmp_path / "there.sqlite", progress=False, client=client, **BALL)
    assert all(here[c].equals(there[c]) for c in FIGURES if c in here)


def test_a_scene_built_here(tmp_path):
    scene = orthant.Scene(gravity=[0, -9.81])
    scene.add("body", name="ball", mass=1, inertia=0.004, position=[0, 1])
    scene.add("contact", name="floor", type="disc-wall", body="ball", radius=0.1, wall={"normal": [0, 1]}, e_n=0.5)
    ask = {**BALL, "grid": {"integrator": "rattle", "step": 1e-3, "set": {"contact.floor.e_n": [0, 0.5]}}}
    frame = orthant.sweep(scene, results=tmp_path / "mine.sqlite", progress=False, **ask)
    assert list(frame["contact.floor.e_n"]) == [0, 0.5] and (frame["error"].abs() < 1e-2).all()
    with pytest.raises(ValueError, match="a scene by name or with overrides has no text of its own"):
        orthant.sweep(orthant.Scene.named("bouncing_ball"), results=tmp_path / "named.sqlite", progress=False, **ask)


def test_errors_name_key_and_value(tmp_path):
    with pytest.raises(ValueError, match="integrator.*eulr|eulr"):
        orthant.sweep("bouncing_ball", results=tmp_path / "a.sqlite", measure="ball.y", grid={"integrator": "eulr"})
    with pytest.raises(ValueError, match="no_such"):
        orthant.sweep("bouncing_ball", results=tmp_path / "a.sqlite", measure="ball.y", no_such=1,
                      grid={"integrator": "rattle"})
    file = tmp_path / "b.sweep.toml"
    shutil.copy(tmp_path / "a.sweep.toml", file)
    with pytest.raises(TypeError, match="measure: a sweep file holds its keys itself"):
        orthant.sweep(file, measure="ball.y")


def test_a_sweep_file_of_the_users_is_not_written_over(tmp_path):
    own = tmp_path / "a.sweep.toml"
    own.write_text("scene = 'mine'\n")
    with pytest.raises(ValueError, match="a.sweep.toml exists and was not written by orthant.sweep"):
        orthant.sweep("bouncing_ball", results=tmp_path / "a.sqlite", **BALL)
    assert own.read_text() == "scene = 'mine'\n"
    with pytest.raises(ValueError, match="jobs = -1: must be a whole number"):
        orthant.sweep("bouncing_ball", results=tmp_path / "b.sqlite", jobs=-1, **BALL)


@pytest.mark.parametrize("damage", ["text", "cut"])
def test_results_that_cannot_be_used_are_named(tmp_path, damage):
    file = tmp_path / "ball.sqlite"
    orthant.sweep("bouncing_ball", results=file, progress=False, **BALL)
    whole = file.read_bytes()
    file.write_bytes(b"x" * 5000 if damage == "text" else whole[:len(whole) // 2])
    with pytest.raises(RuntimeError, match="ball.sqlite: .*(no results file|damaged)"):
        orthant._orthant._sweep_rows(file, "ball")
