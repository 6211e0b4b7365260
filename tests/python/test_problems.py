"""Linear problems from Python: every form of input, what is wrong with it in words, all solutions, copies."""

import numpy as np
import orthant
import pytest
import scipy.sparse as sp

from support import random_problem

M = np.array([[2.0, 1.0], [1.0, 2.0]])
q = np.array([-5.0, -6.0])


def test_solves_and_gives_back_what_was_recomputed():
    r = orthant.solve(M, q)
    assert r.solved and r.status == "solved"
    assert np.allclose(r.z, [4 / 3, 7 / 3], atol=1e-14)
    assert np.array_equal(r.w, M @ r.z + q)
    assert r.residual < 1e-13 and r.certificate is None


@pytest.mark.parametrize("form", [
    lambda A: A, np.asfortranarray, lambda A: A.T.copy().T, lambda A: np.repeat(A, 2, axis=1)[:, ::2],
    lambda A: A.tolist(), lambda A: A[::-1, ::-1].copy()[::-1, ::-1], lambda A: np.ascontiguousarray(A).astype(">f8"),
    sp.csr_matrix, sp.csc_matrix, sp.coo_matrix, sp.csr_array,
])
def test_layout_and_storage_do_not_matter(form):
    A, b = random_problem(7)
    A[0, 1] += 0.25  # a transposed reading would show
    expected = orthant.solve(A, b, solver="lemke").z
    assert np.allclose(orthant.solve(form(A), b).z, expected, atol=1e-12)


def test_sparse_duplicates_are_added_and_the_callers_matrix_is_left_alone():
    A = sp.csr_matrix((np.array([1.0, 1.0, 3.0]), np.array([0, 0, 1]), np.array([0, 2, 3])), shape=(2, 2))
    assert np.allclose(orthant.solve(A, [-2.0, -3.0]).z, [1, 1])
    assert A.nnz == 3


def test_boxes_free_rows_friction_and_delassus():
    assert np.allclose(orthant.solve(M, q, lower=[0, 0], upper=[1, np.inf]).z, [1, 2.5])
    assert np.allclose(orthant.solve(M, q, lower=[-np.inf] * 2).z, np.linalg.solve(M, -q))
    # A block is pushed with 3 against friction mu = 0.5 of the weight 10: it sticks; with 8 it slides, w_t = 3.
    for push, z_t, w_t in ((3, -3, 0), (8, -5, 3)):
        r = orthant.solve(np.eye(2), [-10, push], friction=[(1, 0, 0.5)])
        assert r.solved and np.allclose(r.z, [10, z_t]) and np.allclose(r.w, [0, w_t])
    W = sp.csr_matrix([[1.0, 2.0, 0.0], [0.0, 1.0, 1.0]])
    m = np.array([0.5, 0.25, 2.0])
    A = orthant.Delassus(W, m, [0.1, 0.2])
    dense = W @ np.diag(m) @ W.T + np.diag([0.1, 0.2])
    assert np.allclose(orthant.solve(A, q).z, orthant.solve(dense, q).z)


def test_infeasible_comes_with_a_proof():
    r = orthant.solve([[-1.0, 0], [0, 1]], [-1.0, 1])
    assert r.status == "infeasible" and not r.solved
    u = r.certificate
    assert u.min() >= 0 and np.all(np.array([[-1.0, 0], [0, 1]]).T @ u <= 0) and np.dot([-1, 1], u) < 0


def test_infeasible_by_search_lists_the_cells():
    # w = (z2 - 1, z1 + z2): w1 >= 0 needs z2 >= 1, where w2 > 0. z = (0, 1) has the signs, so there is no vector u.
    r = orthant.solve([[0, 1], [1, 1]], [-1, 0])
    assert r.status == "infeasible" and r.certificate is None
    search = r.cell_search
    assert search["count"] == r.cells == 4 and sorted(search["order"]) == [0, 1]
    begun = [c["sides"] for c in search["classes"]]
    for cell in ("LL", "LI", "IL", "II"):  # each belongs to one class
        assert sum(cell.startswith(sides) for sides in begun) == 1
    assert all(c["why"] for c in search["classes"])
    assert orthant.solve([[1.0]], [-1.0]).cell_search is None


def test_every_solver_solves_or_says_why_not():
    A, b = random_problem(5)
    for entry in orthant.solvers():
        r = orthant.solve(A, b, solver=entry.name)
        assert r.solved or r.status == "unsupported" and r.why_not, entry.name


