"""Planar mechanisms: scenes built in a few lines or read from TOML, and their motion as arrays."""

from __future__ import annotations

import json
import math
import os
from typing import TYPE_CHECKING, Any, Optional, Union

from . import _orthant
from ._orthant import Problem
from ._spec import Entry, seconds, text_of

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    import pandas

_KINDS = ("body", "joint", "contact", "collision", "friction", "spring", "load", "drive")


def _toml(value: Any) -> str:
    if hasattr(value, "tolist"):  # NumPy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return "nan" if math.isnan(value) else "inf" if value == math.inf else "-inf" if value == -math.inf else repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {_toml(v)}" for key, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(v) for v in value) + "]"
    raise TypeError(f"scene value {value!r}: must be a number, bool, text, list or dict")


class Scene:
    """A mechanism as plain data, with the keys of the TOML scene format.

    >>> scene = Scene(gravity=[0, -9.81], duration=1.0)
    >>> scene.add("body", name="ball", mass=1, inertia=0.004, position=[0, 1])
    >>> scene.add("contact", type="disc-wall", body="ball", radius=0.1, wall={"normal": [0, 1]}, e_n=0.5)

    Scene.load("FILE.toml") reads a file, Scene.parse(text) a text, Scene.named("slider_crank", mu=0.1) a built-in one.
    """

    def __init__(self, **keys: Any) -> None:
        self._keys = dict(keys)  # of the scene itself: gravity [m/s^2], duration, step [s], ...
        self._elements: list[tuple[str, dict[str, Any]]] = []
        self._read: Optional[_orthant._Scene] = None

    def add(self, kind: str, **keys: Any) -> None:
        """One more element: "body", "joint", "contact", ...; keys as in the scene format. `simulate` checks them."""
        if self._read is not None:
            raise ValueError("this scene was read from a file or by name: change it by keyword overrides there")
        if kind not in _KINDS:
            raise ValueError(f"kind '{kind}': must be one of {', '.join(_KINDS)}")
        self._elements.append((kind, keys))

    def toml(self) -> str:
        """The scene as a TOML file's text (of one that was built here)."""
        if self._read is not None:
            raise ValueError("this scene was read from a file or by name: it has no text of its own")
        lines = [f"{key} = {_toml(value)}" for key, value in self._keys.items()]
        for kind, keys in self._elements:
            lines += ["", f"[[{kind}]]"] + [f"{key} = {_toml(value)}" for key, value in keys.items()]
        return "\n".join(lines) + "\n"

    @classmethod
    def load(cls, file: Union[str, os.PathLike[str]], **overrides: Any) -> Scene:
        """From a TOML file. overrides: {"contact.corner1.mu": 0.1} by **, key paths of the format."""
        return cls._holding(_orthant._parse_scene(_text_of_file(file), _lines(overrides, _toml), os.fspath(file)))

    @classmethod
    def parse(cls, text: str, **overrides: Any) -> Scene:
        """From TOML text."""
        return cls._holding(_orthant._parse_scene(text, _lines(overrides, _toml), "scene"))

    @classmethod
    def named(cls, name: str, **options: Any) -> Scene:
        """A built-in scene of `scenes()`, with its options."""
        if name not in {entry.name for entry in scenes()}:
            raise ValueError(f"scene '{name}': must be one of {', '.join(entry.name for entry in scenes())}")
        return cls._holding(_orthant._make_scene(name, _lines(options, text_of)))

    @classmethod
    def _holding(cls, read: _orthant._Scene) -> Scene:
        scene = cls()
        scene._read = read
        return scene

    def _checked(self) -> _orthant._Scene:
        return self._read if self._read is not None else _orthant._parse_scene(self.toml(), [], "scene")

    @property
    def bodies(self) -> list[str]:
        """The bodies' names, in the order of coordinates."""
        return self._checked().bodies


def _lines(keys: dict[str, Any], form: Any) -> list[str]:
    return [f"{key}={form(value)}" for key, value in keys.items()]


