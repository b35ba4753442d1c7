#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Is a camera that stands still before a scene that deforms told from one that moves?

    still_camera.py --program build/release/pliant --output_path RESULTS [--only "NAME;..."] [--seed N]

Simulates every scene, tracks it, and prints a table. What is there already is kept.
"""
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "common"))
from scenes import (HOLD, SURFACE, call, depth_errors, frames_with_a_map, scene_arguments, simulated,  # noqa: E402
                    states_of)

FRAMES = "--Trajectory.frames 70"

# name: options of pliant simulate
STILL = {
    "colon, wave of 60 mm": f"{HOLD} --Deformation.amplitude_mm 2.5 --Deformation.wavelength_mm 60",
    "colon, wave of 628 mm": f"{HOLD} --Deformation.amplitude_mm 2.5",
    "colon, breath": f"{HOLD} --Deformation.breathing_mm 2 --Deformation.breathing_period_s 2",
    "surface, wave of 100 mm": f"{HOLD} {SURFACE} --Deformation.amplitude_mm 3 --Deformation.wavelength_mm 100",
    "surface, wave of 200 mm, 5 rad/s": f"{HOLD} {SURFACE} --Deformation.amplitude_mm 5 --Deformation.wavelength_mm 200"
                                        " --Deformation.omega_rad_s 5",
    "surface, poke": f"{HOLD} {SURFACE} --Deformation.poke_mm 8",
    "surface, breath and poke": f"{HOLD} {SURFACE} --Deformation.breathing_mm 4 --Deformation.poke_mm 8",
    "lobes": f"{HOLD} --Scene.kind lobes --Deformation.amplitude_mm 4",
}
MOVING = {
    "colon, insertion at 15 mm/s": "--Deformation.amplitude_mm 2.5",
    "colon, insertion at 6 mm/s": "--Trajectory.speed_mm_s 6 --Deformation.amplitude_mm 2.5",
    "colon, insertion, wave of 60 mm": "--Deformation.amplitude_mm 3 --Deformation.wavelength_mm 60",
    "colon, insertion, breath": "--Deformation.breathing_mm 2",
    "colon, sway of 4 mm": "--Trajectory.kind sway --Trajectory.sway_amplitude_mm 4 --Deformation.amplitude_mm 2.5",
    "surface, sway of 8 mm": f"--Trajectory.kind sway {SURFACE} --Deformation.amplitude_mm 3"
                             " --Deformation.wavelength_mm 150",
    "surface, loop": f"--Trajectory.kind loop {SURFACE} --Deformation.amplitude_mm 3 --Deformation.wavelength_mm 120",
    "lobes, loop": "--Trajectory.kind loop --Scene.kind lobes --Deformation.amplitude_mm 3",
    "surface, tremor of 0.3 mm alone": f"--Trajectory.kind hold {SURFACE} --Deformation.amplitude_mm 4"
                                       " --Deformation.wavelength_mm 100",
    "surface, sway without tremor, breath": f"--Trajectory.kind sway --Trajectory.tremor_mm 0 {SURFACE}"
                                            " --Deformation.breathing_mm 2",
}


def ratios(log):
    """The evidence of every map and of every reference that was given up for it."""
    found = re.findall(r"stands still the errors (?:would be|are) ([0-9]+[.][0-9]{2}) times", log)
    return ", ".join(sorted(set(found), key=found.index))


def row(kind, name, options, arguments):
    sequence = simulated(arguments, f"{kind} {name}", f"{FRAMES} {options}")
    run = arguments.output_path / "runs" / sequence.name
    log = run.with_suffix(".log")
    if not log.exists():
        run.parent.mkdir(parents=True, exist_ok=True)
        tracked = call(arguments.program, "track", "--image_path", sequence, "-o", run)
        log.write_text(tracked.stdout + tracked.stderr)
    states = states_of(run)
    with_map = frames_with_a_map(states)
    errors = depth_errors(arguments.program, run, sequence) if with_map else ["", ""]
    return [kind, name, str(with_map), str(states["ambiguous"]), str(states["initializing"]), ratios(log.read_text()),
            *errors]


def main():
    arguments = scene_arguments(__doc__)
    print("| camera | scene | with a map | ambiguous | initializing | still by moving | depth error | null |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for kind, scenes in (("still", STILL), ("moving", MOVING)):
        for name, options in scenes.items():
            if not arguments.only or name in arguments.only.split(";"):
                print("| " + " | ".join(row(kind, name, options, arguments)) + " |", flush=True)


if __name__ == "__main__":
    main()
