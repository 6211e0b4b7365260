"""Sphinx' settings; build.py calls it."""
import re
import sys
from pathlib import Path

import orthant  # build.py has put it on the path

sys.path.insert(0, str(Path(__file__).parent))  # cpp_api.py
project = "Orthant"
version = release = orthant.__version__
copyright = "the authors of Orthant, BSD-3-Clause"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinx_copybutton", "cpp_api"]
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = f"Orthant {version}"
html_static_path = ["_static"]
html_show_sphinx = False
html_copy_source = False
exclude_patterns = ["README.md", "figures/README.md"]
highlight_language = "none"
pygments_style = "default"  # readable on its background: contrast at least 4.5
default_role = "code"

# Formulas are drawn by KaTeX from this site's own files; the extension only marks them.
mathjax_path = "formulas.js"
html_css_files = ["katex/katex.min.css", "tables.css"]
html_js_files = ["katex/katex.min.js"]

autodoc_typehints = "signature"
autodoc_member_order = "bysource"
nitpick_ignore_regex = [("py:.*", ".*")]  # types of NumPy and pybind11 that no page of ours describes


def docstring_as_rst(app, what, name, obj, options, lines):
    """Docstrings are plain text: bars are no substitutions, and lines that belong together stay so."""
    lines[:] = [re.sub(r"(?<![\\`])\|", r"\\|", line).replace("*", r"\*") for line in lines]


def setup(app):
    app.connect("autodoc-process-docstring", docstring_as_rst)
