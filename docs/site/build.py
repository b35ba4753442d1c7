#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Builds the documentation site from the Markdown of the project: the command behind `./run docs`.

usage: build.py --program PLIANT --python_path FOLDER --output_path DIR [--installed]

PLIANT prints the manuals of its commands, FOLDER holds the built Python package. Leaves DIR/html (index.html is the
first page), and in DIR/source what Sphinx and Doxygen read. Warnings are errors. --installed: commands call `pliant`,
as who installed the packages does, and not the program of the build tree.

The pages lie in the site as they lie in the project, so that their links hold in both. Pages that are made here: the
options, the notebooks, the list of C++ headers.
"""

import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree

import doxygen_filter

ROOT = pathlib.Path(__file__).resolve().parents[2]
SITE = ROOT / "docs" / "site"
# Other files to which a page links are copied too.
COPIED = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md", "tests/README.md", "web/README.md", "docs", "experiments",
          "examples")
NOT_COPIED = shutil.ignore_patterns("__pycache__", "work", "site", ".snakemake", ".ipynb_checkpoints")
# (heading of the navigation, its pages; a page is a path, or a title with a path)
NAVIGATION = (
    ("Use", (("Getting started", "README"), ("Installation", "docs/building"), "docs/your_own_video",
             "docs/calibration", "docs/troubleshooting", "options/index", "examples/notebooks/README",
             "docs/evaluation", "docs/report", "docs/datasets", "docs/simulation", "docs/tracks", "docs/formats", "docs/exchange",
             "docs/reliability")),
    ("Python and C++", (("Python", "docs/python"), "python_api", ("C++ library", "docs/library"), "cpp_api")),
    ("Understand", ("docs/concepts", "docs/method", "docs/results", "experiments/README", "docs/gallery")),
    ("Develop", ("CONTRIBUTING", "SECURITY", "docs/architecture", "tests/README", ("The report's page", "web/README"),
                 ("All pages", "docs/README"), ("Changes", "CHANGELOG"))),
)


def toctree(pages, caption=""):
    """A table of contents that is not printed: it makes the navigation."""
    lines = [page if isinstance(page, str) else f"{page[0]} <{page[1]}>" for page in pages]
    head = [f":caption: {caption}"] if caption else []
    return "\n".join(["", "```{toctree}", ":hidden:", *head, "", *lines, "```", ""])


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def escaped(text):
    """Text that Markdown prints as it is, but for `code`."""
    parts = re.split(r"(`[^`]+`)", text)
    parts[::2] = [re.sub(r"[\\`*_{}\[\]<>#|~$]", r"\\\g<0>", part) for part in parts[::2]]
    return "".join(parts)


# ---- the options: manuals of the program as pages

def manual(program, *command):
    """The lines of the whole manual: that of --help may leave out options."""
    def printed(flag):
        return subprocess.run([program, *command, flag], stdout=subprocess.PIPE, text=True, check=True).stdout
    text = printed("--help")
    return (printed("--help-all") if "--help-all" in text and command else text).splitlines()


def commands(program):
    """Every command of the program, as a tuple of its words."""
    found = []
    for name in [line.split()[0] for line in manual(program) if re.match(r"  [a-z]+  ", line)]:
        verbs = [re.match(rf"(?:usage:|) *pliant {name} ([a-z]+)", line) for line in manual(program, name)[:-1]]
        verbs = [verb.group(1) for verb in verbs if verb] if "USAGE" not in manual(program, name) else []
        found += [(name, verb) for verb in verbs] or [(name,)]
    return found


def sections(lines):
    """(heading, lines) of a manual."""
    found = []
    for line in lines:
        if re.match(r"[A-Z]", line):
            found.append((line, []))
        elif found:
            found[-1][1].append(line)
    return found


def entries(lines):
    """A list of options: names as terms, their texts as definitions, groups as headings, other lines as paragraphs."""
    out = []
    for line in lines:
        indent = len(line) - len(line.lstrip())
        if line.lstrip().startswith("-") and indent <= 4:
            out += ["", f"`{line.strip()}`"]
        elif indent == 8:
            in_definition = out and out[-1] and not out[-1].startswith("`")
            out.append(("  " if in_definition else ": ") + escaped(line.strip()))
        elif re.match(r"  [A-Z]\w*: ", line):
            name, text = line.strip().split(": ", 1)
            out += ["", f"### {name}", "", escaped(text[:1].upper() + text[1:]) + "."]
        else:
            out.append(escaped(line.strip()))
    return out


def manual_page(lines):
    name, summary = lines[0].split(" - ", 1)
    out = [f"# {name}", "", escaped(summary[:1].upper() + summary[1:]) + "."]
    for heading, body in sections(lines[1:]):
        out += ["", f"## {heading.capitalize()}", ""]
        if heading in ("USAGE", "EXAMPLES"):
            out += ["    " + line.strip() for line in body if line.strip()]
        elif heading == "EXIT CODES":
            out += [f"- `{line.split()[0]}`: {escaped(line.split(None, 1)[1])}" if re.match(r"  \d", line)
                    else "  " + escaped(line.strip()) for line in body if line.strip()]
        else:
            out += entries(body) if heading != "DESCRIPTION" else [escaped(line.strip()) for line in body]
    return "\n".join(out) + "\n"


def write_options(program, source):
    names = []
    table = ["# Commands and options", "", "The manuals that `pliant COMMAND --help` prints; here with all options, as",
             "`--help-all` of the longest ones. `--print_config` prints the options of a command in the form that",
             "`--config FILE` reads.", "", "| command | what it does |",
             "| --- | --- |"]
    for command in commands(program):
        lines = manual(program, *command)
        name = "_".join(command)
        page = re.sub(r"docs/([\w\\]+)\.md", lambda match: f"[{match.group()}](../{match.group()})".replace(
            "\\_", "_"), manual_page(lines))
        write(source / "options" / f"{name}.md", page)
        table.append(f"| [{' '.join(command)}]({name}.md) | {escaped(lines[0].split(' - ', 1)[1])} |")
        names.append(name)
    write(source / "options" / "index.md", "\n".join(table) + "\n" + toctree(names))


# ---- pages made of other files

def write_notebooks(source):
    """A page for every notebook: its text and its code."""
    folder = source / "examples" / "notebooks"
    names = []
    for path in sorted(folder.glob("*.ipynb")):
        parts = []
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            text = "".join(cell["source"])
            parts.append(f"```python\n{text}\n```" if cell["cell_type"] == "code" else links_to_pages(text))
        write(path.with_suffix(".md"), "\n\n".join(parts) + f"\n\n[The notebook itself]({path.name}).\n")
        names.append(path.stem)
    for page in [folder / "README.md", source / "docs" / "python.md", source / "docs" / "tracks.md"]:
        page.write_text(links_to_pages(page.read_text(encoding="utf-8")), encoding="utf-8")
    append(folder / "README.md", toctree(names))


def links_to_pages(text):
    """A text whose links to notebooks lead to their pages."""
    return re.sub(r"\.ipynb\)", ".md)", text)


def append(path, text):
    path.write_text(path.read_text(encoding="utf-8") + text, encoding="utf-8")


def write_experiments(source):
    """The experiments in the navigation, in the order of their table."""
    page = source / "experiments" / "README.md"
    links = re.findall(r"^\| \[[^\]]*\]\(([^)]*)\.md\)", page.read_text(encoding="utf-8"), re.MULTILINE)
    append(page, toctree(links + ["common/README"]))


def first_sentence(header):
    """Of the comment at the top of a header."""
    text = []
    for line in header.read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            break
        if line.startswith("// ") and "SPDX-" not in line:
            text.append(line[3:])
    return re.split(r"(?<!eq)(?<!e\.g)(?<!i\.e)[.:] |:$", " ".join(text))[0].rstrip(".") + "."


def write_cpp_api(source, tags):
    """The headers by module, each with what its first sentence says, linked to Doxygen's pages."""
    pages = {group.findtext("name"): group.findtext("filename")
             for group in xml.etree.ElementTree.parse(tags).iter("compound") if group.get("kind") == "group"}
    out = ["# C++ API", "", '<p><a href="api/cpp/index.html">Reference of the C++ API</a>: every public type and',
           "function, made by Doxygen from the headers.</p>", "",
           "The headers by module, from the lowest to the highest. [Architecture](docs/architecture.md) describes the",
           "modules, [C++ library](docs/library.md) how to use them.", ""]
    for module in re.findall(r"\\defgroup (\w+)", (SITE / "cpp_api.dox").read_text(encoding="utf-8")):
        out += [f"## {module}", "", "| header | content |", "| --- | --- |"]
        for header in sorted((ROOT / "include" / "pliant" / module).rglob("*.h")):
            name, title, _ = doxygen_filter.group_of(header)
            link = f'<a href="api/cpp/{pages[name]}"><code>{title}</code></a>'
            out.append(f"| {link} | {escaped(first_sentence(header))} |")
        out.append("")
    write(source / "cpp_api.md", "\n".join(out))


