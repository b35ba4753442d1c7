# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The C++ block of docs/library.md is tests/consumer/project/main.cc, and its CMake block the lines of the project.

usage: library_page_test.py ROOT
"""

import pathlib
import re
import sys

PAGE = "docs/library.md"


def code_of(path):
    """A file's text without its SPDX lines."""
    lines = path.read_text().splitlines()
    return "\n".join(line for line in lines if "SPDX-" not in line).strip()


def main(root):
    page = (root / PAGE).read_text()
    project = root / "tests" / "consumer" / "project"
    wrong = []
    for language, name in (("cpp", "main.cc"), ("cmake", "CMakeLists.txt")):
        blocks = re.findall(rf"^```{language}\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
        if len(blocks) != 1:
            wrong.append(f"{PAGE} has {len(blocks)} blocks of {language}, expected was one")
        elif blocks[0].strip() != code_of(project / name):
            wrong.append(f"the {language} block of {PAGE} is not tests/consumer/project/{name}; copy it over")
    print("\n".join(wrong) if wrong else f"{PAGE} shows the code that is built")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
