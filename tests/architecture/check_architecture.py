#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the rules of the architecture that a compiler does not see.

usage: check_architecture.py ROOT

1. A module includes only itself and modules below it (so there is no circle of modules).
2. FLANN and Assimp are included in one file each, in the modules deformation and simulation; OpenGV in estimation/*/opengv_*.
3. Nothing below the module cli prints, logs, or ends the process.
4. Every source, header, script and CMake list begins with the two SPDX lines.
5. A private header in a folder of a module (src/estimation/window, say) is included in that folder only; where the
   folders of a module have an order, in those above it and above all of them too.
6. Every relative link in a Markdown file leads to a file, and its anchor to a heading or an `<a id="...">` there.
Prints one line a violation, `file:line: sentence`, and exits with 1 if there is one.
"""

import pathlib
import re
import sys

MODULES = ("base geometry image camera colmap scene io datasets board simulation photometric deformation residuals "
           "estimation calibration refinement surface tracking evaluation exchange pipeline viewer python cli").split()
# Where a library may be included: in the files of one module whose names begin so; where nothing is said, in one file of it.
LIBRARY_HOMES = {"flann": ("deformation", ""), "opengv": ("estimation", "opengv_"), "assimp": ("simulation", "")}
# The folders of a module, bottom to top, where the upper ones build on the lower ones.
FOLDERS = {"tracking": "tracks submap depth_prior frame relocalization bootstrapping map_upkeep".split()}
# Files whose calls that end the process are in one of its own.
CHILD_PROCESSES = {"child_call.cc"}
SPDX = ("SPDX-FileCopyrightText: ", "SPDX-License-Identifier: BSD-3-Clause")
SPDX_SUFFIXES = {".h", ".cc", ".py", ".pyi", ".cmake", ".sh"}

LINK = re.compile(r"\[[^\[\]]*\]\(<?([^()\s>]+)>?(?: \"[^\"]*\")?\)|(?:src|href|srcset)=\"([^\"]+)\"")
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]')
FORBIDDEN_CALL = re.compile(
    r"\bstd::(cout|cerr|clog)\b|(?<![\w.>])(std::)?(printf|fprintf|vprintf|vfprintf|puts|fputs|putchar|perror|exit|"
    r"_Exit|_exit|quick_exit|abort|terminate)\s*\(|\bspdlog::|\b(LOG|VLOG)\s*\(")
COMMENT_OR_TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.*?)\)"|"(?:\\.|[^"\\\n])*"', re.DOTALL)


def without_comments(text):
    """The source with comments and string contents blanked, line by line as before."""
    def blank(match):
        return "".join("\n" if c == "\n" else " " for c in match.group())
    return COMMENT_OR_TEXT.sub(blank, text)


def sources(root):
    """(module, path) of every source and header of the library and the program, sorted."""
    for base in (root / "include" / "pliant", root / "src"):
        for path in sorted(base.rglob("*")):
            if path.suffix in (".h", ".cc"):
                yield path.relative_to(base).parts[0], path


def included_module(target):
    parts = target.split("/")
    if parts[0] == "pliant":
        parts = parts[1:]
    return parts[0] if len(parts) > 1 and parts[0] in MODULES else None


def check_module_order(root):
    for module, path in sources(root):
        if module not in MODULES:
            yield path, 1, f"'{module}' is no module of the library"
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = INCLUDE.match(line)
            below = included_module(match.group(1)) if match else None
            if below and MODULES.index(below) > MODULES.index(module):
                yield path, number, f"module {module} includes module {below}, which lies above it"


def check_library_homes(root):
    for library, (home, prefix) in LIBRARY_HOMES.items():
        seen = []
        for module, path in sources(root):
            for number, line in enumerate(path.read_text().splitlines(), 1):
                match = INCLUDE.match(line)
                if match and match.group(1).startswith(library + "/"):
                    if module != home:
                        yield path, number, f"{library} may be included in module {home} only"
                    elif prefix and not path.name.startswith(prefix):
                        yield path, number, f"{library} may be included in files {prefix}* only"
                    elif not prefix and seen and seen[0] != path:
                        yield path, number, f"{library} is already included in {seen[0].relative_to(root)}"
                    seen.append(path)


def check_calls(root):
    for module, path in sources(root):
        if module == "cli" or path.name in CHILD_PROCESSES:
            continue
        for number, line in enumerate(without_comments(path.read_text()).splitlines(), 1):
            match = FORBIDDEN_CALL.search(line)
            if match:
                yield path, number, f"'{match.group().strip()}' below cli: return a Status instead"


def check_spdx(root):
    paths = [root / "run", root / ".ci" / "run", root / "CMakeLists.txt"]
    for folder in ("cmake", "include", "src", "python", "tests", "third_party_configs", "experiments", "docs"):
        paths += [p for p in sorted((root / folder).rglob("*"))
                  if p.suffix in SPDX_SUFFIXES or p.name == "CMakeLists.txt"]
    for path in paths:
        if path.is_file():
            head = [line for line in path.read_text().splitlines()[:3] if not line.startswith("#!")]
            if not all(text in line for text, line in zip(SPDX, head + ["", ""])):
                yield path, 1, "the two SPDX lines are not the first ones"


def lies_above(module, folder, lower):
    """Whether files in `folder` of the module may include private headers of `lower`."""
    order = FOLDERS.get(module, [])
    if lower.name not in order:
        return False
    return folder.name == module or (folder.name in order and order.index(folder.name) > order.index(lower.name))


def check_private_folders(root):
    for module, path in sources(root):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = INCLUDE.match(line)
            header = root / "src" / match.group(1) if match else None
            if header and len(pathlib.PurePath(match.group(1)).parts) > 2 and header.exists() \
                    and path.parent != header.parent and not lies_above(module, path.parent, header.parent):
                yield path, number, f"{match.group(1)} is private to its folder"


def without_code(text):
    """Markdown with fenced blocks and `code` blanked, line by line as before."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match.group())
    return re.sub(r"`[^`\n]+`", blank, re.sub(r"^```.*?^```", blank, text, flags=re.DOTALL | re.MULTILINE))


def anchors(text):
    """The names that links to this Markdown may end with, as GitHub makes them."""
    found = set(re.findall(r'<a id="([^"]+)">', text))
    for heading in re.findall(r"^#{1,6} +(.+?)\s*$", re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE),
                              re.MULTILINE):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        name = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        number = 0
        while (f"{name}-{number}" if number else name) in found:
            number += 1
        found.add(f"{name}-{number}" if number else name)
    return found


def check_links(root):
    ignored = {"build", "node_modules", "work"}
    for path in sorted(root.rglob("*.md")):
        parts = path.relative_to(root).parts
        if any(part in ignored or part.startswith(".") for part in parts):
            continue
        text = without_code(path.read_text())
        for match in LINK.finditer(text):
            link = match.group(1) or match.group(2)
            if re.match(r"\w+:", link):
                continue
            number = text.count("\n", 0, match.start()) + 1
            name, _, anchor = link.partition("#")
            target = path.parent / name if name else path
            if not target.exists():
                yield path, number, f"the link {link} leads nowhere"
            elif anchor and target.suffix == ".md" and anchor not in anchors(target.read_text()):
                yield path, number, f"{target.name} has no heading '#{anchor}'"


CHECKS = (check_module_order, check_library_homes, check_calls, check_spdx, check_private_folders, check_links)


def violations(root):
    root = pathlib.Path(root)
    return [f"{path.relative_to(root)}:{number}: {text}" for check in CHECKS for path, number, text in check(root)]


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    found = violations(sys.argv[1])
    print("\n".join(found) if found else "the rules of the architecture are kept")
    sys.exit(1 if found else 0)
