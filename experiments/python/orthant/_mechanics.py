"""Mechanisms in the plane and in space: scenes built in a few lines or read from TOML, and their motion as arrays."""

from __future__ import annotations

import json
import math
import os
import re
import warnings
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional, Sequence, Union

from . import _orthant
from ._custom import custom_element, without_functions
from ._orthant import Problem, Step
from ._pictures import draw_pose, in_frame, plot_columns, svg_of, write_film, write_view
from ._spec import Entry, flag, options_of, path, registered, regular, seconds, shown, whole, word

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    import pandas

    from ._derivatives import RunAdjoint, RunGradient, RunTangent

_KINDS = ("body", "joint", "contact", "collision", "friction", "spring", "load")


def toml_of(name: str, value: Any) -> str:
    """A value of the format. An error names `name`."""
    if hasattr(value, "tolist"):  # NumPy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        if not -2**63 <= value < 2**63:
            raise ValueError(f"{name} = {shown(value)}: must be a whole number of 64 bits, or a float")
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


class OrthantWarning(UserWarning):
    """A run that is finished, but not to be trusted in everything: the words say in what, with figures."""


class Scene:
    """A mechanism as plain data, with the keys of the TOML scene format.

    >>> scene = Scene(gravity=[0, -9.81], duration=1.0)
    >>> scene.add("body", name="ball", mass=1, inertia=0.004, position=[0, 1])
    >>> scene.add("contact", type="disc-wall", body="ball", radius=0.1, wall={"normal": [0, 1]}, e_n=0.5)

    In space, with dimension=3 (keys: core/scenes/space.md):

    >>> scene = Scene(dimension=3, gravity=[0, 0, -9.81], duration=1.0)
    >>> scene.add("body", name="ball", mass=1, inertia=0.004, position=[0, 0, 1], omega=[9, 0, 0])
    >>> scene.add("contact", type="sphere-wall", body="ball", radius=0.1, wall={"normal": [0, 0, 1]}, mu=0.3)

    Scene.load("FILE.toml") reads a file, Scene.parse(text) a text, Scene.named("slider_crank", mu=0.1) a built-in one.
    """

    def __init__(self, *given: Any, **keys: Any) -> None:
        if given:
            raise TypeError(f"Scene({shown(given[0])}): must be given keys, such as gravity=[0, -9.81]. A built-in scene is "
                            f"Scene.named({shown(given[0])}), a file Scene.load(\"FILE.toml\"), a text Scene.parse(text)")
        self._keys = dict(keys)  # of the scene itself: gravity [m/s^2], duration, step [s], ...
        self._elements: list[tuple[str, dict[str, Any]]] = []
        self._places: dict[tuple[str, str], int] = {}  # of bodies and joints by name
        self._counts: dict[str, int] = dict.fromkeys(_KINDS, 0)
        self._customs: list[dict[str, Any]] = []  # joints and contacts written in Python
        self._read: Optional[_orthant._Scene] = None

    def add(self, kind: str, **keys: Any) -> None:
        """One more element: "body", "joint", "contact", ...; keys as in the scene format.

        Keys and values are checked at once, where the bodies and joints that they name are there already, and as a whole by
        `simulate`. A joint or contact of type="custom" is written in Python, in planar scenes; custom ones come behind all others of their
        kind. A pose is (x, y, angle), a twist its rate. Keys of a contact:

        - bodies=["a", "b"] (one may be "ground");
        - gap(pose_a, pose_b) -> float [m], > 0: open;
        - rows(pose_a, pose_b) -> 6 numbers, d gap / d (x, y, angle) of a, then of b. With friction (2, 6) numbers:
          the second row holds the derivatives of slip;
        - bias(pose_a, pose_b, twist_a, twist_b) -> d/dt of the rates at zero acceleration, one number, or two.
          It may be left out: differences of the rows take its place, good for 11 digits or so;
        - mu, e_n, e_t, mu_static, belt;
        - length [m]: how far bodies may move before the gap's course changes.

        bodies=[["a1", "a2", ...], ["b1", "b2", ...]]: n contacts NAME-1, NAME-2, ... in one call. Poses and twists then
        hold arrays (n,); gap returns (n,), rows (6, n) or (2, 6, n), bias (n,) or (2, n). Numbers among the six, or in
        place of an array, count for all.

        Keys of a joint:

        - bodies=["a", "b"]; count: how many equations, 1 to 3, default 1;
        - residual(pose_a, pose_b) -> count numbers, 0 where the joint is closed;
        - rows(pose_a, pose_b) -> (count, 6) numbers, its derivatives; bias as of a contact, count numbers;
        - rate(pose_a, pose_b, t) -> count numbers, of a joint driven in time only: what rows times twists has to be, minus the
          residual's derivative by t. Then all functions get the time t [s] behind their other arguments.

        Rows and bias are compared with differences of gap, residual and rows before a run. Each call costs some
        microseconds.
        """
        if kind in ("joint", "contact") and keys.get("type") == "custom":
            self._customs.append(custom_element(kind, keys, len(self._customs)))
            return
        if self._read is not None:
            raise ValueError("this scene was read from a file or by name: change it by keyword overrides there")
        if word("kind", kind) not in _KINDS:
            raise ValueError(f"kind '{kind}': must be one of {', '.join(_KINDS)}")
        if isinstance(name := keys.get("name"), str) and (kind, name) in self._places:
            raise ValueError(f'{kind} "{name}": name = "{name}": must be distinct, is taken')
        self._check(kind, keys)
        self._counts[kind] += 1
        if isinstance(name, str):
            self._places[kind, name] = len(self._elements)
        self._elements.append((kind, keys))

    def _check(self, kind: str, keys: dict[str, Any]) -> None:
        """The file reader's words for what is wrong with an element, read with the bodies and joints that it names."""
        needed: dict[int, None] = {}
        if not self._gather(keys, needed):
            return  # named later, maybe
        parts = [self._elements[place] for place in sorted(needed)]
        if kind != "body":
            parts = parts or [("body", {"name": "a", "mass": 1, "inertia": 1})]
            keys = keys if "name" in keys else {"name": f"{kind}{self._counts[kind] + 1}", **keys}
        lines = toml_lines(self._keys)
        for part, given in [*parts, (kind, keys)]:
            lines += [f"[[{part}]]", *toml_lines(given)]
        try:
            _orthant._Scene("\n".join(lines), "scene", [])
        except ValueError as error:
            raise ValueError(re.sub(r"^scene(:\d+)?: ", "", str(error))) from None

    def _gather(self, value: Any, needed: dict[int, None]) -> bool:
        """Places of the bodies and joints that keys name; False: one is not there yet."""
        if isinstance(value, (list, tuple)):
            return all(self._gather(one, needed) for one in value if isinstance(one, (dict, list, tuple)))
        for key, inner in value.items():
            names = [inner] if key in ("body", "joint") else inner if key == "bodies" else ()
            for name in names if isinstance(names, (list, tuple)) else ():
                if name == "ground" or not isinstance(name, str):
                    continue
                place = self._places.get(("joint" if key == "joint" else "body", name))
                if place is None:
                    return False
                if place not in needed:
                    needed[place] = None
                    if not self._gather(self._elements[place][1], needed):
                        return False
            if isinstance(inner, (dict, list, tuple)) and not self._gather(inner, needed):
                return False
        return True

    def toml(self) -> str:
        """The scene as a TOML file's text (not of one by name or with overrides)."""
        if self._customs:
            first = self._customs[0]
            raise ValueError(f"{first['kind']} \"{first['name']}\" is written in Python: the scene has no text")
        return self._text()

    def _text(self) -> str:
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
        if self._read is None:
            return _orthant._Scene(self._text(), "scene", [], self._customs)
        if not self._customs:
            return self._read
        return _orthant._Scene(self._read.text, self._read.name, self._read.sets, self._customs)

    def __repr__(self) -> str:
        if self._read is not None:
            kinds = [("body", self._read.bodies), ("contact", self._read.contacts)]
            counts = [(kind, len(names)) for kind, names in kinds]
            origin = [repr(self._read.name)] + ([f"set={self._read.sets}"] if self._read.sets else [])
        else:
            every = [kind for kind, _ in self._elements] + [
                custom["kind"] for custom in self._customs for _ in custom["a"]]
            counts = [(kind, every.count(kind)) for kind in _KINDS]
            origin = [f"{key}={value!r}" for key, value in self._keys.items()]
        plural = {"body": "bodies"}
        words = [f"{n} {kind if n == 1 else plural.get(kind, kind + 's')}" for kind, n in counts if n]
        return f"Scene({', '.join(origin + words)})"

    @property
    def bodies(self) -> list[str]:
        """The bodies' names, in the order of coordinates."""
        return self._checked().bodies

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return self._checked().dimension

    def draw(self, *, file: Union[str, os.PathLike[str], None] = None, axes: Any = None) -> Any:
        """The scene at its start, by matplotlib: into `axes`, else a figure of its own; file: also written there, .svg, .png or
        .pdf. Returns the axes. In space they are three-dimensional ones (projection="3d")."""
        checked = self._checked()
        return draw_pose(checked, checked.initial, file, axes)

    def _repr_html_(self) -> Optional[str]:
        """In a notebook: the drawing, if matplotlib is installed and the scene is complete."""
        try:
            return svg_of(lambda: self.draw())
        except (ImportError, ValueError):
            return None


