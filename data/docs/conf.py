# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx: the pages of this folder, and the documents of the repository beside them. build.sh knows the version."""
import os
import sys

project = "rio"
author = copyright = "the rio authors"

sys.path.insert(0, os.environ["RIO_PYTHON_SOURCE"])
extensions = ["myst_parser", "sphinx.ext.autodoc"]
autodoc_mock_imports = ["numpy", "rio._rio"]  # the text alone is read
myst_heading_anchors = 4
myst_enable_extensions = ["dollarmath"]
html_theme = "alabaster"
html_theme_options = {"description": "radar-inertial odometry", "fixed_sidebar": True, "page_width": "1100px"}
html_extra_path = ["api"]  # of Doxygen, beside a copy of this folder
exclude_patterns = ["api"]


def as_it_stands(app, what, name, obj, options, lines):
    """Docstrings are plain text: a paragraph, then what is shown as it stands."""
    end = lines.index("") if "" in lines else len(lines)
    rest = [f"   {line}".rstrip() for line in lines[end:]]
    lines[:] = [" ".join(lines[:end]), ""] + (["::", "", *rest, ""] if any(rest) else [])


def setup(app):
    app.connect("autodoc-process-docstring", as_it_stands)
