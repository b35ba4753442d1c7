#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What `pliant track --tracks` makes of tracks from outside, on simulated colons. README.md beside this file.

usage: point_tracks.py [--build DIR] [--output_path DIR] [--sequences DIR] [--amplitudes 0,2.5,5,10] [--omega 2.5]
                       [--seeds 1,2] [--kinds own,oracle,truth,opencv,thinned] [--noise_seeds N]
"""
import argparse
import csv
import json
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

SCENE = "--Deformation.wavelength_mm 628.3185307179587 --Trajectory.speed_mm_s 15 --Trajectory.frames 100".split()
NOISE_PX = 0.3
CORNERS_OF = range(0, 100, 10)  # frames whose corners have a true track
THINNED = 60  # points that are seen at a time
FIRST_MAP_ALONE = "--Growth.grow off --Tracking.find_lost off".split()
VARIANTS = ("own", "oracle", "truth", "opencv", "thinned")
TRUE_TRACKS = ("oracle", "truth")


def pliant(arguments, *args):
    command = [str(arguments.build / "pliant"), *map(str, args)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        print(" ".join(command), result.stderr, file=sys.stderr)


def sequence_of(arguments, amplitude, seed):
    name = f"dm_A{amplitude}_w{arguments.omega if float(amplitude) > 0 else 0}_s{seed}"
    if arguments.sequences and (arguments.sequences / name / "done").exists():
        return arguments.sequences / name
    folder = arguments.output_path / "sequences" / name
    if not (folder / "done").exists():
        pliant(arguments, "simulate", "--quiet", "--overwrite", "--output_path", folder, "--Deformation.amplitude_mm", amplitude,
               "--Deformation.omega_rad_s", arguments.omega, "--Scene.seed", seed, *SCENE)
        (folder / "done").touch()
    return folder


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write_tracks(path, rows):
    """rows: (frame, track_id, u, v)."""
    lines = [f"{frame},{track},{u:.4f},{v:.4f}" for frame, track, u, v in sorted(rows)]
    path.write_text("frame,track_id,u_px,v_px\n" + "\n".join(lines) + "\n", encoding="utf-8")


def true_paths(arguments, sequence):
    """Rows (frame, track, u, v), in order, of the true paths of the corners of the frames CORNERS_OF, from these on.

    A start from the depth of such a frame says which corners it has. What was found of a sequence is kept.
    """
    folder = arguments.output_path / "true_paths" / sequence.name
    paths, starts = folder / "paths.csv", folder / "starts.csv"
    if not paths.exists():
        find_true_paths(arguments, sequence, folder, starts, paths)
    begin = [int(row["frame"]) for row in rows_of(starts)]
    rows = [(int(row["frame"]), int(row["point"]), float(row["u_px"]), float(row["v_px"])) for row in rows_of(paths)
            if row["visibility"] == "visible"]
    return sorted(row for row in rows if row[0] >= begin[row[1]])


def find_true_paths(arguments, sequence, folder, starts, paths):
    folder.mkdir(parents=True, exist_ok=True)
    first = []
    for frame in CORNERS_OF:
        corners = folder / f"corners{frame}"
        pliant(arguments, "track", "--quiet", "--overwrite", "--image_path", sequence, "--output_path", corners,
               "--start", frame, "--end", frame + 1, "--Init.method", "depth")
        first += rows_of(corners / "observations.csv")
    starts.write_text("frame,u_px,v_px\n" + "".join(f"{r['frame']},{r['u_px']},{r['v_px']}\n" for r in first),
                      encoding="utf-8")
    pliant(arguments, "truth", "--quiet", "--sequence", sequence, "--points", starts, "--output_path", paths)


def write_noisy_truth(arguments, sequence, path, seed):
    """The true paths with the oracle's noise: none where a track begins."""
    random = np.random.default_rng(seed)
    begun = set()
    rows = []
    for frame, track, u, v in true_paths(arguments, sequence):
        noise = random.normal(0, NOISE_PX, 2) if track in begun else (0, 0)
        begun.add(track)
        rows.append((frame, track, u + noise[0], v + noise[1]))
    write_tracks(path, rows)


def write_thinned(source, path):
    """A track is kept where fewer than THINNED of those kept are seen in its first frame."""
    tracks = defaultdict(list)
    for row in rows_of(source):
        tracks[int(row["track_id"])].append((int(row["frame"]), float(row["u_px"]), float(row["v_px"])))
    order = sorted(tracks, key=lambda track: (tracks[track][0][0], -len(tracks[track]), track))
    seen = defaultdict(int)
    kept = []
    for track in order:
        if seen[tracks[track][0][0]] >= THINNED:
            continue
        for frame, u, v in tracks[track]:
            seen[frame] += 1
            kept.append((frame, track, u, v))
    write_tracks(path, kept)


