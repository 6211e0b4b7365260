"""Linear complementarity problems: solve, analyse, enumerate."""

from __future__ import annotations

import math
import os
import threading
from typing import TYPE_CHECKING, Any, Callable, Iterable, NamedTuple, Optional, Sequence, Union

from . import _orthant
from ._orthant import Problem, Result, Solutions
from ._spec import Entry, flag, registered, seconds, shown, spec, whole, word

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Array = npt.ArrayLike
    MatrixLike = Union[npt.ArrayLike, "Delassus", Any]  # or a scipy.sparse matrix
    # (lower, upper), [(low, high), ...] a row, or scipy.optimize.Bounds
    Bounds = Union[tuple[Optional[Array], Optional[Array]], Sequence[tuple[Optional[float], Optional[float]]], Any,
                   None]
    FrictionRows = Optional[Union[Iterable[Union[tuple[int, int, float], tuple[int, int, float, int]]],
                                  npt.NDArray[Any]]]


class Delassus(NamedTuple):
    """A = W diag(inverse_mass) W' + diag(regularization), applied row by row and never formed."""

    W: Any  # scipy.sparse, n x m: constraint Jacobian
    inverse_mass: Array  # (m,) >= 0
    regularization: Optional[Array] = None  # (n,) >= 0


_NOTHING: Any = object()


def _bounds(bounds: Bounds, lower: Optional[Array] = None,
            upper: Optional[Array] = None) -> tuple[Optional[Array], Optional[Array]]:
    """(lower, upper) from (lower, upper), a pair a row, or an object with lb and ub; None: no bound."""
    if bounds is None:
        return lower, upper
    if lower is not None or upper is not None:
        raise ValueError("bounds = (lower, upper): must be given alone, without lower and upper")
    low, high = getattr(bounds, "lb", _NOTHING), getattr(bounds, "ub", _NOTHING)
    if low is not _NOTHING and high is not _NOTHING:
        return low, high
    if not hasattr(bounds, "__len__") or not hasattr(bounds, "__getitem__") or isinstance(bounds, (str, bytes, dict)):
        raise TypeError(f"bounds = {shown(bounds)}: must be a pair (lower, upper), a list of pairs, or have lb and ub")
    given: Any = bounds
    if _pair_a_row(given):
        lows: Any = [-math.inf if pair[0] is None else pair[0] for pair in given]
        return lows, [math.inf if pair[1] is None else pair[1] for pair in given]
    low, high = given
    return -math.inf if low is None else low, math.inf if high is None else high


def _pair_a_row(bounds: Any) -> bool:
    """Whether they are SciPy's [(low, high), ...], and not (lower, upper). Two rows of two numbers could be both."""
    def pair(one: Any) -> bool:
        return hasattr(one, "__len__") and hasattr(one, "__getitem__") and len(one) == 2

    if len(bounds) != 2:
        for i, one in enumerate(bounds):
            if not pair(one):
                raise TypeError(f"bounds[{i}] = {shown(one)}: must be a pair (low, high), None is no bound")
        return True
    if not all(pair(one) for one in bounds):
        return False
    if any(number is None for one in bounds for number in one):
        return True
    if isinstance(bounds, list) and all(isinstance(one, tuple) for one in bounds):
        return True
    if isinstance(bounds, tuple) and not any(isinstance(one, tuple) for one in bounds):
        return False
    if isinstance(bounds, list) and all(hasattr(one, "shape") for one in bounds):
        return False
    raise ValueError(
        f"bounds = {shown(bounds)}: could be (lower, upper) or a pair a row: must be a tuple of two lists or "
        "arrays (lower, upper), or a list of tuples [(low, high), (low, high)]")


