#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs Pliant on a published benchmark and prints its figures beside the published ones.

usage: benchmarks.py NAME [--data DIR] [--output_path DIR] [--pliant PROGRAM] [--only SEQUENCE ...] [--camera FILE]
                     [--track OPTIONS] [--surface OPTIONS] [--evaluate OPTIONS] [--splits FILE] [--runs SYSTEM=DIR ...]

NAME is a file of third_party_configs/datasets/benchmarks: sequences, options, figures, published numbers and where they
were read. Without --data, the published numbers alone are printed. A step that is done is not repeated unless its
command has changed. Sequences that are not in --data are left out and named. --runs evaluates the runs (or results) of
another system in the same way: DIR holds one folder a sequence, named as in --output_path. Needs PyYAML, and OpenCV for
labels that are images.

Ends with 0; with 1 and one sentence if nothing can be run; and with 3 if a sequence that is there could not be.
"""

import argparse
import csv
import json
import math
import pathlib
import re
import shlex
import shutil
import statistics
import subprocess
import sys

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "experiments/common"))
import grid
import labels
import windows

PROTOCOLS = ROOT / "third_party_configs/datasets/benchmarks"
IMAGES = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff"}
STEPS = ["track", "surface", "evaluate", "export", "score", "score3d"]
COULD_NOT_RUN = 3
UNLIKE_LABELS = "pixels are not those of the labels"  # what pliant track says of STIR's pairs that are not rectified


class Failure(Exception):
    """What went wrong, in one sentence."""


class Sequence:
    """One row of the table: a folder, or a part of it, and the frames whose depth is compared."""

    def __init__(self, name, path, start=None, end=None, frames=None, depth_frames=None):
        self.name, self.path, self.start, self.end = name, pathlib.Path(path), start, end
        self.frames, self.depth_frames = frames, depth_frames
        self.slug = re.sub(r"[^\w.-]+", "_", name).strip("_")

    def part(self):
        return [item for option, value in (("--start", self.start), ("--end", self.end)) if value is not None
                for item in (option, str(value))]


def read_protocol(name):
    path = PROTOCOLS / f"{name}.yaml"
    if not path.is_file():
        known = ", ".join(sorted(other.stem for other in PROTOCOLS.glob("*.yaml")))
        raise Failure(f"there is no benchmark '{name}', but {known}")
    return yaml.safe_load(path.read_text(encoding="utf-8"))


# Sequences.

def sequences_of(protocol, data, splits=None):
    """(those that are there, the names of those that are not)."""
    data = pathlib.Path(data)
    if not data.is_dir():
        raise Failure(f"--data: {data} is not a folder")
    if protocol["sequences"] == "folders":
        folders = folders_of(protocol, data)
        found = [part for folder in folders for part in parts(protocol, data, folder, splits)]
        missing = [] if found else [f"any folder with {marker(protocol)}"]
        if "labels" in protocol:
            missing += [f"{sequence.name} (no labels)" for sequence in found if not is_labelled(protocol, sequence)]
            found = [sequence for sequence in found if is_labelled(protocol, sequence)]
    else:
        found, missing = [], []
        for name, entry in protocol["sequences"].items():
            path = next((data / other for other in [name, *entry.get("also", [])] if (data / other).is_dir()), None)
            if path is None:
                missing.append(name)
                continue
            first = protocol.get("depth_frames_from", 0)
            depth_frames = [frame - first for frame in entry["depth_frames"]] if "depth_frames" in entry else None
            found.append(Sequence(name, path, entry.get("start"), entry.get("end"), entry.get("frames"), depth_frames))
    return found, missing


def marker(protocol):
    return protocol.get("folder_has") or protocol["view"]["images"]


def folders_of(protocol, data):
    """Those with the marker: where the protocol says that sequences lie, or up to two levels deep."""
    if "folders" in protocol:
        return sorted(path for path in data.glob(protocol["folders"]) if (path / marker(protocol)).exists())
    name = marker(protocol)
    return sorted(path.parent for pattern in (name, f"*/{name}", f"*/*/{name}") for path in data.glob(pattern))


def parts(protocol, data, folder, splits):
    """The folder, or the parts of it that the list of splits in it names."""
    name = folder.relative_to(data).as_posix() if folder != data else folder.name
    columns = protocol.get("splits")
    path = folder / (splits or columns["file"]) if columns else None
    if path is None or not path.is_file():
        return [Sequence(name, folder)]
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    try:
        spans = [(int(float(row[columns["start"]])), int(float(row[columns["end"]]))) for row in rows]
    except (KeyError, TypeError, ValueError):
        raise Failure(f"{path} needs the columns {columns['start']} and {columns['end']}, with frame numbers") from None
    return [Sequence(f"{name} {start} to {end}", folder, start, end, end - start) for start, end in spans]


# A native sequence of links, for a folder that no reader recognizes.

def make_view(view, source, folder, camera):
    images = source / view["images"]
    names = sorted(path.name for path in images.iterdir() if path.suffix.lower() in IMAGES) if images.is_dir() else []
    if not names:
        raise Failure(f"{images} has no images")
    poses = source / view["poses"]
    lines = trajectory_of(poses) if poses.is_file() else []
    if lines and len(lines) != len(names):
        raise Failure(f"{poses} has {len(lines)} poses for {len(names)} images")
    if folder.exists():
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    (folder / "images").symlink_to(images.resolve(), target_is_directory=True)
    shutil.copyfile(camera, folder / "camera.yaml")
    if lines:
        (folder / "groundtruth.txt").write_text("".join(lines), encoding="utf-8")


def trajectory_of(path):
    """TUM lines of one 4x4 matrix a line, world_from_camera, by rows or by columns: where the zeros are tells."""
    lines = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        words = line.replace(",", " ").split()
        if not words:
            continue
        try:
            values = [float(word) for word in words]
        except ValueError:
            values = []
        if len(values) != 16:
            raise Failure(f"{path}, line {number}: 16 numbers are needed")
        by_rows = [values[4 * row:4 * row + 4] for row in range(4)]
        by_columns = [list(column) for column in zip(*by_rows)]
        matrix = next((m for m in (by_columns, by_rows) if is_last_row(m[3])), None)
        if matrix is None:
            raise Failure(f"{path}, line {number}: not the matrix of a pose")
        q = quaternion(matrix)
        lines.append(f"{len(lines)} " + " ".join(f"{v:.9g}" for v in [row[3] for row in matrix[:3]] + q) + "\n")
    return lines


def is_last_row(row):
    return max(abs(a - b) for a, b in zip(row, (0, 0, 0, 1))) < 1e-6


def quaternion(m):
    """[x, y, z, w] of the rotation in `m`: the largest of the four components first, so that none is lost."""
    squares = [1 + m[0][0] - m[1][1] - m[2][2], 1 - m[0][0] + m[1][1] - m[2][2], 1 - m[0][0] - m[1][1] + m[2][2],
               1 + m[0][0] + m[1][1] + m[2][2]]
    i = max(range(4), key=lambda k: squares[k])
    rows = [[squares[0], m[0][1] + m[1][0], m[0][2] + m[2][0], m[2][1] - m[1][2]],
            [m[0][1] + m[1][0], squares[1], m[1][2] + m[2][1], m[0][2] - m[2][0]],
            [m[0][2] + m[2][0], m[1][2] + m[2][1], squares[2], m[1][0] - m[0][1]],
            [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], squares[3]]]
    length = math.sqrt(sum(v * v for v in rows[i]))
    return [v / length for v in rows[i]]


def is_labelled(protocol, sequence):
    try:
        return all(labels.pixels(sequence.path / end["image"]) for end in protocol["labels"].values())
    except ImportError:
        raise Failure("labels are images, for which Python needs OpenCV (python3-opencv)") from None


# Runs.

class Runner:
    """The commands of one benchmark, each with its log and what it was called with."""

    def __init__(self, protocol, arguments):
        self.protocol, self.arguments = protocol, arguments
        self.output = pathlib.Path(arguments.output_path)
        self.camera = self.camera_file()
        if shutil.which(arguments.pliant) is None:
            raise Failure(f"--pliant: {arguments.pliant} is not a program; build it first")

    def camera_file(self):
        if self.arguments.camera:
            if not pathlib.Path(self.arguments.camera).is_file():
                raise Failure(f"--camera: there is no file {self.arguments.camera}")
            return pathlib.Path(self.arguments.camera)
        named = self.protocol.get("camera")
        if named == "given":
            raise Failure("this benchmark publishes no calibration: give one with --camera")
        return (PROTOCOLS / named).resolve() if named else None

    def options(self, step):
        """The benchmark's, and those of the command line; of an option in both, the latter."""
        given = shlex.split(getattr(self.arguments, step))
        names = {word.partition("=")[0] for word in given}
        pairs = zip(*[iter(map(str, self.protocol.get(step, [])))] * 2)
        return [word for pair in pairs if pair[0] not in names for word in pair] + given

    def step(self, name, folder, leaves, command):
        """Runs `command` unless it left the file `leaves` when it was called last; what it says goes to a log."""
        command = [self.arguments.pliant, *map(str, command)]
        record = folder / f"{name}.json"
        if (folder / leaves).is_file() and record.is_file() and json.loads(record.read_text()) == command:
            return
        # What is made of a run is as old as the run.
        for later in STEPS[STEPS.index(name):] if name in STEPS else [name]:
            (folder / f"{later}.json").unlink(missing_ok=True)
        if (folder / leaves).parent.is_dir():
            shutil.rmtree((folder / leaves).parent)
        folder.mkdir(parents=True, exist_ok=True)
        try:
            result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        except OSError as error:
            raise Failure(f"{self.arguments.pliant} cannot be run: {error.strerror}") from None
        (folder / f"{name}.log").write_text(result.stdout, encoding="utf-8")
        if not (folder / leaves).is_file():
            said = result.stdout.strip().splitlines()
            last_words = said[-1] if said else "it said nothing"
            raise Failure(f"pliant {command[1]} ended with {result.returncode}: {last_words}")
        record.write_text(json.dumps(command))

    def source(self, sequence):
        """(the path to read, its options)."""
        if "view" in self.protocol:
            view = self.output / "sequences" / sequence.slug
            make_view(self.protocol["view"], sequence.path, view, self.camera)
            return view, []
        return sequence.path, ["--camera", self.camera] if self.camera else []

    def run(self, sequence):
        """Tracks and evaluates; the figures of the run."""
        folder = self.output / "runs" / sequence.slug
        path, camera = self.source(sequence)
        self.step("track", folder, "run/run.json",
                  ["track", "--image_path", path, *camera, *sequence.part(), "--output_path", folder / "run",
                   "--log_level", "warning", *self.options("track")])
        summary = json.loads((folder / "run/run.json").read_text(encoding="utf-8"))
        figures = {"sequence": sequence.name, "run": summary}
        if summary["counts"]["frames_tracked"] == 0:
            return figures
        if "labels" in self.protocol:
            if UNLIKE_LABELS in (folder / "track.log").read_text(encoding="utf-8"):
                raise Failure("the images were rectified, and its labels are of those before")
            return figures | self.labelled_points(sequence, folder, folder / "run")
        surface = []
        frames = self.depth_frames(sequence, summary)
        if frames:
            self.step("surface", folder, "surface/surface.json",
                      ["surface", "--run", folder / "run", "--output_path", folder / "surface", "--quiet",
                       "--frames", ",".join(map(str, frames)), *self.options("surface")])
            surface = ["--surface", folder / "surface"]
        figures = self.evaluate(folder, folder / "run", path, camera, surface) | figures
        if self.protocol.get("windows"):
            figures["windows"] = self.windows(folder, path, camera, sequence)
        return figures

    def labelled_points(self, sequence, folder, run):
        """How near the points that are labelled in the first frame come to those that are labelled in the last one, in
        the image, and in space where both eyes' labels say where that is: {"points": ..., "points_3d": ...}."""
        folder.mkdir(parents=True, exist_ok=True)
        files = {}
        for end, names in self.protocol["labels"].items():
            for suffix, points in (("", labels.pixels(sequence.path / names["image"])),
                                   ("3d", labels.positions(sequence.path, names["image"], names["infrared"]))):
                files[end + suffix] = folder / f"labels{suffix}_{end}.json" if points else None
                if points:
                    files[end + suffix].write_text(json.dumps({sequence.name: points}), encoding="utf-8")
        self.step("export", folder, "points/positions.json",
                  ["export", "--run", run, "--format", "stir", "--Export.start_points", files["start"],
                   "--Export.recording", sequence.name, "--output_path", folder / "points", "--quiet"])
        figures = {}
        for key, suffix in (("points", ""), ("points_3d", "3d")):
            tracked = folder / f"points/positions{suffix}.json"
            if not (tracked.is_file() and files["start" + suffix] and files["end" + suffix]):
                continue
            self.step(f"score{suffix}", folder, f"score{suffix}/stir.json",
                      ["evaluate", "--stir", tracked, "--stir_start", files["start" + suffix],
                       "--stir_end", files["end" + suffix], "--output_path", folder / f"score{suffix}", "--quiet"])
            figures[key] = json.loads((folder / f"score{suffix}/stir.json").read_text(encoding="utf-8"))
        return figures

    def windows(self, folder, path, camera, sequence):
        """The error of the camera in windows of five frames. One frame is converted for the axes of the rectified
        camera."""
        first = sequence.start or 0
        self.step("first_frame", folder, "first_frame/groundtruth.txt",
                  ["dataset", "convert", path, *camera, "--start", first, "--end", first + 1, "--quiet",
                   "--output_path", folder / "first_frame"])
        words = (folder / "first_frame/groundtruth.txt").read_text(encoding="utf-8").split()
        counts = json.loads((folder / "run/run.json").read_text(encoding="utf-8"))["counts"]
        truth = windows.true_poses(path, windows.pose_of(words[1:8]), first, first + counts["frames_read"])
        return windows.figures(windows.poses_of_run(folder / "run"), truth)

    def depth_frames(self, sequence, summary):
        if "surface" not in self.protocol:
            return []
        if sequence.depth_frames is not None:
            return sequence.depth_frames
        first, every = sequence.start or 0, self.protocol["depth_frames"]["every"]
        return list(range(first, first + summary["counts"]["frames_read"], every))

    def evaluate(self, folder, run, path, camera, surface):
        self.step("evaluate", folder, "evaluation/evaluation.json",
                  ["evaluate", "--run", run, "--sequence", path, *camera, *surface, "--quiet",
                   "--output_path", folder / "evaluation", *self.options("evaluate")])
        return json.loads((folder / "evaluation/evaluation.json").read_text(encoding="utf-8"))

    def evaluate_other(self, system, runs, sequence):
        """The figures of another system's run; None where it has none of this sequence."""
        run = next((folder for folder in (runs / sequence.slug / "run", runs / sequence.slug) if folder.is_dir()), None)
        if run is None:
            return None
        folder = self.output / "others" / re.sub(r"[^\w.-]+", "_", system) / sequence.slug
        path, camera = self.source(sequence)
        for step in ("evaluate", "export", "score", "score3d"):
            (folder / f"{step}.json").unlink(missing_ok=True)  # nobody says whether the run is still the same
        if "labels" in self.protocol:
            return {"sequence": sequence.name} | self.labelled_points(sequence, folder, run)
        return self.evaluate(folder, run, path, camera, []) | {"sequence": sequence.name}


