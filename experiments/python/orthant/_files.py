"""Problems in files: JSON and FCLIB (by the C++ side), NumPy's NPZ (here)."""

from __future__ import annotations

import io
import math
import os
import struct
import zipfile
import zlib
from tokenize import TokenError
from typing import TYPE_CHECKING, Any, Union

from . import _orthant
from ._orthant import Problem
from ._spec import path, regular, shown, whole, word

if TYPE_CHECKING:
    Path = Union[str, os.PathLike[str]]

# What reading an archive of a stranger may raise.
_BROKEN = (ValueError, TypeError, EOFError, NotImplementedError, OSError, RuntimeError, MemoryError, OverflowError,
           KeyError, SyntaxError, TokenError, struct.error, zipfile.BadZipFile, zlib.error)
_LARGEST_FILE, _LARGEST_ARRAY = 4 << 30, 1 << 30  # [bytes]: as of FCLIB files and their datasets
_SPARSE = ("M_data", "M_indices", "M_indptr")  # by rows; M_shape is not needed: M is square


def read_problem(file: Path) -> Problem:
    """A problem file, by its name's end: .npz, .hdf5 or .h5 (FCLIB contact problems), else JSON.

    NPZ keys: M (n, n), or M_data, M_indices, M_indptr (compressed rows); q (n,); lower, upper (n,), friction (k, 3), or
    (k, 4) with the number of rows, 2 a disc, may be absent; arrays of numbers. A file has at most 4 GiB, an array of a
    packed one
    1 GiB: `set_largest_input` sets another limit.
    Raises ValueError or RuntimeError naming file, field and rule.
    """
    file = path("file", file)
    if file.endswith(".mtx"):
        raise ValueError(
            f"{file}: Matrix Market holds a matrix, not a problem: must be read by scipy.io.mmread, and q as well")
    if not file.endswith(".npz"):
        return _orthant._read_problem(file)
    fields = _arrays(file)
    q = fields["q"]
    if q.ndim != 1:
        raise ValueError(f"{file}: q has shape {q.shape}: must be one-dimensional")
    try:
        M = fields["M"] if "M" in fields else _by_rows(fields, len(q))
        return Problem(M, q, fields.get("lower"), fields.get("upper"), _friction(fields.get("friction")))
    except TypeError as error:
        raise TypeError(f"{file}: {_line(error)}") from None
    except (ValueError, OverflowError) as error:
        raise ValueError(f"{file}: {_line(error)}") from None


def set_largest_input(bytes: int) -> None:
    """How large files may be that are read, and arrays of packed ones [bytes], from now on and in every thread; 0: the
    usual of each kind, 4 GiB of a problem, 1 GiB of an array in it, 16 MiB of a scene or a sweep. `orthant --max-input`
    is the same."""
    _orthant._set_largest_input(whole("bytes", bytes, 0, 2**62))


def _line(said: object) -> str:
    """What quotes a file, or an error that may, as one short line."""
    text = str(said) or type(said).__name__
    text = text if text.isprintable() else ascii(text)
    return text if len(text) <= 300 else text[:300] + " ..."


def _arrays(file: str) -> dict[str, Any]:
    """The fields of NumPy's NPZ. Nothing is executed; what an array's header promises is compared with what is there
    before there is memory for it."""
    known = {"M", "q", "lower", "upper", "friction", *_SPARSE}
    fields: dict[str, Any] = {}
    _orthant._check_size(file, os.path.getsize(regular(file)), _orthant._largest_input(_LARGEST_FILE))
    try:
        archive = zipfile.ZipFile(file)
    except FileNotFoundError:
        raise
    except _BROKEN as error:
        raise ValueError(f"{file}: must be NumPy's NPZ, several arrays in a zip archive: {_line(error)}") from None
    with archive:
        members = archive.infolist()
        for member in members:
            key = member.filename[:-4] if member.filename.endswith(".npy") else member.filename
            if key not in known or key == member.filename:
                raise ValueError(
                    f"{file}: {_line(key)} is no known field: must be one of {', '.join(sorted(known))}, with .npy")
            if key in fields:
                raise ValueError(f"{file}: {key} is there twice")
            fields[key] = None
        if "q" not in fields or ("M" in fields) == ("M_data" in fields):
            raise ValueError(f"{file}: must have q, and either M or {', '.join(_SPARSE)}")
        for key, member in zip(fields, members):
            try:
                if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                    raise ValueError("it is packed as NumPy does not")
                packed = min(member.compress_size, os.path.getsize(file))
                if member.file_size > 1040 * packed:  # what there can be in it
                    raise ValueError(f"{member.file_size} bytes: {packed} of the file hold less")
                _orthant._check_size(member.filename, member.file_size, _orthant._largest_input(_LARGEST_ARRAY))
                with archive.open(member) as stream:
                    fields[key] = _array(stream, member.file_size)
            except _BROKEN as error:
                raise ValueError(f"{file}: {key} cannot be read: {_line(error)}") from None
    return fields


