"""Derivatives of solutions from Python: against differences of solves, adjoint against tangent, what is refused."""

import copy
import pickle
import sys

import numpy as np
import orthant
import pytest
import scipy.sparse as sp

from support import random_problem


def moved(M, q, dM, dq, step):
    return orthant.solve(M + step * dM, q + step * dq, solver="lemke").z


@pytest.mark.parametrize("form", [np.asarray, sp.csr_matrix])
def test_tangents_are_differences_of_solves_and_adjoints_their_transposes(form):
    M, q = random_problem(8)
    random = np.random.default_rng(5)
    problem = orthant.Problem(form(M), q)
    s = orthant.sensitivity(problem, orthant.solve(problem))
    assert s.degenerate == [] and not s.redundant and 0 < s.unknowns <= 8
    dM, dq = random.normal(size=(8, 8)), random.normal(size=8)
    t = s.jvp(dM=form(dM), dq=dq)
    step = 1e-6
    difference = (moved(M, q, dM, dq, step) - moved(M, q, dM, dq, -step)) / (2 * step)
    assert np.allclose(t.z, difference, atol=1e-7 * (1 + abs(difference).max()))
    g, h = random.normal(size=8), random.normal(size=8)
    back = s.vjp(g, h)
    dense = back.M.toarray() if sp.issparse(back.M) else back.M
    assert np.isclose((dense * dM).sum() + back.q @ dq, g @ t.z + h @ t.w, rtol=1e-11)


@pytest.mark.parametrize("again", [copy.deepcopy, lambda s: pickle.loads(pickle.dumps(s))])
def test_a_sensitivity_goes_to_other_processes(again):
    M, q = random_problem(6)
    problem = orthant.Problem(M, q)
    s = orthant.sensitivity(problem, orthant.solve(problem))
    other = again(s)
    assert repr(other) == repr(s)
    np.testing.assert_array_equal(other.jvp(dq=q).z, s.jvp(dq=q).z)


def test_bounds_friction_and_the_parts_of_an_operator():
    W = np.array([[0.0, 1.0, 0.5], [1.0, 0.0, -0.5]])
    A = orthant.Delassus(sp.csr_matrix(W), np.array([1.0, 2.0, 0.5]), np.array([0.1, 0.1]))
    problem = orthant.Problem(A, [-1.0, 3.0], friction=[(1, 0, 0.3)])
    result = orthant.solve(problem)
    s = orthant.sensitivity(problem, result)
    assert np.isclose(result.z[1], -0.3 * result.z[0])  # slides
    d_mass = np.array([0.3, -0.2, 0.1])
    t = s.jvp(dM=orthant.Delassus(sp.csr_matrix((2, 3)), d_mass), dmu=[0.5])

    def at(step):
        B = orthant.Delassus(A.W, A.inverse_mass + step * d_mass, A.regularization)
        return orthant.solve(B, [-1.0, 3.0], friction=[(1, 0, 0.3 + step * 0.5)]).z

    assert np.allclose(t.z, (at(1e-6) - at(-1e-6)) / 2e-6, atol=1e-8)
    back = s.vjp([0.0, 1.0])
    assert isinstance(back.M, orthant.Delassus)
    assert np.isclose(back.M.inverse_mass @ d_mass + back.mu @ [0.5], t.z[1], rtol=1e-10)


def test_weakly_active_rows_are_named_and_choose():
    problem = orthant.Problem(np.diag([2.0, 1.0]), [-2.0, 0.0], 0.0, [5.0, 1.0])
    s = orthant.sensitivity(problem, orthant.solve(problem))
    (row,) = s.degenerate
    assert row.row == 1 and row.distance == 0 and row.w == 0
    assert "row 1 is weakly active" in str(s)
    assert s.directional(dq=[0, -3]).z[1] == 3 and s.directional(dq=[0, 3]).z[1] == 0 and s.jvp(dq=[0, -3]).z[1] == 0
    assert s.directional(dlo=[0, 2]).z[1] == 2


