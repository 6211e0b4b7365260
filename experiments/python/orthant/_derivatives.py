"""Derivatives of solutions with respect to the data."""

from __future__ import annotations

from collections import abc
from typing import TYPE_CHECKING, Any, Mapping, NamedTuple, Optional, Sequence, Union

from . import _orthant
from ._orthant import Problem, Result
from ._spec import number, seconds, shown, whole, word

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
        self._from = problem, result

    def __reduce__(self) -> tuple[type[Sensitivity], tuple[Problem, Result]]:
        return type(self), self._from

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

        dM: an array or scipy.sparse matrix; of a problem with a Delassus matrix also a Delassus of changes of W,
        inverse_mass and regularization. dmu: one number a friction. Weakly active rows are held at their bounds.
        """
        return Tangent(*self._of.tangent(dM, dq, dlo, dhi, dmu, False))

    def directional(self, dM: Any = None, dq: Optional[Array] = None, dlo: Optional[Array] = None,
                    dhi: Optional[Array] = None, dmu: Optional[Array] = None) -> Tangent:
        """The one-sided derivative along the change: weakly active rows go as the change lets them.

        They solve a complementarity problem of their own. Without such rows the same as `jvp`. Raises RuntimeError
        where that problem is not solved.
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
    if not isinstance(result, Result):
        raise TypeError(f"result = {shown(result)}: must be a Result, such as orthant.solve(problem)")
    return Sensitivity(problem, result)


class RunGradient(NamedTuple):
    """Derivatives of one column of a run with respect to parameters: a row a record, or one row (`at`); `final` is the
    last."""

    of: str
    wrt: list[str]
    t: Vector  # (rows,) [s]
    values: Vector  # (rows,) of the column
    by: Vector  # (rows, parameters)
    degenerate: list[tuple[float, list[str]]]  # steps with weakly active contacts: their begin [s], the contacts
    inconsistent: int  # steps in which a parameter parts redundant contacts: there is no derivative

    @property
    def final(self) -> dict[str, float]:
        """The derivatives in the last row."""
        return dict(zip(self.wrt, (float(x) for x in self.by[-1])))


class RunTangent(NamedTuple):
    """Of columns of a run along a change of parameters, a row a record."""

    of: list[str]
    t: Vector  # (rows,) [s]
    values: Vector  # (rows, columns)
    change: Vector  # (rows, columns)
    degenerate: list[tuple[float, list[str]]]
    inconsistent: int


class RunAdjoint(NamedTuple):
    """Of a weighted sum over rows and columns of a run."""

    value: float
    gradient: dict[str, float]  # by parameter
    degenerate: list[tuple[float, list[str]]]
    inconsistent: int


class Lyapunov(NamedTuple):
    """Lyapunov exponents, the largest first; -inf: of a direction that a lasting contact or a plastic impact takes
    away."""

    exponents: Vector  # [1/s]
    last_half: Vector  # [1/s] of the second half of the time: how far they have settled
    t: float  # [s] reached


class _Call:
    """What all derivatives of a run are given: scene, method, time."""

    def __init__(self, scene: Any, integrator: str, solver: str, step: Optional[float], duration: Optional[float],
                 every: int) -> None:
        from ._scene import scene_of

        made = scene if isinstance(scene, _orthant._Scene) else scene_of(scene)
        if getattr(scene, "_customs", None):
            raise ValueError("gradient: joints and contacts written in Python have no derivatives here")
        self.scene = (made.text, made.name, made.sets)
        self.how = (word("integrator", integrator), word("solver", solver), seconds("step", step),
                    seconds("duration", duration), whole("every", every, 1, what=" of steps"))

    def records(self) -> int:
        """Of the run."""
        return _orthant._records_of_run(*self.scene, *self.how[2:])

    def forward(self, of: list[str], wrt: list[str]) -> tuple[Any, ...]:
        integrator, solver, step, duration, every = self.how
        t, values, by, status, why, degenerate, inconsistent, warnings = _orthant._gradient(
            *self.scene, of, wrt, integrator, solver, step, duration, every)
        _arrived(status, why)
        _warn([], 0, warnings)
        return t, values, by, degenerate, inconsistent

    def reverse(self, of: list[str], wrt: list[str], weights: Any, total: bool) -> tuple[Any, ...]:
        integrator, solver, step, duration, every = self.how
        t, values, by, status, why, degenerate, inconsistent, warnings = _orthant._vjp_of_run(
            *self.scene, of, wrt, integrator, solver, step, duration, every, weights, total)
        _arrived(status, why)
        _warn([], 0, warnings)
        return t, values, by, degenerate, inconsistent


def _arrived(status: str, why: str) -> None:
    if status != "solved":
        raise RuntimeError(f"gradient: the run ended as {status}{': ' if why else ''}{why}")