def _lines(overrides: dict[str, Any]) -> list[str]:
    return [f"{key}={toml_of(key, value)}" for key, value in overrides.items()]


_LARGEST_SCENE = 16 << 20  # [bytes]


def _text_of_file(file: str) -> str:
    with open(regular(file), encoding="utf-8") as stream:
        try:
            return stream.read(_orthant._largest_input(_LARGEST_SCENE) + 1)  # which is refused by whoever parses it
        except UnicodeDecodeError as error:
            raise ValueError(f"{file}: must be UTF-8 text: byte {error.start} is {error.object[error.start]:#04x}") from None


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended a simulation. `run` is the Trajectory up to there, with the status 'cancelled'."""

    def __init__(self, run: Trajectory) -> None:
        super().__init__(f"the simulation was interrupted at t = {run.summary['t']:g} s; .run keeps it")
        self.run: Trajectory = run


class Trajectory:
    """A run: `columns` name those of `table` (rows, columns), SI units; trajectory["ball.y"] is one of them.

    summary: status, time reached, worst joint residual, penetration, ...
    unsolved: the Problem that stopped it, else None.
    warnings: what the run warned of, a list of texts; why: in words, why it ended, and those warnings.
    final: the last row by column.

    In space `final` and trajectory["NAME"] have the coordinates of joints too, which are no columns of the table:
    "JOINT.angle" [rad], followed through full turns from row to row, and "JOINT.displacement" [m].
    """

    def __init__(self, scene: _orthant._Scene, columns: list[str], table: npt.NDArray[np.float64], summary: dict[str, Any],
                 unsolved: Optional[Problem], events: tuple[Any, ...], warned: list[str],
                 joints: dict[str, npt.NDArray[np.float64]], pushes: Any = ()) -> None:
        self.columns: list[str] = columns
        self.table: npt.NDArray[np.float64] = table
        self.summary: dict[str, Any] = summary
        self.unsolved: Optional[Problem] = unsolved
        self.warnings: list[str] = warned
        self._scene, self._events, self._joints, self._pushes = scene, events, joints, pushes
        self._place = {name: i for i, name in enumerate(columns)}
        self._how: Optional[dict[str, Any]] = None  # how simulate made it

    def __getstate__(self) -> dict[str, Any]:
        state, scene = dict(self.__dict__), self._scene
        if scene.customs:
            state["_scene"] = _orthant._Scene(scene.text, scene.name, scene.sets, without_functions(scene.customs))
        return state

    @property
    def status(self) -> str:
        """'solved', 'time_limit', 'stalled', ...: statuses in the documentation."""
        return str(self.summary["status"])

    @property
    def solved(self) -> bool:
        """status is 'solved': every step up to the duration was."""
        return self.status == "solved"

    @property
    def why(self) -> str:
        """Why the run ended where it is not solved, then what it warned of; empty: it is solved, without a warning."""
        ended = str(self.summary["why"])
        if not ended and not self.solved:
            ended = f"step {self.summary['steps'] + 1} at t = {self.summary['t']:g} s: {self.status}"
        return "\n".join(([ended] if ended else []) + self.warnings)

    @property
    def events(self) -> npt.NDArray[Any]:
        """The events as a table: a structured array with the columns t [s], kind, contact, impulse_n, impulse_t [N s].

        kind: impact, accumulation, touch, release, stick, slip. "adaptive" and "event-driven" locate events; of
        other integrators the table is empty. run.events["t"] is a column; pandas.DataFrame(run.events) takes the whole.
        """
        import numpy as np

        t, kind, contact, normal, tangent = self._events
        kinds, contacts = np.array(_orthant._event_kinds), np.array(self._scene.contacts or [""])
        table = np.empty(len(t), [("t", float), ("kind", kinds.dtype), ("contact", contacts.dtype),
                                  ("impulse_n", float), ("impulse_t", float)])
        table["t"], table["kind"], table["contact"] = t, kinds[kind], contacts[contact]
        table["impulse_n"], table["impulse_t"] = normal, tangent
        return table

    @property
    def t(self) -> npt.NDArray[np.float64]:
        """(rows,) [s]"""
        return self["t"]

    @property
    def final(self) -> dict[str, float]:
        """The last row by column, in space with the coordinates of joints."""
        row = dict(zip(self.columns, self.table[-1].tolist()))
        row.update((name, float(values[-1])) for name, values in self._joints.items())
        return row

    def __getitem__(self, column: str) -> npt.NDArray[np.float64]:
        if column in self._joints:
            return self._joints[column]
        if column not in self._place:
            raise KeyError(f"{column}: must be one of {', '.join([*self.columns, *self._joints])}")
        return self.table[:, self._place[column]]

    def __len__(self) -> int:
        return len(self.table)

    def gradient(self, of: str, wrt: Union[str, Sequence[str]], *, at: str = "records", mode: str = "auto") -> RunGradient:
        """Derivatives of a column along this run with respect to parameters, as `orthant.gradient`: the run is repeated."""
        from ._derivatives import gradient

        return gradient(self._scene, of, wrt, at=at, mode=mode, **self._repeated())

    def jvp(self, of: Union[str, Sequence[str]], change: Mapping[str, float]) -> RunTangent:
        """Derivatives of columns along a change of parameters {name: change}, a row a record: forward mode."""
        from ._derivatives import jvp

        return jvp(self._scene, of, change, **self._repeated())

    def vjp(self, weights: Mapping[str, Any], wrt: Union[str, Sequence[str]]) -> RunAdjoint:
        """Gradient of the sum of weight * value over columns and rows, {column: a number, for the last row, or one a row}.

        Reverse mode: the cost does not grow with the parameters. The run is repeated.
        """
        from ._derivatives import vjp

        return vjp(self._scene, weights, wrt, **self._repeated())

    def _repeated(self) -> dict[str, Any]:
        if self._how is None:
            raise ValueError("gradient: must be of a run by simulate in this process, without elements written in Python")
        return self._how

    def frame(self) -> pandas.DataFrame:
        """As a pandas frame, indexed by time."""
        import pandas

        return pandas.DataFrame(self.table, columns=self.columns).set_index("t")

    def to_pandas(self) -> pandas.DataFrame:
        """The same as frame()."""
        return self.frame()

    def view(self, file: Union[str, os.PathLike[str], None] = None) -> str:
        """The run as one HTML page, with animation, contact forces, plots of any column and events: `file`, whose path is
        returned. Without a file the page is a temporary one, and a browser opens it."""
        return write_view(self._page(), file)

    def _page(self) -> str:
        note = f"{self.status}, {len(self)} rows" + (f"; {self.why}" if self.why else "")
        name = os.path.splitext(os.path.basename(self._scene.name))[0]
        return _orthant._view_page(name, note, self._scene, self.columns, self.table, self._events, self._pushes)

    def _repr_html_(self) -> str:
        """In a notebook: the page of view() in a frame."""
        return in_frame(self._page(), repr(self))

    def plot(self, *columns: str, file: Union[str, os.PathLike[str], None] = None, axes: Any = None) -> Any:
        """Columns over time, by matplotlib; default: the energy. axes: drawn into these, else a figure of their own.
        file: also written there, .png, .svg or .pdf. Returns the axes."""
        return plot_columns(self, columns or ("energy",), file, axes)

    def draw(self, t: Optional[float] = None, *, file: Union[str, os.PathLike[str], None] = None, axes: Any = None) -> Any:
        """The mechanism at the recorded time next to t [s], default the last one, by matplotlib; file, axes as in plot()."""
        import numpy as np

        row = len(self) - 1 if t is None else int(np.argmin(np.abs(self.t - float(t))))
        return draw_pose(self._scene, self._poses(row), file, axes)

    def _poses(self, row: int) -> npt.NDArray[np.float64]:
        import numpy as np

        parts = ("x", "y", "theta") if self._scene.dimension == 2 else ("x", "y", "z", "qw", "qx", "qy", "qz")
        places = [self._place[f"{body}.{part}"] for body in self._scene.bodies for part in parts]
        return np.asarray(self.table[row, places])

    def film(self, file: Union[str, os.PathLike[str]], *, speed: float = 1.0, fps: int = 25) -> None:
        """The motion as a film by matplotlib: .mp4 or .gif (the first needs ffmpeg), or a folder, which gets a PNG picture a
        frame. speed: 1 is real time, 0.1 ten times slower. fps: frames a second."""
        write_film(self, path("file", file), float(speed), whole("fps", fps, 1, 1000))

    def write(self, file: Union[str, os.PathLike[str]]) -> None:
        """As a file, by its name's end: .csv, .h5 (HDF5, a data set a column), .pvd (VTK of the outlines or surfaces, for
        ParaView).
        Events go into NAME.events.csv next to it, or into the HDF5 file's group "events"."""
        _orthant._write_trajectory(path("file", file), self._scene, self.columns, self.table, self._events)

    def __repr__(self) -> str:
        return f"Trajectory(status='{self.status}', rows={len(self)}, t={self.summary['t']:g})"


