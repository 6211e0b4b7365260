"""Solvers, integrators and scenes registered from Python; joints and contacts written in it."""

import copy
import os
import pathlib
import pickle
import signal
import time

import numpy as np
import orthant
import pytest

M, q = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-5.0, -6.0])


def sweeps(problem, start):
    z = start.copy()
    A = problem.M if isinstance(problem.M, np.ndarray) else problem.M.toarray()
    for _ in range(2000):
        for i in range(len(z)):
            z[i] = np.clip(z[i] - (A[i] @ z + problem.q[i]) / A[i, i], problem.lower[i], problem.upper[i])
    return z


def test_a_solver_written_in_python_has_a_name_everywhere():
    orthant.register_solver("my-sweeps", sweeps, "projected Gauss-Seidel in Python")
    assert ("my-sweeps", "projected Gauss-Seidel in Python", "") in orthant.solvers()
    result = orthant.solve(M, q, solver="my-sweeps")
    assert result.solved and np.allclose(result.z, [4 / 3, 7 / 3])
    assert all(r.solved for r in orthant.solve_many([(M, q + t) for t in range(9)], solver="my-sweeps", threads=3))
    run = orthant.simulate("bouncing_ball", solver="my-sweeps", duration=0.5, step=1e-2)
    other = orthant.simulate("bouncing_ball", solver="lemke", duration=0.5, step=1e-2)
    np.testing.assert_allclose(run["ball.y"], other["ball.y"], atol=1e-9)
    with pytest.raises(ValueError, match="'my-sweeps': is registered already"):
        orthant.register_solver("my-sweeps", sweeps)
    with pytest.raises(ValueError, match="a name must be of a-z, 0-9, -"):
        orthant.register_solver("My Sweeps", sweeps)
    with pytest.raises(ValueError, match="a solver written in Python has none"):
        orthant.solve(M, q, solver="my-sweeps", omega=1.2)
    with pytest.raises(TypeError, match="must be a function"):
        orthant.register_solver("no-function", 3)


def test_the_judge_decides_what_a_solver_of_ones_own_has_solved():
    orthant.register_solver("liar", lambda problem, start: np.ones(len(problem)))
    orthant.register_solver("quitter", lambda problem, start: None)
    orthant.register_solver("breaker", lambda problem, start: 1 / 0)
    assert not orthant.solve(M, q, solver="liar").solved
    assert orthant.solve(M, q, solver="quitter").status == "stalled"
    with pytest.raises(ZeroDivisionError):
        orthant.solve(M, q, solver="breaker")


def test_a_scene_has_a_name_and_takes_overrides():
    scene = orthant.Scene(gravity=[0, -9.81], duration=0.5)
    scene.add("body", name="ball", mass=1, inertia=0.004, position=[0, 1])
    scene.add("contact", type="disc-wall", name="floor", body="ball", radius=0.1, wall={"normal": [0, 1]}, e_n=0.5)
    orthant.register_scene("my_ball", scene)
    run = orthant.simulate("my_ball", integrator="adaptive")
    np.testing.assert_array_equal(run.table[:, 1:3], orthant.simulate(scene, integrator="adaptive").table[:, 1:3])
    with pytest.raises(ValueError, match="'my_ball': is registered already"):
        orthant.register_scene("my_ball", scene)
    with pytest.raises(TypeError, match="must be a Scene"):
        orthant.register_scene("other", "text")


def test_a_named_scene_gets_another_name_with_its_options_set():
    orthant.register_scene("rough_crank", orthant.Scene.named("slider_crank", mu=0.3, e=0.5))

    def final(scene, **options):
        run = orthant.simulate(orthant.Scene.named(scene, **options), duration=0.02, step=1e-4)
        return run.table[-1].tolist()

    assert final("rough_crank") == final("slider_crank", mu=0.3, e=0.5) != final("slider_crank")
    assert final("rough_crank", mu=0.1) == final("slider_crank", mu=0.1, e=0.5)
    with pytest.raises(ValueError, match="unknown option 'no_such'"):
        final("rough_crank", no_such=1)


