"""What users of NumPy and SciPy expect: bounds as a pair, results with SciPy's names, sparse formats, tensors, many
problems at once."""

import pickle
import threading
import time

import numpy as np
import orthant
import pytest

M, q = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-5.0, -6.0])


def test_bounds_are_a_pair_or_an_object_of_scipy():
    expected = orthant.solve(M, q, [0, 0], [1, np.inf]).z
    assert expected.tolist() == [1, 2.5]
    for bounds in (([0, 0], [1, np.inf]), (0, [1, np.inf]), [np.zeros(2), np.array([1, np.inf])]):
        assert orthant.solve(M, q, bounds=bounds).z.tolist() == expected.tolist()
        assert orthant.Solver("lemke").solve(M, q, bounds=bounds).z.tolist() == expected.tolist()
    for b in (q, -q):  # no bound: equations, with solutions of either sign
        assert np.allclose(M @ orthant.solve(M, b, bounds=(None, None)).z, -b)
    assert orthant.solve(M, q, bounds=(None, 1)).z.tolist() == [1, 1]
    assert np.allclose(M @ orthant.solve(M, -q, bounds=(None, 1)).z, q)
    optimize = pytest.importorskip("scipy.optimize")
    assert orthant.solve(M, q, bounds=optimize.Bounds([0, 0], [1, np.inf])).z.tolist() == expected.tolist()
    with pytest.raises(ValueError, match="must be given alone"):
        orthant.solve(M, q, 0, bounds=(0, 1))
    with pytest.raises(TypeError, match=r"bounds = 3: must be a pair \(lower, upper\)"):
        orthant.solve(M, q, bounds=3)


def test_bounds_are_a_list_of_pairs_as_scipy_writes_them():
    expected = orthant.solve(M, q, [0, 0], [1, np.inf]).z.tolist()
    assert expected == [1, 2.5]
    for pairs in ([(0, 1), (0, None)], [(0, 1), (0, np.inf)], ((0, 1), (0, None)), [[0, 1], [0, None]]):
        assert orthant.solve(M, q, bounds=pairs).z.tolist() == expected
        assert orthant.Problem(M, q, bounds=pairs).upper.tolist() == [1, np.inf]
        assert orthant.enumerate_solutions(M, q, bounds=pairs).isolated[0].tolist() == expected
        assert orthant.error_bound(M, q, bounds=pairs, z=expected) < 1e-12
    assert np.allclose(M @ orthant.solve(M, -q, bounds=[(None, None), (None, None)]).z, q)
    assert orthant.solve([[2.0]], [-5.0], bounds=[(0, 1)]).z.tolist() == [1]
    A, b = np.diag([2.0, 2, 2]), np.array([-5.0, 5, -1])
    for three in ([(0, 1), (-2, None), (None, 0)], np.array([[0, 1], [-2, np.inf], [-np.inf, 0]]),
                  ((0, 1), (-2, None), [None, 0])):
        assert orthant.solve(A, b, bounds=three).z.tolist() == [1, -2, 0]
    # Of two rows with two numbers each, what could be both is refused; a pair of lists or arrays is (lower, upper).
    assert orthant.Problem(M, q, bounds=([0, 1], [2, 3])).upper.tolist() == [2, 3]
    assert orthant.Problem(M, q, bounds=[(0, 1), (2, 3)]).upper.tolist() == [1, 3]
    for both in (((0, 1), (2, 3)), [[0, 1], [2, 3]], np.array([[0, 1], [2, 3]])):
        with pytest.raises(ValueError, match="could be"):
            orthant.solve(M, q, bounds=both)
    with pytest.raises(TypeError, match=r"bounds\[1\] = 3: must be a pair \(low, high\)"):
        orthant.solve(A, b, bounds=[(0, 1), 3, (0, 1)])
    with pytest.raises(ValueError, match=r"lower has shape \(2,\)|lower"):
        orthant.solve(A, b, bounds=[(0, 1), (0, 1), (0, 1), (0, 1)])
    with pytest.raises(ValueError, match="must be given alone"):
        orthant.Problem(M, q, 0, bounds=(0, 1))
    optimize = pytest.importorskip("scipy.optimize")
    assert orthant.Problem(M, q, bounds=optimize.Bounds(-1, [2, 3])).lower.tolist() == [-1, -1]