def test_redundant_rows_say_what_is_unique():
    problem = orthant.Problem(np.ones((2, 2)), [-2.0, -2.0])
    result = orthant.solve(problem, solver="pgs")
    s = orthant.sensitivity(problem, result)
    if s.redundant:  # both rows are active
        assert s.vjp([1, 1]).consistent and not s.vjp([1, -1]).consistent
    assert np.allclose(s.directional(dq=[1, 1]).w, 0, atol=1e-12)


def test_refusals_name_the_argument():
    problem = orthant.Problem(np.eye(2), [-1.0, 1.0])
    result = orthant.solve(problem)
    with pytest.raises(TypeError, match="problem"):
        orthant.sensitivity(np.eye(2), result)
    with pytest.raises(TypeError, match="result = None: must be a Result"):
        orthant.sensitivity(problem, None)
    s = orthant.sensitivity(problem, result)
    with pytest.raises(ValueError, match="dq"):
        s.jvp(dq=[1.0])
    with pytest.raises(ValueError, match="g"):
        s.vjp([1.0, np.nan])
    other = orthant.solve(-np.eye(2), [-1.0, 1.0])
    with pytest.raises(ValueError, match="must be solved or rounded"):
        orthant.sensitivity(problem, other)


def central(make, key, value, column, step):
    high, low = (make(**{key: value + sign * step}) for sign in (1, -1))
    return (high.final[column] - low.final[column]) / (2 * step)


def test_gradients_of_a_run_are_central_differences_of_runs():
    def run(**options):
        return orthant.simulate(orthant.Scene.named("slider_crank", **options), step=1e-4, duration=0.05)

    made = run()
    found = made.gradient("crank.theta", wrt=["mu", "e", "start.crank.omega"])
    assert found.of == "crank.theta" and found.degenerate == [] and found.inconsistent == 0
    assert found.t[-1] == 0.05 and found.values[-1] == made.final["crank.theta"] and found.by.shape == (501, 3)
    assert np.isclose(found.final["mu"], central(run, "mu", 0.01, "crank.theta", 1e-7), rtol=1e-6)
    assert np.isclose(found.final["e"], central(run, "e", 0.4, "crank.theta", 4e-7), rtol=1e-5)
    assert found.final["start.crank.omega"] > 0
    again = orthant.gradient("slider_crank", "crank.theta", "mu", step=1e-4, duration=0.05, every=100)
    assert again.by[-1, 0] == found.by[-1, 0] and len(again.t) == 6


def test_gradients_of_a_run_of_rattle_are_central_differences_in_both_modes():
    def run(**options):
        return orthant.simulate(orthant.Scene.named("slider_crank", **options), integrator="rattle", step=1e-4,
                                duration=0.03)

    made = run()
    for mode in ("forward", "reverse"):
        found = made.gradient("crank.theta", wrt=["mu", "clearance"], at="end", mode=mode)
        assert np.isclose(found.final["mu"], central(run, "mu", 0.01, "crank.theta", 1e-7), rtol=1e-5)
        assert np.isclose(found.final["clearance"], central(run, "clearance", 1e-3, "crank.theta", 1e-8), rtol=1e-4)


def test_gradients_of_a_run_in_space_are_central_differences_in_both_modes():
    def run(**options):
        return orthant.simulate(orthant.Scene.named("spatial_slider_crank", **options), step=1e-3, duration=0.1)

    made = run()
    parameters = ["omega", "rod_spin", "start.rod.wx"]
    forward, reverse = (made.gradient("slider.x", parameters, at="end", mode=mode) for mode in ("forward", "reverse"))
    assert np.isclose(forward.final["omega"], central(run, "omega", 6.0, "slider.x", 1e-6), rtol=1e-6)
    assert np.allclose(forward.by, reverse.by, rtol=1e-8, atol=1e-12)
    with pytest.raises(ValueError, match="must be moreau-jean, for scenes in space"):
        orthant.gradient("masse", "ball.x", "mu", integrator="rattle")
    with pytest.raises(ValueError, match="rx, ry, rz"):
        orthant.gradient("masse", "ball.x", "start.ball.theta")
    with pytest.raises(ValueError, match="the scene must be planar"):
        orthant.lyapunov("masse", duration=1, integrator="event-driven")