# Tables.

def figure(figures, metric):
    """The figure of a metric, as printed; None where there is none."""
    if metric.get("sequence", figures["sequence"]) != figures["sequence"]:
        return None
    keys = metric.get("figure", "").split("/")
    if keys[0] == "survival" and not (figures.get("survival") or {}).get("tracks"):
        return None  # of points: there are none in a camera path alone, and without a map
    value = figures
    for key in keys:
        value = value.get(key) if isinstance(value, dict) else None
    return None if value is None else metric.get("factor", 1) * value


def mean_text(protocol, metric, rows):
    """Mean and standard deviation over the sequences, or the mean over what the metric, or else the protocol, names as
    its weight: the id of another metric, or "sequences"."""
    named = metric.get("weight", protocol.get("mean_weight", "sequences"))
    weight = next((m for m in protocol["metrics"] if m["id"] == named), None)
    values = [(figure(row, metric), figure(row, weight) if weight else 1) for row in rows
              if figure(row, metric) is not None]
    if not values or sum(w for _, w in values) == 0:
        return "-"
    if metric is weight:
        return grid.number(sum(value for value, _ in values), metric["digits"])
    mean = sum(value * w for value, w in values) / sum(w for _, w in values)
    text = grid.number(mean, metric["digits"])
    if weight is None and len(values) > 1:
        text += f" ± {grid.number(statistics.pstdev(value for value, _ in values), metric['digits'])}"
    return text


