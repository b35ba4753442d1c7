# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Renders the equations of the pages with KaTeX while the site is built: pages need no script for them.

KaTeX is asked by one process of Node for all equations, a line of JSON each.
"""
import json
import shutil
import subprocess
from pathlib import Path

from docutils.nodes import SkipNode
from sphinx.errors import ExtensionError

MODULE = Path("/usr/share/nodejs/katex")      # of Debian's package katex
ASSETS = Path("/usr/share/javascript/katex")  # of libjs-katex
PROGRAM = """
const katex = require(process.argv[1]);
require("readline").createInterface({input: process.stdin}).on("line", line => {
  const [tex, displayMode] = JSON.parse(line);
  try {
    console.log(JSON.stringify({html: katex.renderToString(tex, {displayMode, throwOnError: true})}));
  } catch (error) {
    console.log(JSON.stringify({error: String(error)}));
  }
});
"""


class Katex:
    """A process that renders; begun with the first equation."""

    def __init__(self):
        self.process = None

    def render(self, tex, display):
        if self.process is None:
            if shutil.which("node") is None or not MODULE.is_dir() or not ASSETS.is_dir():
                raise ExtensionError("equations need Node and KaTeX; install nodejs, katex and libjs-katex")
            self.process = subprocess.Popen(["node", "-e", PROGRAM, str(MODULE)], stdin=subprocess.PIPE,
                                            stdout=subprocess.PIPE, text=True, encoding="utf-8")
        self.process.stdin.write(json.dumps([tex, display]) + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline() or '{"error": "Node ended"}')
        if "error" in answer:
            raise ExtensionError(f"an equation cannot be rendered: {answer['error']}\n{tex}")
        return answer["html"]

    def end(self):
        if self.process is not None:
            self.process.stdin.close()
            self.process.wait()
            self.process = None


KATEX = Katex()


def visit_math(translator, node):
    translator.body.append(KATEX.render(node.astext(), display=False))
    raise SkipNode


def visit_displaymath(translator, node):
    ids = "".join(f'<span id="{name}"></span>' for name in node["ids"])
    translator.body.append(f'<div class="equation">{ids}{KATEX.render(node.astext(), display=True)}</div>\n')
    raise SkipNode


def copy_assets(app, error):
    KATEX.end()
    if error is None:
        target = Path(app.outdir) / "_static" / "katex"
        shutil.copytree(ASSETS / "fonts", target / "fonts", dirs_exist_ok=True)
        shutil.copy(ASSETS / "katex.min.css", target)


def setup(app):
    app.add_html_math_renderer("katex", (visit_math, None), (visit_displaymath, None))
    app.add_css_file("katex/katex.min.css")
    app.connect("build-finished", copy_assets)