def test_gradients_take_keys_of_texts_and_entries_of_arrays():
    scene = orthant.Scene(gravity=[0, -9.81], duration=0.6, step=1e-3)
    scene.add("body", name="ball", mass=1, inertia=0.004, position=[0, 1], velocity=[5, 0])
    scene.add("contact", name="floor", type="disc-wall", body="ball", radius=0.1, wall={"normal": [0, 1]}, e_n=0.5,
              mu=0.1)
    found = orthant.gradient(scene, "ball.vx", ["contact.floor.mu", "body.ball.velocity[0]", "gravity[1]"])
    ball = orthant.simulate(scene)
    assert np.isclose(found.final["body.ball.velocity[0]"], 1, rtol=1e-9)  # it slides all the time
    slowed = ball.final["ball.vx"] - 5
    assert np.isclose(found.final["contact.floor.mu"], slowed / 0.1, rtol=1e-8)  # proportional to mu
    assert np.isclose(found.final["gravity[1]"], slowed / -9.81, rtol=1e-8)


def test_gradients_warn_as_the_command_does():
    ball = orthant.Scene(duration=0.1, step=0.01)
    ball.add("body", name="ball", mass=2, inertia=1, position=[0, 1])
    ball.add("contact", type="disc-wall", name="floor", body="ball", radius=1, wall={"normal": [0, 1]})
    with pytest.warns(orthant.OrthantWarning,
                      match=r"^10 steps have weakly active contacts, the first at t = 0 s \(floor\)"):
        assert len(orthant.gradient(ball, "ball.y", "body.ball.mass").degenerate) == 10
    elastic = orthant.Scene.named("bouncing_ball", e=1.0)
    with pytest.warns(orthant.OrthantWarning, match="e = 1 is at the end of its range: the derivative is one-sided"):
        orthant.gradient(elastic, "ball.y", "e", duration=0.01)


def test_gradients_refuse_in_words():
    with pytest.raises(ValueError, match="BODY.COLUMN"):
        orthant.gradient("slider_crank", "crank.gap", "mu")
    with pytest.raises(ValueError, match="must be moreau-jean or rattle, or event-driven"):
        orthant.gradient("slider_crank", "crank.theta", "mu", integrator="adaptive")
    with pytest.raises(ValueError, match="parameter 'nu'"):
        orthant.gradient("slider_crank", "crank.theta", "nu")
    with pytest.raises(ValueError, match="a setting of the run"):
        orthant.gradient("slider_crank", "crank.theta", "duration")


def test_friction_that_begins_has_a_derivative_of_the_motion():
    with pytest.warns(orthant.OrthantWarning, match="mu = 0 is at the end of its range: the derivative is one-sided"):
        d = orthant.gradient(orthant.Scene.named("slider_crank", mu=0.0, e=0.4), "crank.theta", "mu", duration=0.05,
                             step=0.05, integrator="event-driven")
    assert d.final["mu"] == pytest.approx(-0.55541990, rel=1e-6)  # differences of runs, one-sided


def crank(mu=0.01, e=0.4):
    return orthant.Scene.named("slider_crank", mu=mu, e=e)


HOW = {"step": 1e-4, "duration": 0.02, "every": 20}
WRT = ["mu", "e", "clearance", "start.crank.omega", "start.slider.vy", "start.rod.theta"]