def test_names_of_this_process_are_in_its_sweeps(tmp_path):
    pd = pytest.importorskip("pandas")
    orthant.register_solver("swept-sweeps", sweeps)
    orthant.register_integrator("swept-euler", semi_implicit)
    orthant.register_scene("swept_elbow", double_pendulum(residual=lambda a, b: elbow_residual(a, b), rows=elbow_rows))
    ask = {"duration": 0.01, "measure": "b.y", "progress": False, "reference": "moreau-jean"}
    grid = {"integrator": ["moreau-jean", "swept-euler"], "solver": ["lemke", "swept-sweeps"], "step": [1e-3]}
    frame = orthant.sweep("swept_elbow", results=tmp_path / "e.sqlite", grid=grid, **ask)
    assert len(frame) == 4 and (frame["status"] == "solved").all(), frame["why"]
    run = orthant.simulate("swept_elbow", integrator="swept-euler", solver="lemke", duration=0.01, step=1e-3)
    mine = frame[(frame["integrator"] == "swept-euler") & (frame["solver"] == "lemke")]
    assert mine["value"].iloc[0] == run.final["b.y"]
    again = orthant.sweep("swept_elbow", results=tmp_path / "e.sqlite", grid=grid, **ask)
    assert again["seconds"].equals(frame["seconds"])  # nothing ran
    with pytest.raises(ValueError, match="'swept-euler': is registered in this process only"):
        orthant.sweep("swept_elbow", results=tmp_path / "f.sqlite", grid=grid, client="tcp://nowhere:1", **ask)
    # A scene with a text is a file to the processes of a sweep, so its rows notice a change.
    ball = orthant.Scene(gravity=[0, -9.81])
    ball.add("body", name="ball", mass=1, inertia=0.004, position=[0, 1])
    orthant.register_scene("swept_ball", ball)
    ask.update(measure="ball.y", grid={"integrator": "moreau-jean", "step": 1e-3, "set": {"body.ball.mass": [1, 2]}})
    assert len(orthant.sweep("swept_ball", results=tmp_path / "b.sqlite", **ask)) == 2
    assert (tmp_path / "b.scene.toml").exists() and isinstance(frame, pd.DataFrame)


def test_own_names_in_sweeps_run_apart_from_this_process(tmp_path):
    pytest.importorskip("pandas")
    here, ran = os.getpid(), []

    def slow_or_dead(problem, start):
        ran.append(1)  # not seen in this process
        assert os.getpid() != here
        if problem.q[0] < -0.15:  # of steps of 0.02 s
            os.kill(os.getpid(), signal.SIGKILL)
        if problem.q[0] < -0.07:
            time.sleep(1000)
        return sweeps(problem, start)

    orthant.register_solver("slow-or-dead", slow_or_dead)
    stone = orthant.Scene(gravity=[0, -9.81])
    stone.add("body", name="stone", mass=1, inertia=0.004, position=[0, 0.1])
    stone.add("contact", type="disc-wall", name="floor", body="stone", radius=0.1, wall={"normal": [0, 1]})
    orthant.register_scene("rolling_stone", stone)
    def statuses(**grid):
        frame = orthant.sweep("rolling_stone", results=tmp_path / "s.sqlite", duration=0.1, measure="stone.y",
                              progress=False, grid={"integrator": "moreau-jean", "solver": "slow-or-dead",
                                                    **grid}, jobs=2)
        return dict(zip(frame["step"], frame["status"]))

    assert statuses(step=[0.02, 0.005]) == {0.02: "crashed", 0.005: "solved"}
    assert statuses(step=[0.01], time_limit=1)[0.01] == "time_limit"
    assert ran == []


def test_a_scene_in_space_has_a_name(tmp_path):
    pytest.importorskip("pandas")
    scene = orthant.Scene(dimension=3, gravity=[0, 0, -9.81], duration=0.1)
    scene.add("body", name="ball", mass=2, inertia=0.004, position=[0, 0, 1], omega=[1, 2, 3])
    orthant.register_scene("ball_in_space", scene)
    run = orthant.simulate("ball_in_space")
    assert run.final["ball.z"] == orthant.simulate(scene).final["ball.z"] != 1
    orthant.register_scene("tilted_top", orthant.Scene.named("top"))
    assert orthant.simulate("tilted_top", duration=0.01).final == orthant.simulate("top", duration=0.01).final
    for scenes in (scene, orthant.Scene.named("bouncing_ball")):
        with pytest.raises(ValueError, match="'ball_in_space': is registered already"):
            orthant.register_scene("ball_in_space", scenes)
    assert "ball_in_space" in [entry.name for entry in orthant.scenes()]
    orthant.register_solver("swept-in-space", sweeps)
    frame = orthant.sweep("ball_in_space", results=tmp_path / "b.sqlite", duration=0.1, measure="ball.z",
                          progress=False,
                          grid={"integrator": ["moreau-jean", "rattle"], "solver": "swept-in-space", "step": [0.01]})
    assert (frame["status"] == "solved").all() and (frame["value"] - (1 - 0.04905)).abs().max() < 5e-3