class Solver:
    """A solver kept: the second problem of a size allocates nothing. One thread at a time.

    name: a registered solver (`solvers()` lists them with their options); options: its own, checked against their
    ranges.
    Raises ValueError for an unknown name or option and a value out of range.
    """

    def __init__(self, name: str = "auto", **options: Any) -> None:
        self._solver = _orthant._Solver(spec(name, options))

    def solve(self, M: MatrixLike, q: Optional[Array] = None, lower: Optional[Array] = None,
              upper: Optional[Array] = None, *, bounds: Bounds = None, friction: FrictionRows = None,
              start: Optional[Array] = None, time_limit: Optional[float] = None, log: bool = False) -> Result:
        """As the function `solve`."""
        lower, upper = _bounds(bounds, lower, upper)
        return self._solver.solve(M, q, lower, upper, friction, start, seconds("time_limit", time_limit),
                                  flag("log", log))

    def __repr__(self) -> str:
        return f"Solver('{self._solver.spec}')"


_MOST_KEPT = 32
_kept = threading.local()  # solvers by spec, one set a thread: their memory is warm


def solve(M: MatrixLike, q: Optional[Array] = None, lower: Optional[Array] = None, upper: Optional[Array] = None, *,
          bounds: Bounds = None, friction: FrictionRows = None, solver: str = "auto", start: Optional[Array] = None,
          time_limit: Optional[float] = None, log: bool = False, **options: Any) -> Result:
    """Find lower <= z <= upper with w = M z + q: w >= 0 where z = lower, w <= 0 where z = upper, else w = 0.

    M: (n, n) array, scipy.sparse matrix or Delassus; or a Problem alone. q: (n,). Arrays are NumPy's, lists, or tensors
    of other libraries in this processor's memory (DLPack).
    lower, upper: (n,) or one number for all rows, infinite where there is no bound; default 0 and infinity.
    bounds: (lower, upper) in one, where None is no bound; SciPy's list of pairs [(low, high), ...], one a row; or
    scipy.optimize.Bounds. With bounds=None they are 0 and infinity, as without.
    friction: (row, normal row, mu) triples, or a (k, 3) array: |z[row]| <= mu z[normal row]; such rows have no bounds
    of their own. (first row, normal row, mu, 2) is a disc, Coulomb's cone in space, of the rows first row and first row
    + 1: norm(z[both]) <= mu z[normal row].
    solver: a name of `solvers()`; options: that solver's, such as solve(M, q, solver="pgs", omega=1.3).
    start: (n,) a guess. time_limit: [s] of wall time. log: keep what the solver did in `result.log`.
    Returns a Result; a hard problem has a status, never a wrong answer called solved. The interpreter's lock is
    released meanwhile; Ctrl-C ends a solve. Raises ValueError or TypeError naming argument, place and rule. The result
    also answers to SciPy's names, as an OptimizeResult does: result.x, .fun, .success, .message, .nit, .nfev,
    result["x"], .get, .keys().
    Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992).
    """
    key = spec(solver, options) if options or not isinstance(solver, str) else solver
    kept = _kept.__dict__.get(key)
    if kept is None:
        while len(_kept.__dict__) >= _MOST_KEPT:
            del _kept.__dict__[next(iter(_kept.__dict__))]  # the oldest
        kept = _kept.__dict__[key] = _orthant._Solver(key)
    if bounds is not None:  # a call is a microsecond
        lower, upper = _bounds(bounds, lower, upper)
    return kept.solve(M, q, lower, upper, friction, start, seconds("time_limit", time_limit), flag("log", log))


