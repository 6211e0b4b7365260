"""Planar mechanisms: scenes built in a few lines or read from TOML, and their motion as arrays."""

from __future__ import annotations

import json
import math
import os
from typing import TYPE_CHECKING, Any, Optional, Union

from . import _orthant
from ._orthant import Problem
from ._spec import Entry, options_of, path, regular, seconds, shown, whole, word

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    import pandas

_KINDS = ("body", "joint", "contact", "collision", "friction", "spring", "load", "drive")


def toml_of(name: str, value: Any) -> str:
    """A value of the format, `name` of which is told where it is none."""
    if hasattr(value, "tolist"):  # NumPy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return "nan" if math.isnan(value) else "inf" if value == math.inf else "-inf" if value == -math.inf else repr(value)
    if isinstance(value, str):
        return json.dumps(word(name, value), ensure_ascii=False)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(word(name, key))} = {toml_of(f'{name}.{key}', v)}" for key, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml_of(name, v) for v in value) + "]"
    raise TypeError(f"{name} = {shown(value)}: must be a number, bool, text, list or dict")


def toml_lines(keys: dict[str, Any]) -> list[str]:
    return [f"{key} = {toml_of(key, value)}" for key, value in keys.items()]


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
        if word("kind", kind) not in _KINDS:
            raise ValueError(f"kind '{kind}': must be one of {', '.join(_KINDS)}")
        self._elements.append((kind, keys))

    def toml(self) -> str:
        """The scene as a TOML file's text (not of one by name or with overrides)."""
        if self._read is not None:
            if self._read.text is None or self._read.sets:
                raise ValueError("a scene by name or with overrides has no text of its own: must be built here or read as it is")
            return self._read.text
        lines = toml_lines(self._keys)
        for kind, keys in self._elements:
            lines += ["", f"[[{kind}]]"] + toml_lines(keys)
        return "\n".join(lines) + "\n"

    @classmethod
    def load(cls, file: Union[str, os.PathLike[str]], **overrides: Any) -> Scene:
        """From a TOML file. overrides: {"contact.corner1.mu": 0.1} by **, key paths of the format."""
        return cls._holding(_orthant._Scene(_text_of_file(path("file", file)), path("file", file), _lines(overrides)))

    @classmethod
    def parse(cls, text: str, **overrides: Any) -> Scene:
        """From TOML text."""
        return cls._holding(_orthant._Scene(word("text", text), "scene", _lines(overrides)))

    @classmethod
    def named(cls, name: str, **options: Any) -> Scene:
        """A built-in scene of `scenes()`, with its options."""
        if word("name", name) not in (known := [entry.name for entry in scenes()]):
            raise ValueError(f"scene '{name}': must be one of {', '.join(known)}")
        return cls._holding(_orthant._Scene(None, name, [options_of({key: value}) for key, value in options.items()]))

    @classmethod
    def _holding(cls, read: _orthant._Scene) -> Scene:
        scene = cls()
        scene._read = read
        return scene

    def _checked(self) -> _orthant._Scene:
        return self._read if self._read is not None else _orthant._Scene(self.toml(), "scene", [])

    @property
    def bodies(self) -> list[str]:
        """The bodies' names, in the order of coordinates."""
        return self._checked().bodies


def _lines(overrides: dict[str, Any]) -> list[str]:
    return [f"{key}={toml_of(key, value)}" for key, value in overrides.items()]


_LARGEST_SCENE = 16 << 20  # [bytes]


def _text_of_file(file: str) -> str:
    with open(regular(file), encoding="utf-8") as stream:
        try:
            return stream.read(_orthant._largest_input(_LARGEST_SCENE) + 1)  # which is refused by whoever parses it
        except UnicodeDecodeError as error:
            raise ValueError(f"{file}: must be UTF-8 text: byte {error.start} is {error.object[error.start]:#04x}") from None


class Trajectory:
    """A run: `columns` name those of `table` (rows, columns), SI units; trajectory["ball.y"] is one of them.

    summary: status, time reached, worst joint residual, penetration, ... ; why: in words, where the status does not say it all;
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
        _orthant._write_trajectory(path("file", file), self._scene, self.columns, self.table)

    def __repr__(self) -> str:
        return f"Trajectory(status='{self.status}', rows={len(self)}, t={self.summary['t']:g})"


def simulate(scene: Union[Scene, str, os.PathLike[str]], *, integrator: str = "moreau-jean", solver: str = "lemke",
             step: Optional[float] = None, duration: Optional[float] = None, every: int = 1,
             time_limit: Optional[float] = None) -> Trajectory:
    """Run a scene: a Scene, a built-in name or a TOML file.

    integrator, solver: names with options, "adaptive:rtol=1e-8", "pgs:omega=1.3". step, duration: [s], default the
    scene's. every: record every so many steps. time_limit: [s] of wall time; what is done by then is kept, with the status
    'time_limit'. The interpreter's lock is released meanwhile; Ctrl-C ends a run.
    A run that fails ends with its status and words; ValueError names what is wrong with the arguments.
    """
    checked = _scene_of(scene)
    return Trajectory(checked, *_orthant._simulate(
        checked, word("integrator", integrator, "a name, such as 'moreau-jean' or 'adaptive:rtol=1e-8'"),
        word("solver", solver, "a name, such as 'lemke' or 'pgs:omega=1.3'"), seconds("step", step), seconds("duration", duration),
        whole("every", every, 1, what=" of steps"), seconds("time_limit", time_limit)))


def _scene_of(scene: Any) -> _orthant._Scene:
    if isinstance(scene, Scene):
        return scene._checked()
    if not isinstance(scene, (str, os.PathLike)):
        raise TypeError(f"scene {shown(scene)}: must be a Scene, a built-in name or a TOML file")
    if isinstance(scene, os.PathLike) or scene not in {entry.name for entry in scenes()} and os.path.exists(scene):
        return Scene.load(scene)._checked()
    return _orthant._Scene(None, scene, [])


def integrators() -> list[Entry]:
    """Every registered integrator: name, summary, options with defaults and ranges."""
    return [Entry(*row) for row in _orthant._integrators()]


def scenes() -> list[Entry]:
    """Every built-in scene: name, summary, options with defaults and ranges."""
    return [Entry(*row) for row in _orthant._scenes()]
