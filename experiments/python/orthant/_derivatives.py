"""Derivatives of solutions with respect to the data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Sequence, Union

from . import _orthant
from ._orthant import Problem, Result
from ._spec import seconds, shown, whole, word

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
    """What `sensitivity` returns: one factorization, a solve for each product."""

    def __init__(self, problem: Problem, result: Result) -> None:
        self._of = _orthant._Sensitivity(problem, result.status, result.z, result.w, result.residual, result.rounding)

    @property
    def degenerate(self) -> list[WeaklyActive]:
        """The weakly active rows. Where there are any, z has one-sided derivatives only: see `directional`."""
        return [WeaklyActive(*row) for row in self._of.weakly_active]

    @property
    def redundant(self) -> bool:
        """True: the active block is singular, as of contacts that hold a body more than once. Then z is not unique;
        derivatives are those of what all solutions share, w or the velocities."""
        return self._of.redundant

    @property
    def margin(self) -> Vector:
        """(n,) in units of w: how far each row is from another pattern."""
        return self._of.margin

    @property
    def nearest(self) -> int:
        """The row with the least margin that is not weakly active; -1: none."""
        return self._of.nearest

    @property
    def unknowns(self) -> int:
        """Size of the linear system."""
        return self._of.unknowns

    @property
    def reciprocal_condition(self) -> float:
        """Of the scaled linear system, estimated in the 1-norm: 1 at best, 0 where it is singular."""
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


class RunGradient(NamedTuple):
    """Derivatives of one column of a run with respect to parameters, along the run; `final` at its end."""

    of: str
    wrt: list[str]
    t: Vector  # (rows,) [s]
    values: Vector  # (rows,) of the column
    by: Vector  # (rows, parameters)
    degenerate: list[tuple[float, list[str]]]  # steps with weakly active contacts: their begin [s], the contacts
    inconsistent: int  # steps in which a parameter parts redundant contacts: there is no derivative

    @property
    def final(self) -> dict[str, float]:
        """The derivatives at the end of the run."""
        return dict(zip(self.wrt, (float(x) for x in self.by[-1])))


def gradient(scene: Any, of: str, wrt: Union[str, Sequence[str]], *, integrator: str = "moreau-jean", solver: str = "auto",
             step: Optional[float] = None, duration: Optional[float] = None, every: int = 1) -> RunGradient:
    """Derivatives of a run of a planar scene by moreau-jean, step by step: those of the discrete run, impacts included.

    of: a column of a body, "crank.theta", BODY.x, y, theta, vx, vy or omega. wrt: parameters: keys with a number, of a built-in
    scene its options, "mu", else key paths of the scene's text, "body.rod.mass", "contact.corner1.mu", entries of arrays by
    their place, "body.rod.position[0]"; and of the start "start.BODY.x", ... "start.BODY.omega".
    scene, integrator, solver, step, duration, every: as of `simulate`.
    They hold while the sequence of closed contacts, stick and slip stays as it is; `degenerate` lists steps where it may change.
    Raises ValueError for what has no derivative here, RuntimeError where the run does not come to its end.
    """
    from ._mechanics import _scene_of

    made = scene if isinstance(scene, _orthant._Scene) else _scene_of(scene)
    if getattr(scene, "_customs", None):
        raise ValueError("gradient: joints and contacts written in Python have no derivatives here")
    parameters = [wrt] if isinstance(wrt, str) else [word("wrt", key) for key in wrt]
    t, values, by, status, why, degenerate, inconsistent = _orthant._gradient(
        made.text, made.name, made.sets, [word("of", of)], parameters, word("integrator", integrator), word("solver", solver),
        seconds("step", step), seconds("duration", duration), whole("every", every, 1, what=" of steps"))
    if status != "solved":
        raise RuntimeError(f"gradient: the run ended as {status}{': ' if why else ''}{why}")
    _warn(degenerate, inconsistent)
    return RunGradient(of, parameters, t, values[:, 0], by[:, 0, :], degenerate, inconsistent)


def _warn(degenerate: list[tuple[float, list[str]]], inconsistent: int) -> None:
    """What `orthant gradient` warns of."""
    import warnings

    from ._mechanics import OrthantWarning

    if degenerate:
        t, contacts = degenerate[0]
        warnings.warn(f"{len(degenerate)} steps have weakly active contacts, the first at t = {t:g} s ({contacts[0]}): only "
                      "one-sided derivatives exist, these hold such contacts as they are", OrthantWarning, stacklevel=3)
    if inconsistent > 0:
        warnings.warn(f"in {inconsistent} steps a parameter parts redundant contacts: there is no derivative", OrthantWarning, stacklevel=3)