def solve_many(problems: Union[Iterable[Union[Problem, tuple[Any, ...]]], MatrixLike], q: Optional[Array] = None,
               lower: Optional[Array] = None, upper: Optional[Array] = None, *, bounds: Bounds = None,
               friction: FrictionRows = None,
               start: Union[Array, Sequence[Optional[Union[Result, Array]]], None] = None, solver: str = "auto",
               threads: Optional[int] = None, time_limit: Optional[float] = None, **options: Any) -> list[Result]:
    """Solve many problems on several threads, without the interpreter's lock; the results in the problems' order.

    solve_many(problems): Problems, or tuples (M, q), (M, q, lower, upper), (M, q, lower, upper, friction).
    solve_many(M, q): q is (k, n), M (k, n, n), or one matrix of all, as in `solve`. lower, upper: a number, (n,) for
    all, or (k, n); bounds: (lower, upper) of those, or as in `solve` for all. friction: as in `solve`, of all.
    start: guesses, (k, n) or (n,) for all, or a list of k arrays, earlier Results (a warm start) or None.
    threads: default one a processor. solver, options: as in `solve`. time_limit: [s] of each problem. Answers do not
    depend on the threads.
    """
    if q is not None:
        wanted = _stacked(problems, q, *_bounds(bounds, lower, upper), friction)
    else:
        if any(part is not None for part in (lower, upper, bounds, friction)):
            raise ValueError("lower, upper, bounds, friction: must be given with q, or in each problem")
        wanted = []
        listed: Any = problems
        if not hasattr(listed, "__iter__"):
            raise TypeError(f"problems = {shown(problems)}: must be a list, or M with q")
        for i, one in enumerate(listed):
            if isinstance(one, Problem):
                wanted.append((one,))
            elif isinstance(one, (tuple, list)) and 2 <= len(one) <= 5:
                wanted.append((*one, *[None] * (5 - len(one))))
            else:
                raise TypeError(
                    f"problems[{i}] = {shown(one)}: must be a Problem or a tuple (M, q, lower, upper, friction)")
    count = (os.cpu_count() or 1) if threads is None else whole("threads", threads, 1, 1024)
    return _orthant._solve_many(spec(solver, options), wanted, count, seconds("time_limit", time_limit),
                                _starts(start, len(wanted)))


def _array(name: str, value: Any) -> npt.NDArray[np.float64]:
    import numpy as np

    if not hasattr(value, "__array__") and hasattr(value, "__dlpack__"):
        value = np.from_dlpack(value)
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise TypeError(f"{name} = {shown(value)}: must be numbers") from None


def _stacked(M: Any, q: Any, lower: Any, upper: Any, friction: Any) -> list[tuple[Any, ...]]:
    """One (M, q, lower, upper, friction) a problem."""
    if isinstance(M, Problem):
        raise TypeError("M is a Problem, which holds its own q: must be a matrix")
    q = _array("q", q)
    if q.ndim != 2:
        raise ValueError(f"q has shape {q.shape}: must be (k, n), one row a problem")
    if isinstance(M, Delassus) or getattr(M, "ndim", 0) == 2 or hasattr(M, "indptr"):
        matrices = [M] * len(q)  # one of all, sparse maybe
    elif isinstance(M, (list, tuple)) and len(M) == len(q) and all(getattr(one, "ndim", 0) == 2 for one in M):
        matrices = list(M)
    else:
        M = _array("M", M)
        if M.ndim not in (2, 3) or M.ndim == 3 and len(M) != len(q):
            raise ValueError(f"M has shape {M.shape}: must be ({len(q)}, n, n), one matrix a row of q, or (n, n)")
        matrices = list(M) if M.ndim == 3 else [M] * len(q)

    def each(name: str, bound: Any) -> list[Any]:
        if bound is None or isinstance(bound, (int, float)):
            return [bound] * len(q)
        bound = _array(name, bound)
        if bound.ndim == 2 and len(bound) == len(q):
            return list(bound)
        if bound.ndim > 1:
            raise ValueError(f"{name} has shape {bound.shape}: must be a number, (n,) or ({len(q)}, n)")
        return [bound] * len(q)

    return list(zip(matrices, q, each("lower", lower), each("upper", upper), [friction] * len(q)))


