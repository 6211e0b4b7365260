"""Problems in files: JSON and FCLIB (by the C++ side), NumPy's NPZ (here)."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Union

from . import _orthant
from ._orthant import Problem

if TYPE_CHECKING:
    Path = Union[str, os.PathLike[str]]

_SPARSE = ("M_data", "M_indices", "M_indptr")  # by rows; M_shape is not needed: M is square


def read_problem(file: Path) -> Problem:
    """A problem file, by its name's end: .npz, .hdf5 or .h5 (FCLIB contact problems), else JSON.

    NPZ keys: M (n, n), or M_data, M_indices, M_indptr (compressed rows); q (n,); lower, upper (n,), friction (k, 3) may be
    absent. Raises ValueError or RuntimeError naming file, field and rule.
    """
    if os.fspath(file).endswith(".mtx"):
        raise ValueError(f"{file}: Matrix Market holds a matrix, not a problem: must be read by scipy.io.mmread, and q as well")
    if not os.fspath(file).endswith(".npz"):
        return _orthant._read_problem(file)
    import numpy as np

    with np.load(file, allow_pickle=False) as data:
        known = {"M", "q", "lower", "upper", "friction", *_SPARSE}
        if unknown := sorted(set(data.files) - known):
            raise ValueError(f"{file}: {unknown[0]} is no known field: must be one of {', '.join(sorted(known))}")
        if "q" not in data or ("M" in data) == ("M_data" in data):
            raise ValueError(f"{file}: must have q, and either M or {', '.join(_SPARSE)}")
        q = data["q"]
        if "M" in data:
            M = data["M"]
        else:
            import scipy.sparse

            M = scipy.sparse.csr_matrix(tuple(data[key] for key in _SPARSE), shape=(len(q), len(q)))
        friction = [(int(row), int(normal), float(mu)) for row, normal, mu in data["friction"]] if "friction" in data else None
        return Problem(M, q, data["lower"] if "lower" in data else None, data["upper"] if "upper" in data else None, friction)


def write_npz(file: Path, problem: Problem) -> None:
    """A problem as NumPy's NPZ, which `read_problem` reads back bit for bit. A Delassus operator is refused."""
    import numpy as np

    M = problem.M
    if hasattr(M, "inverse_mass"):
        raise ValueError("problem: M is a Delassus operator: must be an array or sparse (write_problem keeps it)")
    fields = {"q": problem.q, "lower": problem.lower, "upper": problem.upper}
    if hasattr(M, "indptr"):
        fields.update(M_data=M.data, M_indices=M.indices, M_indptr=M.indptr)
    else:
        fields["M"] = M
    if problem.friction:
        fields["friction"] = np.array(problem.friction, dtype=float)
    temporary = f"{os.fspath(file)}.tmp{os.getpid()}"  # whole or not at all
    try:
        with open(temporary, "wb") as stream:
            np.savez_compressed(stream, **fields)
        os.replace(temporary, file)
    finally:
        if os.path.exists(temporary):
            os.remove(temporary)
