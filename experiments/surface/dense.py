# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The table of dense depths: how far they are off, beside the points of their runs. Standard library only."""
import json
import pathlib
import statistics

import grid

# Heading, where it is in evaluation.json, digits, factor.
FIGURES = [("points: RMSE, mm", ("surface", "estimate", "mean_rmse_mm"), 2, 1),
           ("known, %", ("dense", "known_share"), 0, 100),
           ("of textured, %", ("dense", "textured", "known_share"), 0, 100),
           ("RMSE, mm", ("dense", "estimate", "rmse_mm"), 2, 1),
           ("AbsRel, %", ("dense", "estimate", "abs_rel"), 2, 100),
           ("more certain half: RMSE, mm", ("dense", "certain_half", "rmse_mm"), 2, 1),
           ("points, interpolated: RMSE, mm", ("dense", "interpolation", "rmse_mm"), 2, 1),
           ("AbsRel, %", ("dense", "interpolation", "abs_rel"), 2, 100),
           ("one depth: AbsRel, %", ("dense", "null", "abs_rel"), 1, 100),
           ("mesh: RMSE, mm", ("dense", "mesh", "rmse_mm"), 2, 1),
           ("mesh elsewhere: within 2 mm, %", ("dense", "mesh_alone", "within_2_mm"), 0, 100),
           ("within 1 sigma, %", ("dense", "within_1_sigma"), 0, 100),
           ("within 2 sigma, %", ("dense", "within_2_sigma"), 0, 100)]


def at(evaluation, path):
    """None where the evaluation has not this figure."""
    for key in path:
        evaluation = (evaluation or {}).get(key)
    return evaluation


def median(values):
    known = [value for value in values if value is not None]
    return statistics.median(known) if known else None


def row_of(run):
    """The figures of the run in folder `run` = runs/VARIANT/SCENE; None where it has no dense depth."""
    run = pathlib.Path(run)
    evaluation = json.loads((run / "dense/evaluation.json").read_text())
    if not evaluation:
        return None
    seconds = [frame["seconds"] for frame in json.loads((run / "dense/surface/surface.json").read_text())["frames"]]
    parts = grid.SCENE.fullmatch(run.name)
    return {"set": parts["set"], "amplitude_mm": parts["amplitude"], "omega_rad_s": parts["omega"],
            "seed": parts["seed"], "variant": run.parent.name, "seconds_a_frame": statistics.median(seconds)} | {
                ".".join(path): at(evaluation, path) for _, path, _, _ in FIGURES}


def write(runs, markdown_path, csv_path):
    """Of the runs of a grid.Grid: a row a run in the CSV, a row a cell and variant in the Markdown (medians)."""
    rows = [row for row in map(row_of, runs.runs()) if row]
    columns = ["set", "amplitude_mm", "omega_rad_s", "seed", "variant", "seconds_a_frame"]
    grid.write_rows(csv_path, columns + [".".join(path) for _, path, _, _ in FIGURES], rows)
    cells = {}
    for row in rows:
        cells.setdefault((row["set"], row["amplitude_mm"], row["omega_rad_s"], row["variant"]), []).append(row)
    body = []
    for key, members in cells.items():
        line = list(key) + [f"{len(members)} of {len(runs.seeds)}"]
        for _, path, digits, factor in FIGURES:
            value = median(row[".".join(path)] for row in members)
            line.append(grid.number(None if value is None else factor * value, digits))
        body.append(line + [grid.number(statistics.median(row["seconds_a_frame"] for row in members), 1)])
    header = ["set", "A, mm", "omega, rad/s", "run", "seeds"] + [heading for heading, _, _, _ in FIGURES]
    pathlib.Path(markdown_path).write_text(grid.markdown(header + ["seconds a frame"], body), encoding="utf-8")
