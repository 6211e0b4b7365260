"""The `orthant` command of the package; `python -m orthant` is the same."""

from __future__ import annotations

import signal
import sys

from . import _orthant


def main() -> None:
    # As of a program: Ctrl-C ends a command or is caught by it, and a reader that has gone ends it.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(_orthant._main(["orthant", *sys.argv[1:]]))
