# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The site of `./run docs`, here as in the package pliant-doc, builds without a warning and shows what it was made of.

usage: site_test.py ROOT PLIANT PYTHON_PATH
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse

SKIPPED = 77
# A text of each kind of page, by its file: of a page, a command, an equation's number, a manual, a docstring in Python
# and one of the compiled part, and the comments of a header, a function and a member.
SHOWN = (
    ("index.html", "Your own video"),
    ("docs/evaluation.html", "<pre><span></span>pliant evaluate run --sequence SEQ"),
    ("docs/method.html", 'id="E7"'),
    ("docs/method.html", 'href="#E7"'),
    ("docs/method.html", 'class="katex-display"'),
    ("options/track.html", "--Growth.grow"),
    ("python_api.html", "Camera pose and the motion of every point."),
    ("python_api.html", "Tracks images as they come, without a run folder."),
    ("examples/notebooks/1_first_run.html", "The sequence"),
    ("cpp_api.html", "Least-squares alignment of point sets"),
    ("api/cpp/group__estimation____pose____camera__pose.html", "from known 3D points and their pixels"),
    ("api/cpp/group__estimation____pose____camera__pose.html", "Running out of iterations is no failure"),
    ("api/cpp/structpliant_1_1CameraPoseOptions.html", "standard deviation of a measured pixel"),
)


def need(python_path):
    missing = [program for program in ("sphinx-build", "doxygen", "katex") if shutil.which(program) is None]
    if not missing:
        # Sphinx's own Python reads the package.
        head = pathlib.Path(shutil.which("sphinx-build")).read_text(encoding="utf-8").splitlines()[0]
        python = head[2:].split() if head.startswith("#!") else ["python3"]
        modules = subprocess.run([*python, "-c", "import myst_parser, furo, sphinx_copybutton, pliant"], check=False,
                                 env={**os.environ, "PYTHONPATH": python_path}, stderr=subprocess.PIPE, text=True)
        missing = modules.stderr.strip().splitlines()[-1:]
    if missing:
        print(f"skipped: {', '.join(missing)} not found")
        sys.exit(SKIPPED)


def broken_links(html):
    """Links and pictures of the site's pages (Doxygen's refer to each other by themselves) that lead nowhere."""
    for page in sorted(html.rglob("*.html")):
        if "api" in page.relative_to(html).parts or page.name in ("search.html", "genindex.html"):
            continue
        for link in re.findall(r'(?:href|src|srcset)="([^"#]+)', page.read_text(encoding="utf-8")):
            target = urllib.parse.unquote(link.split("?")[0])
            if not re.match(r"\w+:|//", target) and not (page.parent / target).exists():
                yield f"{page.relative_to(html)}: {link}"


def main(root, program, python_path):
    need(python_path)
    with tempfile.TemporaryDirectory() as folder:
        result = subprocess.run(
            [sys.executable, "-B", str(root / "docs" / "site" / "build.py"), "--program", program, "--python_path",
             python_path, "--output_path", folder, "--installed"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            text=True, check=False)
        print(result.stdout)
        if result.returncode:
            return 1
        html = pathlib.Path(folder) / "html"
        wrong = [f"{page} does not show '{text}'" for page, text in SHOWN
                 if text not in re.sub(r"\s+", " ", (html / page).read_text(encoding="utf-8"))]
        wrong += [f"the link leads nowhere: {link}" for link in broken_links(html)]
        print("\n".join(wrong) if wrong else "the site shows what it was made of")
        return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3]))
