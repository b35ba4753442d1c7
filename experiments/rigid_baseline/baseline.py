# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The figures of runs of Pliant and COLMAP side by side, and their table. Python's standard library only."""

import json
import pathlib
import statistics

import grid

COLUMNS = ["set", "amplitude_mm", "omega_rad_s", "seed", "variant", "status", "frames_read", "frames_tracked", "points",
           "tracks", "mean_track_length", "continuing_share", "reprojection_px", "rmse_mm", "null_rmse_mm",
           "material_rmse_mm", "ate_percent", "seconds"]


def figures_of(run):
    """The row of the run in folder `run` = .../runs/VARIANT/SCENE. A run without a map has empty figures."""
    run = pathlib.Path(run)
    parts = grid.SCENE.fullmatch(run.name)
    summary = json.loads((run / "run.json").read_text())
    evaluation = json.loads((run / "evaluation/evaluation.json").read_text())
    row = {"set": parts["set"], "amplitude_mm": parts["amplitude"], "omega_rad_s": parts["omega"], "seed": parts["seed"],
           "variant": run.parent.name, "status": summary["status"], "frames_read": summary["counts"]["frames_read"],
           "frames_tracked": summary["counts"]["frames_tracked"], "seconds": summary["timings"]["total_s"]}
    if not evaluation:
        return row
    survival, material, trajectory = evaluation["survival"], evaluation["material"], evaluation["trajectory"]
    return row | {"points": survival["mean_points"], "tracks": survival["tracks"],
                  "mean_track_length": survival["mean_track_length"],
                  "continuing_share": material["continuing_tracks"] / max(1, material["tracks"]),
                  "reprojection_px": evaluation["reprojection"]["median_px"],
                  "rmse_mm": evaluation["surface"]["estimate"]["mean_rmse_mm"],
                  "null_rmse_mm": evaluation["surface"]["null"]["mean_rmse_mm"],
                  "material_rmse_mm": material["estimate"]["mean_rmse_mm"],
                  "ate_percent": 100 * trajectory["ate_rmse_mm"] / trajectory["true_path_length_mm"]}


def write_figures(runs, path):
    grid.write_rows(path, COLUMNS, [figures_of(run) for run in runs])


# Heading, column, digits, factor.
TABLE = [("frames", "frames_tracked", 0, 1), ("points a frame", "points", 0, 1), ("tracks", "tracks", 0, 1),
         ("mean length", "mean_track_length", 1, 1), ("go on with another, %", "continuing_share", 0, 100),
         ("reprojection, px", "reprojection_px", 2, 1), ("surface RMSE, mm", "rmse_mm", 2, 1), ("null", "null_rmse_mm", 1, 1),
         ("material RMSE, mm", "material_rmse_mm", 2, 1), ("ATE, % of the path", "ate_percent", 2, 1),
         ("seconds", "seconds", 0, 1)]


def grouped(rows):
    """{(amplitude, variant): rows}, amplitudes and variants in the order of the rows."""
    amplitudes = dict.fromkeys(row["amplitude_mm"] for row in rows)
    variants = dict.fromkeys(row["variant"] for row in rows)
    return {(amplitude, variant): [row for row in rows if row["amplitude_mm"] == amplitude and row["variant"] == variant]
            for amplitude in amplitudes for variant in variants}


def median(rows, column):
    values = [float(row[column]) for row in rows if row[column] != ""]
    return statistics.median(values) if values else None


def write(figures_path, markdown_path, csv_path):
    rows = []
    for (amplitude, variant), runs in grouped(grid.read_rows(figures_path)).items():
        if not runs:
            continue
        with_map = sum(row["rmse_mm"] != "" for row in runs)
        values = [median(runs, column) for _, column, _, _ in TABLE]
        rows.append([amplitude, variant, f"{with_map}/{len(runs)}"] +
                    [grid.number(None if value is None else factor * value, digits)
                     for value, (_, _, digits, factor) in zip(values, TABLE)])
    header = ["A, mm", "run", "seeds with a map"] + [heading for heading, _, _, _ in TABLE]
    pathlib.Path(markdown_path).write_text(grid.markdown(header, rows), encoding="utf-8")
    grid.write_rows(csv_path, header, [dict(zip(header, row)) for row in rows])