def test_results_answer_as_an_optimize_result_does():
    result = orthant.solve(M, q)
    assert result["nit"] == result.nit and result["fun"].tolist() == result.fun.tolist() == result.w.tolist()
    assert result["nfev"] == result.nfev == result.factorizations
    assert result.get("x").tolist() == result.z.tolist() and result.get("jac") is None and result.get("jac", 3) == 3
    assert list(result) == result.keys() == [key for key, _ in result.items()] and len(result.values()) == len(result)
    assert {"x", "fun", "success", "status", "message", "nit", "nfev"} <= set(dict(result)) == set(result.keys())
    assert 3 not in result and result.get(3) is None and (0, 1) not in result
    with pytest.raises(KeyError, match="0"):
        result[0]
    assert {**result}["x"].tolist() == result.z.tolist()
    optimize = pytest.importorskip("scipy.optimize")
    theirs = optimize.root(lambda z: M @ z + q, [0.0, 0.0])
    assert {"x", "success", "status", "message", "fun", "nfev"} <= set(theirs.keys()) & set(result.keys())

    mcp = orthant.solve_mcp(lambda z: M @ z + q, lambda z: M, [0.0, 0.0])
    assert mcp["x"].tolist() == mcp.x.tolist() == mcp.z.tolist() == mcp[2].tolist()
    assert mcp.success is mcp["success"] is True and mcp.nit == mcp["nit"] == mcp.iterations and mcp.message == "solved"
    assert mcp["fun"].tolist() == mcp.fun.tolist() == mcp.F.tolist() and mcp.get("jac", 3) == 3
    assert [mcp[key] is not None for key in mcp.keys()] and mcp[:2] == ("solved", True)
    with pytest.raises(KeyError, match="nothing"):
        mcp["nothing"]


def test_a_name_that_results_lack_is_an_error_with_those_they_have():
    with pytest.raises(KeyError, match="'slack: must be one of status, solved, z, w, .*, nit, nfev'"):
        orthant.solve([[1.0]], [-1.0])["slack"]


def test_results_have_the_names_of_scipy():
    result = orthant.solve(M, q)
    assert result.x is result.z or np.array_equal(result.x, result.z)
    assert result["x"].tolist() == result.z.tolist() and result["success"] is result.success is True
    assert result.nit == result.iterations and result.message.startswith("solved: ")
    for key in result.keys():
        assert key in result
        result[key]
    assert "nothing" not in result
    with pytest.raises(KeyError, match="nothing"):
        result["nothing"]
    none = orthant.solve([[-1.0]], [-1.0])
    assert not none.success and none.message == "infeasible"
    again = pickle.loads(pickle.dumps(result))
    assert again["z"].tolist() == result.z.tolist() and again.message == result.message


def sparse_problem(n=40):
    rng = np.random.default_rng(3)
    A = np.where(rng.random((n, n)) < 0.1, rng.normal(size=(n, n)), 0) + np.diag(np.full(n, 8.0))
    return A, rng.normal(size=n)


@pytest.mark.parametrize("kind", ["csr", "csc", "bsr", "coo"])
@pytest.mark.parametrize("indices", [np.int32, np.int64])
def test_sparse_formats_give_the_same_bits(kind, indices):
    sparse = pytest.importorskip("scipy.sparse")
    A, b = sparse_problem()
    S = getattr(sparse, kind + "_matrix")(A)
    for name in ("indptr", "indices"):
        if hasattr(S, name):
            setattr(S, name, getattr(S, name).astype(indices))
    expected = orthant.solve(sparse.csr_matrix(A), b)
    assert expected.solved
    assert orthant.solve(S, b).z.tolist() == expected.z.tolist()
    P = orthant.Problem(S, b)
    assert (P.M != sparse.csr_matrix(A)).nnz == 0


