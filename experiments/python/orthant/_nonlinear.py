"""Nonlinear mixed complementarity problems, and games of two players."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, NamedTuple, Optional

from . import _orthant
from ._orthant import Equilibrium
from ._spec import options_of, seconds, shown, whole

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Vector = npt.NDArray[np.float64]


class McpResult(NamedTuple):
    """What `solve_mcp` gives back. It answers to SciPy's names too: result.x, result["fun"], result.get("nit"), ..."""

    status: str
    solved: bool
    z: Vector  # (n,)
    F: Vector  # (n,) F(z)
    residual: float  # natural residual in units of F
    iterations: int
    why: str  # one line where it is not solved: the row, by how much, or the entry that was not finite

    @property
    def x(self) -> Vector:
        """(n,) z, as scipy.optimize calls it"""
        return self.z

    @property
    def fun(self) -> Vector:
        """(n,) F(z), as scipy.optimize calls it"""
        return self.F

    @property
    def success(self) -> bool:
        """solved, as scipy.optimize calls it"""
        return self.solved

    @property
    def message(self) -> str:
        """the outcome in words"""
        return self.status + (f": {self.why}" if self.why else "")

    @property
    def nit(self) -> int:
        """iterations, as scipy.optimize calls it"""
        return self.iterations

    def keys(self) -> list[str]:
        """The names of what result[name] has."""
        return [*self._fields, "x", "fun", "success", "message", "nit"]

    def get(self, key: str, default: Any = None) -> Any:
        """result[key], or default where there is no such name."""
        return getattr(self, key) if key in self.keys() else default

    def __getitem__(self, key: Any) -> Any:
        if not isinstance(key, str):
            return tuple.__getitem__(self, key)
        if key not in self.keys():
            raise KeyError(key)
        return getattr(self, key)


def solve_mcp(F: Callable[[Vector], npt.ArrayLike], jacobian: Callable[[Vector], Any], start: npt.ArrayLike,
              lower: Optional[npt.ArrayLike] = None, upper: Optional[npt.ArrayLike] = None, *,
              time_limit: Optional[float] = None, **options: Any) -> McpResult:
    """Find lower <= z <= upper: F >= 0 where z = lower, F <= 0 where z = upper, else F = 0 (default: 0 and infinity).

    F(z) -> (n,); jacobian(z) -> (n, n) array or scipy.sparse matrix; both called within the bounds only.
    start: (n,). options: those of the solver `path`; tolerance (1e-10) is relative to the
    terms of the linearization, J z and F - J z. What the callbacks raise is passed on.
    Source: Dirkse & Ferris, Optim. Methods Softw. 5 (1995) 123-156.
    """
    for what, value in (("F", F), ("jacobian", jacobian)):
        if not callable(value):
            raise TypeError(f"{what} = {shown(value)}: must be a function of z")
    return McpResult(**_orthant._solve_mcp(F, jacobian, start, lower, upper, options_of(options),
                                           seconds("time_limit", time_limit)))


def equilibrium(A: npt.ArrayLike, B: npt.ArrayLike, label: int = 0, *,
                time_limit: Optional[float] = None) -> Equilibrium:
    """The equilibrium of the game with costs A, B (m, k) that misses `label` in [0, m + k).

    Raises TimeoutError where its path does not end in time_limit [s], RuntimeError where the costs span so many orders
    that rounding leads it in circles; Ctrl-C ends it.
    Source: Lemke & Howson, J. SIAM 12 (1964) 413-423.
    """
    return _orthant._equilibrium(A, B, whole("label", label, 0), seconds("time_limit", time_limit))


def equilibria(A: npt.ArrayLike, B: npt.ArrayLike, *, time_limit: Optional[float] = None) -> list[Equilibrium]:
    """The different equilibria that Lemke-Howson paths connect, from all labels; not always all there are
    (`extreme_equilibria` has all, of a small game).

    Raises TimeoutError where the paths do not end in time_limit [s]; Ctrl-C ends them.
    """
    return _orthant._equilibria(A, B, seconds("time_limit", time_limit))


def extreme_equilibria(A: npt.ArrayLike, B: npt.ArrayLike, *, time_limit: Optional[float] = None) -> list[Equilibrium]:
    """All extreme equilibria of a small game with costs A, B (m, k), m + k <= 64, by exact vertex enumeration.

    Each is judged by the definition, exactly: `regret` is 0. Every equilibrium is a convex combination of extreme
    ones with the same `label`, the number of its connected component; a label with one equilibrium is isolated.
    Time grows with the number of vertices, exponentially in m and k. Raises TimeoutError where it is not done in
    time_limit [s].
    Source: Avis, Rosenberg, Savani & von Stengel, Econ. Theory 42 (2010) 9-37.
    """
    return _orthant._extreme_equilibria(A, B, seconds("time_limit", time_limit))
