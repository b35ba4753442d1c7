# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The median run of every lens, and its RMSE by the first lens's."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "common"))
import grid

COLUMNS = ["lens", "variant", "amplitude_mm", "omega_rad_s", "rmse_mm", "over_the_seeds", "by_the_first_lens",
           "null_rmse_mm", "points", "frames_tracked", "frames_per_second"]
TITLES = {"amplitude_mm": "A mm", "omega_rad_s": "omega rad/s", "rmse_mm": "RMSE mm", "over_the_seeds": "over the seeds",
          "by_the_first_lens": "by the first lens's", "null_rmse_mm": "null mm", "frames_tracked": "frames",
          "frames_per_second": "frames/s"}


def write(figures_path, markdown_path, csv_path):
    grouped = grid.cells_of(grid.read_rows(figures_path))
    first = {variant: cells for (_, variant), cells in reversed(grouped.items())}
    rows = []
    for (lens, variant), cells in grouped.items():
        for (amplitude, omega), cell in cells.items():
            rmse, reference = cell.median_rmse(), first[variant][amplitude, omega].median_rmse()
            rows.append({"lens": lens, "variant": variant, "amplitude_mm": amplitude, "omega_rad_s": omega,
                         "rmse_mm": grid.number(rmse), "over_the_seeds": cell.spread(),
                         "by_the_first_lens": grid.number(rmse / reference if rmse and reference else None),
                         "null_rmse_mm": grid.number(cell.median("null_rmse_mm"), 1),
                         "points": grid.number(cell.median("points"), 0),
                         "frames_tracked": grid.number(cell.median("frames_tracked"), 0),
                         "frames_per_second": grid.number(cell.median("frames_per_second"), 1)})
    text = grid.markdown([TITLES.get(name, name) for name in COLUMNS], [[row[name] for name in COLUMNS] for row in rows])
    pathlib.Path(markdown_path).write_text(text, encoding="utf-8")
    grid.write_rows(csv_path, COLUMNS, rows)
