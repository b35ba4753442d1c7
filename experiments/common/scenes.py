# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulated scenes of the experiments that are scripts: the options they share, and what became of their runs."""
import argparse
import csv
import json
import re
import subprocess
from collections import Counter
from pathlib import Path

HOLD = "--Trajectory.kind hold --Trajectory.tremor_mm 0 --Trajectory.tremor_deg 0"  # of pliant simulate
SURFACE = "--Scene.kind surface"


def scene_arguments(description):
    """Of a script that simulates scenes and tracks them."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--output_path", type=Path, required=True)
    parser.add_argument("--only", default="", help="scenes, separated by ';'")
    parser.add_argument("--seed", type=int, default=1, help="of the scenes")
    return parser.parse_args()


def slug(text):
    return re.sub(r"[^a-z0-9]+", "_", text.lower())


def simulated(arguments, name, options):
    """The folder of a scene's sequence, which is simulated unless it is there."""
    folder = arguments.output_path / "sequences" / f"{slug(name)}_{arguments.seed}"
    if not (folder / "simulation.yaml").exists():
        call(arguments.program, "simulate", "--quiet", "--overwrite", "-o", folder, "--Scene.seed", arguments.seed,
             *options.split()).check_returncode()
    return folder


def call(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)


def states_of(run):
    """How many frames of a run are in each state."""
    with open(run / "frames.csv", newline="", encoding="utf-8") as stream:
        return Counter(row["state"] for row in csv.DictReader(stream))


def frames_with_a_map(states):
    return states["tracking"] + states["provisional"]


def depth_errors(program, run, sequence):
    """The depth error of a run that has a map, and its null, as per cents."""
    call(program, "evaluate", "--run", run, "--sequence", sequence, "-o", run / "evaluation")
    surface = json.loads((run / "evaluation" / "evaluation.json").read_text())["surface"]
    return [f"{100 * surface[which]['median_relative_depth']:.1f} %" for which in ("estimate", "null")]
