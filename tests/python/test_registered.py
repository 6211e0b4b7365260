"""Solvers and scenes registered from Python."""

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
