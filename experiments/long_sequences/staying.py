# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How well runs stay on their scene: what was tracked, found again, and how errors and scale changed from beginning to end."""

import csv
import json
import math
import pathlib
import re
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "common"))
import grid

SPAN = 100  # frames at the beginning, and at the end, that are compared
WITH_MAP = ("tracking", "provisional")  # states
BACK_WITHIN = 5  # frames after a black-out in which the same map has to be found

COLUMNS = ["set", "amplitude_mm", "omega_rad_s", "seed", "variant", "visible_frames", "tracked_visible", "blackouts",
           "blackouts_survived", "submaps", "points", "fewest_points", "rmse_mm", "rmse_first_mm", "rmse_last_mm",
           "drift_median_mm", "scale_drift", "end_point_mm", "path_mm", "ms_per_frame"]


def interruption(options, name, time_s):
    """Whether there is one of that name at a time; by the options of simulation.yaml."""
    period, duration = options[f"{name}_period_s"], options[f"{name}_s"]
    return period > 0 and time_s + 1e-6 >= period and math.fmod(time_s + 1e-6, period) < duration


def simulation_options(sequence, group):
    """The numbers of one group of simulation.yaml, which `pliant simulate` writes: a line an option, indented."""
    options, inside = {}, False
    for line in (pathlib.Path(sequence) / "simulation.yaml").read_text(encoding="utf-8").splitlines():
        if not line.startswith(" "):
            inside = line.startswith(f"{group}:")
        elif inside and (match := re.match(r"\s+(\w+):\s*([-+.\deE]+)\b", line)):
            options[match[1]] = float(match[2])
    return options


def positions(path):
    """{time: (x, y, z)} of a TUM file."""
    rows = (line.split() for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines()
            if line and not line.startswith("#"))
    return {round(float(row[0]), 6): tuple(map(float, row[1:4])) for row in rows}


def distance(a, b):
    return math.dist(a, b)


def end_point(run, sequence, scale):
    """How far the estimated way from the first tracked frame to the last is from the true one's length, and the path's length."""
    estimate, truth = positions(pathlib.Path(run) / "trajectory.txt"), positions(pathlib.Path(sequence) / "groundtruth.txt")
    times = sorted(set(estimate) & set(truth))
    path = sum(distance(truth[a], truth[b]) for a, b in zip(times, times[1:]))
    return path, abs(scale * distance(estimate[times[-1]], estimate[times[0]]) -
                     distance(truth[times[-1]], truth[times[0]]))


def survived(rows, first, last):
    """Whether the frames after a black-out have the map that was there before it, soon enough."""
    before = next((row for row in reversed(rows[:first]) if row["state"] in WITH_MAP), None)
    after = rows[last + 1:last + 1 + BACK_WITHIN]
    return before is not None and any(row["state"] in WITH_MAP and row["submap"] == before["submap"] for row in after)


def mean(values):
    return statistics.fmean(values) if values else None


def figures_of(run, sequence):
    """The row of the run in folder `run` = .../runs/VARIANT/SCENE."""
    run = pathlib.Path(run)
    parts = grid.SCENE.fullmatch(run.name)
    row = {"set": parts["set"], "amplitude_mm": parts["amplitude"], "omega_rad_s": parts["omega"], "seed": parts["seed"],
           "variant": run.parent.name}
    evaluation = json.loads((run / "evaluation/evaluation.json").read_text())
    row["submaps"] = json.loads((run / "run.json").read_text())["counts"]["submaps"]
    frames = grid.read_rows(run / "frames.csv")
    options = simulation_options(sequence, "Interruption")
    times = sorted(positions(pathlib.Path(sequence) / "groundtruth.txt"))
    dark = [interruption(options, "blackout", time) for time in times]
    tracked = {int(frame["frame"]) for frame in frames if frame["state"] in WITH_MAP}
    row["visible_frames"] = dark.count(False)
    row["tracked_visible"] = sum(not dark[idx] for idx in tracked)
    starts = [i for i in range(1, len(dark)) if dark[i] and not dark[i - 1]]
    ends = [next((i for i in range(start, len(dark)) if not dark[i]), len(dark)) - 1 for start in starts]
    row["blackouts"] = len(starts)
    row["blackouts_survived"] = sum(survived(frames, first, last) for first, last in zip(starts, ends))
    optimized = [int(frame["optimized"]) for frame in frames if frame["state"] in WITH_MAP]
    row["points"], row["fewest_points"] = mean(optimized), min(optimized, default=None)
    row["ms_per_frame"] = mean([sum(float(value) for name, value in frame.items() if name.startswith("ms_"))
                                for frame in frames])
    if not evaluation.get("surface"):
        return row
    errors = [line for line in grid.read_rows(run / "evaluation/evaluation.csv") if line["rmse_mm"] not in ("", "nan")]
    first = [line for line in errors if int(line["frame"]) < SPAN]
    last = [line for line in errors if int(line["frame"]) >= len(times) - SPAN]
    row["rmse_mm"] = evaluation["surface"]["estimate"]["mean_rmse_mm"]
    row["rmse_first_mm"] = mean([float(line["rmse_mm"]) for line in first])
    row["rmse_last_mm"] = mean([float(line["rmse_mm"]) for line in last])
    if first and last:
        row["scale_drift"] = mean([float(line["scale"]) for line in last]) / mean([float(line["scale"]) for line in first]) - 1
    if evaluation.get("material"):
        row["drift_median_mm"] = evaluation["material"]["drift"]["median_mm"]
    if evaluation.get("trajectory") and row["submaps"] == 1:
        row["path_mm"], row["end_point_mm"] = end_point(run, sequence, evaluation["trajectory"]["scale"])
    return row


def share(part, whole):
    return f"{100 * part / whole:.1f}" if whole else "-"


def line_of(rows):
    """The rows of one set, cell and variant: means over the seeds, black-outs together."""
    def over(column, digits=2, factor=1):
        values = [factor * float(row[column]) for row in rows if row.get(column) not in (None, "")]
        return f"{statistics.fmean(values):.{digits}f}" if values else "-"
    def together(column):
        return sum(int(row[column]) for row in rows)
    ends = [100 * row["end_point_mm"] / row["path_mm"] for row in rows if row.get("end_point_mm") is not None]
    return [rows[0]["set"], rows[0]["amplitude_mm"], rows[0]["variant"],
            share(together("tracked_visible"), together("visible_frames")),
            f"{together('blackouts_survived')} of {together('blackouts')}", over("submaps", 1), over("points", 0),
            over("fewest_points", 0), over("rmse_mm"), over("rmse_first_mm"), over("rmse_last_mm"),
            over("drift_median_mm", 3), over("scale_drift", 1, 100), f"{statistics.fmean(ends):.2f}" if ends else "-"]


def write(runs, markdown_path, csv_path):
    rows = [figures_of(run, sequence) for run, sequence in runs]
    grid.write_rows(csv_path, COLUMNS, rows)
    groups = {}
    for row in rows:
        groups.setdefault((row["set"], row["amplitude_mm"], row["variant"]), []).append(row)
    header = ["way", "A: mm", "variant", "visible frames tracked: %", "black-outs survived", "submaps", "points a frame",
              "fewest", "RMSE: mm", "first 100 frames", "last 100", "track drift, median: mm", "scale drift: %",
              "end-point: % of path"]
    pathlib.Path(markdown_path).write_text(grid.markdown(header, [line_of(group) for group in groups.values()]),
                                           encoding="utf-8")
