# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the Python blocks of docs/python.md, one after the other, in a folder with a sequence and a run.

usage: page_test.py SOURCE
"""

import os
import pathlib
import re
import shutil
import sys
import tempfile
import types

import support


def opencv():
    """OpenCV, or of it what the page uses."""
    try:
        import cv2
        return cv2
    except ImportError:
        stand_in = types.ModuleType("cv2")
        stand_in.imread = lambda name: support.read_png(pathlib.Path(name))
        return stand_in


def main(source):
    text = (source / "docs" / "python.md").read_text()
    blocks = list(re.finditer(r"^```python\n(.*?)^```$", text, re.DOTALL | re.MULTILINE))
    if len(blocks) < 5:
        return f"docs/python.md has {len(blocks)} blocks of Python, expected were at least 5"
    sys.modules["cv2"] = opencv()
    folder = tempfile.mkdtemp()
    try:
        os.chdir(folder)
        os.symlink(support.SEQUENCE, "colon")
        names = {}
        for block in blocks:
            # Line numbers of an error are those of the page.
            lines = "\n" * text.count("\n", 0, block.start(1))
            exec(compile(lines + block.group(1), "docs/python.md", "exec"), names)
    finally:
        os.chdir(source)
        shutil.rmtree(folder)
    return None


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
