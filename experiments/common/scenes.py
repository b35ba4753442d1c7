# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulated scenes of the experiments that are scripts: the options they share, and what became of their runs."""
import csv
import json
import subprocess
from collections import Counter

HOLD = "--Trajectory.kind hold --Trajectory.tremor_mm 0 --Trajectory.tremor_deg 0"  # of pliant simulate
SURFACE = "--Scene.kind surface"


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
