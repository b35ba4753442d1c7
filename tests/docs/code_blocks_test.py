# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The code blocks of the documentation, and the messages that docs/troubleshooting.md quotes.

usage: code_blocks_test.py commands|python|messages ROOT PLIANT

commands: the program knows every command, flag and option of the shell lines. python: every Python block compiles.
messages: the source has every message. Each check is also shown to find what is wrong in a page made for it.
"""

import functools
import pathlib
import re
import subprocess
import sys

PAGES = ("README.md", "CONTRIBUTING.md", "docs/**/*.md", "examples/**/*.md", "experiments/**/*.md", "tests/*.md",
         "web/*.md")
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FEWEST = {"commands": 40, "python": 10, "messages": 30}  # that are there to be checked


def pages(root):
    for pattern in PAGES:
        for path in sorted(root.glob(pattern)):
            if "work" not in path.relative_to(root).parts:
                yield path


def shell_lines(text):
    """(line number, command) of the indented blocks and those that are marked as shell; continued lines are joined."""
    def blank(match):
        mark = "    " if match.group(1) in ("sh", "bash", "shell", "console") else "| "
        return "\n" + "".join(mark + line + "\n" for line in match.group(2).splitlines())
    joined, number = "", 0
    for current, line in enumerate(FENCE.sub(blank, text).splitlines(), 1):
        if not line.startswith("    "):
            continue
        number = number if joined else current
        joined += line.strip()
        if joined.endswith("\\"):
            joined = joined[:-1]
            continue
        yield number, re.sub(r"(^|\s)#\s.*", "", joined)
        joined = ""


class Manuals:
    """What the program knows, from the manuals that it prints."""

    def __init__(self, program):
        self.program = program

    @functools.lru_cache(maxsize=None)
    def text(self, *command):
        """The whole manual: that of --help may leave out options. None: there is no such command."""
        for flag in ("--help-all", "--help"):
            result = subprocess.run([self.program, *command, flag], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                    text=True, check=False)
            if result.returncode == 0:
                return result.stdout
        return None

    def complaints(self, line):
        """What is wrong with the calls of the program in a shell line."""
        for call in re.findall(r"(?:^|[\s;|(/])pliant ((?:[a-z]+)(?: [^;|&]*)?)", line):
            words = call.split()
            command = words[:2] if words[0] in ("dataset", "model") else words[:1]
            manual = self.text(*command)
            if manual is None:
                yield f"there is no command 'pliant {' '.join(command)}'"
                continue
            for flag in re.findall(r"(?<=\s)(--?[A-Za-z][\w.]*)", call):
                if flag in ("--help", "--help-all", "--version"):
                    continue
                if not re.search(rf"(?:^|[\s,\[]){re.escape(flag)}(?![\w.])", manual):
                    yield f"'pliant {' '.join(command)}' does not know {flag}"


def check_commands(text, manuals):
    """(number of commands, complaints)"""
    lines = [(number, line) for number, line in shell_lines(text) if re.search(r"(^|[\s/])pliant [a-z]", line)]
    return len(lines), [f"{number}: {complaint}" for number, line in lines for complaint in manuals.complaints(line)]


def check_python(text):
    blocks = [match for match in FENCE.finditer(text) if match.group(1) in ("python", "py")]
    wrong = []
    for block in blocks:
        first = text.count("\n", 0, block.start(2))
        try:
            compile("\n" * first + block.group(2), "page", "exec")
        except SyntaxError as error:
            wrong.append(f"{error.lineno}: {error.msg}")
    return len(blocks), wrong


def sentences(root):
    """The texts of the program: every source file with the literals that continue over lines joined."""
    paths = sorted((root / "src").rglob("*.cc"))
    return [re.sub(r'"\s*\n\s*"', "", path.read_text(encoding="utf-8")) for path in paths]


def check_messages(text, sources):
    """Messages stand in **`...`**; three dots are what differs from one run to another."""
    messages = list(re.finditer(r"\*\*`([^`]+)`\*\*", text))
    wrong = []
    for message in messages:
        parts = [part.strip(" ',;?") for part in message.group(1).split("...")]
        for part in [part for part in parts if len(part) > 3]:
            if not any(part in source for source in sources):
                wrong.append(f"{text.count(chr(10), 0, message.start()) + 1}: the program does not say '{part}'")
    return len(messages), wrong


def finds_what_is_wrong(check, page, expected):
    number, wrong = check(page)
    if len(wrong) != expected or number == 0:
        sys.exit(f"of {expected} errors in\n{page}\nwere found: {wrong}")


def main(what, root, program):
    if what == "commands":
        manuals = Manuals(program)
        check = functools.partial(check_commands, manuals=manuals)
        finds_what_is_wrong(check, "    pliant trak --image_path x\n    build/release/pliant track --no_flag 1 \\\n"
                                   "        -o run --Growth.grow off --Growth.no_option 1  # pliant track --comment\n"
                                   "```sh\npliant dataset inf x\n```\n", 4)
    elif what == "python":
        check = check_python
        finds_what_is_wrong(check, "```python\nfor x in y\n```\n```python\nx = 1\n```\n", 1)
    else:
        check = functools.partial(check_messages, sources=sentences(root))
        finds_what_is_wrong(check, "**`there is no option --...`** **`it never says this ...`**\n", 1)
    found, wrong = 0, []
    for path in pages(root) if what != "messages" else [root / "docs" / "troubleshooting.md"]:
        number, complaints = check(path.read_text(encoding="utf-8"))
        found += number
        wrong += [f"{path.relative_to(root)}:{complaint}" for complaint in complaints]
    if found < FEWEST[what]:
        wrong.append(f"only {found} {what} were found, expected were at least {FEWEST[what]}")
    print("\n".join(wrong) if wrong else f"{found} {what}: nothing is wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3] if len(sys.argv) > 3 else ""))
