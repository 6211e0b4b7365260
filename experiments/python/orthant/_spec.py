"""Names with options, as every table of solvers, integrators and scenes writes them: "pgs:omega=1.3"."""

from __future__ import annotations

from typing import Any, NamedTuple, Optional


class Entry(NamedTuple):
    """A row of a registry."""

    name: str
    summary: str
    options: str  # every option with its default and range


def text_of(value: Any) -> str:
    """A number, bool or word as option text; numbers in a form that reads back bit for bit."""
    if hasattr(value, "item") and not isinstance(value, (str, bytes)):  # a NumPy scalar
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return value
    raise TypeError(f"option value {value!r}: must be a number, a bool or a word")


def seconds(name: str, value: Any) -> Optional[float]:
    """A time that the caller gives, or None."""
    if value is None:
        return None
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} = {value!r}: must be a number [s]") from None
    if not number > 0:
        raise ValueError(f"{name} = {number:g}: must be > 0 [s]")
    return number


def spec(name: str, options: dict[str, Any]) -> str:
    """"pgs" and {"omega": 1.3} become "pgs:omega=1.3"; a name that brings options of its own keeps them."""
    if not isinstance(name, str):
        raise TypeError(f"solver {name!r}: must be a name, such as 'auto'")
    if not options:
        return name
    given = ",".join(f"{key}={text_of(value)}" for key, value in options.items())
    return f"{name}{',' if ':' in name else ':'}{given}"