def options_of(arguments, variant, sequence, folder, seed):
    if variant == "own":
        return []
    if variant == "oracle":
        return ["--Oracle.tracks", "on", "--Oracle.track_noise_px", NOISE_PX, "--General.seed", seed, *FIRST_MAP_ALONE]
    path = folder / f"{variant}.csv"
    if variant == "truth":
        write_noisy_truth(arguments, sequence, path, seed)
        return ["--tracks", path, "--General.seed", seed, *FIRST_MAP_ALONE]
    if variant == "opencv":
        subprocess.run([arguments.build / "pliant_opencv_tracks", sequence, path], check=True, capture_output=True)
    if variant == "thinned":
        write_thinned(folder / "opencv.csv", path)
    return ["--tracks", path]


def figures_of(run):
    path = run / "evaluation" / "evaluation.json"
    counts = json.loads((run / "run.json").read_text(encoding="utf-8"))["counts"]
    if not path.exists():
        return {"tracked": counts["frames_tracked"]}
    evaluation = json.loads(path.read_text(encoding="utf-8"))
    return {"tracked": counts["frames_tracked"],
            "points": evaluation["survival"]["mean_points"],
            "depth": evaluation["surface"]["estimate"]["median_relative_depth"],
            "rmse": evaluation["surface"]["estimate"]["mean_rmse_mm"],
            "null": evaluation["surface"]["null"]["mean_rmse_mm"],
            "within": evaluation["tracks"]["average_within"],
            "jaccard": evaluation["tracks"]["average_jaccard"]}


def figures_of_run(arguments, variant, sequence, folder, seed):
    """Tracks and evaluates into a run folder beside the files of tracks."""
    run = folder / variant
    pliant(arguments, "track", "--quiet", "--overwrite", "--image_path", sequence, "--output_path", run,
           *options_of(arguments, variant, sequence, folder, seed))
    pliant(arguments, "evaluate", "--quiet", "--run", run, "--sequence", sequence, "--output_path", run / "evaluation")
    return figures_of(run)


def print_table(arguments):
    print("| A mm | seed | tracks | frames | points | RMSE mm | null mm | within, mean % | Jaccard, mean % |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for amplitude in arguments.amplitudes.split(","):
        for seed in arguments.seeds.split(","):
            sequence = sequence_of(arguments, amplitude, seed)
            folder = arguments.output_path / sequence.name
            folder.mkdir(parents=True, exist_ok=True)
            for variant in arguments.kinds.split(","):
                f = figures_of_run(arguments, variant, sequence, folder, int(seed))
                cells = [f"{f['tracked']}"]
                if "rmse" in f:
                    cells += [f"{f['points']:.0f}", f"{f['rmse']:.2f}", f"{f['null']:.2f}", f"{100 * f['within']:.1f}",
                              f"{100 * f['jaccard']:.1f}"]
                else:
                    cells += ["-"] * 5
                print(f"| {amplitude} | {seed} | {variant} | " + " | ".join(cells) + " |", flush=True)


def print_true_tracks(arguments):
    """The oracle's tracks and a file of true tracks, over several draws of the same noise."""
    print("| A mm | seed | oracle: maps | depth error % | quartiles | RMSE mm | file: maps | depth error % | quartiles | "
          "RMSE mm | depth error of the file by the oracle's |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for amplitude in arguments.amplitudes.split(","):
        for seed in arguments.seeds.split(","):
            sequence = sequence_of(arguments, amplitude, seed)
            cells, medians = [], []
            for variant in TRUE_TRACKS:
                runs = []
                for noise_seed in range(1, arguments.noise_seeds + 1):
                    folder = arguments.output_path / "noise" / sequence.name / str(noise_seed)
                    folder.mkdir(parents=True, exist_ok=True)
                    runs.append(figures_of_run(arguments, variant, sequence, folder, noise_seed))
                maps = [run for run in runs if "rmse" in run]
                cells.append(f"{len(maps)} of {len(runs)}")
                depths = [100 * run["depth"] for run in maps] or [np.nan]
                low, median, high = np.percentile(depths, [25, 50, 75])
                medians.append(median)
                rmse = np.median([run["rmse"] for run in maps] or [np.nan])
                cells += [f"{median:.2f}", f"{low:.2f} to {high:.2f}", f"{rmse:.2f}"]
            print(f"| {amplitude} | {seed} | " + " | ".join(cells) + f" | {medians[1] / medians[0]:.2f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, default=Path("build/release"))
    parser.add_argument("--output_path", type=Path, default=Path("build/experiments/point_tracks"))
    parser.add_argument("--sequences", type=Path, help="sequences of the experiment simulated_colon, where they are there")
    parser.add_argument("--amplitudes", default="0,2.5,5,10")
    parser.add_argument("--omega", default="2.5", help="of the deformation, rad/s")
    parser.add_argument("--seeds", default="1,2")
    parser.add_argument("--kinds", default=",".join(VARIANTS), help="of tracks; thinned ones are those of opencv")
    parser.add_argument("--noise_seeds", type=int, default=0,
                        help="compare the oracle with a file of true tracks over as many draws of the noise, no more")
    arguments = parser.parse_args()
    if arguments.noise_seeds > 0:
        print_true_tracks(arguments)
    else:
        print_table(arguments)


if __name__ == "__main__":
    main()
