"""Scenes and runs from Python."""

import copy
import pickle
import xml.etree.ElementTree as ET

import numpy as np
import orthant
import pytest


def ball(**contact):
    scene = orthant.Scene(gravity=[0, -9.81], duration=1.0, step=1e-3)
    scene.add("body", name="ball", mass=1, inertia=0.004, position=[0, 1])
    scene.add("contact", name="floor", type="disc-wall", body="ball", radius=0.1, wall={"normal": [0, 1]}, **contact)
    return scene


def test_a_scene_of_a_few_lines_falls_and_bounces():
    run = orthant.simulate(ball(e_n=0.5), integrator="event-driven")
    assert run.solved and len(run) == 1001 and run.columns[0] == "t"
    t = np.sqrt(2 * 0.9 / 9.81)  # first impact
    v = 0.5 * 9.81 * t
    k = np.searchsorted(run.t, t + 0.1)
    dt = run.t[k] - t
    assert np.isclose(run["ball.y"][k], 0.1 + v * dt - 9.81 / 2 * dt * dt, atol=1e-9)
    assert run.summary["max_penetration"] < 1e-12


def test_as_a_frame():
    frame = orthant.simulate(ball(), duration=0.01).frame()
    assert frame.index.name == "t" and frame["floor.gap"].iloc[0] == pytest.approx(0.9)


def test_names_and_files_and_overrides(tmp_path):
    named = orthant.simulate(orthant.Scene.named("slider_crank", mu=0.1), step=1e-4, duration=0.01)
    assert named.solved
    file = tmp_path / "ball.toml"
    file.write_text(ball(e_n=0.5).toml())
    a = orthant.simulate(str(file), duration=0.5)
    assert np.array_equal(orthant.simulate(file, duration=0.5).table, a.table)
    assert orthant.Scene.load(file).toml() == file.read_text()
    b = orthant.simulate(orthant.Scene.load(file, **{"contact.floor.e_n": 0.5}), duration=0.5)
    c = orthant.simulate(ball(e_n=0.5), duration=0.5)
    assert np.array_equal(a.table, b.table) and np.array_equal(a.table, c.table)
    assert orthant.Scene.load(file).bodies == ["ball"]


def test_what_is_wrong_is_named(tmp_path):
    with pytest.raises(ValueError, match="kind 'bdy': must be one of body"):
        ball().add("bdy")
    with pytest.raises(ValueError, match="contact.*floor.*mu.*-1"):
        orthant.simulate(ball(mu=-1))
    with pytest.raises(ValueError, match="floor.*no_such"):
        orthant.simulate(ball(no_such=1))
    with pytest.raises(TypeError, match="mu = <object.*: must be a number, bool"):
        orthant.simulate(ball(mu=object()))
    with pytest.raises(ValueError, match="unknown scene 'no_such'"):
        orthant.simulate("no_such")
    with pytest.raises(ValueError, match="scene 'no_such': must be one of bouncing_ball"):
        orthant.Scene.named("no_such")
    with pytest.raises(ValueError, match="step"):
        orthant.simulate(ball(), step=-1)
    with pytest.raises(ValueError, match="every = 0: must be a whole number"):
        orthant.simulate(ball(), every=0)
    for key, bad in (("step", "a"), ("duration", [1]), ("every", 0.5), ("integrator", 3), ("solver", None)):
        with pytest.raises(TypeError, match=f"{key} = .*: must be"):
            orthant.simulate(ball(), **{key: bad})
    with pytest.raises(ValueError, match="unknown integrator 'eulr'|'eulr'"):
        orthant.simulate(ball(), integrator="eulr")
    with pytest.raises(KeyError, match="ball.z"):
        orthant.simulate(ball(), duration=0.01)["ball.z"]
    with pytest.raises(FileNotFoundError):
        orthant.Scene.load(tmp_path / "none.toml")


def test_a_run_that_fails_says_so_and_keeps_its_problem():
    scene = orthant.Scene.named("slider_crank", mu=0.1)
    run = orthant.simulate(scene, solver="pgs:max_sweeps=1,tolerance=1e-15", step=1e-4, duration=0.1)
    assert not run.solved and run.summary["t"] < 0.1
    assert run.unsolved is not None and orthant.solve(run.unsolved, solver="lemke").solved


def test_trajectories_as_files(tmp_path):
    run = orthant.simulate(ball(), duration=0.01)
    run.write(tmp_path / "run.csv")
    lines = (tmp_path / "run.csv").read_text().splitlines()
    assert lines[0].split(",") == run.columns and [float(x) for x in lines[-1].split(",")] == run.table[-1].tolist()
    run.write(tmp_path / "run.h5")
    assert (tmp_path / "run.h5").read_bytes()[:4] == b"\x89HDF"
    run.write(tmp_path / "run.pvd")
    moments = ET.parse(tmp_path / "run.pvd").getroot().findall("Collection/DataSet")
    assert [float(m.get("timestep")) for m in moments] == run.t.tolist()
    piece = ET.parse(tmp_path / moments[-1].get("file")).getroot().find("UnstructuredGrid/Piece")
    assert len(piece.find("Points/DataArray").text.split()) == 3 * int(piece.get("NumberOfPoints"))
    with pytest.raises(ValueError, match="run.vtk: must end in .csv, .h5, .hdf5 or .pvd"):
        run.write(tmp_path / "run.vtk")


def test_runs_and_scenes_go_to_other_processes(tmp_path):
    failed = orthant.simulate(orthant.Scene.named("slider_crank", mu=0.1), solver="pgs:max_sweeps=1,tolerance=1e-15", step=1e-4)
    for run in (copy.deepcopy(failed), pickle.loads(pickle.dumps(failed))):
        assert np.array_equal(run.table, failed.table) and run.summary == failed.summary
        assert orthant.solve(run.unsolved, solver="lemke").solved
        run.write(tmp_path / "run.pvd")
    for scene in (ball(e_n=0.5), orthant.Scene.parse(ball(e_n=0.5).toml()), orthant.Scene.named("bouncing_ball", e=0.5),
                  orthant.Scene.parse(ball().toml(), **{"contact.floor.e_n": 0.5})):
        before = orthant.simulate(scene, duration=0.5).table
        assert np.array_equal(orthant.simulate(pickle.loads(pickle.dumps(scene)), duration=0.5).table, before)


def test_a_time_limit_and_ctrl_c_end_a_run(ctrl_c):
    run = orthant.simulate("slider_crank", step=1e-8, every=1000000, time_limit=0.2)
    assert run.status == "time_limit" and 0 < run.summary["t"] < 0.2
    with pytest.raises(ValueError, match="time_limit = -1"):
        orthant.simulate(ball(), time_limit=-1)
    ctrl_c()
    with pytest.raises(KeyboardInterrupt):
        orthant.simulate("slider_crank", step=1e-8, every=1000000, time_limit=60)


def test_registries():
    assert {"moreau-jean", "adaptive"} <= {e.name for e in orthant.integrators()}
    assert "slider_crank" in {e.name for e in orthant.scenes()}
