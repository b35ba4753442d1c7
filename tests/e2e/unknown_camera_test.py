#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A rigid sequence is tracked with a field of view that is wrong, and refinement finds the focal length, and the
distortion where there is one.

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
DISTORTION = -0.25
DISTORTION_ERROR = 0.01
DISTORTED_ERROR = 0.005  # of the focal length, relative
SHARE_OF_NULL = 0.05  # of the refined surface's error, by that of one constant depth


def run(*arguments):
    done = subprocess.run([str(argument) for argument in arguments], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)
    assert done.returncode == 0, f"{' '.join(map(str, arguments))} ended with {done.returncode}:\n{done.stdout[-2000:]}"
    return done.stdout


def params(camera):
    return [float(number) for number in re.search(r"params: \[([^]]+)", camera.read_text())[1].split(",")]


def check(name, sequence, distortion):
    """Tracks and refines it, and returns what `refine` said."""
    assumed, refined, evaluation = (WORK / f"{name}_{what}" for what in ("assumed", "refined", "evaluation"))
    said = run(PLIANT, "track", sequence, "--camera", "unknown", "--fov_deg", FOV_DEG, "-o", assumed)
    assert "The camera is not calibrated" in said, said
    said = run(PLIANT, "refine", "--run", assumed, "-o", refined)
    found = re.search(r"focal length ([\d.]+) \+- ([\d.]+) px", said)
    assert found, said
    estimate, sigma = float(found[1]), float(found[2])
    truth = params(sequence / "camera.yaml")[0]
    assert 0 < sigma < 0.05 * truth, said
    # Patches of distorted images drift together, which the standard deviation does not know of.
    assert abs(estimate - truth) < (DISTORTED_ERROR * truth if distortion else SIGMAS * sigma), (truth, said)
    written = params(refined / "camera.yaml")
    assert abs(written[0] - estimate) < 0.1
    if distortion:
        assert "distortion k" in said, said
        assert abs(written[-1] - distortion) < DISTORTION_ERROR, (distortion, said)
    else:
        assert "distortion" not in said, said
    run(PLIANT, "evaluate", "--run", refined, "--sequence", sequence, "--Evaluation.camera", "any", "-o", evaluation)
    surface = json.loads((evaluation / "evaluation.json").read_text())["surface"]
    error, null = (surface[which]["mean_rmse_mm"] for which in ("estimate", "null"))
    assert error < SHARE_OF_NULL * null, (error, null)
    # Later commands find the estimated camera.
    assert json.loads((refined / "run.json").read_text())["camera"] == str((refined / "camera.yaml").resolve())
    run(PLIANT, "report", "--run", refined, "-o", WORK / f"{name}.html")
    print(f"{name}: {written}, is {params(sequence / 'camera.yaml')}; error {error:.2f} mm of {null:.1f} mm")


def main():
    shutil.rmtree(WORK, ignore_errors=True)
    check("straight", SEQUENCE, 0)
    distorted = WORK / "sequence"
    run(PLIANT, "simulate", "-o", distorted, "--Trajectory.frames", 60, "--Camera.model", "SIMPLE_RADIAL",
        "--Camera.params", f"457,319.5,239.5,{DISTORTION}", "--quiet")
    check("distorted", distorted, DISTORTION)


if __name__ == "__main__":
    main()
