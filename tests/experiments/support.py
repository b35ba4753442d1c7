# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the experiments share."""

import csv
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
ROUND_OFF = 1e-9  # of figures with a few digits before the point
PAPER_RMSE_MM = 1.77  # of the cell that TINY has
MIN_PLOT_BYTES = 10000  # an empty plot is smaller
# One cell, 12 frames of 160x120 of a coarse scene, and none that was rendered for another experiment. The method's own
# start finds no map in so few; an oracle's does.
TINY = ["--config", "sets=dm", "cells=2.5:2.5", "seeds=1", "frames=12", "sequences=nowhere", "variants=default,oracle_all",
        "simulate_options=--Camera.width 160 --Camera.height 120 --Scene.mesh_step_mm 0.8 --Scene.view_mm 120 "
        "--Texture.texel_mm 0.3 --Texture.smallest_mm 0.8"]


def experiment_modules(*names):
    """Makes the modules of these experiments, and what all of them share, importable."""
    sys.path[:0] = [str(ROOT / "experiments" / name) for name in ("common", *names)]


def need(*programs):
    missing = [program for program in programs if shutil.which(program) is None]
    if missing:
        print(f"skipped: {', '.join(missing)} not found")
        sys.exit(SKIPPED)


def snakemake(experiment, folder, *arguments, **environment):
    result = subprocess.run(
        ["snakemake", "--snakefile", str(ROOT / "experiments" / experiment / "Snakefile"), "--directory", str(folder),
         "--cores", "2", *arguments],
        env={**os.environ, "PLIANT_PROGRAM": os.path.abspath(sys.argv[2]), "XDG_CACHE_HOME": str(folder / "cache"),
             **environment},
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    assert result.returncode == 0, result.stdout
    return result.stdout


def check_tiny_grid(folder):
    with open(folder / "figures.csv", newline="", encoding="utf-8") as file:
        none, oracle = csv.DictReader(file)
    assert none["variant"] == "default" and none["status"] == "failed" and none["rmse_mm"] == "", none
    assert oracle["variant"] == "oracle_all" and oracle["frames_tracked"] == "12", oracle
    assert 0 < float(oracle["rmse_mm"]) < PAPER_RMSE_MM, oracle  # everything is true
    lines = (folder / "table.md").read_text(encoding="utf-8").splitlines()
    overview = next(line for line in lines if line.startswith("| 2.5 | 2.5 | 1.77 |"))
    assert overview == f"| 2.5 | 2.5 | 1.77 | - | {float(oracle['rmse_mm']):.2f} |", overview


def main(*tests):
    """Runs the one that the command line names, in a folder of its own."""
    test = {test.__name__: test for test in tests}[sys.argv[1]]
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for part in ("colon", "regularizers", "initialization", "baseline", "cache", "grid"):
            (folder / part).mkdir()
        test(folder)
    print("passed")
