# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The figures of first maps, one row a run, and their tables: a row a start, for every set of scenes and speed."""

import collections
import json
import pathlib
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "common"))
import grid

# One row a run: what it is, then what its first map gave. A run without one has empty figures. Depth errors are relative,
# in the frame that made the map where nothing else is said.
FIGURES = ["set", "amplitude_mm", "omega_rad_s", "seed", "variant", "declared", "reference_frame", "declared_frame",
           "frames_waited", "frames_before", "points", "median_depth", "rmse_depth", "p90_depth", "null_median_depth",
           "reference_median_depth", "rotation_error_deg", "true_rotation_deg", "direction_error_deg",
           "initializer_ms", "initializer_largest_ms", "frames_after", "rmse_mm_after", "null_rmse_mm_after", "note"]

COLUMNS = ["set", "speed", "amplitude_mm", "omega_rad_s", "start", "runs", "declared_share", "failed_share",
           "median_depth", "rmse_depth", "null_median_depth", "frames_waited", "frames_before", "rotation_error_deg",
           "true_rotation_deg", "direction_error_deg", "initializer_ms", "initializer_largest_ms", "frames_after",
           "rmse_mm_after", "null_rmse_mm_after"]

# A map has failed with a larger median relative depth error; so many frames later the surface error is looked at.
Limits = collections.namedtuple("Limits", ["failed_above", "frames_after"])


def after(frames, declared_frame, frames_after):
    """The frame of a surface error's `frames` that is `frames_after` behind the declared one, or the last before."""
    reached = [frame for frame in frames if declared_frame <= frame["frame"] <= declared_frame + frames_after]
    return reached[-1] if reached else None


def figures_of(run, frames_after):
    """The row of the run in folder `run` = .../runs/VARIANT/SCENE."""
    run = pathlib.Path(run)
    row = {name: value for name, value in grid.figures_of(run).items() if name in FIGURES}
    row["points"] = ""
    declared = json.loads((run / "run.json").read_text())["first_map"]
    row["declared"] = "yes" if declared else "no"
    evaluation = json.loads((run / "evaluation/evaluation.json").read_text())
    first_map = evaluation.get("first_map")
    if not first_map:
        return row
    estimate, reference, motion = first_map["declared"]["estimate"], first_map["reference"], first_map["motion"] or {}
    row |= {name: first_map[name] for name in ("reference_frame", "declared_frame", "frames_waited", "frames_before")}
    row |= {"points": first_map["declared"]["points"], "median_depth": estimate["median_relative_depth"],
            "rmse_depth": estimate["rmse_relative_depth"], "p90_depth": estimate["p90_relative_depth"],
            "null_median_depth": first_map["declared"]["null"]["median_relative_depth"],
            "reference_median_depth": reference["estimate"]["median_relative_depth"] if reference else "",
            "initializer_ms": first_map["initializer_ms"]["total"],
            "initializer_largest_ms": first_map["initializer_ms"]["largest"]}
    row |= {name: "" if motion.get(name) is None else motion[name]
            for name in ("rotation_error_deg", "true_rotation_deg", "direction_error_deg")}
    frame = after(evaluation["surface"]["frames"], first_map["declared_frame"], frames_after)
    if frame:
        row |= {"frames_after": frame["frame"] - first_map["declared_frame"],
                "rmse_mm_after": frame["estimate"]["rmse_mm"], "null_rmse_mm_after": frame["null"]["rmse_mm"]}
    return row


def write_figures(runs, frames_after, csv_path):
    grid.write_rows(csv_path, FIGURES, [figures_of(run, frames_after) for run in runs])