def summary_table(protocol, measured, total):
    """Systems that were evaluated here, [(name, input, rows)], then the published ones."""
    metrics = protocol["metrics"]
    header = ["system", "input", *(metric["heading"] for metric in metrics), "sequences", "source"]
    rows = []
    for system, given, figures in measured:
        mapped = [row for row in figures if any(figure(row, metric) is not None for metric in metrics)]
        rows.append([system, given, *(mean_text(protocol, metric, mapped) for metric in metrics),
                     f"{len(mapped)} of {total}", "here"])
    for row in protocol["reported"]:
        values = [row["values"].get(metric["id"], "-") for metric in metrics]
        rows.append([row["system"], row["input"], *values, "all", row["source"]])
    return grid.markdown(header, rows)


def sequence_table(protocol, rows):
    header = ["sequence", "frames", "tracked", *(metric["heading"] for metric in protocol["metrics"])]
    return grid.markdown(header, [
        [sequence.name, figures["run"]["counts"]["frames_read"], figures["run"]["counts"]["frames_tracked"],
         *("-" if figure(figures, metric) is None else grid.number(figure(figures, metric), metric["digits"])
           for metric in protocol["metrics"])] for sequence, figures in rows])


def notes(protocol, rows, missing, failed):
    lines = []
    for sequence, figures in rows:
        counts = figures["run"]["counts"]
        if counts["frames_tracked"] == 0:
            lines.append(f"{sequence.name}: no map ({figures['run']['note']}).")
        if sequence.frames is not None and counts["frames_read"] != sequence.frames:
            lines.append(f"{sequence.name}: {counts['frames_read']} frames were read, {sequence.frames} are published.")
    lines += [f"{name}: {sentence}." for name, sentence in failed]
    if missing:
        lines.append(f"Not in the data, and left out: {', '.join(missing)}.")
    return lines


