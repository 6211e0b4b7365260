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


def test_errors_name_element_key_and_value(tmp_path):
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
    with pytest.raises(TypeError, match=r"step = '1': must be a number \[s\]"):
        orthant.simulate(ball(), step="1")
    with pytest.raises(TypeError, match="check = 'no': must be True or False"):
        orthant.simulate(ball(), check="no")
    with pytest.raises(ValueError, match="mass = 1000.*must be a whole number of 64 bits"):
        orthant.Scene().add("body", name="b", mass=10**400, inertia=1)
    with pytest.raises(ValueError, match=r"M has shape \(1000000, 1000000\): must have at most 2\^36 entries"):
        orthant.solve(np.broadcast_to(1.0, (10**6, 10**6)), np.ones(10**6))
    for key, bad in (("step", "a"), ("duration", [1]), ("every", 0.5), ("integrator", 3), ("solver", 3)):
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
    failed = orthant.simulate(orthant.Scene.named("slider_crank", mu=0.1), solver="pgs:max_sweeps=1,tolerance=1e-15",
                              step=1e-4)
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
    with pytest.raises(KeyboardInterrupt, match="interrupted at t = ") as stop:
        orthant.simulate("slider_crank", step=1e-8, every=1000, time_limit=60)
    kept = stop.value.run
    assert isinstance(stop.value, orthant.Interrupted) and kept.status == "cancelled"
    assert len(kept) > 2 and kept["t"][-1] == kept.summary["t"] > kept["t"][0]


def test_registries():
    assert {"moreau-jean", "adaptive"} <= {e.name for e in orthant.integrators()}
    assert "slider_crank" in {e.name for e in orthant.scenes()}


def test_check_claims_no_more_digits_than_are_true():
    for integrator in ("moreau-jean", "adaptive:rtol=1e-4"):
        run = orthant.simulate(ball(e_n=0.5), integrator=integrator, step=1e-3, duration=0.6, check=True)
        t = np.sqrt(2 * 0.9 / 9.81)
        exact = 0.1 + 0.5 * 9.81 * t * (0.6 - t) - 9.81 / 2 * (0.6 - t) ** 2
        off = abs(run["ball.y"][-1] - exact)
        check = run.summary["check"]
        assert off <= check["error"]["ball.y"] <= 1e-2
        assert 1 <= check["digits"]["ball.y"] <= -np.log10(off / exact + 1e-16) + 0.5
        assert integrator.split(":")[0] in check["against"] and check["left_out"] == ""
    assert "check" not in orthant.simulate(ball(), duration=0.01).summary


def test_python_warns_of_the_same_as_the_command(recwarn):
    scene = ball()
    scene._elements[0][1]["position"] = [0, 0.05]  # 5 cm deep
    with pytest.warns(orthant.OrthantWarning, match="at the start contacts penetrate by 0.05 m"):
        run = orthant.simulate(scene, duration=0.01)
    assert run.solved and run.warnings and "penetrate by 0.05 m" in run.why
    fast = orthant.Scene(duration=0.1, step=1e-2)
    fast.add("body", name="rotor", mass=1, inertia=1, omega=100)
    with pytest.warns(orthant.OrthantWarning, match='"rotor" turns by 1 rad in a step') as caught:
        assert "turns by 1 rad" in orthant.simulate(fast).why
    assert caught[0].filename == __file__  # where simulate was called
    recwarn.clear()
    quiet = orthant.simulate(ball(), duration=0.01)
    assert quiet.why == "" and quiet.warnings == [] and not recwarn.list


def test_why_is_never_empty_where_a_run_is_not_solved():
    scene = orthant.Scene.named("slider_crank", mu=0.1)
    run = orthant.simulate(scene, solver="pgs:max_sweeps=1,tolerance=1e-15", step=1e-4)
    assert run.status in run.why and "t = " in run.why