# ---- the site

def run_doxygen(output, tags):
    shutil.rmtree(output, ignore_errors=True)
    output.mkdir(parents=True)
    config = (SITE / "Doxyfile").read_text(encoding="utf-8") + "\n".join([
        f'OUTPUT_DIRECTORY = "{output}"', f'GENERATE_TAGFILE = "{tags}"',
        f'FILTER_PATTERNS = *.h="{sys.executable} -B -S docs/site/doxygen_filter.py"'])
    result = subprocess.run(["doxygen", "-"], input=config, text=True, cwd=ROOT, check=False)
    if result.returncode:
        sys.exit("build.py: Doxygen has warnings (see above)")


def copy_pages(source):
    shutil.rmtree(source, ignore_errors=True)
    for name in COPIED:
        target = source / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, target, ignore=NOT_COPIED)
        else:
            shutil.copy2(ROOT / name, target)
    shutil.copy2(SITE / "python_api.rst", source)
    # The first page lies in docs/site of the project, and above all pages in the site.
    text = (SITE / "index.md").read_text(encoding="utf-8")
    text = re.sub(r"\]\((?!\w+:|\.\./|#)", "](docs/site/", text)
    text = text.replace("](../../", "](").replace("](../", "](docs/")
    write(source / "index.md", text + "".join(toctree(pages, caption) for caption, pages in NAVIGATION))