def _starts(start: Any, count: int) -> list[Any]:
    if start is None:
        return []
    if isinstance(start, (list, tuple)) and any(one is None or isinstance(one, Result) for one in start):
        starts: list[Any] = [one.z if isinstance(one, Result) else one for one in start]
    else:
        guess = _array("start", start)
        starts = [guess] * count if guess.ndim < 2 else list(guess)
    if len(starts) != count:
        raise ValueError(f"start: {len(starts)} guesses: must be one a problem, {count}")
    return starts


def register_solver(name: str, function: Callable[[Problem, npt.NDArray[np.float64]], Optional[npt.ArrayLike]],
                    summary: str = "written in Python") -> None:
    """A method of your own under a name, for `solve`, `Solver`, `solve_many` and `simulate` of this process.

    function(problem, start) -> z: (n,) numbers, or None where it gives up; start is a guess. The judge decides what is
    solved. `sweep` takes it too. It may be called from any thread, with the interpreter's lock. An exception ends the
    solve.
    Raises ValueError for a name that is taken, or made of other than a-z, 0-9 and -.
    """
    if not callable(function):
        raise TypeError(f"function = {shown(function)}: must be a function of a Problem and a start")
    _orthant._register_solver(word("name", name), function, word("summary", summary))
    registered.add(("solver", name))


def solvers() -> list[Entry]:
    """Every registered solver: name, summary, options with defaults and ranges."""
    return [Entry(*row) for row in _orthant._solvers()]


def analyse(M: MatrixLike, *, time_limit: Optional[float] = None) -> dict[str, Any]:
    """What kind of matrix M is, an array, scipy.sparse matrix, Delassus or Problem.

    True, False, or None where it is not decided, never a guess: symmetric, positive_definite, positive_semidefinite,
    diagonally_dominant, z (no positive entry off the diagonal), p and p0 (principal minors > 0, >= 0), k (z and p),
    h_plus (its comparison matrix is k), copositive, column_sufficient, row_sufficient.
    n; rank (None: not decided); smallest, largest: of |M_ij|, zeros left out; condition: an estimate, inf where M is
    singular to working precision, nan where there is none; not_p: rows of a principal minor <= 0, where p is False and
    one is known.
    time_limit: [s]; what is open by then is None. Ctrl-C ends it. Cost: a few factorizations of M, or about a second.
    Source: Cottle, Pang & Stone (1992), ch. 3.
    """
    return _orthant._analyse(M, seconds("time_limit", time_limit))


def _problem(M: Any, q: Any, lower: Any, upper: Any, friction: Any) -> Problem:
    if not isinstance(M, Problem):
        return Problem(M, q, lower, upper, friction)
    if any(part is not None for part in (q, lower, upper, friction)):
        raise ValueError("a Problem holds q, bounds and friction itself: must be given alone")
    return M


def enumerate_solutions(M: MatrixLike, q: Optional[Array] = None, lower: Optional[Array] = None,
                        upper: Optional[Array] = None, *, bounds: Bounds = None, friction: FrictionRows = None,
                        time_limit: Optional[float] = None) -> Solutions:
    """Every solution, exactly: isolated points and maximal faces. At most 20 rows [0, inf), or 12 boxes or friction
    rows.

    Arguments as in `solve`. time_limit: [s]; what is found by then, with `complete` False. Ctrl-C ends it.
    Raises ValueError where the problem is too large.
    """
    return _orthant._enumerate(_problem(M, q, *_bounds(bounds, lower, upper), friction),
                               seconds("time_limit", time_limit))


def error_bound(M: MatrixLike, q: Optional[Array] = None, lower: Optional[Array] = None,
                upper: Optional[Array] = None, *, z: Array, bounds: Bounds = None,
                time_limit: Optional[float] = None) -> float:
    """A proved bound on max |z - solution|, rounding included; inf where theory gives none, or not in time_limit
    [s]."""
    return _orthant._error_bound(_problem(M, q, *_bounds(bounds, lower, upper), None), z,
                                 seconds("time_limit", time_limit))
