#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What depth images of a network add, and what they spoil.

    depth_prior.py --program build/release/pliant --output_path RESULTS [--only "NAME;..."] [--seed N]

Simulates every scene, makes depth images with a network's errors (degrade.py), tracks with and without them, and
prints two tables. What is there already is kept.
"""
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "common"))
from degrade import degrade  # noqa: E402
from scenes import (HOLD, SURFACE, call, depth_errors, frames_with_a_map, scene_arguments, simulated,  # noqa: E402
                    slug, states_of)

STILL_FRAMES = "--Trajectory.frames 70"
# name: options of pliant simulate
STILL = {
    "colon, wave of 628 mm": f"{HOLD} --Deformation.amplitude_mm 2.5",
    "colon, breath": f"{HOLD} --Deformation.breathing_mm 2 --Deformation.breathing_period_s 2",
    "surface, wave of 200 mm, 5 rad/s": f"{HOLD} {SURFACE} --Deformation.amplitude_mm 5 --Deformation.wavelength_mm 200"
                                        " --Deformation.omega_rad_s 5",
    "surface, breath and poke": f"{HOLD} {SURFACE} --Deformation.breathing_mm 4 --Deformation.poke_mm 8",
    "lobes": f"{HOLD} --Scene.kind lobes --Deformation.amplitude_mm 4",
}
DM = "--Deformation.wavelength_mm 628.3185307179587 --Trajectory.speed_mm_s 15"
HARD = "--Deformation.wavelength_mm 104.71975511965977 --Trajectory.speed_mm_s 8"
MOVING = {f"{name}, {a}:{omega}": f"{options} --Deformation.amplitude_mm {a} --Deformation.omega_rad_s {omega}"
          for name, options in (("dm", DM), ("hard", HARD)) for a, omega in ((2.5, 2.5), (5, 2.5), (5, 5), (10, 5))}
# name: options of pliant track, and whether the prior is there
STILL_TRACKS = {
    "default": ("", False),
    "from the prior": ("--Init.method depth_prior --Tracking.camera_motion none", True),
}
MOVING_TRACKS = {
    "light": ("", False),
    "light and prior": ("", True),
    "neither": ("--WindowInit.light off", False),
    "prior": ("--WindowInit.light off", True),
}


class Bench:
    def __init__(self, arguments):
        self.arguments = arguments

    def sequence(self, kind, name, options):
        folder = simulated(self.arguments, f"{kind} {name}", options)
        if not (folder / "prior").exists():
            degrade(folder, folder / "prior", self.arguments.seed)
        return folder

    def track(self, sequence, variant, options, with_prior):
        """Frames with a map, depth error and null in per cent, RMSE in mm."""
        run = self.arguments.output_path / "runs" / sequence.name / slug(variant)
        if not (run / "run.json").exists():
            run.parent.mkdir(parents=True, exist_ok=True)
            prior = ["--depth_prior", sequence / "prior"] if with_prior else []
            tracked = call(self.arguments.program, "track", "--quiet", "--image_path", sequence, "-o", run, *prior,
                           *options.split())
            if not (run / "run.json").exists():
                raise SystemExit(tracked.stderr)
        frames = frames_with_a_map(states_of(run))
        if frames == 0:
            return [str(frames), "", "", ""]
        errors = depth_errors(self.arguments.program, run, sequence)
        surface = json.loads((run / "evaluation" / "evaluation.json").read_text())["surface"]
        return [str(frames), *errors, f"{surface['estimate']['mean_rmse_mm']:.2f}"]

    def table(self, kind, scenes, variants, frames=""):
        columns = [f"{name}: {what}" for name in variants for what in ("frames", "depth error", "null", "RMSE, mm")]
        print(f"\n| {kind} | " + " | ".join(columns) + " |")
        print("| --- |" + " --- |" * len(columns))
        for name, options in scenes.items():
            if self.arguments.only and name not in self.arguments.only.split(";"):
                continue
            sequence = self.sequence(kind, name, f"{options} {frames}")
            cells = [cell for variant, (track, prior) in variants.items()
                     for cell in self.track(sequence, variant, track, prior)]
            print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


def main():
    bench = Bench(scene_arguments(__doc__))
    bench.table("camera that stands still", STILL, STILL_TRACKS, STILL_FRAMES)
    bench.table("moving camera", MOVING, MOVING_TRACKS, "--Trajectory.frames 100")


if __name__ == "__main__":
    main()