def report(protocol, rows=(), others=(), missing=(), failed=(), total=0):
    measured = [("Pliant", "images", [figures for _, figures in rows])] if rows else []
    sections = [f"# {protocol['title']}"]
    if measured or others or protocol["reported"]:
        sections.append(summary_table(protocol, [*measured, *others], total).rstrip())
    if not protocol["reported"]:
        sections.append(f"No published numbers: {protocol['none_reported'].strip()}")
    if protocol.get("differences"):
        sections.append(f"Differences: {protocol['differences'].strip()}")
    if rows:
        sections.append(sequence_table(protocol, rows).rstrip())
    sections += notes(protocol, rows, missing, failed)
    sections += [f"{heading}: {protocol[key].strip()}"
                 for heading, key in (("Verified", "verified"), ("Not verified", "not_verified"))]
    return "\n\n".join(sections) + "\n"


def run_all(protocol, arguments):
    """(the report, whether every sequence that is there could be run)."""
    others = [(system, pathlib.Path(runs)) for system, _, runs in (text.partition("=") for text in arguments.runs)]
    for system, runs in others:
        if not runs.name or not runs.is_dir():
            raise Failure(f"--runs is SYSTEM=DIR with a folder of runs, not '{system}={runs}'")
    runner = Runner(protocol, arguments)
    found, missing = sequences_of(protocol, arguments.data, arguments.splits)
    names = [*(sequence.name for sequence in found), *missing]
    total = len(names)
    if arguments.only:
        unknown = [name for name in arguments.only if name not in names]
        if unknown:
            raise Failure(f"--only: '{unknown[0]}' is not one of {', '.join(names)}")
        found = [sequence for sequence in found if sequence.name in arguments.only]
        missing = [name for name in missing if name in arguments.only]
    if not found:
        raise Failure(f"{arguments.data} has none of the sequences of '{arguments.name}': {', '.join(missing[:3])}"
                      f"{', ...' if len(missing) > 3 else ''}")
    rows, failed, figures_of_others = [], [], {system: [] for system, _ in others}
    for sequence in found:
        print(f"{sequence.name} ...", file=sys.stderr, flush=True)
        try:
            rows.append((sequence, runner.run(sequence)))
            for system, runs in others:
                figures = runner.evaluate_other(system, runs, sequence)
                if figures is None:
                    failed.append((sequence.name, f"no run of {system}"))
                else:
                    figures_of_others[system].append(figures)
        except Failure as failure:
            failed.append((sequence.name, str(failure)))
    measured = [(system, "-", figures) for system, figures in figures_of_others.items()]
    return report(protocol, rows, measured, missing, failed, total), not failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name")
    parser.add_argument("--data", help="folder that holds the folders of the sequences")
    parser.add_argument("--output_path", help="runs, logs and table.md (default: benchmark_NAME)")
    parser.add_argument("--pliant", default=str(ROOT / "build/release/pliant"))
    parser.add_argument("--only", nargs="+", metavar="SEQUENCE", help="these sequences alone")
    parser.add_argument("--camera", help="calibration, instead of the published one")
    for step in ("track", "surface", "evaluate"):
        parser.add_argument(f"--{step}", default="", metavar="OPTIONS", help=f"more options of pliant {step}")
    parser.add_argument("--splits", help="another list of parts, by its name in the folders (StereoMIS: scenarios.csv)")
    parser.add_argument("--runs", action="append", default=[], metavar="SYSTEM=DIR", help="another system's runs")
    arguments = parser.parse_args()
    try:
        protocol = read_protocol(arguments.name)
        if arguments.data is None:
            print(report(protocol), end="")
            return 0
        arguments.output_path = arguments.output_path or f"benchmark_{arguments.name}"
        text, complete = run_all(protocol, arguments)
        (pathlib.Path(arguments.output_path) / "table.md").write_text(text, encoding="utf-8")
    except Failure as failure:
        print(f"benchmarks.py: {failure}", file=sys.stderr)
        return 1
    print(text, end="")
    return 0 if complete else COULD_NOT_RUN


if __name__ == "__main__":
    sys.exit(main())