def call_installed_program(source):
    for page in source.rglob("*.md"):
        text = re.sub(r"^( {4,})build/release/pliant ", r"\1pliant ", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
        page.write_text(text, encoding="utf-8")


def copy(path, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(path, target)


def copy_linked_files(source, extra):
    """What pages link to: files as downloads; pictures in HTML where their links look for them; folders not at all."""
    for page in source.rglob("*.md"):
        folder = (ROOT / page.relative_to(source)).parent
        text = page.read_text(encoding="utf-8")
        for name in re.findall(r'src(?:set)?="([^":]*)"', text):
            copy(folder / name, extra / page.parent.relative_to(source) / name)
        for link, name in re.findall(r"(\[[^\[\]]*\])\(([^():#]+)\)", text):
            target = pathlib.Path(os.path.normpath(folder / name))
            if target.is_dir():
                text = text.replace(f"{link}({name})", link[1:-1])
            elif target.is_file() and not (page.parent / name).exists():
                copy(target, source / target.relative_to(ROOT))
        page.write_text(text, encoding="utf-8")


def mend_furo(static):
    """Debian's Furo loads a style sheet from the root of a server and a script as the module that it is not: here both
    are put into the files that load them."""
    script, styles = static / "scripts" / "furo.js", static / "styles" / "furo.css"
    text = script.read_text(encoding="utf-8")
    imported = re.match(r'import Gumshoe from "\./(\S+)";', text)
    if imported:
        module = (script.parent / imported.group(1)).read_text(encoding="utf-8")
        script.write_text(module + text[imported.end():], encoding="utf-8")
    text = styles.read_text(encoding="utf-8")
    imported = re.match(r"@import url\((/\S+)\);", text)
    if imported:
        path = pathlib.Path("/usr/share" + imported.group(1))
        rules = path.read_text(encoding="utf-8") if path.is_file() else "body { margin: 0; }"
        styles.write_text(rules + text[imported.end():], encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1].removeprefix("usage: "))
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--python_path", type=pathlib.Path, required=True)
    parser.add_argument("--output_path", type=pathlib.Path, required=True)
    parser.add_argument("--installed", action="store_true")
    given = parser.parse_args()
    output = given.output_path.resolve()
    source, extra, html = output / "source", output / "extra", output / "html"
    copy_pages(source)
    if given.installed:
        call_installed_program(source)
    write_options(given.program.resolve(), source)
    write_notebooks(source)
    write_experiments(source)
    shutil.rmtree(extra, ignore_errors=True)
    copy_linked_files(source, extra)
    tags = output / "cpp_api.tags"
    run_doxygen(extra / "api" / "cpp", tags)
    write_cpp_api(source, tags)
    shutil.rmtree(html, ignore_errors=True)
    environment = {**os.environ, "PYTHONPATH": str(given.python_path.resolve()), "PYTHONDONTWRITEBYTECODE": "1"}
    result = subprocess.run(
        ["sphinx-build", "-q", "-W", "--keep-going", "-b", "html", "-c", str(SITE), "-d", str(output / "doctrees"),
         "-D", f"html_extra_path={extra}", str(source), str(html)], env=environment, check=False)
    if result.returncode:
        sys.exit("build.py: Sphinx has warnings (see above)")
    mend_furo(html / "_static")
    print(f"{len(list(source.rglob('*.md'))) + 1} pages; open {html / 'index.html'} in a browser")


if __name__ == "__main__":
    main()