def test_reverse_mode_is_forward_mode():
    run = orthant.simulate(crank(), **HOW)
    for column in ("crank.theta", "corner1.gap", "corner2.impulse_n"):
        rows = run.gradient(column, WRT)
        end, total = (run.gradient(column, WRT, at=at, mode="reverse") for at in ("end", "sum"))
        assert np.allclose(end.by[0], rows.by[-1], rtol=1e-8, atol=1e-12)
        assert np.allclose(total.by[0], rows.by.sum(axis=0), rtol=1e-8, atol=1e-12)
        assert np.isclose(total.values[0], rows.values.sum()) and end.t[0] == run.t[-1]
        assert np.allclose(
            run.gradient(column, WRT, at="end").by, run.gradient(column, WRT, at="end", mode="forward").by, rtol=1e-8
        )
    assert abs(run.gradient("corner2.impulse_n", "mu").by).max() > 0


def test_products_with_the_jacobian_of_a_run_and_its_transpose():
    run = orthant.simulate(crank(), **HOW)
    columns, change = ["crank.theta", "slider.y"], {"mu": 0.3, "e": -2.0}
    t = run.jvp(columns, change)
    assert t.change.shape == (len(run), 2) == t.values.shape and np.allclose(t.values[:, 0], run["crank.theta"],
                                                                             rtol=1e-12)
    weights = np.random.default_rng(3).normal(size=len(run))
    back = run.vjp({"crank.theta": weights, "slider.y": 2.0}, list(change))
    assert np.isclose(back.value, weights @ run["crank.theta"] + 2 * run["slider.y"][-1], rtol=1e-12)
    tangent = weights @ t.change[:, 0] + 2 * t.change[-1, 1]
    assert np.isclose(sum(back.gradient[key] * value for key, value in change.items()), tangent, rtol=1e-8)
    with pytest.raises(ValueError, match="has 10 entries: must have 11, one a record"):
        run.vjp({"crank.theta": weights[:-1]}, "mu")
    with pytest.raises(ValueError, match="mode"):
        run.gradient("crank.theta", "mu", mode="reverse")


@pytest.mark.parametrize("call, rule", [
    (lambda run: run.jvp("crank.theta", "mu"), r"change = 'mu': must be a mapping \{parameter: number\}"),
    (lambda run: run.jvp("x", [1.0]), r"change = \[1.0\]: must be a mapping"),
    (lambda run: run.jvp("x", None), "change = None: must be a mapping"),
    (lambda run: run.jvp("crank.theta", {}), r"change = \{\}: must have at least one entry"),
    (lambda run: run.jvp("crank.theta", {1: 1.0}), "a key of change = 1: must be a name"),
    (lambda run: run.jvp("crank.theta", {"mu": "a lot"}), r"change\['mu'\] = 'a lot': must be a number"),
    (lambda run: run.jvp("crank.theta", {"mu": float("nan")}), r"change\['mu'\] = nan: must be finite"),
    (lambda run: run.jvp(None, {"mu": 1.0}), "of = None: must be a name or a sequence of names"),
    (lambda run: run.jvp(["crank.theta", 2], {"mu": 1.0}), r"of\[1\] = 2: must be a name"),
    (lambda run: run.jvp([], {"mu": 1.0}), r"of = \[\]: must have at least one name"),
    (lambda run: run.vjp("crank.theta", "mu"), "weights = 'crank.theta': must be a mapping"),
    (lambda run: run.vjp({}, "mu"), r"weights = \{\}: must have at least one entry"),
    (lambda run: run.vjp({"crank.theta": "x"}, "mu"), r"weights\['crank.theta'\] = 'x': must be a number, or an array"),
    (lambda run: run.vjp({"crank.theta": None}, "mu"), r"weights\['crank.theta'\] = None: must be a number, or an"),
    (lambda run: run.vjp({"crank.theta": [[1.0]]}, "mu"), r"weights\['crank.theta'\] has the shape \(1, 1\)"),
    (lambda run: run.vjp({"crank.theta": [1.0, np.inf]}, "mu"), r"weights\['crank.theta'\] = .*: must be finite"),
    (lambda run: run.vjp({"crank.theta": 1.0}, 3), "wrt = 3: must be a name or a sequence of names"),
    (lambda run: run.gradient("crank.theta", {"mu": 1}), "wrt = .*: must be a name or a sequence of names"),
    (lambda run: run.gradient("crank.theta", []), r"wrt = \[\]: must have at least one name"),
    (lambda run: run.gradient(["crank.theta"], "mu"), "of = .*: must be a text"),
    (lambda run: run.gradient("crank.theta", "mu", at=np.zeros(2)), "at = .*: must be 'records', 'end' or 'sum'"),
    (lambda run: run.gradient("crank.theta", "mu", mode=[]), r"mode = \[\]: must be 'auto', 'forward' or 'reverse'"),
    (lambda run: orthant.gradient("slider_crank", "crank.theta", "mu", step="small"), "step = 'small': must be a num"),
    (lambda run: orthant.lyapunov("impact_oscillator", duration=None), r"duration = None: must be a number \[s\]"),
    (lambda run: orthant.lyapunov("impact_oscillator", duration=1.0, transient=None), "transient = None: must be a nu"),
    (lambda run: orthant.lyapunov("impact_oscillator", duration=1.0, transient=-1), "transient = -1: must be >= 0"),
    (lambda run: orthant.sensitivity("x", "y"), "problem = 'x': must be a Problem"),
])
def test_wrong_arguments_of_derivatives_are_named_with_the_rule(call, rule):
    run = orthant.simulate(crank(), step=1e-3, duration=2e-3)
    with pytest.raises((TypeError, ValueError), match=f"^{rule}") as refused:
        call(run)
    assert "\n" not in str(refused.value)


