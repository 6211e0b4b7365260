"""Scenes: mechanisms in the plane and in space, built in a few lines, read from TOML or registered under a name."""

from __future__ import annotations

import json
import math
import os
import re
from typing import Any, Optional, Union

from . import _orthant
from ._custom import custom_element
from ._pictures import draw_pose, svg_of
from ._spec import Entry, options_of, path, registered, regular, shown, word

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
        if not math.isfinite(value):
            return "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"
        return repr(value)
    if isinstance(value, str):
        return json.dumps(word(name, value), ensure_ascii=False)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(word(name, key))} = {toml_of(f'{name}.{key}', v)}"
                               for key, v in value.items()) + "}"
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

    In space, with dimension=3 (keys: core/scenes/space.md):

    >>> scene = Scene(dimension=3, gravity=[0, 0, -9.81], duration=1.0)
    >>> scene.add("body", name="ball", mass=1, inertia=0.004, position=[0, 0, 1], omega=[9, 0, 0])
    >>> scene.add("contact", type="sphere-wall", body="ball", radius=0.1, wall={"normal": [0, 0, 1]}, mu=0.3)

    Scene.load("FILE.toml") reads a file, Scene.parse(text) a text, Scene.named("slider_crank", mu=0.1) a built-in one.
    """

    def __init__(self, *given: Any, **keys: Any) -> None:
        if given:
            raise TypeError(
                f"Scene({shown(given[0])}): must be given keys, such as gravity=[0, -9.81]. A built-in scene is "
                f"Scene.named({shown(given[0])}), a file Scene.load(\"FILE.toml\"), a text Scene.parse(text)")
        self._keys = dict(keys)  # of the scene itself: gravity [m/s^2], duration, step [s], ...
        self._elements: list[tuple[str, dict[str, Any]]] = []
        self._places: dict[tuple[str, str], int] = {}  # of bodies and joints by name
        self._counts: dict[str, int] = dict.fromkeys(_KINDS, 0)
        self._customs: list[dict[str, Any]] = []  # joints and contacts written in Python
        self._read: Optional[_orthant._Scene] = None

    def add(self, kind: str, **keys: Any) -> None:
        """One more element: "body", "joint", "contact", ...; keys as in the scene format.

        Keys and values are checked at once, where the bodies and joints that they name are there already, and as a
        whole by `simulate`. A joint or contact of type="custom" is written in Python, in planar scenes; custom ones
        come behind all others of their kind. A pose is (x, y, angle), a twist its rate. Keys of a contact:

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
        - rate(pose_a, pose_b, t) -> count numbers, of a joint driven in time only: what rows times twists has to be,
          minus the residual's derivative by t. Then all functions get the time t [s] behind their other arguments.

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
                raise ValueError(
                    "a scene by name or with overrides has no text of its own: must be built here or read as it is")
            return self._read.text
        lines = toml_lines(self._keys)
        for kind, keys in self._elements:
            lines += ["", f"[[{kind}]]"] + toml_lines(keys)
        return "\n".join(lines) + "\n"

    @classmethod
    def load(cls, file: Union[str, os.PathLike[str]], **overrides: Any) -> Scene:
        """From a TOML file. overrides: {"contact.corner1.mu": 0.1} by **, key paths of the format."""
        return cls._holding(
            _orthant._Scene(text_of_file(path("file", file)), path("file", file), override_lines(overrides)))

    @classmethod
    def parse(cls, text: str, **overrides: Any) -> Scene:
        """From TOML text."""
        return cls._holding(_orthant._Scene(word("text", text), "scene", override_lines(overrides)))

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
        """The scene at its start, by matplotlib: into `axes`, else a figure of its own; file: also written there, .svg,
        .png or .pdf. Returns the axes. In space they are three-dimensional ones (projection="3d")."""
        checked = self._checked()
        return draw_pose(checked, checked.initial, file, axes)

    def _repr_html_(self) -> Optional[str]:
        """In a notebook: the drawing, if matplotlib is installed and the scene is complete."""
        try:
            return svg_of(lambda: self.draw())
        except (ImportError, ValueError):
            return None


def override_lines(overrides: dict[str, Any]) -> list[str]:
    return [f"{key}={toml_of(key, value)}" for key, value in overrides.items()]


_LARGEST_SCENE = 16 << 20  # [bytes]


def text_of_file(file: str) -> str:
    with open(regular(file), encoding="utf-8") as stream:
        try:
            return stream.read(_orthant._largest_input(_LARGEST_SCENE) + 1)  # which is refused by whoever parses it
        except UnicodeDecodeError as error:
            raise ValueError(
                f"{file}: must be UTF-8 text: byte {error.start} is {error.object[error.start]:#04x}") from None


def scene_of(scene: Any) -> _orthant._Scene:
    if isinstance(scene, Scene):
        return scene._checked()
    if not isinstance(scene, (str, os.PathLike)):
        raise TypeError(f"scene {shown(scene)}: must be a Scene, a built-in name or a TOML file")
    if isinstance(scene, os.PathLike) or scene not in {entry.name for entry in scenes()} and os.path.exists(scene):
        return Scene.load(scene)._checked()
    return _orthant._Scene(None, scene, [])


registered_scenes: dict[str, Scene] = {}


def register_scene(name: str, scene: Scene, summary: str = "written in Python") -> None:
    """A scene under a name, for `simulate`, `Scene.named` and `sweep` of this process, in the plane or in space.

    Options of it are key paths of the format; of a scene that is itself Scene.named(...) that one's options. Joints and
    contacts written in Python may be in it.
    Raises ValueError for a name that is taken, or made of other than a-z, 0-9, - and _.
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene = {shown(scene)}: must be a Scene")
    _orthant._register_scene(word("name", name), scene._checked(), word("summary", summary))
    registered_scenes[name] = scene
    registered.add(("scene", name))


def scenes() -> list[Entry]:
    """Every built-in scene: name, summary, options with defaults and ranges."""
    return [Entry(*row) for row in _orthant._scenes()]
