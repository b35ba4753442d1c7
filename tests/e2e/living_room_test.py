#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A recording of a rigid room, reconstructed by COLMAP from its own features and tracked by Pliant: one camera path.

usage: living_room_test.py PLIANT RECORDINGS WORK

Skipped (exit code 77) where there is no COLMAP or no folder living_room in RECORDINGS.
"""

import importlib.util
import json
import pathlib
import shutil
import subprocess
import sys

SKIPPED = 77
ROOT = pathlib.Path(__file__).resolve().parents[2]
FRAMES = 30
SHARE_OF_PATH = 0.01  # of the length of COLMAP's path, which is no truth to better than that
PLIANT, RECORDINGS, WORK = (pathlib.Path(argument) for argument in sys.argv[1:4])


def run(*arguments):
    done = subprocess.run([str(argument) for argument in arguments], text=True, errors="replace", stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)
    assert done.returncode == 0, f"{' '.join(map(str, arguments))} ended with {done.returncode}:\n{done.stdout[-2000:]}"
    return done.stdout


def make_sequence():
    sequence = WORK / "sequence"
    for name in ("images", "depth"):
        (sequence / name).mkdir(parents=True)
        for path in sorted((RECORDINGS / "living_room" / name).iterdir())[:FRAMES]:
            shutil.copy(path, sequence / name)
    shutil.copy(RECORDINGS / "living_room/camera.yaml", sequence)
    return sequence


def main():
    if shutil.which("colmap") is None or importlib.util.find_spec("yaml") is None:
        print("skipped: no COLMAP, or Python has no yaml")
        return SKIPPED
    if not (RECORDINGS / "living_room").is_dir():
        print(f"skipped: no living_room in {RECORDINGS}")
        return SKIPPED
    shutil.rmtree(WORK, ignore_errors=True)
    sequence = make_sequence()
    for method in ("depth", "window"):
        run(PLIANT, "track", "--image_path", sequence, "--output_path", WORK / method, "--Init.method", method, "--quiet")
    run(sys.executable, "-B", ROOT / "experiments/rigid_baseline/colmap_pipeline.py", "sift", "--run", WORK / "depth",
        "--sequence", sequence, "--output_path", WORK / "rigid", "--pliant", PLIANT)
    model = WORK / "rigid/colmap" / json.loads((WORK / "rigid/colmap/pipeline.json").read_text())["model"]

    assert "error" not in run(PLIANT, "model", "check", model)
    run(PLIANT, "model", "convert", "--input_path", model, "--output_path", WORK / "again", "--format", "binary")
    for name in ("cameras.bin", "images.bin", "points3D.bin"):
        assert (model / name).read_bytes() == (WORK / "again" / name).read_bytes(), name

    # COLMAP's path as the truth: ours lies within 1 % of its length after a similarity.
    run(PLIANT, "import", "--input_path", model, "--sequence", sequence, "--as", "truth", "--output_path", sequence)
    for method in ("depth", "window"):
        run(PLIANT, "evaluate", "--run", WORK / method, "--sequence", sequence, "--parts", "camera", "--output_path",
            WORK / f"{method}_evaluated", "--quiet")
        path = json.loads((WORK / f"{method}_evaluated/evaluation.json").read_text())["trajectory"]
        share = path["ate_rmse_mm"] / path["true_path_length_mm"]
        print(f"{method}: {path['poses']} poses, ATE {100 * share:.2f} % of COLMAP's path")
        assert path["poses"] == FRAMES and share < SHARE_OF_PATH
    return 0


if __name__ == "__main__":
    sys.exit(main())
