"""Derivatives of solutions with respect to the data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Optional

from . import _orthant
from ._orthant import Problem, Result
from ._spec import shown

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Array = npt.ArrayLike
    Vector = npt.NDArray[np.float64]


class Tangent(NamedTuple):
    """Changes of z and w = M z + q along a change of the data."""

    z: Vector
    w: Vector
    consistent: bool  # False: redundant rows part, and there is no derivative


class Gradient(NamedTuple):
    """Of a scalar with respect to the data; `M` is stored as the problem's."""

    M: Any
    q: Vector
    lower: Vector
    upper: Vector
    mu: Vector  # one a friction
    consistent: bool  # False: the scalar depends on the choice among solutions, and has no derivative


class WeaklyActive(NamedTuple):
    """A row that may go either way: z is at a bound and w is 0, both up to the solution's accuracy."""

    row: int
    distance: float  # of z from the bound
    w: float


class Sensitivity:
    """What `sensitivity` returns: one factorization, a solve for each product.

    degenerate: the weakly active rows; where there are any, z has one-sided derivatives only, which `directional` gives.
    redundant: the active block is singular, as of contacts that hold a body more than once. Then z is not unique; derivatives
    are those of what all solutions share, w or the velocities; the z given is one of many.
    margin: (n,) how far each row is from another pattern, in units of w; nearest: the row with the least one, -1: none.
    unknowns, reciprocal_condition: of the linear system.
    """

    def __init__(self, problem: Problem, result: Result) -> None:
        self._of = _orthant._Sensitivity(problem, result.status, result.z, result.w, result.residual, result.rounding)

    @property
    def degenerate(self) -> list[WeaklyActive]:
        return [WeaklyActive(*row) for row in self._of.weakly_active]

    @property
    def redundant(self) -> bool:
        return self._of.redundant

    @property
    def margin(self) -> Vector:
        return self._of.margin

    @property
    def nearest(self) -> int:
        return self._of.nearest

    @property
    def unknowns(self) -> int:
        return self._of.unknowns

    @property
    def reciprocal_condition(self) -> float:
        return self._of.reciprocal_condition

    def jvp(self, dM: Any = None, dq: Optional[Array] = None, dlo: Optional[Array] = None, dhi: Optional[Array] = None,
            dmu: Optional[Array] = None) -> Tangent:
        """The tangent along a change of M, q, bounds and friction coefficients; None: no change.

        dM: an array or scipy.sparse matrix; of a problem with a Delassus matrix also a Delassus of changes of W, inverse_mass
        and regularization. dmu: one number a friction. Weakly active rows are held at their bounds.
        """
        return Tangent(*self._of.tangent(dM, dq, dlo, dhi, dmu, False))

    def directional(self, dM: Any = None, dq: Optional[Array] = None, dlo: Optional[Array] = None,
                    dhi: Optional[Array] = None, dmu: Optional[Array] = None) -> Tangent:
        """The one-sided derivative along the change: weakly active rows go as the change lets them.

        They solve a complementarity problem of their own. Without such rows the same as `jvp`. Raises RuntimeError where that
        problem is not solved.
        """
        return Tangent(*self._of.tangent(dM, dq, dlo, dhi, dmu, True))

    def vjp(self, g: Array, h: Optional[Array] = None) -> Gradient:
        """The gradient of g @ z + h @ w with respect to all data. Weakly active rows are held at their bounds."""
        return Gradient(*self._of.vjp(g, h))

    def __repr__(self) -> str:
        return f"Sensitivity(unknowns={self.unknowns}, degenerate={len(self.degenerate)}, redundant={self.redundant})"

    def __str__(self) -> str:
        return str(self._of)


def sensitivity(problem: Problem, result: Result) -> Sensitivity:
    """Derivatives of a solution with respect to M, q, bounds and friction, from its active set.

    problem: a Problem; result: of `solve(problem)`, solved or rounded. One factorization, kept for all products.
    Raises ValueError where the result is no answer to the problem.
    Source: Robinson, Strongly regular generalized equations, Math. Oper. Res. 5 (1980).
    """
    if not isinstance(problem, Problem):
        raise TypeError(f"problem = {shown(problem)}: must be a Problem, such as orthant.Problem(M, q)")
    return Sensitivity(problem, result)
