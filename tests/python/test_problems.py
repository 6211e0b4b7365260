"""Linear problems from Python: answers, storages, words for what is wrong, threads, cost."""

import copy
import io
import os
import pickle
import re
import signal
import threading
import time
import tracemalloc
import warnings
import zipfile

import numpy as np
import orthant
import pytest
import scipy.sparse as sp

M = np.array([[2.0, 1.0], [1.0, 2.0]])
q = np.array([-5.0, -6.0])


def test_solves_and_gives_back_what_was_recomputed():
    r = orthant.solve(M, q)
    assert r.solved and r.status == "solved"
    assert np.allclose(r.z, [4 / 3, 7 / 3], atol=1e-14)
    assert np.array_equal(r.w, M @ r.z + q)
    assert r.residual < 1e-13 and r.certificate is None


def random_problem(n, seed=1):
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((n, n))
    return A @ A.T + np.eye(n), rng.standard_normal(n)


def large_problem(n):
    """As fast to make as to fill: definite and diagonally dominant, not symmetric."""
    rng = np.random.default_rng(1)
    return rng.random((n, n)) + n * np.eye(n), rng.standard_normal(n)


@pytest.mark.parametrize("form", [
    lambda A: A, np.asfortranarray, lambda A: A.T.copy().T, lambda A: np.repeat(A, 2, axis=1)[:, ::2], lambda A: A.tolist(),
    lambda A: A[::-1, ::-1].copy()[::-1, ::-1], lambda A: np.ascontiguousarray(A).astype(">f8"), sp.csr_matrix, sp.csc_matrix, sp.coo_matrix,
    sp.csr_array,
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
def test_what_is_wrong_is_named(error, words, arguments):
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


def test_problem_files_read_back_bit_for_bit(tmp_path):
    A, b = random_problem(4)
    p = orthant.Problem(A / 3, b, lower=[-np.inf, 0, 0.1, 0], upper=[np.inf, 1, 2, np.inf])
    orthant.write_problem(tmp_path / "p.json", p, note="a note")
    r = orthant.read_problem(tmp_path / "p.json")
    assert np.array_equal(r.M, p.M) and np.array_equal(r.q, p.q) and np.array_equal(r.upper, p.upper)
    assert np.array_equal(orthant.solve(r).z, orthant.solve(p).z)
    s = orthant.Problem(sp.csr_matrix(A), b)
    orthant.write_problem(tmp_path / "s.json", s)
    assert sp.issparse(orthant.read_problem(tmp_path / "s.json").M)
    with pytest.raises(RuntimeError, match="no_such"):
        orthant.read_problem(tmp_path / "no_such.json")


def test_the_interpreter_is_free_while_a_solver_works():
    A, b = random_problem(500)
    solver, ticks, done = orthant.Solver("lemke"), 0, threading.Event()

    def work():
        for _ in range(3):
            solver.solve(A, b)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        ticks += 1
        time.sleep(1e-4)
    thread.join()
    assert ticks > 5


def test_ctrl_c_ends_a_solve(ctrl_c):
    """In the main thread; a signal between calls is none of ours, and the solver answers again afterwards."""
    A, b = large_problem(2500)
    ctrl_c()
    begin = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        orthant.solve(A, b, solver="lemke")
    assert time.perf_counter() - begin < 5
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert orthant.solve(M, q, solver="lemke").solved
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
    assert orthant.solve(M, q, solver="lemke").solved


def test_a_handler_that_does_not_raise_sees_the_run_cancelled(ctrl_c):
    A, b = large_problem(2500)
    heard = []
    signal.signal(signal.SIGINT, lambda *_: heard.append(1))
    ctrl_c()
    assert orthant.solve(A, b, solver="lemke").status == "cancelled" and heard


def test_a_solver_at_work_refuses_a_second_thread():
    A, b = random_problem(600)
    solver, errors = orthant.Solver("lemke"), []

    def work():
        for _ in range(3):
            try:
                solver.solve(A, b)
            except RuntimeError as error:
                errors.append(str(error))

    threads = [threading.Thread(target=work) for _ in range(2)]
    [t.start() for t in threads]
    [t.join() for t in threads]
    assert errors and "another thread" in errors[0]


def test_a_call_costs_microseconds():
    """10 x 10: what a call takes beyond the solver itself, 15 us asked for (3 to 9 measured, by machine)."""
    A, b = random_problem(10)

    def beyond():
        begin = time.perf_counter()
        inside = sum(orthant.solve(A, b).seconds for _ in range(100))
        return (time.perf_counter() - begin - inside) / 100

    best = min(beyond() for _ in range(30))
    print(f"{1e6 * best:.1f} us beyond the solver")  # pytest -s shows it
    assert best < 15e-6


def test_npz_and_fclib(tmp_path):
    A, b = random_problem(4)
    for M_, friction in ((A, None), (sp.csr_matrix(A), [(1, 0, 0.5), (3, 2, 0.25)])):
        lower = None if friction is None else [0, -np.inf, 0, -np.inf]
        p = orthant.Problem(M_, b, lower=lower, friction=friction)
        orthant.write_npz(tmp_path / "p.npz", p)
        r = orthant.read_problem(tmp_path / "p.npz")
        assert sp.issparse(r.M) == sp.issparse(M_) and r.friction == p.friction
        assert np.array_equal(orthant.solve(r).z, orthant.solve(p).z)
    orthant.write_fclib(tmp_path / "p.hdf5", p, dimension=2, title="mine")
    assert np.array_equal(orthant.solve(orthant.read_problem(tmp_path / "p.hdf5")).z, orthant.solve(p).z)
    np.savez(tmp_path / "bad.npz", q=b)
    with pytest.raises(ValueError, match="bad.npz: must have q, and either M"):
        orthant.read_problem(tmp_path / "bad.npz")
    np.savez(tmp_path / "bad.npz", q=b, M=A, Q=b)
    with pytest.raises(ValueError, match="Q is no known field"):
        orthant.read_problem(tmp_path / "bad.npz")
    with pytest.raises(ValueError, match="row 0: must be a normal|row 1: must be friction|contacts"):
        orthant.write_fclib(tmp_path / "q.hdf5", orthant.Problem(A, b), dimension=2)


@pytest.mark.parametrize("pointers", [[0, 10**6, 4], [0, 100, 4], [0, -5, 4], [0, 3, 2]])
def test_pointers_of_a_sparse_matrix_that_lie(tmp_path, pointers):
    file = tmp_path / "p.npz"
    np.savez(file, M_data=[2.0, 1, 1, 2], M_indices=[0, 1, 0, 1], M_indptr=pointers, q=[-5.0, -6])
    with pytest.raises(ValueError, match="p.npz: "):
        orthant.read_problem(file)
    for kind in (sp.csr_matrix, sp.csc_matrix):
        M = kind(np.array([[2.0, 1], [1, 2]]))
        M.indptr[:] = pointers
        with pytest.raises(ValueError, match="M is no sound sparse matrix"):
            orthant.solve(M, [-5.0, -6])


@pytest.mark.parametrize("fields, said", [
    ({"M_data": [1.0], "M_indices": [0]}, "M_indptr is missing"),
    ({"M_data": [1.0, 1], "M_indices": [0, 1.5], "M_indptr": [0, 1, 2]}, "M_indices has shape .* of integers"),
    ({"M": np.eye(2), "q": np.ones((2, 1))}, "q has shape .2, 1.: must be one-dimensional"),
    ({"M": np.eye(2), "friction": [[1, 0]]}, "friction has shape .* must be .k, 3."),
    ({"M": np.eye(2), "friction": [[1.7, 0, 0.5]]}, "friction.0. = .1.7 .*: must begin with the numbers of two rows"),
])
def test_npz_fields_that_are_wrong_are_named(tmp_path, fields, said):
    np.savez(tmp_path / "p.npz", **{"q": [-1.0, -1.0], **fields})
    with pytest.raises(ValueError, match=f"p.npz: {said}"):
        orthant.read_problem(tmp_path / "p.npz")


def test_problems_keep_to_the_endings_they_are_read_by(tmp_path):
    p = orthant.Problem(M, q)
    for ending in ("npz", "hdf5", "h5", "mtx"):
        with pytest.raises(ValueError, match=f"p.{ending}: must not end so"):
            orthant.write_problem(tmp_path / f"p.{ending}", p)
    with pytest.raises(ValueError, match="p.json: must end in .hdf5 or .h5"):
        orthant.write_fclib(tmp_path / "p.json", p, dimension=2)
    assert not list(tmp_path.iterdir())


def npy(shape, descr="<f8", data=b"", version=1, order="False", more=""):
    """One array as a file that says what it likes of itself."""
    head = f"{{'descr': {descr!r}, 'fortran_order': {order}, 'shape': {shape}, {more}}}".encode("latin1")
    head += b" " * (-(len(head) + 11) % 64) + b"\n"
    return b"\x93NUMPY" + bytes([version, 0]) + len(head).to_bytes(2 if version == 1 else 4, "little") + head + data


def archive(members, **how):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", **how) as packed, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a name twice
        for name, content in members:
            packed.writestr(name, content)
    return stream.getvalue()


class Payload:
    def __reduce__(self):
        return os.mkdir, ("run",)  # what loading it as a pickle would do


def hostile_archives():
    """Files that lie: about shapes, types, sizes, names, or that are more than arrays."""
    whole = npy("(2,)", data=q.tobytes())
    square = npy("(2, 2)", data=M.tobytes())
    shapes = ["(1099511627776,)", "(1152921504606846976, 16)", "(-2,)", "(2.0,)", "2", "()", "(0,)", "[2]", "None", "(True,)", "('2',)",
              "(" + "[" * 3000 + "]" * 3000 + ",)", "(" * 150 + "2," + ")" * 150, "(" + "1," * 100 + ")", "(2, 1)", "(3,)", "(1,)",
              "(9" + "9" * 4000 + ",)"]
    for shape in shapes:
        for version in (1, 2, 3):
            yield archive([("M.npy", square), ("q.npy", npy(shape, data=q.tobytes(), version=version))])
        yield archive([("M.npy", npy(shape, data=M.tobytes())), ("q.npy", whole)])
    for descr in ["|O", "O", "<f2", ">f8", "<f16", "<c16", "|b1", "<i8", "<U4", "|S8", "<M8[s]", "|V8", "", "f", 7, None, [("a", "<f8")],
                  [("a", "|O")], [("a", "<f8", (1 << 30,))], ["<f8"], {"a": 1}, "<f8, <f8", "|S" + "9" * 30, "|V1073741824"]:
        for key in ("q", "M", "lower", "friction"):
            members = {"M": square, "q": whole, key: npy("(2,)" if key != "M" else "(2, 2)", descr, data=M.tobytes())}
            yield archive([(f"{name}.npy", content) for name, content in members.items()])
    for more in ["'shape': (2,)", "'more': 1", "**{}", "'a' * (1 << 40): 1", "[]: 1", "\x00", "__import__('os').mkdir('run'): 1"]:
        yield archive([("M.npy", square), ("q.npy", npy("(2,)", data=q.tobytes(), more=more))])
    pickled = io.BytesIO()
    np.save(pickled, np.array([Payload(), 1.0], dtype=object), allow_pickle=True)
    for content in (pickled.getvalue(), pickle.dumps(Payload()), b"", b"\x93NUMPY", whole[:20], whole[:-1], whole + b"more",
                    b"\x93NUMPY\x02\x00" + b"\xff" * 4 + whole[10:], b"\x93NUMPY\x09\x09" + whole[8:]):
        yield archive([("M.npy", square), ("q.npy", content)])
        yield content
    for name in ("q", "q.npy.npy", "../q.npy", "/q.npy", "Q.npy", ".npy", "q.npy/", "\x07.npy", "ü.npy", "q" * 60000, "M_data", "M.npy"):
        yield archive([("M.npy", square), (name, whole)])
        yield archive([("M.npy", square), ("q.npy", whole), (name, whole)])
    for table in ([[1.0, 0, np.nan]], [[np.nan, 0, 1]], [[np.inf, 0, 1]], [[1e300, 0, 1]], [[-1, 0, 1]], [[1, 1, 1]], [[1, 0, -1]]):
        yield archive([("M.npy", square), ("q.npy", whole), ("friction.npy", npy("(1, 3)", data=np.array(table).tobytes()))])
    for size in (1 << 20, 1 << 22):  # zeros, packed a thousandfold
        bomb = npy(f"({size},)", data=bytes(8 * size))
        yield archive([("M.npy", square), ("q.npy", whole), ("M_data.npy", bomb)], compression=zipfile.ZIP_DEFLATED)
        yield archive([("M.npy", square), ("q.npy", b"\x93NUMPY\x02\x00" + (8 * size).to_bytes(4, "little") + bomb)],
                      compression=zipfile.ZIP_DEFLATED)


def mutations(count, wholes):
    """Flips, cuts, runs of one byte, pieces of the other file, numbers in the zip's own headers; the same in each run."""
    random = np.random.default_rng(11)
    for trial in range(count):
        data = bytearray(wholes[trial % len(wholes)])
        other = wholes[random.integers(len(wholes))]
        for _ in range(1 + random.integers(3)):
            at, length = int(random.integers(len(data))), int(random.integers(1, 40))
            kind = random.integers(6)
            if kind == 0:
                data[at] ^= 1 << int(random.integers(8))
            elif kind == 1:
                del data[at:]
            elif kind == 2:
                data[at:at + length] = bytes([random.choice([0, 255, 127])]) * length
            elif kind == 3:
                begin = int(random.integers(len(other)))
                data[at:at + int(random.integers(40))] = other[begin:begin + length]
            elif kind == 4:
                del data[at:at + length]
            else:  # sizes, offsets, methods, flags
                starts = [m.start() for m in re.finditer(b"PK(?:\x01\x02|\x03\x04|\x05\x06)", bytes(data))]
                if starts:
                    field = starts[random.integers(len(starts))] + int(random.integers(4, 46))
                    data[field:field + 4] = int(random.choice([0, 1, 8, 99, 0x7FFFFFFF, 0xFFFFFFFF, len(data)])).to_bytes(4, "little")
            if not data:
                break
        yield bytes(data)


def read_or_refused(file, data):
    """One error that names the file, in two seconds of the processor and in 64 MB more than the file has."""
    file.write_bytes(data)
    tracemalloc.reset_peak()
    before, began = tracemalloc.get_traced_memory()[0], time.process_time()
    try:
        orthant.read_problem(file)
        return "read"
    except (ValueError, TypeError) as error:
        assert "p.npz" in str(error) and len(str(error)) < 2000
        return str(error)
    finally:
        assert time.process_time() - began < 2
        assert tracemalloc.get_traced_memory()[1] - before < 64e6 + len(data)


@pytest.fixture
def counted(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tracemalloc.start()
    yield tmp_path / "p.npz"
    tracemalloc.stop()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["p.npz"]  # nothing was run, nothing written


def test_npz_with_mutations_is_read_or_refused_by_name(counted):
    wholes = []
    for matrix, friction in ((M, None), (sp.csr_matrix(M), [(1, 0, 0.5)])):
        orthant.write_npz(counted, orthant.Problem(matrix, q, lower=None if friction is None else [0, -np.inf], friction=friction))
        wholes.append(counted.read_bytes())
    fields = {"M": M, "q": q}
    np.savez(counted, **fields)  # not packed: what is changed inside an array is seen by its checksum alone
    wholes.append(counted.read_bytes())
    flips = [whole[:at] + bytes([whole[at] ^ 0x55]) + whole[at + 1:] for whole in wholes for at in range(0, len(whole), 7)]
    said = [read_or_refused(counted, data) for data in [*flips, *mutations(600, wholes)]]
    assert len(set(said)) > 30 and 0 < said.count("read") < len(said) / 2


def test_npz_of_a_stranger_is_refused_by_name_in_bounded_time_and_memory(counted):
    said = [read_or_refused(counted, data) for data in hostile_archives()]
    assert len(said) > 200 and said.count("read") < 30


def test_largest_input_holds_for_every_file(tmp_path):
    p = orthant.Problem(np.eye(30), -np.ones(30))
    orthant.write_problem(tmp_path / "p.json", p)
    orthant.write_npz(tmp_path / "p.npz", p)
    (tmp_path / "s.toml").write_text("[[body]]\nname = 'b'\nmass = 1\ninertia = 1\n#" + 2000 * " ")
    try:
        orthant.set_largest_input(500)
        for file, error in (("p.json", RuntimeError), ("p.npz", RuntimeError), ("s.toml", ValueError)):
            with pytest.raises(error, match=f"{file}: [0-9]+ bytes: must be at most 500 bytes .*set_largest_input"):
                orthant.Scene.load(tmp_path / file) if file == "s.toml" else orthant.read_problem(tmp_path / file)
        orthant.set_largest_input(5000)
        assert (tmp_path / "p.npz").stat().st_size < 5000
        with pytest.raises(ValueError, match="p.npz: M cannot be read: M.npy: 7328 bytes: must be at most 5000 bytes"):
            orthant.read_problem(tmp_path / "p.npz")
        orthant.set_largest_input(1000)
        with pytest.raises(ValueError, match="s.toml: 20[0-9]+ bytes: must be at most 1000 bytes"):
            orthant.sweep(tmp_path / "s.toml", results=tmp_path / "s.sqlite", duration=0.1, measure="energy",
                          grid={"integrator": ["moreau-jean"], "solver": ["lemke"], "step": [0.1]})
    finally:
        orthant.set_largest_input(0)
    assert (orthant.read_problem(tmp_path / "p.npz").q == -1).all()
    assert orthant.Scene.load(tmp_path / "s.toml").bodies == ["b"]
    for value, error in ((-1, ValueError), (1.5, TypeError), (True, TypeError)):
        with pytest.raises(error, match="bytes = "):
            orthant.set_largest_input(value)


def test_what_is_no_npz(tmp_path):
    (tmp_path / "p.npz").write_bytes(b"garbage")
    with pytest.raises(ValueError, match="p.npz: must be NumPy's NPZ"):
        orthant.read_problem(tmp_path / "p.npz")


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
    for call, words in ((lambda: orthant.solve(M, q, [2, 0], [1, 1]), r"row 0 has bounds \[2, 1\]: must be lower <= upper"),
                        (lambda: orthant.solve(M, q, lower=[-1, 0], friction=[(1, 0, 0.5)]), "friction row 1 has bounds"),
                        (lambda: orthant.solve_mcp(lambda z: z, lambda z: np.eye(1), [0.0], [2.0], [1.0]), "row 0 has bounds .*lower <= upper")):
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


def copies(value):
    return copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))


def test_values_go_to_other_processes():
    for matrix in (M, sp.csr_matrix(M), orthant.Delassus(sp.csr_matrix(np.eye(2)), [1.0, 2.0], [0.5, 0.5])):
        for p in copies(orthant.Problem(matrix, [-5.0, -6], lower=[0, -np.inf], friction=[(1, 0, 0.3)])):
            assert p.q.tolist() == [-5, -6] and p.lower.tolist() == [0, -np.inf] and p.friction == [(1, 0, 0.3)]
            assert np.array_equal(orthant.solve(p).z, orthant.solve(matrix, q, friction=[(1, 0, 0.3)]).z)
    result = orthant.solve([[-1.0, 0], [0, 1]], [-1.0, 1], solver="lemke", log=True)
    for r in copies(result):
        assert (r.status, r.iterations, r.seconds, len(r.log)) == (result.status, result.iterations, result.seconds, len(result.log))
        assert np.array_equal(r.certificate, result.certificate) and r.log[0].event == result.log[0].event
    for s in copies(orthant.enumerate_solutions([[1.0, -1], [-1, 1]], [0.0, 0])):
        assert s.complete and s.faces[0].directions[0].tolist() == [1, 1]
    for e in copies(orthant.equilibrium(M, M)):
        assert np.isclose(e.x.sum(), 1)
    for solver in copies(orthant.Solver("pgs", omega=1.5)):
        assert repr(solver) == "Solver('pgs:omega=1.5')" and solver.solve(M, q).solved


def beside(work, until=0.2):
    """How often another thread gets to run while `work` does, which is told to end after `until` seconds."""
    ticks, done = 0, threading.Event()

    def count():
        nonlocal ticks
        while not done.is_set():
            ticks += 1
            time.sleep(1e-3)

    thread = threading.Thread(target=count)
    thread.start()
    begin = time.perf_counter()
    try:
        work(until)
    except TimeoutError:
        pass
    finally:
        seconds = time.perf_counter() - begin
        done.set()
        thread.join()
    return ticks, seconds


LARGE = large_problem(1200)
CORNERS = -np.eye(18), np.ones(18)  # each of a cube is a solution
COSTS = np.random.default_rng(1).random((2, 60, 60))
LONG = {"analyse": lambda t: orthant.analyse(LARGE[0], time_limit=t),
        "enumerate": lambda t: orthant.enumerate_solutions(*CORNERS, time_limit=t),
        "error bound": lambda t: orthant.error_bound(*LARGE, z=np.ones(1200), time_limit=t),
        "equilibria": lambda t: orthant.equilibria(*COSTS, time_limit=t)}


@pytest.mark.parametrize("name", LONG)
def test_long_calls_let_other_threads_run_and_end_in_time(name):
    ticks, seconds = beside(LONG[name])
    assert 0.1 < seconds < 5 and ticks > 20  # a lock that is held leaves one or two


@pytest.mark.parametrize("name", LONG)
def test_ctrl_c_ends_long_calls(ctrl_c, name):
    ctrl_c()
    begin = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        LONG[name](60)
    assert time.perf_counter() - begin < 10


def test_what_is_not_done_in_time_is_said():
    assert orthant.enumerate_solutions(*CORNERS, time_limit=1e-3).complete is False
    assert orthant.enumerate_solutions(M, q, time_limit=60).complete is True
    a = orthant.analyse(random_problem(12)[0], time_limit=1e-9)
    assert a["p"] is None and a["symmetric"] is True and np.isnan(a["condition"])
    with pytest.raises(TimeoutError, match="time_limit"):
        orthant.equilibria(*COSTS, time_limit=1e-3)


def test_bytes_that_are_no_text_are_written_as_numbers(tmp_path):
    (tmp_path / "p.json").write_bytes(b'{"format": "\xff\xfe"')
    with pytest.raises(RuntimeError, match="p.json: no JSON"):
        orthant.read_problem(tmp_path / "p.json")
    with pytest.raises(ValueError, match="p.dat: must end in .npz"):
        orthant.write_npz(tmp_path / "p.dat", orthant.Problem(M, q))


def test_devices_and_pipes_are_no_files(tmp_path):
    device = tmp_path / "zero.npz"
    device.symlink_to("/dev/zero")
    with pytest.raises(ValueError, match="zero.npz: is no regular file"):
        orthant.read_problem(device)
    os.mkfifo(tmp_path / "pipe.npz")
    problem = orthant.Problem([[1.0]], [-1.0])
    with pytest.raises(ValueError, match="pipe.npz: is no regular file"):
        orthant.write_npz(tmp_path / "pipe.npz", problem)
    os.mkfifo(tmp_path / "pipe.toml")
    with pytest.raises(ValueError, match="pipe.toml: is no regular file"):
        orthant.Scene.load(tmp_path / "pipe.toml")
    (tmp_path / "link.npz").symlink_to(tmp_path / "there.npz")
    orthant.write_npz(tmp_path / "link.npz", problem)  # a link is followed
    assert (tmp_path / "link.npz").is_symlink() and (tmp_path / "there.npz").is_file()
