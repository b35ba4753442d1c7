#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""COLMAP's reconstruction of a sequence that Pliant tracked, as a run beside Pliant's.

usage: colmap_pipeline.py PIPELINE --run RUN --sequence SEQ --output_path DIR [--pliant PROGRAM] [--colmap PROGRAM]
                          [--threads N]

PIPELINE is one of third_party_configs/colmap/pipelines.yaml: sift, tracks, sift_global, tracks_global. RUN, of Pliant on
SEQ, says which calibration to use and, for `tracks`, what to reconstruct from. Leaves in DIR, which is replaced: the run
(as `pliant import` makes it, of the model with the most images), and colmap/ with database, models/0, 1, ..., a log a
command, and pipeline.json (versions, commands, seconds). Ends with 1 and one sentence when a command fails; where COLMAP finds no
model, the run is one of status `failed`.
"""

import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
PIPELINES = ROOT / "third_party_configs/colmap/pipelines.yaml"
# What each command is told of where things are.
PATHS = {"feature_extractor": ("database_path", "image_path"), "sequential_matcher": ("database_path",),
         "mapper": ("database_path", "image_path", "output_path"),
         "global_mapper": ("database_path", "image_path", "output_path")}
MAPPERS = ("mapper", "global_mapper")


class Failure(Exception):
    """One sentence for the person who asked."""


class Colmap:
    """The program that is installed, with its version and its commands."""

    def __init__(self, program):
        self.program = program
        try:
            done = subprocess.run([program, "help"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        except OSError as error:
            raise Failure(f"cannot run COLMAP ('{program}'): {error.strerror}; install it, or name it with --colmap") from error
        found = re.search(r"COLMAP (\d+)\.(\d+)", done.stdout)
        if not found:
            raise Failure(f"'{program} help' does not say COLMAP's version; is it COLMAP?")
        self.version = (int(found[1]), int(found[2]))
        self.commands = done.stdout.split()

    def option(self, name, renamed):
        """The name that this version has for an option."""
        change = renamed.get(name)
        since = tuple(map(int, change["since"].split("."))) if change else None
        return change["to"] if change and self.version >= since else name

    def steps(self, pipeline, configuration, values):
        """[(command, [argument, ...])] of a pipeline, without the paths."""
        steps = []
        for command, options in configuration["pipelines"][pipeline].items():
            if command not in self.commands:
                raise Failure(f"COLMAP {self.version[0]}.{self.version[1]} has no {command}, which the pipeline '{pipeline}' needs")
            arguments = []
            for name, value in options.items():
                arguments += [f"--{self.option(name, configuration['renamed'])}", str(value).format(**values)]
            steps.append((command, arguments))
        return steps


def camera_of(run):
    """Model and parameters of the run's camera, in COLMAP's words: half a pixel is in them already."""
    path = run / "sparse/cameras.txt"
    try:
        lines = [line.split() for line in path.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    except OSError as error:
        raise Failure(f"cannot read {path}: {error.strerror}; give a run of Pliant that ended with a map") from error
    return lines[0][1], ",".join(lines[0][4:])


def last_line(log):
    lines = [line.strip() for line in log.read_text(encoding="utf-8", errors="replace").splitlines() if line.strip()]
    return lines[-1] if lines else "it said nothing"


def run_step(name, command, log):
    """Seconds that it took; all that it says goes to `log`."""
    begin = time.monotonic()
    with open(log, "w", encoding="utf-8") as file:
        file.write(" ".join(map(str, command)) + "\n")
        file.flush()
        done = subprocess.run(list(map(str, command)), stdout=file, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                              env={**os.environ, "QT_QPA_PLATFORM": "offscreen"}, check=False)
    if done.returncode != 0:
        raise Failure(f"{name} ended with {done.returncode}: {last_line(log)} (all that it said: {log})")
    return time.monotonic() - begin


def number_of_images(model):
    return int.from_bytes((model / "images.bin").read_bytes()[:8], "little")


def models_in(folder):
    """Those that are whole, the one with the most images first."""
    models = [path for path in sorted(folder.iterdir()) if (path / "images.bin").exists()]
    return sorted(models, key=number_of_images, reverse=True)


def reconstruct(pipeline, run, images, work, colmap, pliant, threads):
    """What pipeline.json says; `model` is the largest model in `work`, or None."""
    configuration = yaml.safe_load(PIPELINES.read_text(encoding="utf-8"))
    if pipeline not in configuration["pipelines"]:
        raise Failure(f"there is no pipeline '{pipeline}', but {', '.join(configuration['pipelines'])}")
    model, params = camera_of(run)
    steps = colmap.steps(pipeline, configuration, {"camera_model": model, "camera_params": params, "threads": threads})
    paths = {"database_path": work / "database.db", "image_path": images, "output_path": work / "models"}
    paths["output_path"].mkdir(parents=True)
    report = {"pipeline": pipeline, "colmap": ".".join(map(str, colmap.version)), "seconds": {}, "model": None}
    if steps[0][0] in MAPPERS:
        report["seconds"]["export"] = run_step("pliant export", [pliant, "export", "--run", run, "--format", "database",
                                                                 "--output_path", work, "--quiet"], work / "export.log")
    for command, arguments in steps:
        where = [text for name in PATHS[command] for text in (f"--{name}", paths[name])]
        log = work / f"{command}.log"
        begin = time.monotonic()
        try:
            run_step(f"COLMAP's {command}", [colmap.program, command, *where, *arguments], log)
        except Failure:
            # A mapper that finds nothing to begin with ends with an error too.
            if command not in MAPPERS or not re.search("failed to create sparse model|No good initial image pair", log.read_text(errors="replace")):
                raise
        report["seconds"][command] = time.monotonic() - begin
    models = models_in(paths["output_path"])
    if models:
        report |= {"model": models[0].relative_to(work).as_posix(), "models": len(models), "images": number_of_images(models[0])}
    return report


def write_run_without_a_model(output, frames, seconds):
    """What an evaluation finds of a reconstruction that never came to be."""
    summary = {"status": "failed", "note": "COLMAP found no first pair of images to begin with",
               "counts": {"frames_read": frames, "frames_tracked": 0},
               "timings": {"total_s": seconds, "frames_per_second": 0}}
    (output / "run.json").write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")


def make_run(pipeline, run, sequence, output, colmap="colmap", pliant=ROOT / "build/release/pliant", threads=2):
    """The whole of it: see the top of this file."""
    program = Colmap(colmap)
    images = sequence / "images" if (sequence / "images").is_dir() else sequence
    if not images.is_dir():
        raise Failure(f"there is no folder of images at {sequence}, which COLMAP needs (of a video, write its frames out)")
    shutil.rmtree(output, ignore_errors=True)
    beside = output.with_name(output.name + ".colmap")
    shutil.rmtree(beside, ignore_errors=True)
    beside.mkdir(parents=True)
    report = reconstruct(pipeline, run, images, beside, program, pliant, threads)
    seconds = sum(report["seconds"].values())
    if report["model"] is None:
        output.mkdir(parents=True)
        write_run_without_a_model(output, len(list(images.iterdir())), seconds)
    else:
        run_step("pliant import", [pliant, "import", "--input_path", beside / report["model"], "--sequence", sequence, "--output_path",
                                   output, "--Import.seconds", f"{seconds:.3f}", "--quiet"], beside / "import.log")
    (beside / "pipeline.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    beside.rename(output / "colmap")
    return report


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("pipeline")
    for name in ("run", "sequence", "output_path"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    parser.add_argument("--pliant", type=pathlib.Path, default=ROOT / "build/release/pliant")
    parser.add_argument("--colmap", default="colmap")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    given = parser.parse_args()
    try:
        report = make_run(given.pipeline, given.run, given.sequence, given.output_path, given.colmap, given.pliant, given.threads)
    except Failure as failure:
        print(f"colmap_pipeline.py: {failure}", file=sys.stderr)
        return 1
    print(f"{report.get('images', 0)} images in {given.output_path}, {sum(report['seconds'].values()):.1f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
