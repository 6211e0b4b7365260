"""Where the parts of HTML pages are: in the package, if it came as a wheel; else the compiled part knows."""

from __future__ import annotations

import os

from ._orthant import _set_folder_of_parts

_folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "share", "orthant", "report")
if os.path.isdir(_folder):
    _set_folder_of_parts(_folder)
