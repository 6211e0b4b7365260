"""The `orthant` command of the package; `python -m orthant` is the same."""

from __future__ import annotations

import importlib.util
import os
import signal
import sys
import traceback
from pathlib import Path

from . import _orthant

_OWN = {str(file)
        for file in Path(__file__).parent.glob("*.py")
        } | {"<frozen importlib._bootstrap>", "<frozen importlib._bootstrap_external>"}


def described(error: BaseException) -> str:
    """What it says, and the innermost line outside of this package that raised it."""
    words = f"{type(error).__name__}: {error}"
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename not in _OWN]
    if isinstance(error, SyntaxError) or not frames:
        return words
    return f"{words} ({os.path.basename(frames[-1].filename)}, line {frames[-1].lineno})"


def load_plugin(file: str) -> None:
    """Runs a Python file, as a module of its own name, for the solvers, integrators and scenes that it registers."""
    path = Path(file).absolute()
    if path.suffix != ".py":
        raise ValueError(
            f"--plugin '{file}': must be a Python file, .py: compiled plugins need an orthant that was built "
            "from its sources")
    if not path.is_file():
        raise ValueError(f"--plugin '{file}': must be a Python file that exists")
    sys.path.insert(0, str(path.parent))  # modules of its folder, as of a script
    name = f"orthant_plugin_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise ValueError(f"--plugin '{file}': {described(error)}") from error


def main() -> None:
    # As of a program: Ctrl-C ends a command or is caught by it, and a reader that has gone ends it.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(_orthant._main(["orthant", *sys.argv[1:]]))