def test_options_are_checked_and_reach_the_solver():
    A, b = random_problem(20)
    few = orthant.solve(A, b, solver="pgs", max_sweeps=2)
    assert few.status == "iteration_limit" and few.iterations == 2
    assert orthant.solve(A, b, solver="lemke", log=True).log
    assert orthant.solve(A, b, start=orthant.solve(A, b).z, solver="path").solved
    with pytest.raises(ValueError, match="unknown option 'omeg'.*omega"):
        orthant.solve(A, b, solver="pgs", omeg=1.3)
    with pytest.raises(ValueError, match=r"omega = 3.*must be in \[0, 2\]|omega"):
        orthant.solve(A, b, solver="pgs", omega=3.0)
    with pytest.raises(ValueError, match="'lemk'.*lemke"):
        orthant.solve(A, b, solver="lemk")
    with pytest.raises(ValueError, match="time_limit = -1"):
        orthant.solve(A, b, time_limit=-1)


@pytest.mark.parametrize("error, words, arguments", [
    (ValueError, r"M has shape \(2, 3\): must be square", (np.ones((2, 3)), q)),
    (ValueError, r"M has shape \(4,\): must have two dimensions", (np.ones(4), q)),
    (ValueError, r"M has shape \(2, 3\): must be square", (sp.csr_matrix((2, 3)), q)),
    (ValueError, r"q has shape \(3,\): must be \(2,\)", (M, np.ones(3))),
    (ValueError, r"q has shape \(2, 1\): must be \(2,\)", (M, np.ones((2, 1)))),
    (ValueError, r"M\[1, 0\] = nan: must be finite", ([[1, 2], [np.nan, 1]], q)),
    (ValueError, r"M\.data\[1\] = inf: must be finite", (sp.csr_matrix([[1.0, 0], [0, np.inf]]), q)),
    (ValueError, r"q\[1\] = -inf: must be finite", (M, [0, -np.inf])),
    (ValueError, r"lower\[0\] = nan: must be a number", (M, q, [np.nan, 0])),
    (TypeError, "M has dtype complex128: must be real", (M + 0j, q)),
    (TypeError, "q has dtype <U1: must be real", (M, ["a", "b"])),
    (TypeError, "M has dtype object", ([[None, 1], [1, 1]], q)),
    (TypeError, r"q is missing: must be \(2,\)", (M,)),
])
def test_errors_name_argument_value_and_rule(error, words, arguments):
    with pytest.raises(error, match=words):
        orthant.solve(*arguments)


def test_bad_friction_is_named():
    with pytest.raises(ValueError, match=r"friction\[0\].normal = 5"):
        orthant.solve(M, q, friction=[(1, 5, 0.3)])
    with pytest.raises(ValueError, match=r"friction\[0\].mu = -1"):
        orthant.solve(M, q, friction=[(1, 0, -1)])
    for bad, place in ((3, "friction"), ([(1, 0)], r"friction\[0\]"), ([(1, 0, 0.3), (1, 0, "a")], r"friction\[1\]")):
        with pytest.raises(TypeError, match=place + r": must be \(row, normal row, mu\) triples"):
            orthant.solve(M, q, friction=bad)


def test_times_and_files_that_are_none_are_named(tmp_path):
    for solve in (orthant.solve, orthant.Solver().solve):
        with pytest.raises(TypeError, match="time_limit = 'a': must be a number"):
            solve(M, q, time_limit="a")
        with pytest.raises(ValueError, match="time_limit = nan: must be > 0"):
            solve(M, q, time_limit=np.nan)
    with pytest.raises(ValueError, match="M.mtx: Matrix Market holds a matrix, not a problem"):
        orthant.read_problem(tmp_path / "M.mtx")


def test_analyse_says_none_where_it_does_not_know():
    a = orthant.analyse(M)
    assert a["p"] is True and a["symmetric"] is True and a["z"] is False and a["rank"] == 2
    assert orthant.analyse(np.diag([1.0, -1.0]))["p"] is False
    rng = np.random.default_rng(3)
    assert orthant.analyse(rng.standard_normal((60, 60)) + 8 * np.eye(60))["row_sufficient"] in (None, True)


def test_all_solutions():
    s = orthant.enumerate_solutions([[-1.0, 0], [0, -1]], [1.0, 1])
    assert sorted(tuple(z) for z in s.isolated) == [(0, 0), (0, 1), (1, 0), (1, 1)] and not s.faces
    face, = orthant.enumerate_solutions([[1.0, -1], [-1, 1]], [0.0, 0]).faces
    assert face.dimension == 1 and np.allclose(face.directions[0], [1, 1])
    with pytest.raises(ValueError, match="2\\^20|20"):
        orthant.enumerate_solutions(np.eye(200), -np.ones(200))


