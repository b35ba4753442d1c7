#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shows Doxygen the comments of a header: prints the header with its ordinary `//` comments as Doxygen's.

usage: doxygen_filter.py HEADER

- a header is a group of its module's group: the comment at its top (after the license) describes it, and its page has
  all that it declares (else Doxygen has one page for all functions of the namespace),
- a comment directly above a declaration describes it, and the overloads that directly follow,
- a comment behind a declaration, with the lines below that continue it, describes the declaration.
Comments in function bodies and initializers, and those with an empty line below, stay as they are. Indented lines are
formulas or tables and are kept as written. Equations and pages of docs/ are linked. Every line stays on its line.
"""

import pathlib
import re
import sys

COMMENT = re.compile(r"^(\s*)//(?: (.*)|)$")
CODE = re.compile(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'')
NO_DECLARATION = re.compile(r"^\s*(?:$|[}#]|(?:public|protected|private):|using namespace)")
FUNCTION = re.compile(r"\b(operator\S+|\w+)\(")
LIST_ITEM = re.compile(r"(?:-|\d+\.) ")
EQUATION = re.compile(r"\b[A-Z]\d{1,2}\b")  # of docs/method.md
TYPE = re.compile(r"\b(?:struct|class|union|enum)\b")


def without_strings(line):
    """The line with the characters of its texts replaced, of the same length."""
    return CODE.sub(lambda match: "~" * len(match.group()), line)


def comment_column(line):
    """Where the `//` comment of a line begins, -1 without one."""
    return without_strings(line).find("//")


def escaped(text):
    """Text that Doxygen prints as it is, but for `code`."""
    text = re.sub(r"[\\@#$%]", r"\\\g<0>", text).replace("--", r"\--")
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    text = re.sub(r"\b(eqs?|e\.g|i\.e|cf|vs|no)\. ", r"\1.\\ ", text)  # no end of the first sentence
    text = re.sub(r"`([^`]+)`", r"<code>\1</code>", text)
    text = re.sub(r"docs/(\w+)\.md\b", r'<a href="../../docs/\1.html">docs/\1.md</a>', text)
    return EQUATION.sub(r'<a href="../../docs/method.html#\g<0>">\g<0></a>', text) if "eq" in text else text


def documented(texts, mark):
    """Doxygen's comment of these lines, each with the mark before it."""
    lines, in_list, preformatted = [], False, False
    for number, text in enumerate(texts):
        indent = len(text) - len(text.lstrip())
        if LIST_ITEM.match(text):
            in_list = True
        elif indent == 0:
            in_list = False
        if indent >= 2 and not in_list:
            following = texts[number + 1] if number + 1 < len(texts) else ""
            start = "" if preformatted else r"\verbatim "
            preformatted = following.startswith("  ")
            lines.append(f"{mark} {start}{text}" + ("" if preformatted else r" \endverbatim"))
        else:
            lines.append(f"{mark} {escaped(text)}".rstrip())
    return lines


class Scopes:
    """Which braces are open: those of namespaces and types, in which declarations are documented, or others."""

    def __init__(self):
        self.open, self.head = [], ""

    def read(self, code):
        if code.lstrip().startswith("#"):
            return
        for character in without_strings(code):
            if character == "{":
                is_scope = re.search(r"\bnamespace\b|\bextern\b", self.head) or (
                    TYPE.search(re.sub(r"<[^<>]*>", "", self.head)) and not re.search("[(=]", self.head))
                self.open.append(bool(is_scope))
            elif character == "}" and self.open:
                self.open.pop()
            self.head = "" if character in "{};" else self.head + character

    def documents(self):
        return all(self.open)


def function_name(line):
    match = FUNCTION.search(without_strings(line))
    return match.group(1) if match else None


def group_of(path):
    """(name, title, module) of the group of a header in include/pliant."""
    parts = pathlib.PurePath(path).with_suffix("").parts
    parts = parts[parts.index("pliant") + 1:] if "pliant" in parts else parts
    return "__".join(parts), "/".join(parts[1:] or parts) + ".h", parts[0]


def grouped(lines, path):
    """The filtered lines with the commands of the header's group in place of the license and around the namespace's
    contents."""
    name, title, module = group_of(path)
    begin = next((k for k, line in enumerate(lines) if line.startswith("namespace pliant")), None)
    if begin is None or lines[begin + 1] or "SPDX-" not in lines[0] or lines[2] != r"/// \file":
        return lines
    end = max(k for k, line in enumerate(lines) if line.startswith("}"))
    lines[begin:begin + 2] = [rf"{lines[begin]} /** \addtogroup {name}", r" * \{ */"]
    lines[end] = r"/** \} */ " + lines[end]
    return [rf"/// \defgroup {name} {title}", rf"/// \ingroup {module}", "///", *lines[3:]]


def filtered(text, path=""):
    lines, out, scopes = text.split("\n"), [], Scopes()
    behind = -1         # column of the comment that this line may continue
    overloads = None    # (name of the last documented function, its comment on one line)
    seen_file_comment = False
    number = 0
    while number < len(lines):
        line = lines[number]
        if not COMMENT.match(line):
            column = comment_column(line)
            code = line if column < 0 else line[:column]
            name = function_name(code)
            begins = scopes.head.strip() == "" and scopes.documents() and code.strip() != ""
            if begins and overloads and overloads[0] == name and not out[-1].lstrip().startswith("///"):
                code = f"/** {overloads[1]} */ {code}"
            elif begins or not code.strip():
                overloads = overloads if begins and overloads and overloads[0] == name else None
            scopes.read(line if column < 0 else line[:column])
            behind = -1
            if column < 0:
                out.append(code)
            elif not scopes.documents() or NO_DECLARATION.match(code):
                out.append(line)
            elif code.rstrip().endswith("{"):
                out.append(f"/** {escaped(line[column + 2:].strip())} */ {code.rstrip()}")
            else:
                behind = column
                out.append(f"{code}///< {escaped(line[column + 2:].strip())}")
            number += 1
            continue
        if behind >= 0 and line.index("//") == behind:
            out.append(f"{line[:behind]}///< {escaped(line[behind + 2:].strip())}")
            number += 1
            continue
        behind, end = -1, number
        while end < len(lines) and COMMENT.match(lines[end]):
            end += 1
        texts = [COMMENT.match(comment).group(2) or "" for comment in lines[number:end]]
        indent = COMMENT.match(line).group(1)
        following = lines[end] if end < len(lines) else ""
        if "SPDX-" in texts[0]:
            out += lines[number:end]
        elif not seen_file_comment and not any(done.strip() and "SPDX-" not in done for done in out):
            seen_file_comment = True
            comment = documented(texts, "///")
            if out and not out[-1]:
                out[-1] = r"/// \file"
            out += comment
        elif NO_DECLARATION.match(following) or not scopes.documents():
            out += lines[number:end]
        else:
            comment = documented(texts, indent + "///")
            out += comment
            name = function_name(following)
            overloads = (name, " ".join(escaped(text) for text in texts)) if name else None
        number = end
    return "\n".join(grouped(out, path) if path else out)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        sys.stdout.write(filtered(file.read(), sys.argv[1]))