def test_events_are_a_table(tmp_path):
    impact = np.sqrt(2 * 0.9 / 9.81)
    for integrator in ("event-driven", "adaptive:rtol=1e-9"):
        run = orthant.simulate(ball(e_n=0.5), integrator=integrator, duration=0.6, step=0.1)
        events = run.events
        assert len(events) == run.summary["events"] == 1
        assert events["kind"][0] == "impact" and events["contact"][0] == "floor"
        assert np.isclose(events["t"][0], impact, atol=1e-8)
        assert np.isclose(events["impulse_n"][0], 1.5 * 9.81 * impact, atol=1e-6)
    run.write(tmp_path / "run.csv")
    lines = (tmp_path / "run.events.csv").read_text().splitlines()
    assert lines[0] == "t,kind,contact,impulse_n,impulse_t" and float(lines[1].split(",")[0]) == events["t"][0]
    copied = pickle.loads(pickle.dumps(run))
    assert np.array_equal(copied.events, events)
    assert len(orthant.simulate(ball(), duration=0.01).events) == 0


def wave(**law):
    """A ball over a wavy floor y = 0.1 sin(2 x), in Python: the vertical distance of its centre of mass is the gap."""
    scene = orthant.Scene(gravity=[0, -9.81], duration=1.0, step=1e-3)
    scene.add("body", name="ball", mass=1, inertia=0.01, position=[0, 0.5], velocity=[0.4, 0])
    scene.add("contact", type="custom", name="wave", bodies=["ball", "ground"],
              gap=lambda a, b: a[1] - 0.1 * np.sin(2 * a[0]),
              rows=lambda a, b: [-0.2 * np.cos(2 * a[0]), 1, 0, 0, 0, 0], **law)
    return scene


def test_a_contact_written_in_python():
    bias = lambda a, b, va, vb: 0.4 * np.sin(2 * a[0]) * va[0] ** 2
    runs = [orthant.simulate(wave(e_n=0.5, bias=given), integrator="event-driven", step=0.1) for given in (bias, None)]
    for run in runs:
        assert run.solved and "wave.gap" in run.columns and run["wave.gap"].min() > -1e-9
        assert run.events["kind"][0] == "impact" and run.events["contact"][0] == "wave"
        # Free fall onto the wave: 0.5 - 9.81 t^2 / 2 = 0.1 sin(0.8 t).
        t = run.events["t"][0]
        assert abs(0.5 - 9.81 * t * t / 2 - 0.1 * np.sin(0.8 * t)) < 1e-9
    assert np.abs(runs[0].table[-1][:7] - runs[1].table[-1][:7]).max() < 1e-7
    assert orthant.simulate(wave(), duration=0.5).solved
    with_friction = orthant.Scene(gravity=[0, -9.81], duration=0.5, step=1e-3)  # a floor, with slip
    with_friction.add("body", name="block", mass=1, inertia=1, velocity=[2, 0])
    with_friction.add("contact", type="custom", name="floor", bodies=["block", "ground"], mu=0.2, gap=lambda a, b: a[1],
                      rows=lambda a, b: [[0, 1, 0, 0, 0, 0], [1, 0, 0, 0, 0, 0]])
    run = orthant.simulate(with_friction)
    assert np.isclose(run["block.vx"][-1], 2 - 0.2 * 9.81 * 0.5, atol=1e-9)