def test_runs_of_scenes_with_lambdas_are_pickled_without_them(tmp_path):
    scene = double_pendulum(residual=lambda a, b: elbow_residual(a, b), rows=lambda a, b: elbow_rows(a, b))
    run = orthant.simulate(scene, duration=0.05)
    for copied in (pickle.loads(pickle.dumps(run)), copy.deepcopy(run)):
        assert copied.table.tolist() == run.table.tolist() and copied.final == run.final and len(copied.events) == 0
        copied.write(tmp_path / "run.csv")
        copied.view(tmp_path / "run.html")
        assert (tmp_path / "run.html").read_bytes() == pathlib.Path(run.view(tmp_path / "its.html")).read_bytes()
        with pytest.raises(RuntimeError, match='joint "elbow": rows: a copied run does not keep'):
            orthant._orthant._simulate(copied._scene, "moreau-jean", "auto", 1e-3, 0.01, 1, None, False, False, False,
                                       print)
    assert orthant.simulate(scene, duration=0.05).table.tolist() == run.table.tolist()


def semi_implicit(step):
    """Velocities first, by one problem of closed gaps without friction; joints at velocity level."""
    here = step.terms(step.t, step.q, step.v)
    free = step.v + step.h * here["f"] / step.mass
    closed = here["gap"] + step.h * (here["W_N"] @ step.v) <= 0
    W = here["W_N"][closed]
    rows = np.vstack([here["G"], W])
    if len(rows) == 0:
        return step.q + step.h * free, free
    A = rows @ (rows / step.mass).T
    wanted = np.concatenate([-here["joint_rate"], step.e_n[closed] * (W @ step.v)])
    lower = np.concatenate([np.full(len(here["G"]), -np.inf), np.zeros(len(W))])
    impulse = step.solve(A, rows @ free + wanted, lower)
    if impulse is None:
        return None
    v = free + (impulse @ rows) / step.mass
    impulses = np.zeros((len(here["gap"]), 2))
    impulses[closed, 0] = impulse[len(here["G"]):]
    return step.q + step.h * v, v, impulses


def test_an_integrator_written_in_python_has_a_name():
    orthant.register_integrator("my-euler", semi_implicit, "semi-implicit Euler in Python")
    assert ("my-euler", "semi-implicit Euler in Python", "") in orthant.integrators()
    run = orthant.simulate("bouncing_ball", integrator="my-euler", step=1e-3, duration=1.0)
    exact = orthant.simulate("bouncing_ball", integrator="event-driven", step=1e-3, duration=1.0)
    assert run.solved and np.max(np.abs(run["ball.y"] - exact["ball.y"])) < 0.02
    assert np.isclose(
        run.table[:, run.columns.index(next(c for c in run.columns if c.endswith("impulse_n")))].sum(),
        exact.table[:, exact.columns.index(next(c for c in exact.columns if c.endswith("impulse_n")))].sum(),
        rtol=0.05,
    )
    swing = orthant.simulate("pendulum", integrator="my-euler", step=1e-4, duration=0.2)
    other = orthant.simulate("pendulum", integrator="rattle", step=1e-4, duration=0.2)
    assert swing.solved and 0 < swing.summary["max_joint_residual"] < 1e-3  # measured, not taken on trust
    assert np.max(np.abs(swing.table[:, 1:4] - other.table[:, 1:4])) < 1e-3
    with pytest.raises(ValueError, match="'my-euler': is registered already"):
        orthant.register_integrator("my-euler", semi_implicit)
    with pytest.raises(ValueError, match="an integrator written in Python has none"):
        orthant.simulate("pendulum", integrator="my-euler:order=2")
    with pytest.raises(ValueError, match="my-euler"):  # collisions are searched, which it does not see
        orthant.simulate("pile", integrator="my-euler")
    with pytest.raises(TypeError, match="must be a function"):
        orthant.register_integrator("no-function", None)


