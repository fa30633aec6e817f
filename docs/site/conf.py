"""Sphinx's settings for the site; `tools/site` gathers the pages and calls it (docs/site/build.py)."""

import os
import re
import sys
from pathlib import Path

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

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
myst_enable_extensions = ["html_image", "dollarmath"]
myst_dmath_allow_space = myst_dmath_allow_digits = False  # prices and shell variables are no formulas
html_math_renderer = "mathml"

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


def show_formula(writer: nodes.NodeVisitor, node: nodes.Element) -> None:
    """A formula as MathML, which browsers set themselves: it needs no script, font or network."""
    bars = node.astext().replace("\\lvert", "\\lmoustache").replace("\\rvert", "\\rmoustache")
    try:
        formula = tex2mathml(bars)
    except Exception as error:  # noqa: BLE001: its type differs between versions of docutils
        logging.getLogger(__name__).warning("%s: %s", node.astext(), error, location=node)
        raise nodes.SkipNode from error
    for side, bar in (("prefix", "\u23b0"), ("postfix", "\u23b1")):  # which side of it a bar belongs to
        formula = re.sub(f"<mo[^>]*>{bar}</mo>", f'<mo form="{side}" stretchy="false">|</mo>', formula)
    if isinstance(node, nodes.math_block):
        shown = formula.replace("<math ", '<math display="block" ', 1)
        formula = f'<div class="formula">{shown}</div>'
    writer.body.append(formula)
    raise nodes.SkipNode


def keep_whole(app, name: str, template: str, context: dict, tree: nodes.document | None) -> None:
    """Formulas in a line keep the brackets and stops beside them: no line begins with a comma."""
    formula = r"\(?<math xmlns=\"[^\"]*\">(?:(?!</math>).)*</math>[,.;:)?]+"
    if "body" in context:
        context["body"] = re.sub(formula, r'<span class="whole">\g<0></span>', context["body"], flags=re.S)


def setup(app) -> None:
    app.connect("html-page-context", keep_whole)
    app.add_html_math_renderer("mathml", (show_formula, None), (show_formula, None))