class Starts:
    """The runs of one start, set and speed: one a seed."""

    def __init__(self, rows):
        self.rows = rows

    def declared(self):
        return [row for row in self.rows if row["declared"] == "yes"]

    def failed(self, failed_above):
        """A map of which no point has truth has failed too."""
        return [row for row in self.declared() if row["median_depth"] == "" or float(row["median_depth"]) > failed_above]

    def values(self, column):
        return [float(row[column]) for row in self.declared() if row[column] != ""]

    def median(self, column):
        """Over the runs with a map that have the figure; None where none has."""
        values = self.values(column)
        return statistics.median(values) if values else None


def starts_of(rows):
    """{set: {(amplitude, omega): {variant: Starts}}}, everything in the order of the rows."""
    grouped = {}
    for row in rows:
        cells = grouped.setdefault(row["set"], {})
        variants = cells.setdefault((row["amplitude_mm"], row["omega_rad_s"]), {})
        variants.setdefault(row["variant"], []).append(row)
    return {name: {cell: {variant: Starts(rows) for variant, rows in variants.items()}
                   for cell, variants in cells.items()} for name, cells in grouped.items()}


def speed_of(cell, cell_names):
    return cell_names.get(":".join(cell), f"A {cell[0]}, omega {cell[1]}")


def percent(value, digits=1):
    return "-" if value is None else f"{100 * value:.{digits}f}"


def table_row(variant, starts, failed_above):
    median = starts.median
    count = len(starts.rows)
    rotation, true_rotation = median("rotation_error_deg"), median("true_rotation_deg")
    return [variant, percent(len(starts.declared()) / count, 0), percent(len(starts.failed(failed_above)) / count, 0),
            f"{percent(median('median_depth'))} ({percent(median('null_median_depth'))})", percent(median("rmse_depth")),
            grid.number(median("frames_waited"), 0), grid.number(median("frames_before"), 0),
            f"{grid.number(rotation)} ({grid.number(true_rotation)})", grid.number(median("direction_error_deg"), 1),
            grid.number(median("initializer_ms"), 0), grid.number(median("initializer_largest_ms"), 0),
            f"{grid.number(median('rmse_mm_after'))} ({grid.number(median('null_rmse_mm_after'), 1)})",
            grid.number(median("frames_after"), 0)]


HEADER = ["start", "declared %", "failed %", "depth, median % (null)", "depth, RMSE %", "waited", "since the first",
          "rotation deg (true)", "direction deg", "initializer ms", "at once", "RMSE mm after (null)", "frames after"]


def csv_rows(grouped, failed_above, cell_names):
    medians = COLUMNS[COLUMNS.index("median_depth"):]
    for name, cells in grouped.items():
        for cell, variants in cells.items():
            for variant, starts in variants.items():
                count = len(starts.rows)
                row = {"set": name, "speed": speed_of(cell, cell_names), "amplitude_mm": cell[0],
                       "omega_rad_s": cell[1], "start": variant, "runs": count,
                       "declared_share": len(starts.declared()) / count,
                       "failed_share": len(starts.failed(failed_above)) / count}
                row |= {column: starts.median(column) for column in medians}
                yield {column: "" if value is None else value for column, value in row.items()}


def write(figures_path, limits, cell_names, markdown_path, csv_path):
    grouped = starts_of(grid.read_rows(figures_path))
    text = []
    for name, cells in grouped.items():
        for cell, variants in cells.items():
            seeds = max(len(starts.rows) for starts in variants.values())
            text.append(f"### `{name}`, {speed_of(cell, cell_names)} (A {cell[0]} mm, omega {cell[1]} rad/s)\n\n"
                        f"{seeds} seed{'s' if seeds > 1 else ''}; failed: a median depth error above "
                        f"{100 * limits.failed_above:.0f} %; medians over the runs with a map.\n\n" +
                        grid.markdown(HEADER, [table_row(variant, starts, limits.failed_above)
                                               for variant, starts in variants.items()]))
    pathlib.Path(markdown_path).write_text("\n".join(text), encoding="utf-8")
    grid.write_rows(csv_path, COLUMNS, csv_rows(grouped, limits.failed_above, cell_names))