def test_integrators_that_give_up_or_break_end_the_run():
    kept = []
    orthant.register_integrator("gives-up", lambda step: None)
    orthant.register_integrator("returns-words", lambda step: "done")
    orthant.register_integrator("returns-nan", lambda step: (step.q * np.nan, step.v))
    orthant.register_integrator("breaks", lambda step: 1 / 0)
    orthant.register_integrator("keeps", lambda step: kept.append(step) or (step.q, step.v))
    run = orthant.simulate("bouncing_ball", integrator="gives-up")
    assert run.status == "stalled" and "gave up" in run.why and len(run) == 1
    with pytest.raises(TypeError, match=r"must return \(q, v\)"):
        orthant.simulate("bouncing_ball", integrator="returns-words")
    with pytest.raises(ValueError, match=r"q\[0\] = nan: must be finite"):
        orthant.simulate("bouncing_ball", integrator="returns-nan")
    with pytest.raises(ZeroDivisionError):
        orthant.simulate("bouncing_ball", integrator="breaks")
    orthant.simulate("bouncing_ball", integrator="keeps", duration=1e-2, step=1e-2)
    with pytest.raises(RuntimeError, match="this step is over"):
        kept[0].solve([[1.0]], [-1.0])


def double_pendulum(**own):
    """Two rods; the second pin of the built-in kind, or of one's own."""
    scene = orthant.Scene(gravity=[0, -9.81], duration=0.5, step=1e-3)
    scene.add("body", name="a", mass=1, inertia=1 / 12, position=[0.5, 0])
    scene.add("body", name="b", mass=1, inertia=1 / 12, position=[1.5, 0])
    scene.add("joint", type="revolute", name="pin", bodies=["ground", "a"], point_b=[-0.5, 0])
    if own:
        scene.add("joint", type="custom", name="elbow", bodies=["a", "b"], count=2, **own)
    else:
        scene.add("joint", type="revolute", name="elbow", bodies=["a", "b"], point_a=[0.5, 0], point_b=[-0.5, 0])
    return scene


def elbow_residual(a, b):
    return [
        a[0] + 0.5 * np.cos(a[2]) - b[0] + 0.5 * np.cos(b[2]), a[1] + 0.5 * np.sin(a[2]) - b[1] + 0.5 * np.sin(b[2])
    ]


def elbow_rows(a, b):
    return [[1, 0, -0.5 * np.sin(a[2]), -1, 0, -0.5 * np.sin(b[2])],
            [0, 1, 0.5 * np.cos(a[2]), 0, -1, 0.5 * np.cos(b[2])]]


def elbow_bias(a, b, va, vb):
    return [-0.5 * np.cos(a[2]) * va[2] ** 2 - 0.5 * np.cos(b[2]) * vb[2] ** 2,
            -0.5 * np.sin(a[2]) * va[2] ** 2 - 0.5 * np.sin(b[2]) * vb[2] ** 2]


def test_a_joint_written_in_python_moves_as_the_built_in_one():
    for integrator in ("moreau-jean", "adaptive:rtol=1e-9"):
        built_in = orthant.simulate(double_pendulum(), integrator=integrator)
        for bias in (elbow_bias, None):
            own = double_pendulum(residual=elbow_residual, rows=elbow_rows, bias=bias)
            assert "2 joints" in repr(own)
            run = orthant.simulate(own, integrator=integrator)
            assert run.solved and run.summary["max_joint_residual"] < 1e-9
            np.testing.assert_allclose(run["b.theta"], built_in["b.theta"], atol=1e-8)
    wrong = double_pendulum(residual=elbow_residual, rows=lambda a, b: -np.array(elbow_rows(a, b)))
    with pytest.raises(ValueError, match='joint "elbow": rows'):
        orthant.simulate(wrong)
    with pytest.raises(TypeError, match="residual returned something else: must be 2 numbers"):
        orthant.simulate(double_pendulum(residual=lambda a, b: 1.0, rows=elbow_rows))
    with pytest.raises(ValueError, match='joint "elbow" is written in Python'):
        double_pendulum(residual=elbow_residual, rows=elbow_rows).toml()
    with pytest.raises(ValueError, match="count = 4"):
        orthant.Scene().add("joint", type="custom", bodies=["a", "b"], count=4, residual=len, rows=len)


