# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What must hold whatever happens to the program: how it ends, what it says, and what it leaves on disk."""

import csv
import json
import math
import pathlib
import re
import struct
import xml.etree.ElementTree
import zipfile

MOST_CHARACTERS = 400
STATES = {"waiting_for_reference", "initializing", "ambiguous", "tracking", "provisional", "lost"}  # docs/formats.md
NO_NUMBER = re.compile(r"(?<![\w.])[-+]?(nan|inf|infinity)(?![\w.])", re.IGNORECASE)
# Those of Ceres are what fail_calls.cc says in its place.
LIBRARIES_WORDS = ["terminate called", "OpenCV(", "Assertion", "std::bad_alloc", "a fault that was asked for"]
CRASHES = {-4: "SIGILL", -6: "SIGABRT", -7: "SIGBUS", -8: "SIGFPE", -11: "SIGSEGV", -25: "SIGXFSZ", -31: "SIGSYS"}
PLY_TYPES = {b"char": "b", b"uchar": "B", b"short": "h", b"ushort": "H", b"int": "i", b"uint": "I", b"float": "f",
             b"double": "d", b"int8": "b", b"uint8": "B", b"int16": "h", b"uint16": "H", b"int32": "i", b"uint32": "I",
             b"float32": "f", b"float64": "d"}


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
    if any(words in stderr for words in LIBRARIES_WORDS):
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


def _ply_elements(head):
    """Of each element its number and the types of its properties; b"list" of one with a list."""
    elements = []
    for words in (line.split() for line in head.splitlines()):
        if words[:1] == [b"element"]:
            elements.append((int(words[2]), []))
        elif words[:1] == [b"property"]:
            elements[-1][1].extend(words[1:3] if words[1] == b"list" else words[1:2])
    return elements


def _wrong_ply(data):
    head, found, body = data.partition(b"end_header\n")
    if not found:
        return "a PLY without its header"
    if b"format binary" not in head:
        return ""
    needed, has_list = 0, False
    for count, types in _ply_elements(head):
        has_list = has_list or b"list" in types
        needed += count * sum(struct.calcsize(PLY_TYPES[name]) for name in types if name != b"list")
    return "" if (len(body) >= needed if has_list else len(body) == needed) else "a PLY whose data break off"


def _has_numbers(data):
    """Whether all numbers of the elements up to the first one with a list are finite."""
    head, _, body = data.partition(b"end_header\n")
    if b"format binary" not in head:
        return not NO_NUMBER.search(body.decode("utf-8", errors="replace"))
    for count, types in _ply_elements(head):
        if b"list" in types:
            break
        row = struct.Struct("<" + "".join(PLY_TYPES[name] for name in types))
        rows, body = body[:count * row.size], body[count * row.size:]
        if not all(math.isfinite(value) for values in row.iter_unpack(rows) for value in values):
            return False
    return True


def _rotations(lines, first):
    """Whether the four words from the `first` of each line are a quaternion of unit length, up to its digits."""
    quaternions = [[float(word) for word in line.split()[first:first + 4]] for line in lines]
    return all(abs(math.hypot(*quaternion) - 1) < 1e-6 for quaternion in quaternions)


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


def _wrong_numbers(path):
    """What is wrong with the numbers in one file of a run."""
    if path.suffix == ".ply":
        return [] if _has_numbers(path.read_bytes()) else ["not a number"]
    if path.suffix not in (".txt", ".csv", ".json"):
        return []
    text = path.read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    wrong = [found[0]] if (found := NO_NUMBER.search(text)) else []
    if path.name == "trajectory.txt":
        wrong += [] if _rotations(lines, 4) else ["no rotation"]
    elif path.name == "images.txt":
        wrong += [] if _rotations(lines[::2], 1) else ["no rotation"]
    elif path.name == "frames.csv":
        states = {row["state"] for row in csv.DictReader(lines)}
        wrong += [f"state {state}" for state in sorted(states - STATES)]
    elif path.name == "observations.csv" and len(lines) > 1:
        wrong += [] if any(float(row["z"]) for row in csv.DictReader(lines)) else ["all points are at depth 0"]
    return wrong


def _wrong_count(folder):
    """Whether each tracked frame has a pose."""
    trajectory, frames = folder / "trajectory.txt", folder / "frames.csv"
    if not trajectory.exists() or not frames.exists():
        return []
    poses = sum(not line.startswith("#") for line in trajectory.read_text(encoding="utf-8").splitlines())
    with open(frames, newline="", encoding="utf-8") as rows:
        tracked = sum(row["state"] in ("tracking", "provisional") for row in csv.DictReader(rows))
    return [] if poses == tracked else [f"trajectory.txt: {poses} poses of {tracked} tracked frames"]


def wrong_run(path):
    """What is wrong with the numbers of a run that has ended, or of what was made of one (a file or a folder), "NAME:
    what"."""
    path = pathlib.Path(path)
    wrong = []
    for file in [path] if path.is_file() else sorted(path.rglob("*")):
        try:
            wrong += [f"{file.name}: {what}" for what in _wrong_numbers(file)] if file.is_file() else []
        except (ValueError, KeyError, IndexError, TypeError, struct.error) as error:
            wrong.append(f"{file.name}: {error!r}")
    return wrong + (_wrong_count(path) if not wrong else [])