def _text_of_file(file: Union[str, os.PathLike[str]]) -> str:
    with open(file, encoding="utf-8") as stream:
        return stream.read()


class Trajectory:
    """A run: `columns` name those of `table` (rows, columns), SI units; trajectory["ball.y"] is one of them.

    summary: status, time reached, worst joint residual, penetration, ... ; why: in words, where it did not end as solved;
    unsolved: the Problem that stopped it, else None.
    """

    def __init__(self, scene: _orthant._Scene, columns: list[str], table: npt.NDArray[np.float64], summary: dict[str, Any],
                 unsolved: Optional[Problem]) -> None:
        self.columns, self.table, self.summary, self.unsolved = columns, table, summary, unsolved
        self._scene = scene
        self._place = {name: i for i, name in enumerate(columns)}

    @property
    def status(self) -> str:
        return str(self.summary["status"])

    @property
    def solved(self) -> bool:
        return self.status == "solved"

    @property
    def why(self) -> str:
        return str(self.summary["why"])

    @property
    def t(self) -> npt.NDArray[np.float64]:
        """(rows,) [s]"""
        return self["t"]

    def __getitem__(self, column: str) -> npt.NDArray[np.float64]:
        if column not in self._place:
            raise KeyError(f"{column}: must be one of {', '.join(self.columns)}")
        return self.table[:, self._place[column]]

    def __len__(self) -> int:
        return len(self.table)

    def frame(self) -> pandas.DataFrame:
        """As a pandas frame, indexed by time."""
        import pandas

        return pandas.DataFrame(self.table, columns=self.columns).set_index("t")

    def write(self, file: Union[str, os.PathLike[str]]) -> None:
        """As a file, by its name's end: .csv, .h5 (HDF5, a data set a column), .pvd (VTK of the bodies' outlines, for ParaView)."""
        _orthant._write_trajectory(file, self._scene, self.columns, self.table)

    def __repr__(self) -> str:
        return f"Trajectory(status='{self.status}', rows={len(self)}, t={self.summary['t']:g})"


def simulate(scene: Union[Scene, str], *, integrator: str = "moreau-jean", solver: str = "lemke",
             step: Optional[float] = None, duration: Optional[float] = None, every: int = 1,
             time_limit: Optional[float] = None) -> Trajectory:
    """Run a scene: a Scene, a built-in name or a TOML file.

    integrator, solver: names with options, "adaptive:rtol=1e-8", "pgs:omega=1.3". step, duration: [s], default the
    scene's. every: record every so many steps. time_limit: [s] of wall time; what is done by then is kept, with the status
    'time_limit'. The interpreter's lock is released meanwhile; Ctrl-C ends a run.
    A run that fails ends with its status and words; ValueError names what is wrong with the arguments.
    """
    if isinstance(scene, Scene):
        checked = scene._checked()
    elif isinstance(scene, str):
        checked = _orthant._make_scene(scene, [])
    else:
        raise TypeError(f"scene {scene!r}: must be a Scene, a built-in name or a TOML file")
    for what, word in (("integrator", integrator), ("solver", solver)):
        if not isinstance(word, str):
            raise TypeError(f"{what} = {word!r}: must be a name, such as 'moreau-jean' or 'pgs:omega=1.3'")
    if not hasattr(every, "__index__"):
        raise TypeError(f"every = {every!r}: must be a whole number of steps")
    return Trajectory(checked, *_orthant._simulate(checked, integrator, solver, seconds("step", step), seconds("duration", duration),
                                                   every, seconds("time_limit", time_limit)))


def integrators() -> list[Entry]:
    """Every registered integrator: name, summary, options with defaults and ranges."""
    return [Entry(*row) for row in _orthant._integrators()]


def scenes() -> list[Entry]:
    """Every built-in scene: name, summary, options with defaults and ranges."""
    return [Entry(*row) for row in _orthant._scenes()]