def _words(what: str, names: Union[str, Sequence[str]]) -> list[str]:
    if isinstance(names, str):
        return [word(what, names)]
    if isinstance(names, (bytes, abc.Mapping)) or not isinstance(names, abc.Iterable):
        raise TypeError(f"{what} = {shown(names)}: must be a name or a sequence of names")
    words = [word(f"{what}[{place}]", name, "a name") for place, name in enumerate(names)]
    if not words:
        raise ValueError(f"{what} = {shown(names)}: must have at least one name")
    return words


def _mapping(what: str, given: Any, form: str) -> Mapping[str, Any]:
    if not isinstance(given, abc.Mapping):
        raise TypeError(f"{what} = {shown(given)}: must be a mapping {form}")
    for key in given:
        word(f"a key of {what}", key, "a name")
    if not given:
        raise ValueError(f"{what} = {shown(given)}: must have at least one entry, {form}")
    return given


def _weights_of(column: str, given: Any) -> Vector:
    """A number, or an array of them."""
    import numpy

    what = f"weights[{column!r}]"
    try:
        if isinstance(given, (str, bytes, bool)) or numpy.asarray(given).dtype.kind not in "iuf":
            raise TypeError
        weights = numpy.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise TypeError(f"{what} = {shown(given)}: must be a number, or an array of them, one a record") from None
    if weights.ndim > 1:
        raise ValueError(f"{what} has the shape {weights.shape}: must be a number, or an array of them, one a record")
    if not numpy.isfinite(weights).all():
        raise ValueError(f"{what} = {shown(given)}: must be finite")
    return weights


def _settings(given: Mapping[str, Any]) -> dict[str, Any]:
    """Of a run: those given, the others at their defaults."""
    for key in given:
        if key not in _HOW:
            raise TypeError(f"{key}: is no setting of a run: must be {', '.join(list(_HOW)[:-1])} or {list(_HOW)[-1]}")
    return {**_HOW, **given}


def gradient(scene: Any, of: str, wrt: Union[str, Sequence[str]], *, at: str = "records", mode: str = "auto",
             integrator: str = "moreau-jean", solver: str = "auto", step: Optional[float] = None,
             duration: Optional[float] = None, every: int = 1) -> RunGradient:
    """Derivatives of a run: by moreau-jean, in the plane also rattle, those of the discrete run, step by step, impacts
    included; in the plane by event-driven those of the motion itself (variational equations and saltation; forward, of
    bodies, gaps and the energy).

    of: a column, of a body "crank.theta", BODY.x, y, theta, vx, vy or omega; of a contact CONTACT.gap, impulse_n,
    impulse_t; of a dry friction in a joint FRICTION.impulse; "energy". In space BODY.x, y, z, qw, qx, qy, qz, vx, vy,
    vz, wx, wy or wz, and impulse_t1, impulse_t2.
    wrt: parameters: keys with a number, of a built-in scene its options, "mu", else key paths of the scene's text,
    "body.rod.mass", "contact.corner1.mu", entries of arrays by their place, "body.rod.position[0]"; "rod.mass" of a
    body of any scene; and of the start
    "start.BODY.x", ... "start.BODY.omega", in space "start.BODY.x", y, z, rx, ry, rz (a turn about an axis of the
    world), vx, ... wz.
    at: "records": at each of them; "end": at the last one; "sum": of the sum over all of them.
    mode: "forward": its cost grows with the parameters; "reverse", not for at="records": it does not; "auto": the
    cheaper one. scene, integrator, solver, step, duration, every: as of `simulate`.
    They hold while the sequence of closed contacts, stick and slip stays as it is; `degenerate` lists steps where it
    may change.
    Raises ValueError for what has no derivative here, RuntimeError where the run does not come to its end, or the
    motion has no derivative (a graze, contacts that part, a crowd of events).
    """
    call = _Call(scene, integrator, solver, step, duration, every)
    parameters = _words("wrt", wrt)
    at, mode = word("at", at, "'records', 'end' or 'sum'"), word("mode", mode, "'auto', 'forward' or 'reverse'")
    if at not in ("records", "end", "sum"):
        raise ValueError(f"at = {shown(at)}: must be 'records', 'end' or 'sum'")
    if mode not in ("auto", "forward", "reverse") or (mode == "reverse" and at == "records"):
        raise ValueError(f"mode = {shown(mode)}: must be 'auto', 'forward' or, with at = 'end' or 'sum', 'reverse'")
    columns = [word("of", of)]
    cheaper_back = at != "records" and len(parameters) > _REVERSE_FROM and not call.how[0].startswith("event-driven")
    if mode == "reverse" or (mode == "auto" and cheaper_back):
        end, values, by, degenerate, inconsistent = call.reverse(columns, parameters, None, at == "sum")
        import numpy

        _warn(degenerate, inconsistent, [])
        return RunGradient(of, parameters, numpy.array([end]), values, by, degenerate, inconsistent)
    t, values, by, degenerate, inconsistent = call.forward(columns, parameters)
    values, by = values[:, 0], by[:, 0, :]
    if at == "end":
        t, values, by = t[-1:], values[-1:], by[-1:]
    if at == "sum":
        t, values, by = t[-1:], values.sum(keepdims=True), by.sum(axis=0, keepdims=True)
    _warn(degenerate, inconsistent, [])
    return RunGradient(of, parameters, t, values, by, degenerate, inconsistent)


