"""What a user meets first: the import's cost, the docstrings' examples."""

import doctest
import os
import pathlib
import subprocess
import sys
import time

import orthant


def test_import_is_quick():
    path = {**os.environ, "PYTHONPATH": str(pathlib.Path(orthant.__file__).parents[1])}

    def seconds(code):
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True, env=path)
        return time.perf_counter() - begin

    assert min(seconds("import orthant") for _ in range(3)) < 0.5 + min(seconds("import numpy") for _ in range(3))


def test_examples_in_docstrings():
    for module in (orthant, orthant._mechanics):
        assert doctest.testmod(module, extraglobs=vars(orthant)).failed == 0


def test_everything_public_is_documented():
    for name in orthant.__all__:
        assert name.startswith("__") or name in ("revision", "LogEntry") or getattr(orthant, name).__doc__, name
