"""Problem files from Python: they read back bit for bit; hostile and damaged ones are refused by name."""

import io
import os
import pickle
import re
import time
import tracemalloc
import warnings
import zipfile

import numpy as np
import orthant
import pytest
import scipy.sparse as sp

from support import random_problem

M = np.array([[2.0, 1.0], [1.0, 2.0]])
q = np.array([-5.0, -6.0])


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
    shapes = [
        "(1099511627776,)", "(1152921504606846976, 16)", "(-2,)", "(2.0,)", "2", "()", "(0,)", "[2]", "None", "(True,)",
        "('2',)", "(" + "[" * 3000 + "]" * 3000 + ",)", "(" * 150 + "2," + ")" * 150, "(" + "1," * 100 + ")", "(2, 1)",
        "(3,)", "(1,)", "(9" + "9" * 4000 + ",)"
    ]
    for shape in shapes:
        for version in (1, 2, 3):
            yield archive([("M.npy", square), ("q.npy", npy(shape, data=q.tobytes(), version=version))])
        yield archive([("M.npy", npy(shape, data=M.tobytes())), ("q.npy", whole)])
    for descr in [
            "|O", "O", "<f2", ">f8", "<f16", "<c16", "|b1", "<i8", "<U4", "|S8", "<M8[s]", "|V8", "", "f", 7, None,
        [("a", "<f8")], [("a", "|O")], [("a", "<f8", (1 << 30, ))], ["<f8"], {"a": 1}, "<f8, <f8", "|S" + "9" * 30,
            "|V1073741824"
    ]:
        for key in ("q", "M", "lower", "friction"):
            members = {"M": square, "q": whole, key: npy("(2,)" if key != "M" else "(2, 2)", descr, data=M.tobytes())}
            yield archive([(f"{name}.npy", content) for name, content in members.items()])
    for more in [
            "'shape': (2,)", "'more': 1", "**{}", "'a' * (1 << 40): 1", "[]: 1", "\x00",
            "__import__('os').mkdir('run'): 1"
    ]:
        yield archive([("M.npy", square), ("q.npy", npy("(2,)", data=q.tobytes(), more=more))])
    pickled = io.BytesIO()
    np.save(pickled, np.array([Payload(), 1.0], dtype=object), allow_pickle=True)
    for content in (pickled.getvalue(), pickle.dumps(Payload()), b"", b"\x93NUMPY", whole[:20], whole[:-1],
                    whole + b"more", b"\x93NUMPY\x02\x00" + b"\xff" * 4 + whole[10:], b"\x93NUMPY\x09\x09" + whole[8:]):
        yield archive([("M.npy", square), ("q.npy", content)])
        yield content
    for name in ("q", "q.npy.npy", "../q.npy", "/q.npy", "Q.npy", ".npy", "q.npy/", "\x07.npy", "ü.npy", "q" * 60000,
                 "M_data", "M.npy"):
        yield archive([("M.npy", square), (name, whole)])
        yield archive([("M.npy", square), ("q.npy", whole), (name, whole)])
    for table in ([[1.0, 0, np.nan]], [[np.nan, 0, 1]], [[np.inf, 0, 1]], [[1e300, 0,
                                                                            1]], [[-1, 0, 1]], [[1, 1, 1]], [[1, 0,
                                                                                                              -1]]):
        yield archive([("M.npy", square), ("q.npy", whole),
                       ("friction.npy", npy("(1, 3)", data=np.array(table).tobytes()))])
    for size in (1 << 20, 1 << 22):  # zeros, packed a thousandfold
        bomb = npy(f"({size},)", data=bytes(8 * size))
        yield archive([("M.npy", square), ("q.npy", whole), ("M_data.npy", bomb)], compression=zipfile.ZIP_DEFLATED)
        yield archive([("M.npy", square), ("q.npy", b"\x93NUMPY\x02\x00" + (8 * size).to_bytes(4, "little") + bomb)],
                      compression=zipfile.ZIP_DEFLATED)


def mutations(count, wholes):
    """Flips, cuts, runs of one byte, pieces of the other file, numbers in the zip's own headers; the same in each
    run."""
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
                    data[field:field + 4] = int(random.choice([0, 1, 8, 99, 0x7FFFFFFF, 0xFFFFFFFF,
                                                               len(data)])).to_bytes(4, "little")
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
        orthant.write_npz(
            counted, orthant.Problem(matrix, q, lower=None if friction is None else [0, -np.inf], friction=friction))
        wholes.append(counted.read_bytes())
    fields = {"M": M, "q": q}
    np.savez(counted, **fields)  # not packed: what is changed inside an array is seen by its checksum alone
    wholes.append(counted.read_bytes())
    flips = [
        whole[:at] + bytes([whole[at] ^ 0x55]) + whole[at + 1:] for whole in wholes for at in range(0, len(whole), 7)
    ]
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


def test_files_that_are_no_npz_are_refused(tmp_path):
    (tmp_path / "p.npz").write_bytes(b"garbage")
    with pytest.raises(ValueError, match="p.npz: must be NumPy's NPZ"):
        orthant.read_problem(tmp_path / "p.npz")


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


def test_friction_discs_survive_every_file(tmp_path):
    # A puck pushed along (3, 4): mu z_n = 2.5 against it.
    puck = orthant.Problem(np.eye(3), [-10.0, 3.0, 4.0], friction=[(1, 0, 0.25, 2)])
    assert puck.friction == [(1, 0, 0.25, 2)]
    orthant.write_problem(tmp_path / "p.json", puck)
    orthant.write_npz(tmp_path / "p.npz", puck)
    orthant.write_fclib(tmp_path / "p.hdf5", puck, dimension=3)
    for file in ("p.json", "p.npz", "p.hdf5"):
        back = orthant.read_problem(tmp_path / file)
        assert back.friction == puck.friction
        result = orthant.solve(back)
        assert result.status == "solved"
        assert np.allclose(result.z, [10, -1.5, -2], rtol=0, atol=1e-9)
    with pytest.raises(ValueError, match=r"must end with 1 \(interval\) or 2 \(disc\)"):
        orthant.Problem(np.eye(3), [-10.0, 3.0, 4.0], friction=[(1, 0, 0.25, 3)])
