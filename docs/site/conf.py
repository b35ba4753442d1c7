# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's configuration. build.py makes the folder of pages that it reads."""

import re
import sys
from pathlib import Path

from docutils import nodes

sys.path.insert(0, str(Path(__file__).resolve().parent))

project = "Pliant"
author = "The Pliant authors"
copyright = "2026 The Pliant authors"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton", "equations"]
myst_enable_extensions = ["deflist", "dollarmath"]
myst_heading_anchors = 4
smartquotes = False            # --flag stays --flag
highlight_language = "none"    # indented blocks are commands
copybutton_exclude = ".linenos, .gp, .go"
exclude_patterns = ["experiments/behavior"]
suppress_warnings = ["myst.header"]  # some pages of notebooks begin with a heading of another level

autodoc_typehints = "signature"
autodoc_type_aliases = {name: name for name in ("StrPath", "RunOrPath", "OptionValues")}
autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
napoleon_google_docstring = True
napoleon_use_ivar = True
napoleon_attr_annotations = False  # the texts have the types

html_theme = "furo"
html_title = "Pliant"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_copy_source = False
html_math_renderer = "katex"   # of equations.py


EQUATION = re.compile(r"\(([A-Z]\d{1,2})\)")


def add_html_anchors(app, doctree):
    """Makes `<a id="name"></a>` a target of links, as a heading is one."""
    labels = app.env.get_domain("std").anonlabels
    docname = app.env.docname
    for node in doctree.findall(nodes.raw):
        for name in re.findall(r'<a id="([^"]+)">', node.astext()):
            labels[f"{app.env.doc2path(docname, base=False)}#{name}"] = (docname, name)


def link_equations(app, doctree):
    """Gives each equation of the method its number as an anchor (method.html#E7), and links the numbers in its text."""
    if app.env.docname != "docs/method":
        return
    numbers = set()
    for block in doctree.findall(lambda node: isinstance(node, (nodes.literal_block, nodes.math_block))):
        here = re.findall(r"^\(([A-Z]\d{1,2})\)|\\tag\{([A-Z]\d{1,2})\}", block.astext(), re.MULTILINE)
        here = [in_words or in_symbols for in_words, in_symbols in here]
        block["ids"] += [number for number in here if number not in numbers]
        numbers.update(here)
    for text in list(doctree.findall(nodes.Text)):
        if isinstance(text.parent, (nodes.literal_block, nodes.literal, nodes.math_block, nodes.title, nodes.reference)):
            continue
        parts = EQUATION.split(str(text))  # text, number, text, number, text ...
        if any(number in numbers for number in parts[1::2]):
            new = [nodes.Text(part) if k % 2 == 0 else nodes.reference("", f"({part})", refid=part, internal=True)
                   if part in numbers else nodes.Text(f"({part})") for k, part in enumerate(parts)]
            text.parent.replace(text, new)


def mark_short_code(app, doctree):
    """Code of words that fit on a line of a phone, which are not to break at their dashes."""
    for node in doctree.findall(nodes.literal):
        if all(len(word) <= 40 for word in node.astext().split()):
            node["classes"].append("whole")


def keep_code(app, what, name, obj, options, lines):
    """Indented lines in the docstring of a module are code."""
    if what == "module":
        for k in range(len(lines) - 1, 0, -1):
            if lines[k].startswith("    ") and not lines[k - 1]:
                lines[k:k] = [".. code-block:: python", ""]


def setup(app):
    app.connect("doctree-read", add_html_anchors)
    app.connect("doctree-read", link_equations)
    app.connect("doctree-read", mark_short_code)
    app.connect("autodoc-process-docstring", keep_code)