def _array(stream: Any, size: int) -> Any:
    """One array of `size` bytes with its header, of a type that numbers have."""
    import numpy as np

    npy: Any = np.lib.format
    version = npy.read_magic(stream)
    if version not in ((1, 0), (2, 0)):
        raise ValueError(f"version {version}: must be (1, 0) or (2, 0)")
    # Before NumPy 1.24 any length was taken, and its parser has no bound.
    bytes_of_length = 2 if version == (1, 0) else 4
    length = int.from_bytes(stream.read(bytes_of_length), "little")
    if length > 10000:
        raise ValueError(f"a header of {length} bytes: must have at most 10000")
    header = io.BytesIO(length.to_bytes(bytes_of_length, "little") + stream.read(length))
    shape, by_columns, dtype = (npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0)(header)
    if dtype.kind not in "biuf":
        raise ValueError(f"type {_line(dtype)}: must be numbers")
    if len(shape) > 2 or any(isinstance(n, bool) or n < 0 for n in shape):
        raise ValueError(f"shape {_line(shape)}: must be one or two lengths")
    there, promised = size - npy.MAGIC_LEN - bytes_of_length - length, math.prod(shape) * dtype.itemsize
    if promised != there:
        raise ValueError(f"shape {_line(shape)} asks for {str(promised)[:30]} bytes: it has {there}")
    values, at = np.empty(math.prod(shape), dtype), 0
    room = values.view(np.uint8)
    while chunk := stream.read(1 << 18):  # at the end the checksum is compared
        room[at:at + len(chunk)] = np.frombuffer(chunk, np.uint8)
        at += len(chunk)
    if at != promised:
        raise ValueError("it ends early")
    return values.reshape(shape, order="F" if by_columns else "C")


def _by_rows(fields: dict[str, Any], n: int) -> Any:
    import scipy.sparse

    if missing := [key for key in _SPARSE if key not in fields]:
        raise ValueError(f"{missing[0]} is missing: must be there with {', '.join(k for k in _SPARSE if k in fields)}")
    for key in _SPARSE:
        if fields[key].ndim != 1 or (key != "M_data" and fields[key].dtype.kind not in "iu"):
            raise ValueError(
                f"{key} has shape {fields[key].shape} and type {fields[key].dtype}: must be one-dimensional" +
                ("" if key == "M_data" else ", of integers"))
    try:
        return scipy.sparse.csr_matrix(tuple(fields[key] for key in _SPARSE), shape=(n, n))
    except ValueError as error:
        raise ValueError(f"{', '.join(_SPARSE)} are no {n} x {n} matrix by rows: {error}") from None


def _friction(table: Any) -> Any:
    if table is not None and (table.ndim != 2 or table.shape[1] not in (3, 4) or table.dtype.kind not in "iuf"):
        raise ValueError(f"friction has shape {table.shape} and type {table.dtype}: must be (k, 3) or (k, 4), real")
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
    """A contact problem for the FCLIB collection, HDF5: dimension 2, 3 or 5 (with rolling) rows a contact, the normal
    one first, then an interval, a disc or two discs."""
    file, dimension = path("file", file), whole("dimension", dimension, 1, 5)
    if not file.endswith((".hdf5", ".h5")):
        raise ValueError(f"{file}: must end in .hdf5 or .h5, by which read_problem knows it")
    _orthant._write_fclib(file, _problem(problem), dimension, word("title", title), word("description", description))


def write_npz(file: Path, problem: Problem) -> None:
    """A problem as NumPy's NPZ (NAME.npz), which `read_problem` reads back bit for bit. A Delassus operator is
    refused."""
    import numpy as np

    file = path("file", file)
    if not file.endswith(".npz"):
        raise ValueError(f"{file}: must end in .npz, by which read_problem knows it")
    M = _problem(problem).M
    if hasattr(M, "inverse_mass"):
        raise ValueError("problem: M is a Delassus operator: must be an array or sparse (write_problem keeps it)")
    fields: dict[str, Any] = {"q": problem.q, "lower": problem.lower, "upper": problem.upper}
    if hasattr(M, "indptr"):
        fields.update(M_data=M.data, M_indices=M.indices, M_indptr=M.indptr)
    else:
        fields["M"] = M
    if problem.friction:
        fields["friction"] = np.array(problem.friction, dtype=float)
    file = os.path.realpath(regular(file))  # a link is followed
    temporary = f"{file}.tmp{os.getpid()}"  # whole or not at all
    try:
        with open(temporary, "wb") as stream:
            np.savez_compressed(stream, **fields)
        os.replace(temporary, file)
    finally:
        if os.path.exists(temporary):
            os.remove(temporary)
