"""Linear complementarity problems: solve, analyse, enumerate."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, Iterable, NamedTuple, Optional, Union

from . import _orthant
from ._orthant import Problem, Result, Solutions
from ._spec import Entry, flag, seconds, spec

if TYPE_CHECKING:
    import numpy.typing as npt

    Array = npt.ArrayLike
    MatrixLike = Union[npt.ArrayLike, "Delassus", Any]  # or a scipy.sparse matrix
    FrictionRows = Optional[Union[Iterable[Union[tuple[int, int, float], tuple[int, int, float, int]]], npt.NDArray[Any]]]


class Delassus(NamedTuple):
    """A = W diag(inverse_mass) W' + diag(regularization), applied row by row and never formed."""

    W: Any  # scipy.sparse, n x m: constraint Jacobian
    inverse_mass: Array  # (m,) >= 0
    regularization: Optional[Array] = None  # (n,) >= 0


class Solver:
    """A solver kept: the second problem of a size allocates nothing. One thread at a time.

    name: a registered solver (`solvers()` lists them with their options); options: its own, checked against their ranges.
    Raises ValueError for an unknown name or option and a value out of range.
    """

    def __init__(self, name: str = "auto", **options: Any) -> None:
        self._solver = _orthant._Solver(spec(name, options))

    def solve(self, M: MatrixLike, q: Optional[Array] = None, lower: Optional[Array] = None,
              upper: Optional[Array] = None, *, friction: FrictionRows = None, start: Optional[Array] = None,
              time_limit: Optional[float] = None, log: bool = False) -> Result:
        """As the function `solve`."""
        return self._solver.solve(M, q, lower, upper, friction, start, seconds("time_limit", time_limit), flag("log", log))

    def __repr__(self) -> str:
        return f"Solver('{self._solver.spec}')"


_MOST_KEPT = 32
_kept = threading.local()  # solvers by spec, one set a thread: their memory is warm


def solve(M: MatrixLike, q: Optional[Array] = None, lower: Optional[Array] = None, upper: Optional[Array] = None, *,
          friction: FrictionRows = None, solver: str = "auto", start: Optional[Array] = None,
          time_limit: Optional[float] = None, log: bool = False, **options: Any) -> Result:
    """Find lower <= z <= upper with w = M z + q: w >= 0 where z = lower, w <= 0 where z = upper, else w = 0.

    M: (n, n) array, scipy.sparse matrix or Delassus; or a Problem alone. q: (n,).
    lower, upper: (n,) or one number for all rows, infinite where there is no bound; default 0 and infinity.
    friction: (row, normal row, mu) triples, or a (k, 3) array: |z[row]| <= mu z[normal row]; such rows have no bounds of
    their own. (first row, normal row, mu, 2) is a disc, Coulomb's cone in space, of the rows first row and first row + 1:
    norm(z[both]) <= mu z[normal row].
    solver: a name of `solvers()`; options: that solver's, such as solve(M, q, solver="pgs", omega=1.3).
    start: (n,) a guess. time_limit: [s] of wall time. log: keep what the solver did in `result.log`.
    Returns a Result; a hard problem has a status, never a wrong answer called solved. The interpreter's lock is released
    meanwhile; Ctrl-C ends a solve. Raises ValueError or TypeError naming argument, place and rule.
    Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992).
    """
    key = spec(solver, options) if options or not isinstance(solver, str) else solver
    kept = _kept.__dict__.get(key)
    if kept is None:
        while len(_kept.__dict__) >= _MOST_KEPT:
            del _kept.__dict__[next(iter(_kept.__dict__))]  # the oldest
        kept = _kept.__dict__[key] = _orthant._Solver(key)
    return kept.solve(M, q, lower, upper, friction, start, seconds("time_limit", time_limit), flag("log", log))


def solvers() -> list[Entry]:
    """Every registered solver: name, summary, options with defaults and ranges."""
    return [Entry(*row) for row in _orthant._solvers()]


def analyse(M: MatrixLike, *, time_limit: Optional[float] = None) -> dict[str, Any]:
    """What kind of matrix M is, an array, scipy.sparse matrix, Delassus or Problem.

    True, False, or None where it is not decided, never a guess: symmetric, positive_definite, positive_semidefinite,
    diagonally_dominant, z (no positive entry off the diagonal), p and p0 (principal minors > 0, >= 0), k (z and p), h_plus
    (its comparison matrix is k), copositive, column_sufficient, row_sufficient.
    n; rank (None: not decided); smallest, largest: of |M_ij|, zeros left out; condition: an estimate, inf where M is singular to
    working precision, nan where there is none; not_p: rows of a principal minor <= 0, where p is False and one is known.
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
                        upper: Optional[Array] = None, *, friction: FrictionRows = None,
                        time_limit: Optional[float] = None) -> Solutions:
    """Every solution, exactly: isolated points and maximal faces. At most 20 rows [0, inf), or 12 boxes or friction rows.

    Arguments as in `solve`. time_limit: [s]; what is found by then, with `complete` False. Ctrl-C ends it.
    Raises ValueError where the problem is too large.
    """
    return _orthant._enumerate(_problem(M, q, lower, upper, friction), seconds("time_limit", time_limit))


def error_bound(M: MatrixLike, q: Optional[Array] = None, lower: Optional[Array] = None,
                upper: Optional[Array] = None, *, z: Array, time_limit: Optional[float] = None) -> float:
    """A proved bound on max |z - solution|, rounding included; inf where theory gives none, or not in time_limit [s]."""
    return _orthant._error_bound(_problem(M, q, lower, upper, None), z, seconds("time_limit", time_limit))
