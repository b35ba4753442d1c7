# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""README.md's C++ block is tests/consumer/project/main.cc, and its CMake block the project's lines.

usage: readme_test.py ROOT
"""

import pathlib
import re
import sys


def code_of(path):
    """A file's text without its SPDX lines."""
    lines = path.read_text().splitlines()
    return "\n".join(line for line in lines if "SPDX-" not in line).strip()


def main(root):
    readme = (root / "README.md").read_text()
    project = root / "tests" / "consumer" / "project"
    wrong = []
    for language, name in (("cpp", "main.cc"), ("cmake", "CMakeLists.txt")):
        blocks = re.findall(rf"^```{language}\n(.*?)^```$", readme, re.DOTALL | re.MULTILINE)
        if len(blocks) != 1:
            wrong.append(f"README.md has {len(blocks)} blocks of {language}, expected was one")
        elif blocks[0].strip() != code_of(project / name):
            wrong.append(f"README.md's {language} block is not tests/consumer/project/{name}; copy it over")
    print("\n".join(wrong) if wrong else "README.md shows the code that is built")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