def test_wrong_arguments_of_products_of_a_solution_are_named():
    problem = orthant.Problem(np.diag([2.0, 1.0]), [-2.0, 1.0])
    s = orthant.sensitivity(problem, orthant.solve(problem))
    for call, field in [(lambda: s.jvp(dq="x"), "dq"), (lambda: s.jvp(dq={"a": 1}), "dq"),
                        (lambda: s.jvp(dM="x"), "dM"),
                        (lambda: s.jvp(dmu=1.0), "dmu"), (lambda: s.directional(dlo=[1.0]), "dlo"),
                        (lambda: s.vjp("x"), "g"), (lambda: s.vjp(None), "g"), (lambda: s.vjp([1.0, 0], h="x"), "h"),
                        (lambda: s.vjp([1.0, np.nan]), "g")]:
        with pytest.raises((TypeError, ValueError), match=rf"^{field}\b") as refused:
            call()
        assert "\n" not in str(refused.value)


@pytest.mark.parametrize("framework", ["torch", "jax"])
def test_wrong_arguments_of_frameworks_are_named(framework):
    library = pytest.importorskip(framework)
    wrap = orthant.as_torch if framework == "torch" else orthant.as_jax
    for given, rule in [((None, "crank.theta", "mu"), "make = None: must be a function"),
                        ((crank, 1, "mu"), "of = 1"), ((crank, "crank.theta", None), "wrt = None"),
                        ((crank, ["crank.theta"] * 2, "mu"), "of: 'crank.theta' is there twice"),
                        ((crank, "crank.theta", ["mu", "mu"]), "wrt: 'mu' is there twice")]:
        with pytest.raises((TypeError, ValueError), match=f"^{rule}"):
            wrap(*given)
    with pytest.raises(TypeError, match="^steps: is no setting of a run"):
        wrap(crank, "crank.theta", ["mu", "e"], steps=3)
    run = wrap(crank, "crank.theta", ["mu", "e"], **HOW)
    array = library.tensor if framework == "torch" else library.numpy.asarray
    for given, rule in [(array([0, 1]), "parameters: must be real numbers in floating point"),
                        (array([0.1]), "parameters: must be a vector of 2 numbers"),
                        ([0.1, 0.2], r"parameters = \[0.1, 0.2\]: must be a")]:
        with pytest.raises((TypeError, ValueError), match=f"^{rule}"):
            run(given)