def test_a_joint_driven_in_time_written_in_python():
    scene = orthant.Scene(duration=1.0, step=1e-3)
    scene.add("body", name="a", mass=1, inertia=1, velocity=[0.5, 0])
    scene.add("joint", type="custom", name="drive", bodies=["a", "ground"],
              residual=lambda a, b, t: a[0] - 0.1 * np.sin(5 * t), rows=lambda a, b, t: [1, 0, 0, 0, 0, 0],
              rate=lambda a, b, t: 0.5 * np.cos(5 * t))
    run = orthant.simulate(scene, integrator="adaptive")
    assert run.solved
    np.testing.assert_allclose(run["a.x"], 0.1 * np.sin(5 * run.t), atol=1e-8)


calls = []


def ridge(a, b):
    calls.append(len(np.atleast_1d(a[0])))
    return a[1] - 0.1 * np.sin(2 * a[0]) - b[1]


def ridge_rows(a, b):
    return [-0.2 * np.cos(2 * a[0]), 1, 0, 0, -1, 0]


def test_many_contacts_in_one_call_are_the_same_as_one_by_one():
    def balls(together):
        scene = orthant.Scene(gravity=[0, -9.81], duration=0.6, step=1e-3)
        for i in range(8):
            scene.add("body", name=f"ball{i}", mass=1, inertia=0.01, position=[0.3 * i, 0.3 + 0.05 * i],
                      velocity=[0.4, 0])
        names = [f"ball{i}" for i in range(8)]
        if together:
            scene.add("contact", type="custom", name="ridge", bodies=[names, ["ground"] * 8], e_n=0.4, gap=ridge,
                      rows=ridge_rows)
        else:
            for i, name in enumerate(names):
                scene.add("contact", type="custom", name=f"ridge-{i + 1}", bodies=[name, "ground"], e_n=0.4, gap=ridge,
                          rows=ridge_rows)
        return scene

    calls.clear()
    apart = orthant.simulate(balls(False))
    one_by_one = len(calls)
    calls.clear()
    scene = balls(True)
    assert "8 contacts" in repr(scene)
    run = orthant.simulate(scene)
    assert set(calls) == {8} and len(calls) < one_by_one / 4
    assert run.columns == apart.columns and run.solved
    np.testing.assert_allclose(run.table, apart.table, rtol=1e-9, atol=1e-9)
    assert run.summary["steps"] == 600 and (run["ridge-1.impulse_n"] > 0).any()
    with pytest.raises(ValueError, match="two lists of equal length"):
        orthant.Scene().add("contact", type="custom", bodies=[["a"], ["b", "c"]], gap=len, rows=len)
    with pytest.raises(TypeError, match=r"gap returned something else: must be a distance \[m\] of each"):
        short = orthant.Scene()
        for name in ("a", "b"):
            short.add("body", name=name, mass=1, inertia=1)
        short.add("contact", type="custom", bodies=[["a", "b"], ["ground", "ground"]], gap=lambda a, b: a[1][:1],
                  rows=ridge_rows)
        orthant.simulate(short)


def test_a_scene_with_parts_in_python_has_a_name():
    orthant.register_scene("my_elbow", double_pendulum(residual=elbow_residual, rows=elbow_rows))
    run = orthant.simulate("my_elbow", duration=0.1)
    other = orthant.simulate(double_pendulum(residual=elbow_residual, rows=elbow_rows), duration=0.1)
    np.testing.assert_array_equal(run.table, other.table)
    assert run.summary["max_joint_residual"] < 1e-9


@pytest.mark.parametrize("key, value, words", [
    ("mu", "x", "contact \"wave\": mu = 'x': must be a number"),
    ("e_n", None, 'contact "wave": e_n = None: must be a number'),
    ("belt", float("inf"), 'contact "wave": belt = inf: must be finite'),
    ("length", "1", "contact \"wave\": length = '1': must be a number"),
    ("length", -1, 'contact "wave": length = -1: must be >= 0'),
])
def test_a_number_of_a_contact_in_python_that_is_none_is_named(key, value, words):
    scene = orthant.Scene()
    scene.add("body", name="ball", mass=1, inertia=0.01)
    with pytest.raises((TypeError, ValueError), match=words):
        scene.add("contact", type="custom", name="wave", bodies=["ball", "ground"], gap=lambda a, b: a[1],
                  rows=lambda a, b: [0, 1, 0, 0, 0, 0], **{key: value})
        orthant.simulate(scene, duration=0.01)
