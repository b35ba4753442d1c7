# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What must hold whatever happens to the program: how it ends, what it says, and what it leaves on disk."""

import json
import pathlib
import xml.etree.ElementTree
import zipfile

MOST_CHARACTERS = 400
CRASHES = {-4: "SIGILL", -6: "SIGABRT", -7: "SIGBUS", -8: "SIGFPE", -11: "SIGSEGV", -25: "SIGXFSZ", -31: "SIGSYS"}


def wrong_end(code, stderr, stopped_by=None, stdout=""):
    """What is wrong with an end; "" where nothing is. `stopped_by`: the signal that was sent, or None; `stdout`: where
    a check lists what it found."""
    if code in CRASHES:
        return f"died of {CRASHES[code]}"
    if stopped_by is not None and code == -stopped_by:
        return ""  # before its handlers were there, or of SIGKILL
    if code not in (0, 1, 2):
        return f"ended with exit code {code}"
    said = [line for line in stderr.splitlines() if line.startswith("pliant")]
    if code != 0 and not said and not stdout.strip():
        return "failed without a sentence"
    longest = max((len(line) for line in said), default=0)
    if longest > MOST_CHARACTERS:
        return f"a message of {longest} characters"
    if "terminate called" in stderr or "OpenCV(" in stderr or "Assertion" in stderr:
        return "a library's own message"
    return ""


def wrong_file(path):
    """What is wrong with a file that has its final name; "" where nothing is."""
    data = path.read_bytes()
    suffix = path.suffix
    if suffix == ".json" and not _is_json(data):
        return "no JSON"
    if suffix == ".pdf" and not data.rstrip().endswith(b"%%EOF"):
        return "a PDF without its end"
    if suffix == ".svg" and not _is_xml(data):
        return "no XML"
    if suffix == ".png" and not data.endswith(b"IEND\xaeB`\x82"):
        return "a PNG without its end"
    if suffix == ".html" and b"</html>" not in data[-200:]:
        return "a page without its end"
    if suffix in (".npz", ".zip") and not zipfile.is_zipfile(path):
        return "no zip archive"
    if suffix == ".mp4" and b"moov" not in data:
        return "a film without its index"
    if suffix == ".ply":
        return _wrong_ply(data)
    if suffix == ".yaml" and data and not data.endswith(b"\n"):
        return "YAML that breaks off"
    return ""


def wrong_files(folder):
    """Of all files below `folder`, "NAME: what". Rows that are appended (.csv, .txt) may break off, and so may what is
    marked as unfinished, and what a killed film left under its own name, .part."""
    wrong = []
    for path in sorted(pathlib.Path(folder).rglob("*")):
        unfinished = any((above / ".unfinished").exists() for above in path.parents)
        if not path.is_file() or path.is_symlink() or unfinished or path.stem.endswith(".part"):
            continue
        what = wrong_file(path)
        if what:
            wrong.append(f"{path.name}: {what}")
    return wrong


def _is_json(data):
    try:
        json.loads(data)
        return True
    except ValueError:
        return False


def _is_xml(data):
    try:
        xml.etree.ElementTree.fromstring(data)
        return True
    except xml.etree.ElementTree.ParseError:
        return False


def _wrong_ply(data):
    head, found, body = data.partition(b"end_header\n")
    if not found:
        return "a PLY without its header"
    if b"format binary" not in head:
        return ""
    sizes = {b"char": 1, b"uchar": 1, b"short": 2, b"ushort": 2, b"int": 4, b"uint": 4, b"float": 4, b"double": 8,
             b"int8": 1, b"uint8": 1, b"int16": 2, b"uint16": 2, b"int32": 4, b"uint32": 4, b"float32": 4, b"float64": 8}
    needed, count, has_list = 0, 0, False
    for line in head.splitlines():
        words = line.split()
        if words[:1] == [b"element"]:
            count = int(words[2])
        elif words[:2] == [b"property", b"list"]:
            has_list = True
            needed += count * sizes[words[2]]
        elif words[:1] == [b"property"]:
            needed += count * sizes[words[1]]
    return "" if (len(body) >= needed if has_list else len(body) == needed) else "a PLY whose data break off"


def differing_runs(one, other):
    """In which files two run folders differ; command line and paths in run.json do not count."""
    names = {path.relative_to(folder) for folder in (one, other) for path in folder.rglob("*") if path.is_file()}
    differing = []
    for name in sorted(names):
        if not (one / name).exists() or not (other / name).exists():
            differing.append(f"{name} is in one run only")
            continue
        data = [(folder / name).read_bytes() for folder in (one, other)]
        if name.name == "run.json":
            data = [{**json.loads(text), "command_line": None, "input": None} for text in data]
        if data[0] != data[1]:
            differing.append(f"{name} differs")
    return differing