@pytest.mark.parametrize("framework", ["torch", "jax"])
def test_frameworks_differentiate_through_a_run(framework):
    library = pytest.importorskip(framework)
    expected = orthant.gradient(crank(), "crank.theta", ["mu", "e"], at="end", **HOW)
    if framework == "torch":
        p = library.tensor([0.01, 0.4], dtype=library.float64, requires_grad=True)
        run = orthant.as_torch(crank, ["crank.theta", "slider.y"], ["mu", "e"], **HOW)
        (3 * run(p)[0]).backward()
        found = p.grad.numpy()
    else:
        library.config.update("jax_enable_x64", True)
        run = orthant.as_jax(crank, ["crank.theta", "slider.y"], ["mu", "e"], **HOW)
        found = np.asarray(library.grad(lambda p: 3 * run(p)[0])(library.numpy.array([0.01, 0.4])))
    assert np.allclose(found, 3 * expected.by[0], rtol=1e-8)


def test_pytorch_takes_a_vector_of_parameters_and_no_second_derivative():
    torch = pytest.importorskip("torch")
    run = orthant.as_torch(crank, ["crank.theta", "slider.y"], ["mu", "e"], **HOW)
    p = torch.tensor([0.01, 0.4], dtype=torch.float64, requires_grad=True)
    expected = [
        orthant.gradient(crank(), column, ["mu", "e"], at="end", **HOW).by[0] for column in ("crank.theta", "slider.y")
    ]
    assert np.allclose(torch.autograd.functional.jacobian(run, p), expected, rtol=1e-8)
    (g,) = torch.autograd.grad(run(p)[0], p, create_graph=True)
    with pytest.raises(RuntimeError, match="once_differentiable|does not require grad"):  # by PyTorch's version
        torch.autograd.grad(g.sum(), p)
    with pytest.raises(ValueError, match="a vector of 2 numbers"):
        run(p.reshape(1, 2))


def test_jax_compiles_and_maps_runs():
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    run = orthant.as_jax(crank, ["crank.theta", "slider.y"], ["mu", "e"], **HOW)
    p = jax.numpy.array([0.01, 0.4])
    expected = [
        orthant.gradient(crank(), column, ["mu", "e"], at="end", **HOW).by[0] for column in ("crank.theta", "slider.y")
    ]
    assert np.allclose(jax.jit(jax.jacrev(run))(p), expected, rtol=1e-8)
    several = jax.numpy.stack([p, 1.5 * p])
    assert np.array_equal(jax.vmap(run)(several), [run(several[0]), run(several[1])])


def test_lyapunov_exponents_of_the_impact_oscillator_are_those_of_its_floquet_multipliers():
    T = 2 * np.pi / 1.6
    how = dict(duration=20 * T, transient=10.25 * T, every=T / 4)
    found = orthant.lyapunov("impact_oscillator", 6, **how)
    assert np.isclose(found.exponents.sum(), 2 * np.log(0.8) / T, atol=1e-6) and np.isclose(found.t, 30.25 * T)
    assert np.all(np.diff(found.exponents) <= 0)
    with pytest.raises(ValueError, match="count: must be 1 ... 6"):
        orthant.lyapunov("impact_oscillator", 7, **how)
    with pytest.raises(ValueError, match="must be event-driven"):
        orthant.lyapunov("impact_oscillator", integrator="adaptive", **how)


def test_frameworks_that_are_missing_are_named(monkeypatch):
    for function, module in ((orthant.as_torch, "torch"), (orthant.as_jax, "jax")):
        monkeypatch.setitem(sys.modules, module, None)
        with pytest.raises(ModuleNotFoundError, match=f"needs .*: pip install {module}$"):
            function(crank, "crank.theta", "mu")


def test_many_parameters_of_a_motion_itself_are_by_forward_mode():
    names = ["mu", "e", "clearance", "start.crank.omega", "start.rod.omega"]
    how = {"integrator": "event-driven", "step": 0.01, "duration": 0.01}
    many = orthant.gradient("slider_crank", "energy", names, at="end", **how)
    few = orthant.gradient("slider_crank", "energy", names[:1], at="end", **how)
    assert np.allclose(many.by[0, 0], few.by[0, 0], rtol=1e-12)
