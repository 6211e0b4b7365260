"""Simulation of scenes by a named integrator and solver, and integrators written in Python."""

from __future__ import annotations

import os
import warnings
from typing import Any, Callable, Optional, Union

from . import _orthant
from ._orthant import Step
from ._scene import Scene, scene_of
from ._spec import Entry, flag, registered, seconds, shown, whole, word
from ._trajectory import Interrupted, Trajectory


class OrthantWarning(UserWarning):
    """A run that is finished, but not to be trusted in everything: the words say in what, with figures."""


def _stops(rounded: str) -> bool:
    if rounded not in ("take", "stop"):
        raise ValueError(f"rounded = {rounded!r}: must be 'take' or 'stop'")
    return rounded == "stop"


def simulate(scene: Union[Scene, str, os.PathLike[str]], *, integrator: str = "moreau-jean", solver: str = "auto",
             step: Optional[float] = None, duration: Optional[float] = None, every: int = 1,
             time_limit: Optional[float] = None, rounded: str = "take", check: bool = False,
             reactions: bool = False) -> Trajectory:
    """Run a scene in the plane or in space: a Scene, a built-in name or a TOML file.

    integrator, solver: names with options, "adaptive:rtol=1e-8", "pgs:omega=1.3". step, duration: [s], default the
    scene's. every: record every so many steps. time_limit: [s] of wall time; what is done by then is kept, with the
    status 'time_limit'. The interpreter's lock is released meanwhile; Ctrl-C raises Interrupted, whose `run` is what is
    done by then.
    rounded: what to do with a step whose problem is 'rounded' only, "take" (counted in summary["rounded_steps"], with a
    warning) or "stop" (the run ends before it).
    check: repeat the run with a tighter tolerance, or smaller steps; summary["check"] then has, by column, "error" (an
    estimate) and "digits" (significant decimal digits that agree) of the last state.
    reactions: columns of the joints' reaction forces, too: NAME.force_x, NAME.force_y [N], NAME.moment [N m] of what
    the first body exerts on the second one, about the joint's point, the mean since the record before; in space three
    of each.
    A run that fails ends with its status and words; ValueError names what is wrong with the arguments.
    What `orthant simulate` warns of is an OrthantWarning here, and in the run's `warnings`.
    """
    checked = scene_of(scene)
    warned: list[str] = []

    def warn(words: str) -> None:
        warned.append(words)
        warnings.warn(words, OrthantWarning, stacklevel=3)

    columns, table, summary, unsolved, events, interruption, joints, angles, pushes = _orthant._simulate(
        checked, word("integrator", integrator, "a name, such as 'moreau-jean' or 'adaptive:rtol=1e-8'"),
        word("solver", solver, "a name, such as 'lemke' or 'pgs:omega=1.3'"), seconds("step", step),
        seconds("duration", duration), whole("every", every, 1, what=" of steps"), seconds("time_limit", time_limit),
        _stops(rounded), flag("check", check), flag("reactions", reactions), warn)
    trajectory = Trajectory(checked, columns, table, summary, unsolved, events, warned, dict(zip(joints, angles.T)),
                            pushes)
    if not getattr(scene, "_customs", None):
        trajectory._how = {
            "integrator": integrator, "solver": solver, "step": step, "duration": duration, "every": every
        }
    if isinstance(interruption, KeyboardInterrupt):
        raise Interrupted(trajectory)
    if interruption is not None:
        raise interruption
    return trajectory


def integrators() -> list[Entry]:
    """Every registered integrator: name, summary, options with defaults and ranges."""
    return [Entry(*row) for row in _orthant._integrators()]


def register_integrator(name: str, function: Callable[[Step], Any], summary: str = "written in Python") -> None:
    """A scheme of your own under a name, for `simulate` of this process, and for reports of it.

    function(step) -> (q, v) at the end of the step, or (q, v, impulses) with (contacts, 2) impulses, normal and
    tangential [N s]; None where it gives up. step: t, h [s], q, v; mass, mu, e_n as arrays; step.terms(t, q, v): a dict
    of the arrays of the equations of motion; step.solve(M, q, ...): a complementarity problem by the run's solver, None
    where it has no answer. Scenes without searched collisions, dry friction in joints, Poisson's law and sequential
    impacts are taken. Joints and gaps at the end of each step are measured as of every scheme. An exception ends the
    run.
    Raises ValueError for a name that is taken, or made of other than a-z, 0-9 and -.
    """
    if not callable(function):
        raise TypeError(f"function = {shown(function)}: must be a function of a Step")
    _orthant._register_integrator(word("name", name), function, word("summary", summary))
    registered.add(("integrator", name))