def test_sparse_matrices_that_are_not_plain_are_read_or_refused():
    sparse = pytest.importorskip("scipy.sparse")
    twice = sparse.csr_matrix((np.array([1.0, 1, 2]), np.array([0, 0, 1]), np.array([0, 2, 3])), shape=(2, 2))
    assert orthant.Problem(twice, q).M.toarray().tolist() == [[2, 0], [0, 2]]  # duplicates add
    assert twice.nnz == 3  # the caller's own stays
    unsorted = sparse.csr_matrix((np.array([1.0, 2, 2]), np.array([1, 0, 1]), np.array([0, 2, 3])), shape=(2, 2))
    assert orthant.Problem(unsorted, q).M.toarray().tolist() == [[2, 1], [0, 2]]
    doubled = sparse.csc_matrix((np.array([1.0, 1, 2]), np.array([0, 0, 1]), np.array([0, 2, 3])), shape=(2, 2))
    assert orthant.Problem(doubled, q).M.toarray().tolist() == [[2, 0], [0, 2]]
    for format_of in (sparse.csr_matrix, sparse.csc_matrix, lambda X: sparse.bsr_matrix(X, blocksize=(1, 1))):
        outside = format_of(M)
        outside.indices[0] = 7
        with pytest.raises(ValueError, match="no sound sparse matrix"):
            orthant.Problem(outside, q)
        lying = format_of(M)
        lying.indptr[1] = 100
        with pytest.raises(ValueError, match="no sound sparse matrix"):
            orthant.Problem(lying, q)
        with pytest.raises(ValueError, match="must be finite"):
            orthant.Problem(format_of(M * np.nan), q)
        with pytest.raises(ValueError, match=r"shape \(1, 2\): must be square"):
            orthant.Problem(format_of(M[:1]), q)


@pytest.mark.parametrize("blocksize", [(1, 1), (2, 4), (4, 2), (8, 8), (40, 1)])
def test_block_matrices_are_read_from_their_own_arrays(blocksize, monkeypatch):
    sparse = pytest.importorskip("scipy.sparse")
    A, b = sparse_problem()
    S = sparse.bsr_matrix(A, blocksize=blocksize)
    expected = orthant.solve(sparse.csr_matrix(A), b)
    for name in ("tocsr", "check_format"):
        monkeypatch.setattr(sparse.bsr_matrix, name, None)
    P = orthant.Problem(S, b)
    monkeypatch.undo()
    assert P.M.toarray().tolist() == A.tolist()
    np.testing.assert_allclose(orthant.solve(P).z, expected.z, rtol=1e-12, atol=1e-14)


class Tensor:
    """A tensor of another library: nothing but DLPack."""

    def __init__(self, array, fails=None):
        self.array, self.fails = array, fails

    def __dlpack__(self, **kwargs):
        if self.fails:
            raise self.fails
        return self.array.__dlpack__(**kwargs)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def test_tensors_of_other_libraries_are_taken():
    assert orthant.solve(Tensor(M), Tensor(q)).z.tolist() == orthant.solve(M, q).z.tolist()
    assert orthant.solve(Tensor(M.astype(np.float32)), q, lower=Tensor(np.zeros(2))).solved
    with pytest.raises(TypeError, match="M is a Tensor: must be in this processor's memory, without gradient"):
        orthant.solve(Tensor(M, BufferError("it is on a GPU")), q)
    torch = pytest.importorskip("torch")
    assert orthant.solve(torch.tensor(M), torch.tensor(q)).z.tolist() == orthant.solve(M, q).z.tolist()


def many(count=200, n=30):
    rng = np.random.default_rng(5)
    G = rng.normal(size=(n, n))
    return [(G @ G.T + np.eye(n), rng.normal(size=n)) for _ in range(count)]


def test_many_problems_have_the_results_of_single_ones_on_any_number_of_threads():
    problems = many()
    single = [orthant.solve(A, b, solver="lemke") for A, b in problems]
    for threads in (1, 2, 7):
        results = orthant.solve_many(problems, solver="lemke", threads=threads)
        assert [r.status for r in results] == [r.status for r in single]
        assert all(r.z.tolist() == s.z.tolist() for r, s in zip(results, single))
    mixed = orthant.solve_many([orthant.Problem(M, q), (M, q, 0, [1, np.inf]), (M, q, None, None, [(1, 0, 0.5)])])
    assert mixed[0].z.tolist() == orthant.solve(M, q).z.tolist() and mixed[1].z.tolist() == [1, 2.5]
    assert mixed[2].z.tolist() == orthant.solve(M, q, friction=[(1, 0, 0.5)]).z.tolist()
    assert orthant.solve_many([]) == []
    with pytest.raises(ValueError, match=r"problem 1: q has shape \(3,\)"):
        orthant.solve_many([(M, q), (M, np.zeros(3))])
    with pytest.raises(TypeError, match=r"problems\[0\] = 3: must be a Problem"):
        orthant.solve_many([3])


