"""Joints and contacts written in Python, checked and brought into one form."""

from __future__ import annotations

from typing import Any, Callable

from ._spec import number, shown, whole, word

_LAW = ("mu", "e_n", "e_t", "mu_static", "belt")
_FUNCTIONS = {"contact": ("gap", "rows", "bias"), "joint": ("residual", "rows", "bias", "rate")}
_OPTIONAL = ("bias", "rate")


def custom_element(kind: str, keys: dict[str, Any], place: int) -> dict[str, Any]:
    """What Scene.add collected, for the compiled side."""
    functions = _FUNCTIONS[kind]
    known = {"type", "name", "bodies", *functions, *(("length", *_LAW) if kind == "contact" else ("count",))}
    if unknown := [key for key in keys if key not in known]:
        raise ValueError(f"{kind}: {unknown[0]}: must be one of {', '.join(sorted(known))}")
    name = word("name", keys.get("name", f"custom{place + 1}"))
    bodies = keys.get("bodies")
    if not isinstance(bodies, (list, tuple)) or len(bodies) != 2:
        raise TypeError(f"{kind} \"{name}\": bodies = {shown(bodies)}: must be two names")
    many = kind == "contact" and all(isinstance(side, (list, tuple)) for side in bodies)
    sides = [[word("bodies", body) for body in (side if many else [side])] for side in bodies]
    if len(sides[0]) != len(sides[1]) or not sides[0]:
        raise ValueError(f"{kind} \"{name}\": bodies = {shown(bodies)}: must be two lists of equal length, not empty")
    for key in functions:
        if not callable(keys.get(key)) and not (key in _OPTIONAL and keys.get(key) is None):
            raise TypeError(f"{kind} \"{name}\": {key} = {shown(keys.get(key))}: must be a function of the poses")
    made: dict[str, Any] = {"kind": kind, "name": name, "many": many, "a": sides[0], "b": sides[1]}
    for key in functions:
        function = keys.get(key)
        made[key] = Together(function, len(sides[0])) if many and function is not None else function
    if kind == "joint":
        made["count"] = whole("count", keys.get("count", 1), 1, 3)
        return made
    where = f"{kind} \"{name}\": "
    made.update({key: number(where + key, keys.get(key, 0)) for key in _LAW})
    made["length"] = None if keys.get("length") is None else number(where + "length", keys["length"])
    if made["length"] is not None and made["length"] < 0:
        raise ValueError(f"{where}length = {made['length']:g}: must be >= 0 [m]")
    return made


class Missing:
    """In place of a function in a run that was copied or pickled: a run needs none, and a lambda has no name to pickle
    by."""

    def __init__(self, where: str) -> None:
        self.where = where

    def __call__(self, *motion: Any) -> Any:
        raise RuntimeError(f"{self.where}: a copied run does not keep the functions of its scene")


def without_functions(customs: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The same joints and contacts, for a run that is to be pickled."""
    def missing(custom: dict[str, Any], key: str) -> bool:
        return key in _FUNCTIONS[custom["kind"]] and custom[key] is not None

    return [{key: Missing(f"{custom['kind']} \"{custom['name']}\": {key}") if missing(custom, key) else value
             for key, value in custom.items()} | {"copied": True} for custom in customs]


class Together:
    """A function of n contacts at once: numbers in what it returns count for all of them. A class, so that it
    pickles."""

    def __init__(self, function: Callable[..., Any], n: int) -> None:
        self.function, self.n = function, n

    def __call__(self, *motion: Any) -> Any:
        return _filled(self.function(*motion), self.n)


def _filled(value: Any, n: int) -> Any:
    import numpy as np

    if isinstance(value, (list, tuple)):
        return np.stack([_filled(part, n) for part in value])
    array = np.asarray(value, dtype=float)
    return array if array.ndim else np.full(n, float(array))
