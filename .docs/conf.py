"""Settings of Sphinx; `python .docs` collects the pages first and runs it."""

import sys
from pathlib import Path

import matplotlib

import sebody

sys.path.insert(0, str(Path(__file__).parent))      # `mathematics.py` beside this file

project = "sebody"
author = "the sebody authors"
copyright = "the sebody authors"
version = release = sebody.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.viewcode",
              "mathematics"]
root_doc = "index"
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4        # links name headings as public forges do
suppress_warnings = ["myst.header"]     # tutorials may begin sections at any depth

default_role = "literal"        # docstrings have names in single backticks
autodoc_member_order = "bysource"
autodoc_typehints = "none"      # types are in the docstrings, with shapes and units
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_rtype = False

html_math_renderer = "mathml"
html_theme = "furo"
html_title = f"sebody {version}"
html_copy_source = False
html_show_sphinx = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1f2a44", "color-brand-content": "#2a5db0"},
}
# letters of formulas, where a machine has no font with them, from the font that Matplotlib brings
html_static_path = ["static", f"{matplotlib.get_data_path()}/fonts/ttf/STIXGeneral.ttf"]
html_css_files = ["pages.css"]