def _stops(rounded: str) -> bool:
    if rounded not in ("take", "stop"):
        raise ValueError(f"rounded = {rounded!r}: must be 'take' or 'stop'")
    return rounded == "stop"


def simulate(scene: Union[Scene, str, os.PathLike[str]], *, integrator: str = "moreau-jean", solver: str = "auto",
             step: Optional[float] = None, duration: Optional[float] = None, every: int = 1,
             time_limit: Optional[float] = None, rounded: str = "take", check: bool = False) -> Trajectory:
    """Run a scene in the plane or in space: a Scene, a built-in name or a TOML file.

    integrator, solver: names with options, "adaptive:rtol=1e-8", "pgs:omega=1.3". step, duration: [s], default the
    scene's. every: record every so many steps. time_limit: [s] of wall time; what is done by then is kept, with the status
    'time_limit'. The interpreter's lock is released meanwhile; Ctrl-C raises Interrupted, whose `run` is what is done by then.
    rounded: what to do with a step whose problem is 'rounded' only, "take" (counted in summary["rounded_steps"], with a
    warning) or "stop" (the run ends before it).
    check: repeat the run with a tighter tolerance, or smaller steps; summary["check"] then has, by column, "error" (an estimate)
    and "digits" (significant decimal digits that agree) of the last state.
    A run that fails ends with its status and words; ValueError names what is wrong with the arguments.
    What `orthant simulate` warns of is an OrthantWarning here, and in the run's `warnings`.
    """
    checked = _scene_of(scene)
    warned: list[str] = []

    def warn(words: str) -> None:
        warned.append(words)
        warnings.warn(words, OrthantWarning, stacklevel=3)

    columns, table, summary, unsolved, events, interruption, joints, angles, pushes = _orthant._simulate(
        checked, word("integrator", integrator, "a name, such as 'moreau-jean' or 'adaptive:rtol=1e-8'"),
        word("solver", solver, "a name, such as 'lemke' or 'pgs:omega=1.3'"),
        seconds("step", step), seconds("duration", duration), whole("every", every, 1, what=" of steps"), seconds("time_limit", time_limit), _stops(rounded), flag("check", check),
        warn)
    trajectory = Trajectory(checked, columns, table, summary, unsolved, events, warned, dict(zip(joints, angles.T)), pushes)
    if not getattr(scene, "_customs", None):
        trajectory._how = {"integrator": integrator, "solver": solver, "step": step, "duration": duration, "every": every}
    if isinstance(interruption, KeyboardInterrupt):
        raise Interrupted(trajectory)
    if interruption is not None:
        raise interruption
    return trajectory


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