def test_error_bound_holds():
    z = orthant.solve(M, q).z + 1e-3
    assert 1e-3 <= orthant.error_bound(M, q, z=z) < 1e-2


def test_solvers_with_other_options_are_not_kept_for_ever():
    for omega in np.linspace(0.5, 1.5, 100):
        assert orthant.solve([[2.0]], [-1.0], solver="pgs", omega=float(omega)).solved
    assert len(orthant._problems._kept.__dict__) <= orthant._problems._MOST_KEPT


def test_friction_as_an_array_and_what_is_no_row():
    triples = [(1, 0, 0.5)]
    expected = orthant.solve(np.eye(2), [-10, 8], friction=triples).z
    for friction in (np.array(triples), np.array(triples, dtype=object), [np.array([1, 0, 0.5], dtype=np.float32)]):
        assert np.array_equal(orthant.solve(np.eye(2), [-10, 8], friction=friction).z, expected)
    for bad in (np.array([[1.5, 0, 0.5]]), [(1, np.nan, 0.5)]):
        with pytest.raises(ValueError, match=r"friction\[0\] = .*: must begin with the numbers of two rows"):
            orthant.solve(np.eye(2), [-10, 8], friction=bad)


def test_masked_arrays_are_refused():
    masked = np.ma.array([-5.0, -6], mask=[False, True])
    with pytest.raises(TypeError, match="q is a masked array: must have no masks"):
        orthant.solve(M, masked)
    with pytest.raises(TypeError, match="M is a masked array"):
        orthant.analyse(np.ma.array(M))


@pytest.mark.parametrize("value", ["1.3,max_sweeps=1", "1.3:x", "a b", "", "1.3\nmax_sweeps=1"])
def test_an_option_is_one_option(value):
    for call in (lambda: orthant.solve(M, q, solver="pgs", omega=value), lambda: orthant.Solver("pgs", omega=value),
                 lambda: orthant.solve_mcp(lambda z: z, lambda z: np.eye(1), [0.0], tolerance=value),
                 lambda: orthant.Scene.named("slider_crank", mu=value)):
        with pytest.raises(ValueError, match="option .* = '|option .*: must be"):
            call()
    with pytest.raises(ValueError, match="option 'omega=1,max_sweeps': must be a name"):
        orthant.solve(M, q, solver="pgs", **{"omega=1,max_sweeps": 1})


def test_messages_speak_of_what_the_user_wrote():
    for call, words in ((lambda: orthant.solve(M, q, [2, 0], [1, 1]),
                         r"row 0 has bounds \[2, 1\]: must be lower <= upper"),
                        (lambda: orthant.solve(M, q, lower=[-1, 0], friction=[(1, 0, 0.5)]),
                         "friction row 1 has bounds"),
                        (lambda: orthant.solve_mcp(lambda z: z, lambda z: np.eye(1), [0.0], [2.0], [1.0]),
                         "row 0 has bounds .*lower <= upper")):
        with pytest.raises(ValueError, match=words):
            call()
    assert "entry (0, 0) = 0" in orthant.solve(np.zeros((1, 1)), [1.0], solver="pgs").why_not


