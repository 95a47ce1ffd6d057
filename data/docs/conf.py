# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx: the pages of this folder, and the documents of the repository beside them. build.sh knows the version."""
project = "rio"
author = copyright = "the rio authors"

extensions = ["myst_parser"]
myst_heading_anchors = 4
myst_enable_extensions = ["dollarmath"]
html_theme = "alabaster"
html_theme_options = {"description": "radar-inertial odometry", "fixed_sidebar": True, "page_width": "1100px"}
html_extra_path = ["api"]  # of Doxygen, beside a copy of this folder
exclude_patterns = ["api"]
