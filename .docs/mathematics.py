"""Formulas of pages as MathML, which browsers typeset themselves: nothing is loaded for it."""

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator


def inline(writer: HTML5Translator, node: nodes.math) -> None:
    """Write a formula within a line."""
    writer.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def display(writer: HTML5Translator, node: nodes.math_block) -> None:
    """Write a formula of its own, which scrolls where a screen is too narrow for it."""
    writer.body.append(f'<div class="formula">{tex2mathml(node.astext(), as_block=True)}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer under the name that `conf.py` chooses."""
    app.add_html_math_renderer("mathml", inline_renderers=(inline, None),
                               block_renderers=(display, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