def test_many_problems_are_stacked_arrays_or_one_matrix_of_many():
    problems = many(12, 6)
    stack, b = np.array([A for A, _ in problems]), np.array([c for _, c in problems])

    def same(results, expected):
        assert [r.z.tolist() for r in results] == [r.z.tolist() for r in expected] and all(r.solved for r in results)

    same(orthant.solve_many(stack, b), [orthant.solve(A, c) for A, c in problems])
    same(orthant.solve_many(list(stack), b.tolist()), [orthant.solve(A, c) for A, c in problems])
    A = stack[0]
    for one in (A, A.tolist()):
        same(orthant.solve_many(one, b, threads=3), [orthant.solve(A, c) for c in b])
    sparse = pytest.importorskip("scipy.sparse")
    same(orthant.solve_many(sparse.csr_matrix(A), b), [orthant.solve(sparse.csr_matrix(A), c) for c in b])
    same(orthant.solve_many(Tensor(stack), Tensor(b)), [orthant.solve(A, c) for A, c in problems])

    low, high = np.full(6, -1.0), np.arange(12 * 6).reshape(12, 6) / 50
    expected = [orthant.solve(A, c, low, up) for c, up in zip(b, high)]
    same(orthant.solve_many(A, b, low, high), expected)
    same(orthant.solve_many(A, b, bounds=(-1, high)), expected)
    same(orthant.solve_many(A, b, bounds=[(-1, 1)] * 6), [orthant.solve(A, c, -1, 1) for c in b])
    friction = [(1, 0, 0.5)]
    same(orthant.solve_many(A, b, friction=friction), [orthant.solve(A, c, friction=friction) for c in b])
    assert orthant.solve_many(A, np.empty((0, 6))) == []

    for wrong, words in (
        (dict(q=b[0]), r"q has shape \(6,\): must be \(k, n\)"),
        (dict(q=b[:5]), r"must be \(5, n, n\)"),
        (dict(q=b, lower=np.zeros((3, 6))), r"lower has shape \(3, 6\)"),
        (dict(q=b[:, :4]), r"problem 0: q has shape \(4,\)"),
    ):
        with pytest.raises(ValueError, match=words):
            orthant.solve_many(stack, **wrong)
    with pytest.raises(ValueError, match="must be given with q"):
        orthant.solve_many(problems, lower=0)
    with pytest.raises(TypeError, match="must be a matrix"):
        orthant.solve_many(orthant.Problem(A, b[0]), b)
    with pytest.raises(TypeError, match="q = 'text': must be numbers"):
        orthant.solve_many(A, "text")


def test_many_problems_start_from_guesses_or_earlier_results():
    problems = many(8, 40)
    cold = orthant.solve_many(problems, solver="pgs", max_sweeps=100000)
    assert all(r.solved for r in cold) and all(r.iterations > 3 for r in cold)
    z = np.array([r.z for r in cold])
    for start in (cold, list(cold), z, list(z)):
        warm = orthant.solve_many(problems, solver="pgs", start=start)
        assert all(r.solved for r in warm) and all(r.iterations <= 3 for r in warm)
        stacked = orthant.solve_many(np.array([A for A, _ in problems]), np.array([c for _, c in problems]),
                                     solver="pgs", start=start)
        assert [r.iterations for r in stacked] == [r.iterations for r in warm]
    half = orthant.solve_many(problems, solver="pgs", max_sweeps=100000, start=[cold[0], None, z[2], *[None] * 5])
    assert [r.iterations <= 3 for r in half] == [True, False, True] + [False] * 5
    one = orthant.solve_many([problems[0]] * 3, solver="pgs", start=z[0])
    assert all(r.iterations <= 3 for r in one)
    with pytest.raises(ValueError, match="start: 2 guesses: must be one a problem, 8"):
        orthant.solve_many(problems, start=z[:2])
    with pytest.raises(ValueError, match=r"problem 0: start has shape \(3,\)"):
        orthant.solve_many(problems, start=z[:, :3])


def test_many_problems_release_the_interpreter():
    """Another thread of Python goes on while they are solved."""
    turns, over = 0, threading.Event()

    def count():
        nonlocal turns
        while not over.is_set():
            turns += 1
            time.sleep(1e-4)

    problems = many(60, 120)
    other = threading.Thread(target=count)
    other.start()
    begin = time.perf_counter()
    before = turns
    orthant.solve_many(problems, solver="lemke", threads=2)
    seconds, during = time.perf_counter() - begin, turns - before
    over.set()
    other.join()
    assert seconds < 0.02 or during > 5, (seconds, during)
