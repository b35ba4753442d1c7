# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Table I beside the paper's: one overview a set of scenes, then one table a set and variant."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "common"))
import grid

# RMSE in mm by (A in mm, omega in rad/s). Gomez Rodriguez, Montiel, Tardos, IROS 2022, Table I.
PAPER = {("0", "0"): 1.15, ("2.5", "2.5"): 1.77, ("2.5", "5"): 1.70, ("5", "2.5"): 1.84, ("5", "5"): 3.65,
         ("10", "2.5"): 2.27, ("10", "5"): 4.57}
# What a cell must have besides the RMSE.
LEAST_POINTS = 100
LEAST_FRAME_SHARE = 0.9

COLUMNS = ["set", "variant", "amplitude_mm", "omega_rad_s", "paper_rmse_mm", "rmse_mm", "least_rmse_mm",
           "largest_rmse_mm", "median_mm", "material_rmse_mm", "null_rmse_mm", "points", "frames_tracked", "alive_share",
           "ate_mm", "frames_per_second", "runs_with_map", "runs", "met"]


def is_met(cell, paper, frames):
    rmse = cell.median_rmse()
    return (rmse is not None and paper is not None and rmse <= paper and cell.median("points") >= LEAST_POINTS and
            cell.median("frames_tracked") >= LEAST_FRAME_SHARE * frames)


def overview(by_variant, frames):
    """Median RMSE over the seeds: a row a cell, a column a variant; met cells in bold."""
    cells = next(iter(by_variant.values()))
    rows = []
    for key in cells:
        paper = PAPER.get(key)
        row = [*key, number_of_paper(key)]
        for by_cell in by_variant.values():
            text = grid.number(by_cell[key].median_rmse())
            row.append(f"**{text}**" if is_met(by_cell[key], paper, frames) else text)
        rows.append(row)
    return grid.markdown(["A mm", "omega rad/s", "paper", *by_variant], rows)


def number_of_paper(key):
    return grid.number(PAPER.get(key))


def details(by_cell, frames):
    rows = []
    for key, cell in by_cell.items():
        alive = cell.median("alive_share")
        rows.append([*key, number_of_paper(key), grid.number(cell.median_rmse()), cell.spread(),
                     grid.number(cell.median("median_mm")), grid.number(cell.median("material_rmse_mm")),
                     grid.number(cell.median("null_rmse_mm"), 1), grid.number(cell.median("points"), 0),
                     grid.number(cell.median("frames_tracked"), 0),
                     "-" if alive is None else f"{100 * alive:.0f} %", grid.number(cell.median("ate_mm")),
                     grid.number(cell.median("frames_per_second"), 1), f"{len(cell.measured)} of {len(cell.rows)}",
                     "yes" if is_met(cell, PAPER.get(key), frames) else "no"])
    return grid.markdown(["A mm", "omega rad/s", "paper RMSE mm", "RMSE mm", "over seeds", "median mm", "material RMSE mm",
                          "null RMSE mm", "points", f"frames of {frames}", "alive", "ATE mm", "frames/s", "with a map",
                          "met"], rows)


def csv_rows(grouped, frames):
    for (name, variant), by_cell in grouped.items():
        for key, cell in by_cell.items():
            values = cell.values("rmse_mm")
            row = {"set": name, "variant": variant, "amplitude_mm": key[0], "omega_rad_s": key[1],
                   "paper_rmse_mm": PAPER.get(key, ""), "rmse_mm": cell.median_rmse(),
                   "least_rmse_mm": min(values, default=""), "largest_rmse_mm": max(values, default=""),
                   "runs_with_map": len(cell.measured), "runs": len(cell.rows),
                   "met": "yes" if is_met(cell, PAPER.get(key), frames) else "no"}
            for column in ["median_mm", "material_rmse_mm", "null_rmse_mm", "points", "frames_tracked", "alive_share",
                           "ate_mm", "frames_per_second"]:
                row[column] = cell.median(column)
            yield {column: "" if value is None else value for column, value in row.items()}


def write(figures_path, frames, markdown_path, csv_path):
    grouped = grid.cells_of(grid.read_rows(figures_path))
    text = []
    for name in dict.fromkeys(key[0] for key in grouped):
        by_variant = {variant: cells for (a_set, variant), cells in grouped.items() if a_set == name}
        seeds = max(len(cell.rows) for cells in by_variant.values() for cell in cells.values())
        text.append(f"### `{name}`\n\nMedian over {seeds} seed{'s' if seeds > 1 else ''} of the RMSE in mm; bold: at or "
                    f"below the paper's, with at least {LEAST_POINTS} points and {LEAST_FRAME_SHARE * frames:.0f} of the "
                    f"{frames} frames.\n\n" + overview(by_variant, frames))
        for variant, by_cell in by_variant.items():
            text.append(f"#### `{name}`, {variant}\n\n" + details(by_cell, frames))
    pathlib.Path(markdown_path).write_text("\n".join(text), encoding="utf-8")
    grid.write_rows(csv_path, COLUMNS, csv_rows(grouped, frames))
