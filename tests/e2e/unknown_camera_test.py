#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A rigid sequence is tracked with a field of view that is wrong, and refinement finds the focal length.

usage: unknown_camera_test.py PLIANT SEQUENCE WORK
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys

PLIANT, SEQUENCE, WORK = (pathlib.Path(argument) for argument in sys.argv[1:4])
FOV_DEG = 90  # the camera has 70
SIGMAS = 4
SHARE_OF_NULL = 0.05  # of the refined surface's error, by that of one constant depth


def run(*arguments):
    done = subprocess.run([str(argument) for argument in arguments], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)
    assert done.returncode == 0, f"{' '.join(map(str, arguments))} ended with {done.returncode}:\n{done.stdout[-2000:]}"
    return done.stdout


def focal_length(camera):
    return float(re.search(r"params: \[([\d.]+)", camera.read_text())[1])


def main():
    shutil.rmtree(WORK, ignore_errors=True)
    assumed, refined = WORK / "assumed", WORK / "refined"
    said = run(PLIANT, "track", SEQUENCE, "--camera", "unknown", "--fov_deg", FOV_DEG, "-o", assumed)
    assert "The camera is not calibrated" in said, said
    said = run(PLIANT, "refine", "--run", assumed, "-o", refined)
    found = re.search(r"focal length ([\d.]+) \+- ([\d.]+) px", said)
    assert found, said
    estimate, sigma = float(found[1]), float(found[2])
    truth = focal_length(SEQUENCE / "camera.yaml")
    assert 0 < sigma < 0.05 * truth, said
    assert abs(estimate - truth) < SIGMAS * sigma, (truth, said)
    assert abs(focal_length(refined / "camera.yaml") - estimate) < 0.1
    run(PLIANT, "evaluate", "--run", refined, "--sequence", SEQUENCE, "--Evaluation.camera", "any", "-o", WORK / "evaluation")
    surface = json.loads((WORK / "evaluation" / "evaluation.json").read_text())["surface"]
    error, null = (surface[which]["mean_rmse_mm"] for which in ("estimate", "null"))
    assert error < SHARE_OF_NULL * null, (error, null)
    # Later commands find the estimated camera.
    assert json.loads((refined / "run.json").read_text())["camera"] == str((refined / "camera.yaml").resolve())
    run(PLIANT, "report", "--run", refined, "-o", WORK / "report.html")
    print(f"focal length {estimate} +- {sigma} px, is {truth:.1f} px; error {error:.2f} mm of {null:.1f} mm")


if __name__ == "__main__":
    main()