def lyapunov(scene: Any, count: int = 1, *, duration: float, transient: float = 0, every: Optional[float] = None,
             integrator: str = "event-driven", solver: str = "auto") -> Lyapunov:
    """Lyapunov exponents of a planar scene's motion, from its variational equations and saltation, by event-driven.

    count: how many, at most twice the degrees of freedom. duration: time to average over [s], after transient [s];
    every: time between two orthonormalizations [s], by default a hundredth of the duration.
    Raises RuntimeError where the motion has no tangents (a graze, a crowd of events) or does not come to its end.
    Source: Benettin et al., Meccanica 15 (1980) 9-30.
    """
    if duration is None:
        raise TypeError("duration = None: must be a number [s]")
    call = _Call(scene, integrator, solver, None, duration, 1)
    integrator, solver = call.how[:2]
    length = float(duration)
    if (rest := number("transient", transient)) < 0:
        raise ValueError(f"transient = {rest:g}: must be >= 0 [s]")
    between = seconds("every", every) or length / 100
    t, exponents, last_half, status, why = _orthant._lyapunov(
        *call.scene, integrator, solver, whole("count", count, 1), length, rest, between)
    _arrived(status, why)
    return Lyapunov(exponents, last_half, t)


_REVERSE_FROM = 4  # parameters: up to here forward mode costs less


def jvp(scene: Any, of: Union[str, Sequence[str]], change: Mapping[str, float], **how: Any) -> RunTangent:
    """Derivatives of columns along a change of parameters {name: change}, at each record, by forward mode; see
    `gradient`."""
    columns = _words("of", of)
    along = {key: number(f"change[{key!r}]", value)
             for key, value in _mapping("change", change, "{parameter: number}").items()}
    call, parameters = _Call(scene, **_settings(how)), list(along)
    t, values, by, degenerate, inconsistent = call.forward(columns, parameters)
    import numpy

    return RunTangent(columns, t, values, by @ numpy.array(list(along.values())), degenerate, inconsistent)


def vjp(scene: Any, weights: Mapping[str, Any], wrt: Union[str, Sequence[str]], **how: Any) -> RunAdjoint:
    """Gradient of the sum of weight * value over records and columns, by reverse mode; see `gradient`.

    weights: {column: a number, for the last record, or an array, one a record}.
    """
    import numpy

    columns, parameters = list(_mapping("weights", weights, "{column: number or array}")), _words("wrt", wrt)
    given = [_weights_of(column, weights[column]) for column in columns]
    call = _Call(scene, **_settings(how))
    rows = call.records()
    table = numpy.zeros((rows, len(columns)))
    for column, w in enumerate(given):
        if w.ndim == 0:
            table[-1, column] = w
        elif len(w) == rows:
            table[:, column] = w
        else:
            raise ValueError(f"weights[{columns[column]!r}] has {len(w)} entries: must have {rows}, one a record")
    _, values, by, degenerate, inconsistent = call.reverse(columns, parameters, table, False)
    return RunAdjoint(float(values[0]), dict(zip(parameters, (float(x) for x in by[0]))), degenerate, inconsistent)


_HOW: dict[str, Any] = {"integrator": "moreau-jean", "solver": "auto", "step": None, "duration": None, "every": 1}


def _warn(degenerate: list[tuple[float, list[str]]], inconsistent: int, others: Sequence[str]) -> None:
    """What `orthant gradient` warns of."""
    import warnings

    from ._simulate import OrthantWarning

    for words in others:
        warnings.warn(words, OrthantWarning, stacklevel=4)
    if degenerate:
        t, contacts = degenerate[0]
        warnings.warn(
            f"{len(degenerate)} steps have weakly active contacts, the first at t = {t:g} s ({contacts[0]}): only "
            "one-sided derivatives exist, these hold such contacts as they are", OrthantWarning, stacklevel=4)
    if inconsistent > 0:
        warnings.warn(f"in {inconsistent} steps a parameter parts redundant contacts: there is no derivative",
                      OrthantWarning, stacklevel=4)
