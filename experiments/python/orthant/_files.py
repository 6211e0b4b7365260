"""Problems in files: JSON and FCLIB (by the C++ side), NumPy's NPZ (here)."""

from __future__ import annotations

import os
import zipfile
import zlib
from typing import TYPE_CHECKING, Any, Union

from . import _orthant
from ._orthant import Problem
from ._spec import path, shown, whole, word

if TYPE_CHECKING:
    Path = Union[str, os.PathLike[str]]

_BROKEN = (ValueError, EOFError, NotImplementedError, OSError, RuntimeError, zipfile.BadZipFile, zlib.error)  # an archive
_SPARSE = ("M_data", "M_indices", "M_indptr")  # by rows; M_shape is not needed: M is square


def read_problem(file: Path) -> Problem:
    """A problem file, by its name's end: .npz, .hdf5 or .h5 (FCLIB contact problems), else JSON.

    NPZ keys: M (n, n), or M_data, M_indices, M_indptr (compressed rows); q (n,); lower, upper (n,), friction (k, 3) may be
    absent. Raises ValueError or RuntimeError naming file, field and rule.
    """
    file = path("file", file)
    if file.endswith(".mtx"):
        raise ValueError(f"{file}: Matrix Market holds a matrix, not a problem: must be read by scipy.io.mmread, and q as well")
    if not file.endswith(".npz"):
        return _orthant._read_problem(file)
    import numpy as np

    try:
        archive = np.load(file, allow_pickle=False)
    except (ValueError, EOFError, NotImplementedError, zipfile.BadZipFile) as error:
        raise ValueError(f"{file}: must be NumPy's NPZ: {error}") from None
    if not isinstance(archive, np.lib.npyio.NpzFile):
        raise ValueError(f"{file}: must be NumPy's NPZ of several arrays, not one array")
    with archive as data:
        known = {"M", "q", "lower", "upper", "friction", *_SPARSE}
        if unknown := sorted(set(data.files) - known):
            raise ValueError(f"{file}: {unknown[0]} is no known field: must be one of {', '.join(sorted(known))}")
        if "q" not in data.files or ("M" in data.files) == ("M_data" in data.files):
            raise ValueError(f"{file}: must have q, and either M or {', '.join(_SPARSE)}")
        fields = {}
        for key in data.files:
            try:
                fields[key] = data[key]
            except _BROKEN as error:
                raise ValueError(f"{file}: {key} cannot be read: {error}") from None
    q = fields["q"]
    if q.ndim != 1:
        raise ValueError(f"{file}: q has shape {q.shape}: must be one-dimensional")
    try:
        M = fields["M"] if "M" in fields else _by_rows(fields, len(q))
        return Problem(M, q, fields.get("lower"), fields.get("upper"), _friction(fields.get("friction")))
    except (TypeError, ValueError) as error:
        raise type(error)(f"{file}: {error}") from None


def _by_rows(fields: dict[str, Any], n: int) -> Any:
    import scipy.sparse

    if missing := [key for key in _SPARSE if key not in fields]:
        raise ValueError(f"{missing[0]} is missing: must be there with {', '.join(k for k in _SPARSE if k in fields)}")
    for key in _SPARSE:
        if fields[key].ndim != 1 or (key != "M_data" and fields[key].dtype.kind not in "iu"):
            raise ValueError(f"{key} has shape {fields[key].shape} and type {fields[key].dtype}: must be one-dimensional"
                             + ("" if key == "M_data" else ", of integers"))
    try:
        return scipy.sparse.csr_matrix(tuple(fields[key] for key in _SPARSE), shape=(n, n))
    except ValueError as error:
        raise ValueError(f"{', '.join(_SPARSE)} are no {n} x {n} matrix by rows: {error}") from None


def _friction(table: Any) -> Any:
    if table is not None and (table.ndim != 2 or table.shape[1] != 3 or table.dtype.kind not in "iuf"):
        raise ValueError(f"friction has shape {table.shape} and type {table.dtype}: must be (k, 3), real")
    return table


def _problem(value: Any) -> Problem:
    if not isinstance(value, Problem):
        raise TypeError(f"problem = {shown(value)}: must be a Problem")
    return value


def write_problem(file: Path, problem: Problem, note: str = "") -> None:
    """A problem as one JSON file, whole or not at all; `read_problem` reads it back bit for bit."""
    file, problem, note = path("file", file), _problem(problem), word("note", note)
    if file.endswith((".npz", ".hdf5", ".h5", ".mtx")):
        raise ValueError(f"{file}: must not end so: read_problem takes it for another format (write_npz, write_fclib)")
    _orthant._write_problem(file, problem, note)


def write_fclib(file: Path, problem: Problem, dimension: int, title: str = "", description: str = "") -> None:
    """A contact problem for the FCLIB collection, HDF5: dimension 2 or 3 rows a contact, the normal one first."""
    file, dimension = path("file", file), whole("dimension", dimension, 1, 3)
    if not file.endswith((".hdf5", ".h5")):
        raise ValueError(f"{file}: must end in .hdf5 or .h5, by which read_problem knows it")
    _orthant._write_fclib(file, _problem(problem), dimension, word("title", title), word("description", description))


def write_npz(file: Path, problem: Problem) -> None:
    """A problem as NumPy's NPZ (NAME.npz), which `read_problem` reads back bit for bit. A Delassus operator is refused."""
    import numpy as np

    file = path("file", file)
    if not file.endswith(".npz"):
        raise ValueError(f"{file}: must end in .npz, by which read_problem knows it")
    M = _problem(problem).M
    if hasattr(M, "inverse_mass"):
        raise ValueError("problem: M is a Delassus operator: must be an array or sparse (write_problem keeps it)")
    fields = {"q": problem.q, "lower": problem.lower, "upper": problem.upper}
    if hasattr(M, "indptr"):
        fields.update(M_data=M.data, M_indices=M.indices, M_indptr=M.indptr)
    else:
        fields["M"] = M
    if problem.friction:
        fields["friction"] = np.array(problem.friction, dtype=float)
    temporary = f"{file}.tmp{os.getpid()}"  # whole or not at all
    try:
        with open(temporary, "wb") as stream:
            np.savez_compressed(stream, **fields)
        os.replace(temporary, file)
    finally:
        if os.path.exists(temporary):
            os.remove(temporary)