def register_integrator(name: str, function: Callable[[Step], Any], summary: str = "written in Python") -> None:
    """A scheme of your own under a name, for `simulate` of this process, and for reports of it.

    function(step) -> (q, v) at the end of the step, or (q, v, impulses) with (contacts, 2) impulses, normal and tangential
    [N s]; None where it gives up. step: t, h [s], q, v; mass, mu, e_n as arrays; step.terms(t, q, v): a dict of the arrays of
    the equations of motion; step.solve(M, q, ...): a complementarity problem by the run's solver, None where it has no answer.
    Scenes without searched collisions, dry friction in joints, Poisson's law and sequential impacts are taken. Joints and gaps at
    the end of each step are measured as of every scheme. An exception ends the run.
    Raises ValueError for a name that is taken, or made of other than a-z, 0-9 and -.
    """
    if not callable(function):
        raise TypeError(f"function = {shown(function)}: must be a function of a Step")
    _orthant._register_integrator(word("name", name), function, word("summary", summary))
    registered.add(("integrator", name))


_registered_scenes: dict[str, Scene] = {}


def register_scene(name: str, scene: Scene, summary: str = "written in Python") -> None:
    """A scene under a name, for `simulate`, `Scene.named` and `sweep` of this process, in the plane or in space.

    Options of it are key paths of the format; of a scene that is itself Scene.named(...) that one's options. Joints and contacts
    written in Python may be in it.
    Raises ValueError for a name that is taken, or made of other than a-z, 0-9, - and _.
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene = {shown(scene)}: must be a Scene")
    _orthant._register_scene(word("name", name), scene._checked(), word("summary", summary))
    _registered_scenes[name] = scene
    registered.add(("scene", name))


def scenes() -> list[Entry]:
    """Every built-in scene: name, summary, options with defaults and ranges."""
    return [Entry(*row) for row in _orthant._scenes()]
