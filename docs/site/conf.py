"""Sphinx's settings for the site; `tools/site` gathers the pages and calls it (docs/site/build.py)."""

import os
import sys
from pathlib import Path

gathered = Path(os.environ["MIEBRDF_SITE"])  # what build.py puts together
sys.path.insert(0, str(gathered / "python"))

project = "miebrdf"
author = "the miebrdf developers"
copyright = author
release = version = os.environ["MIEBRDF_VERSION"]
language = "en"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "breathe",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["tests", "materials", "mie", "rte", "pipeline", ".github"]

myst_heading_anchors = 6
myst_enable_extensions = ["html_image"]

breathe_projects = {"miebrdf": str(gathered / "doxygen" / "xml")}
breathe_default_project = "miebrdf"
breathe_show_include = False
breathe_order_parameters_first = True
cpp_index_common_prefix = ["miebrdf::"]

autosummary_generate = False
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_preserve_defaults = True
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
default_role = "py:obj"  # words in single backticks of docstrings: a link where they name something

html_theme = "plain"
html_theme_path = [str(Path(__file__).parent / "theme")]
html_title = f"miebrdf {version}"
html_short_title = "miebrdf"
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_permalinks_icon = "#"
html_show_search_summary = False  # it would be fetched, which browsers refuse for files on a disk