def test_a_custom_contact_that_is_wrong_is_refused():
    def changed(scene, place, value):
        scene._customs[0][place] = value
        return scene

    wrong = changed(wave(), "rows", lambda a, b: [0.2 * np.cos(2 * a[0]), 1, 0, 0, 0, 0])
    with pytest.raises(ValueError, match='contact "wave": rows.normal by the x of body 0 is'):
        orthant.simulate(wrong)
    with pytest.raises(ValueError, match="bias of rows.normal is"):
        orthant.simulate(wave(bias=lambda a, b, va, vb: 7.0))
    with pytest.raises(TypeError, match="gap returned no number"):
        orthant.simulate(changed(wave(), "gap", lambda a, b: "far"))
    with pytest.raises(ZeroDivisionError):  # what a callback raises is passed on
        orthant.simulate(changed(wave(), "gap", lambda a, b: a[1] - 0.1 * np.sin(2 * a[0]) if a[1] > 0.3 else 1 // 0))
    with pytest.raises(ValueError, match='bodies: "nobody": must be the name of a body'):
        orthant.simulate(changed(wave(), "a", ["nobody"]))
    with pytest.raises(TypeError, match="gap = 3: must be a function"):
        orthant.Scene().add("contact", type="custom", bodies=["a", "b"], gap=3, rows=3)
    with pytest.raises(ValueError, match="nu: must be one of"):
        orthant.Scene().add("contact", type="custom", bodies=["a", "b"], nu=3)
    with pytest.raises(ValueError, match='contact "wave" is written in Python'):
        wave().toml()


def test_gears_from_python():
    scene = orthant.Scene(duration=1.0, step=1e-3)
    for name, inertia, x in (("a", 0.5, 0), ("b", 2, 3)):
        scene.add("body", name=name, mass=1, inertia=inertia, position=[x, 0])
        scene.add("joint", type="revolute", bodies=["ground", name], point_a=[x, 0])
    scene.add("joint", type="gear", name="teeth", bodies=["a", "b"], ratio=-0.5)
    scene.add("load", body="a", torque=3)
    run = orthant.simulate(scene, integrator="event-driven", step=0.1)
    assert np.isclose(run["a.theta"][-1], 1.5 / (0.5 + 0.25 * 2), atol=1e-9)
    assert np.allclose(run["b.theta"], -0.5 * run["a.theta"], atol=1e-10)


def test_repr():
    assert repr(ball()) == "Scene(gravity=[0, -9.81], duration=1.0, step=0.001, 1 body, 1 contact)"
    assert repr(wave()).endswith("1 body, 1 contact)")
    named = orthant.Scene.named("slider_crank", mu=0.1)
    assert repr(named) == "Scene('slider_crank', set=['mu=0.1'], 3 bodies, 4 contacts)"


def test_added_elements_are_checked_at_once_in_the_words_of_the_file_reader(tmp_path):
    scene = orthant.Scene(gravity=[0, -9.81])
    scene.add("body", name="b", mass=1, inertia=1)
    wrong = [("body", dict(name="c", mass=-1, inertia=1), 'body "c": mass = -1: must be > 0'),
             ("body", dict(name="c", mass=float("nan"), inertia=1), 'body "c": mass = nan: must be finite'),
             ("body", dict(name="c", mass=1, inertia=1, positon=[0, 1]), 'body "c": unknown key "positon"'),
             ("contact", dict(type="disc-wall", body="b", radius=-1,
                              wall={"normal": [0, 1]}), 'contact "contact1": radius = -1: must'),
             ("contact", dict(type="disc-wall", body="b", radius=1,
                              wall={"normal": [0, 0]}), "wall.normal = .* a direction, not zero"),
             ("joint", dict(type="revolute", name="pin", bodies=["b", "b"]), 'joint "pin": joins body "b" to itself'),
             ("body", dict(name="b", mass=1, inertia=1), 'body "b": name = "b": must be distinct, is taken'),
             ("load", dict(body="b", force=[0, np.nan]), 'load "load1": force = nan: must be finite')]
    for kind, keys, words in wrong:
        with pytest.raises(ValueError, match="^" + words if words[0] != "w" else words) as said:
            scene.add(kind, **keys)
        assert "scene:" not in str(said.value)
        if kind == "body" and keys["name"] == "c":  # a file's error ends with the same words
            file = tmp_path / "wrong.toml"
            file.write_text("[[body]]\n" + "\n".join(f"{key} = {value!r}" for key, value in keys.items()),
                            encoding="utf-8")
            with pytest.raises(ValueError) as read:
                orthant.Scene.load(file)
            assert str(read.value).endswith(": " + str(said.value))
    assert repr(scene).endswith("1 body)")  # nothing wrong was kept
    scene.add("joint", type="revolute", name="late", bodies=["b", "later"])  # named before it is there
    scene.add("body", name="later", mass=1, inertia=1)
    scene.add("friction", joint="late", bound=1)
    with pytest.raises(ValueError, match='friction "friction2": bound = -1'):
        scene.add("friction", joint="late", bound=-1)
    assert orthant.simulate(scene, duration=0.01).solved
    with pytest.raises(ValueError, match="gravity = nan: must be finite"):
        orthant.Scene(gravity=[0, np.nan]).add("body", name="b", mass=1, inertia=1)
    with pytest.raises(ValueError, match='body "b": inertia = .* that of a body'):
        orthant.Scene(dimension=3).add("body", name="b", mass=1, inertia=[1, 1, 3])


def test_a_name_in_place_of_keys_is_told_where_it_belongs():
    with pytest.raises(TypeError, match=r"Scene\.named\('slider_crank'\)"):
        orthant.Scene("slider_crank")
