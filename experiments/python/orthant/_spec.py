"""Arguments in words: names with options, as every table writes them ("pgs:omega=1.3"), and what is wrong with the
others."""

from __future__ import annotations

import importlib.util
import math
import operator
import os
import re
from typing import Any, NamedTuple, Optional


class Entry(NamedTuple):
    """A row of a registry."""

    name: str
    summary: str
    options: str  # every option with its default and range


registered: set[tuple[str, str]] = set()  # ("solver", name), ...: from Python, in this process


def shown(value: Any) -> str:
    """As Python writes it, cut where it is long."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else text[:57] + "..."


def seconds(name: str, value: Any) -> Optional[float]:
    """A time that the caller gives, or None."""
    if value is None:
        return None
    try:
        if isinstance(value, (str, bytes, bool)):
            raise TypeError
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name} = {shown(value)}: must be a number [s]") from None
    if not number > 0:
        raise ValueError(f"{name} = {number:g}: must be > 0 [s]")
    return number


def number(name: str, value: Any) -> float:
    """A finite number."""
    try:
        if isinstance(value, (str, bytes, bool)):
            raise TypeError
        read = float(value)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name} = {shown(value)}: must be a number") from None
    if not math.isfinite(read):
        raise ValueError(f"{name} = {read:g}: must be finite")
    return read


def installed(module: str, what: str) -> None:
    """Of a package that only some parts need: what lacks it, and the command that installs it."""
    if importlib.util.find_spec(module) is None:
        raise ModuleNotFoundError(f"{what} needs {module}: pip install {module}", name=module)


def whole(name: str, value: Any, least: int, most: int = 2**31 - 1, what: str = "") -> int:
    """A whole number in [least, most]."""
    if isinstance(value, bool) or not hasattr(value, "__index__"):
        raise TypeError(f"{name} = {shown(value)}: must be a whole number{what}")
    if not least <= (number := operator.index(value)) <= most:
        raise ValueError(f"{name} = {shown(number)}: must be a whole number in [{least}, {most}]{what}")
    return number


def flag(name: str, value: Any) -> bool:
    """True or False, NumPy's as well."""
    if not isinstance(value, bool) and getattr(getattr(value, "dtype", None), "kind", "") != "b":
        raise TypeError(f"{name} = {shown(value)}: must be True or False")
    return bool(value)


def word(name: str, value: Any, example: str = "a text") -> str:
    """A text."""
    if not isinstance(value, str):
        raise TypeError(f"{name} = {shown(value)}: must be {example}")
    if not value.isascii() and any("\ud800" <= c <= "\udfff" for c in value):
        raise ValueError(f"{name} = {shown(value)}: must be Unicode")
    return value


def path(name: str, value: Any) -> str:
    """A file's name."""
    if not isinstance(value, (str, bytes, os.PathLike)):
        raise TypeError(f"{name} = {shown(value)}: must be a file's name or path")
    if not (text := os.fsdecode(value)) or "\0" in text:
        raise ValueError(f"{name} = {shown(value)}: must be a file's name or path")
    return text


def regular(file: str) -> str:
    """The same name, of a regular file or of none: a device or a pipe has no end, and is nothing to replace."""
    if os.path.exists(file) and not os.path.isfile(file):
        raise ValueError(f"{file}: is no regular file")
    return file


def _text_of(key: str, value: Any) -> str:
    """A number, bool or word as option text; numbers in a form that reads back bit for bit."""
    if hasattr(value, "item") and getattr(value, "ndim", 0) == 0:  # a NumPy scalar
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return value
    raise TypeError(f"option {key} = {shown(value)}: must be a number, a bool or a word")


def options_of(options: dict[str, Any]) -> str:
    """{"omega": 1.3, "max_sweeps": 50} becomes "omega=1.3,max_sweeps=50"; a value is one value."""
    given = []
    for key, value in options.items():
        if not re.fullmatch(r"\w+", key):
            raise ValueError(f"option {shown(key)}: must be a name")
        if not re.fullmatch(r"[\w.+-]*", text := _text_of(key, value)):
            raise ValueError(f"option {key} = {shown(value)}: must be one number, bool or word")
        given.append(f"{key}={text}")
    return ",".join(given)


def spec(name: str, options: dict[str, Any]) -> str:
    """"pgs" and {"omega": 1.3} become "pgs:omega=1.3"; a name that brings options of its own keeps them."""
    word("solver", name, "a name, such as 'auto' or 'pgs:omega=1.3'")
    return f"{name}{',' if ':' in name else ':'}{options_of(options)}" if options else name
