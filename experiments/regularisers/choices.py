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


def ratio_to(standard, cells):
    """Geometric mean over the cells of RMSE by the default's; None where a run of either has no map."""
    logs = []
    for key, cell in cells.items():
        rmse, reference = cell.median_rmse(), standard[key].median_rmse()
        if rmse is None or reference is None:
            return None
        logs.append(math.log(rmse / reference))
    return math.exp(sum(logs) / len(logs))


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
        ratio = ratio_to(by_variant[f"{start}.{STANDARD}"], cells)
        rows.append({"start": start, "choice": choice, "ratio": grid.number(ratio),
                     **{name: grid.number(cells[key].median_rmse()) for name, key in zip(names, keys)},
                     "points": grid.number(mean(cells, "points"), 0),
                     "frames": grid.number(mean(cells, "frames_tracked"), 0),
                     "frames/s": grid.number(mean(cells, "frames_per_second"), 1)})
    header = list(rows[0])
    titles = {"ratio": "RMSE by default's", "frames": f"frames of {frames}", **{name: f"{name}: mm" for name in names}}
    text = grid.markdown([titles.get(name, name) for name in header], [[row[name] for name in header] for row in rows])
    pathlib.Path(markdown_path).write_text(text, encoding="utf-8")
    grid.write_rows(csv_path, header, rows)