@pytest.mark.parametrize("call, words", [
    (lambda file: orthant.solve(M, q, log="yes"), "log = 'yes': must be True or False"),
    (lambda file: orthant.solve(M, q, solver=3), "solver = 3: must be a name"),
    (lambda file: orthant.solve(M, q, solver="pgs", omega=[1, 2]), r"option omega = \[1, 2\]: must be a number"),
    (lambda file: orthant.Solver(None), "solver = None: must be a name"),
    (lambda file: orthant.Problem(M), "q is missing"),
    (lambda file: orthant.Problem(M, q, bound=3), "Problem: must be given M, q and"),
    (lambda file: orthant.Problem(), "Problem: must be given M, q and"),
    (lambda file: orthant.analyse(None), "M has dtype object"),
    (lambda file: orthant.analyse(M, time_limit="a"), "time_limit = 'a': must be a number"),
    (lambda file: orthant.enumerate_solutions(M), "q is missing"),
    (lambda file: orthant.equilibrium(M, M, "a"), "label = 'a': must be a whole number"),
    (lambda file: orthant.equilibria(M, M, time_limit=[]), r"time_limit = \[\]: must be a number"),
    (lambda file: orthant.read_problem(3), "file = 3: must be a file's name or path"),
    (lambda file: orthant.write_problem(3, orthant.Problem(M, q)), "file = 3: must be a file's name or path"),
    (lambda file: orthant.write_problem(file, M), "problem = array.*: must be a Problem"),
    (lambda file: orthant.write_problem(file, orthant.Problem(M, q), note=3), "note = 3: must be a text"),
    (lambda file: orthant.write_npz(file, 3), "problem = 3: must be a Problem"),
    (lambda file: orthant.write_fclib(file, orthant.Problem(M, q), "2"), "dimension = '2': must be a whole number"),
    (lambda file: orthant.Scene.load(3), "file = 3: must be a file's name or path"),
    (lambda file: orthant.Scene.parse(3), "text = 3: must be a text"),
    (lambda file: orthant.Scene.named(3), "name = 3: must be a text"),
    (lambda file: orthant.Scene().add(3), "kind = 3: must be a text"),
    (lambda file: orthant.simulate(3), "scene 3: must be a Scene, a built-in name or a TOML file"),
    (lambda file: orthant.simulate("bouncing_ball", duration=0.01).write(3), "file = 3: must be a file's name or path"),
    (lambda file: orthant.sweep(3), "what = 3: must be a file's name or path"),
    (lambda file: orthant.sweep("bouncing_ball", quick="no"), "quick = 'no': must be True or False"),
    (lambda file: orthant.sweep("bouncing_ball", results=3), "results = 3: must be a file's name or path"),
    (lambda file: orthant.sweep("bouncing_ball", grid=3), "grid = 3: must be a dict or a list of dicts"),
    (lambda file: orthant.sweep("bouncing_ball", measure=None), "measure = None: must be a number, bool, text"),
    (lambda file: orthant.sweep("bouncing_ball", jobs=1.5), "jobs = 1.5: must be a whole number"),
])
def test_wrong_types_are_named(tmp_path, monkeypatch, call, words):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(TypeError, match=words):
        call(tmp_path / "file.npz")


def test_one_number_bounds_all_rows_but_friction_rows():
    M, q = [[2.0, 1.0], [1.0, 2.0]], [-5.0, 6.0]
    expected = orthant.solve(M, q, [0, 0], [1.0, 1.0]).z
    for lower, upper in ((0, 1), (0.0, np.float64(1)), (np.array(0), np.int64(1))):
        assert np.array_equal(orthant.solve(M, q, lower=lower, upper=upper).z, expected)
    assert orthant.Problem(M, q, lower=-np.inf).lower.tolist() == [-np.inf, -np.inf]
    with_friction = orthant.Problem(M, q, lower=0, friction=[(1, 0, 0.3)])
    assert with_friction.lower.tolist() == [0, -np.inf]
    with pytest.raises(ValueError, match=r"lower\[0\] = nan"):
        orthant.solve(M, q, lower=float("nan"))


def test_reprs_show_the_solution():
    result = orthant.solve([[2.0, 1.0], [1.0, 2.0]], [-5.0, -6.0])
    assert repr(result).startswith("Result(status='solved', z=[1.33333, 2.33333], n=2, residual=")
    assert "z=[1, 1, 1, ..., 1, 1, 1], n=20" in repr(orthant.solve(np.eye(20), -np.ones(20)))
    solutions = orthant.enumerate_solutions([[0.0, 1.0], [1.0, 0.0]], [-1.0, -1.0])
    assert repr(solutions).startswith("Solutions(isolated=[[") and "complete=True" in repr(solutions)
    face = orthant.enumerate_solutions([[0.0]], [0.0])
    assert "Face(dimension=1, vertices=1, directions=1, lines=0)" in repr(face)


def test_discs_have_their_residuals_in_units_of_their_own_and_other_problems_have_none():
    puck = orthant.Problem(np.eye(3), [-10.0, -3.0, -4.0], friction=[(1, 0, 0.2, 2)])
    r = orthant.solve(puck)
    assert 0 <= r.residual_scale_free < 1e-9 and 0 <= r.residual_natural < 1e-8
    assert r["residual_natural"] == r.residual_natural and "residual_scale_free" in r.keys()
    same = orthant.solve(orthant.Problem(np.eye(3) * 2.0**40, [-10.0, -3.0, -4.0], friction=[(1, 0, 0.2, 2)]))
    assert same.residual_scale_free < 1e-9
    rough = orthant.solve(puck, solver="pgs:max_sweeps=1")
    assert rough.residual_scale_free >= 0
    plain = orthant.solve(M, q)
    assert plain.residual_scale_free is None and plain.residual_natural is None


@pytest.mark.parametrize("entry", [(True, 0, 0.3), (1, False, 0.3), (1, 0, True), (1, 0, 0.3, True),
                                   np.array([True, False, True])])
def test_booleans_are_no_rows_of_friction(entry):
    with pytest.raises(TypeError, match=r"friction\[0\] = .*: must be numbers, not booleans"):
        orthant.solve(M, q, lower=[0, -np.inf], friction=[entry])
