#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What do default options give in scenes that nobody has chosen?

    random_scenes.py --program build/release/pliant --output_path RESULTS [--first N] [--scenes N]

Draws scenes, camera paths, deformations, cameras and sensors at random, each from its number alone, simulates them as
the preset `endoscope` records them, tracks them with default options, and prints a table and a summary. What is there
already is kept.
"""
import argparse
import json
import random
import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "common"))
from scenes import HOLD, call, frames_with_a_map, states_of  # noqa: E402

FRAMES = 120
ATTEMPTS = 20  # a camera that runs into the wall is drawn again


def log_uniform(draw, low, high):
    return low * (high / low) ** draw.random()


def option(name, value):
    return f"--{name} {value:.4g}" if isinstance(value, float) else f"--{name} {value}"


def scene_of(draw):
    """A scene's name, its options, and whether its camera moves."""
    kind = draw.choices(("colon", "surface", "lobes"), (5, 4, 1))[0]
    path = draw.choices(("insert", "sway", "loop", "hold", "still"), (5, 4, 2, 2, 3))[0]
    motion = draw.choices(("rigid", "wave", "breath", "poke"), (2, 5, 3, 2))[0]
    if path == "still" and motion == "rigid":
        motion = "breath"
    options = [option("Scene.kind", kind), option("Trajectory.frames", FRAMES)]
    options.append(option("Trajectory.fps", draw.choice((15, 25, 30))))
    if path == "still":
        options.append(HOLD)
    else:
        options += [option("Trajectory.kind", path), option("Trajectory.tremor_mm", log_uniform(draw, 0.05, 0.4)),
                    option("Trajectory.tremor_deg", log_uniform(draw, 0.1, 1.0))]
    if path == "insert":
        options.append(option("Trajectory.speed_mm_s", log_uniform(draw, 4, 20)))
    if path == "sway":
        options += [option("Trajectory.sway_amplitude_mm", log_uniform(draw, 3, 12)),
                    option("Trajectory.sway_period_s", log_uniform(draw, 2, 8))]
    size = ""
    if motion == "wave":
        amplitude, omega = log_uniform(draw, 1, 8), log_uniform(draw, 1, 5)
        wavelength = log_uniform(draw, 60, 600)
        options += [option("Deformation.amplitude_mm", amplitude), option("Deformation.omega_rad_s", omega),
                    option("Deformation.wavelength_mm", wavelength)]
        size = f" of {amplitude:.1f} mm, {omega:.1f} rad/s, {wavelength:.0f} mm"
    if motion == "breath":
        height = log_uniform(draw, 0.5, 3)
        options += [option("Deformation.breathing_mm", height),
                    option("Deformation.breathing_period_s", log_uniform(draw, 2, 5))]
        size = f" of {height:.1f} mm"
    if motion == "poke":
        height = log_uniform(draw, 3, 10)
        options += [option("Deformation.poke_mm", height), option("Deformation.poke_period_s", log_uniform(draw, 1, 4))]
        size = f" of {height:.1f} mm"
    width, height = draw.choice(((320, 256), (446, 446), (480, 360), (640, 360), (640, 480), (640, 512)))
    view = log_uniform(draw, 60, 110) if kind == "colon" else log_uniform(draw, 45, 80)
    options += [option("Camera.width", width), option("Camera.height", height),
                option("Camera.horizontal_fov_deg", view)]
    options += [option("Texture.contrast", 0.7 * log_uniform(draw, 0.6, 1.6)),
                option("Recording.video_qp", draw.randint(14, 30))]
    if draw.random() < 0.2:
        options += [option("Interruption.tool_period_s", 2.5), option("Interruption.tool_s", 0.5)]
        size += ", tools"
    return f"{kind}, {path}, {motion}{size}, {width}x{height}, {view:.0f} deg", options, path != "still"


def simulated(program, folder, number):
    """The description of a scene, which is simulated unless it is there, and whether its camera moves."""
    for attempt in range(ATTEMPTS):
        name, options, moves = scene_of(random.Random(f"{number} {attempt}"))
        if (folder / "sequence" / "simulation.yaml").exists() and (folder / "attempt").read_text() != str(attempt):
            continue
        if not (folder / "sequence" / "simulation.yaml").exists():
            made = call(program, "simulate", "--quiet", "--overwrite", "--realism", "endoscope", "-o",
                        folder / "sequence", "--Scene.seed", number, *" ".join(options).split())
            if made.returncode != 0:
                continue
            (folder / "attempt").write_text(str(attempt))
        return name, moves
    raise SystemExit(f"scene {number}: no camera path stays clear of the wall in {ATTEMPTS} attempts")


def errors_of(program, folder):
    """Relative errors of the depths of a run's map, and of one constant depth."""
    call(program, "evaluate", "--run", folder / "run", "--sequence", folder / "sequence", "-o", folder / "evaluation")
    surface = json.loads((folder / "evaluation" / "evaluation.json").read_text())["surface"]
    return [surface[which]["median_relative_depth"] for which in ("estimate", "null")]


def result(program, folder, number):
    folder.mkdir(parents=True, exist_ok=True)
    name, moves = simulated(program, folder, number)
    if not (folder / "run" / "run.json").exists():
        call(program, "track", "--quiet", "-o", folder / "run", "--image_path", folder / "sequence")
    states = states_of(folder / "run")
    with_map = frames_with_a_map(states)
    error, null = errors_of(program, folder) if with_map else (None, None)
    return {"number": number, "name": name, "moves": moves, "frames": sum(states.values()), "with_map": with_map,
            "provisional": states["provisional"], "ambiguous": states["ambiguous"], "error": error, "null": null}


def print_row(row):
    errors = [f"{100 * row[which]:.1f} %" if row[which] is not None else "" for which in ("error", "null")]
    print(f"| {row['number']} | {row['name']} | {row['with_map']} of {row['frames']} | {row['provisional']} |"
          f" {row['ambiguous']} | {errors[0]} | {errors[1]} |", flush=True)


def print_summary(rows):
    moving, still = ([row for row in rows if row["moves"] == moves] for moves in (True, False))
    mapped = [row for row in moving if row["error"] is not None]
    frames, with_map = (sum(row[which] for row in moving) for which in ("frames", "with_map"))
    wrong = [row for row in mapped if row["error"] > 0.5 * row["null"]]
    certain_wrong = [row for row in wrong if row["provisional"] < 0.5 * row["with_map"]]
    print(f"\n{len(moving)} scenes with a camera that moves: a map in {100 * with_map / frames:.0f} % of the frames;"
          f" depth error in the median scene {100 * statistics.median(row['error'] for row in mapped):.1f} %,"
          f" null {100 * statistics.median(row['null'] for row in mapped):.1f} %; off by more than half of the null in"
          f" {len(wrong)} of {len(mapped)} that have a map, {len(certain_wrong)} of these not provisional.")
    print(f"{len(still)} scenes with a camera that stands still: a map in {sum(row['with_map'] > 0 for row in still)}.")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--output_path", type=Path, required=True)
    parser.add_argument("--first", type=int, default=1, help="number of the first scene")
    parser.add_argument("--scenes", type=int, default=24)
    arguments = parser.parse_args()
    print("| | scene | frames with a map | provisional | ambiguous | depth error | null |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    rows = []
    for number in range(arguments.first, arguments.first + arguments.scenes):
        rows.append(result(arguments.program, arguments.output_path / f"{number:03}", number))
        print_row(rows[-1])
    print_summary(rows)


if __name__ == "__main__":
    main()
