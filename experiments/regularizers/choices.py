# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every choice from every start as one variant START.CHOICE, and the table that sets each beside `default`."""

import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "common"))
import grid

STANDARD = "default"


def variants(config):
    """The keys `variant_options` and `variants` of the grid. The default is always run: the rest is compared with it."""
    options = {f"{start}.{choice}": f"{start_options} {choice_options}".strip()
               for start, start_options in config["start_options"].items()
               for choice, choice_options in config["choice_options"].items()}
    starts, chosen = grid.words(config["starts"]), grid.words(config["choices"])
    starts = list(config["start_options"]) if starts == ["all"] else starts
    chosen = list(config["choice_options"]) if chosen == ["all"] else list(dict.fromkeys([STANDARD] + chosen))
    return {"variant_options": options, "variants": [f"{start}.{choice}" for start in starts for choice in chosen]}


# A run that lost its points early has a mean over its easy frames alone: it is compared with nothing.
LEAST_FRAME_SHARE = 0.9


def comparable(cell, standard):
    """Whether both have a map in the median run, and the cell about as many tracked frames as the default's."""
    return (cell.median_rmse() is not None and standard.median_rmse() is not None and
            cell.median("frames_tracked") >= LEAST_FRAME_SHARE * standard.median("frames_tracked"))


def ratio_to(standard, cells):
    """Geometric mean over the comparable cells of RMSE by the default's, and in how many of all."""
    logs = [math.log(cell.median_rmse() / standard[key].median_rmse()) for key, cell in cells.items()
            if comparable(cell, standard[key])]
    if not logs:
        return "-"
    part = f" ({len(logs)} of {len(cells)})" if len(logs) < len(cells) else ""
    return f"{math.exp(sum(logs) / len(logs)):.2f}{part}"


def rmse_of(cell, standard):
    """With the number of tracked frames behind it where they are too few to compare."""
    rmse = grid.number(cell.median_rmse())
    return rmse if rmse == "-" or comparable(cell, standard) else f"{rmse} ({cell.median('frames_tracked'):.0f} frames)"


def mean(cells, column):
    values = [value for value in (cell.median(column) for cell in cells.values()) if value is not None]
    return sum(values) / len(values) if values else None


def write(figures_path, frames, markdown_path, csv_path):
    by_variant = {}  # {variant: {(set, amplitude, omega): Cell}}
    for (name, variant), cells in grid.cells_of(grid.read_rows(figures_path)).items():
        for (amplitude, omega), cell in cells.items():
            by_variant.setdefault(variant, {})[name, amplitude, omega] = cell
    keys = list(next(iter(by_variant.values())))
    names = [f"{name} A {amplitude}, omega {omega}" for name, amplitude, omega in keys]
    rows = []
    for variant, cells in by_variant.items():
        start, choice = variant.split(".", 1)
        standard = by_variant[f"{start}.{STANDARD}"]
        rows.append({"start": start, "choice": choice, "ratio": ratio_to(standard, cells),
                     **{name: rmse_of(cells[key], standard[key]) for name, key in zip(names, keys)},
                     "points": grid.number(mean(cells, "points"), 0),
                     "frames": grid.number(mean(cells, "frames_tracked"), 0),
                     "frames/s": grid.number(mean(cells, "frames_per_second"), 1)})
    header = list(rows[0])
    titles = {"ratio": "RMSE by default's", "frames": f"frames of {frames}", **{name: f"{name}: mm" for name in names}}
    text = grid.markdown([titles.get(name, name) for name in header], [[row[name] for name in header] for row in rows])
    pathlib.Path(markdown_path).write_text(text, encoding="utf-8")
    grid.write_rows(csv_path, header, rows)
