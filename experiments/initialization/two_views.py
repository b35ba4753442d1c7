# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Crosses of factors for pliant_two_views: what is run, its rows, and the tables made of them.

A factor has named values, each some options of the program. A cross is every combination of the named values of its
factors: each a cell, of so many seeds. Python's standard library only.
"""

import concurrent.futures
import itertools
import math
import pathlib
import shlex
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "common"))
import grid

# A map this good by its median depth error is a success, if it is also clearly better than the same points at one
# distance: a flat organ is near that anyhow.
SUCCESS = 0.1
SUCCESS_BY_NULL = 0.5

FIGURES = ["trials", "success", "refused", "rotation_deg", "direction_deg", "median_depth_error", "depth_rmse",
           "null_depth_error", "map_points", "inlier_share", "ms"]


class Crosses:
    """What two_views.yaml defines; a name that it does not define is an error."""

    def __init__(self, config):
        self.config = config
        self.factors = config["factors"]
        self.names = grid.selected(config["crosses"], config["cross_options"], "crosses")
        self.plots = {name: plot for name, plot in config["plots"].items() if plot["cross"] in self.names}
        for name in self.names:
            self.values(name)

    def program(self, root, pliant):
        if self.config["program"]:
            return str(root / self.config["program"])
        return str(pathlib.Path(pliant or root / "build/release/pliant").with_name("pliant_two_views"))

    def values(self, cross):
        """{factor: [its values in this cross]}"""
        factors = self.config["cross_options"][cross]["factors"]
        grid.selected(list(factors), self.factors, f"factors of {cross}")
        return {factor: grid.selected(names, self.factors[factor], f"{factor} of {cross}")
                for factor, names in factors.items()}

    def seeds(self, cross):
        return int(self.config["cross_options"][cross].get("seeds", self.config["seeds"]))

    def cells(self, cross):
        """Every cell as {factor: value}. A solver with a loop of its own is not crossed with the loops."""
        values = self.values(cross)
        cells = [dict(zip(values, combination)) for combination in itertools.product(*values.values())]
        return [cell for cell in cells if not (cell.get("solver") in ("opencv_usac", "homography", "rotation_only") and
                                               cell.get("robust", "ransac") != "ransac")]

    def options(self, cross, cell):
        """Those of the cross first, then those of the factors in their order; of one given twice the last counts."""
        words = shlex.split(self.config["cross_options"][cross].get("options", ""))
        for factor, value in cell.items():
            words += shlex.split(self.factors[factor][value])
        return [word for name, value in dict(zip(words[::2], words[1::2])).items() for word in (name, value)]

    def definition(self, cross):
        """All that the rows of a cross depend on."""
        return {"seeds": self.seeds(cross),
                "cells": [" ".join(self.options(cross, cell)) for cell in self.cells(cross)]}

    def run(self, cross, program, threads, csv_path):
        """One row a trial: the cell's factors, then what the program writes."""
        cells = self.cells(cross)
        with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(threads) as pool:
            def trials(index):
                path = pathlib.Path(folder) / f"{index}.csv"
                subprocess.run([str(program), "--seeds", str(self.seeds(cross)), "--output_path", str(path),
                                *self.options(cross, cells[index])], check=True)
                rows = grid.read_rows(path)
                return list(rows[0]), [{**row, **cells[index]} for row in rows]

            results = list(pool.map(trials, range(len(cells))))
        columns = list(cells[0]) + [column for column in results[0][0] if column not in cells[0]]
        grid.write_rows(csv_path, columns, (row for _, rows in results for row in rows))

    def write_tables(self, csv_paths, markdown_path, csv_path):
        """Markdown: a table a cross, its other factors pooled. CSV: every cell."""
        text, lines = [], []
        for cross, path in zip(self.names, csv_paths):
            rows = grid.read_rows(path)
            factors = list(self.values(cross))
            for cell, trials in grouped(rows, factors).items():
                lines.append({"cross": cross, **dict(zip(factors, cell)), **figures(trials)})
            text.append(f"### {cross.replace('_', ' ').capitalize()}\n\n" + self.table(cross, rows))
        pathlib.Path(markdown_path).write_text("\n".join(text), encoding="utf-8")
        grid.write_rows(csv_path, ["cross", *self.factors, *FIGURES], lines)

    def table(self, cross, rows):
        options = self.config["cross_options"][cross]
        columns = self.values(cross)[options["columns"]]
        header = [*options["rows"], *(column_title(options["columns"], value) for value in columns), "refused",
                  "rotation deg", "direction deg", "depth", "depth RMSE", "one distance", "ms"]
        share = SHARES[options.get("shares", "success")]
        lines = []
        for key, trials in grouped(rows, options["rows"]).items():
            by_column = grouped(trials, [options["columns"]])
            all_of_them = figures(trials)
            lines.append([*key, *(percent(share(by_column.get((value,), []))) for value in columns),
                          percent(all_of_them["refused"]), number(all_of_them["rotation_deg"]),
                          number(all_of_them["direction_deg"]), percent(all_of_them["median_depth_error"], 1),
                          percent(all_of_them["depth_rmse"], 1), percent(all_of_them["null_depth_error"], 1),
                          number(all_of_them["ms"])])
        return grid.markdown(header, lines)


def column_title(factor, value):
    """A number says nothing without its factor."""
    return f"{factor} {value}" if value[0].isdigit() else value


def grouped(rows, factors):
    """{values of the factors: rows}, in the order of the rows."""
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[factor] for factor in factors), []).append(row)
    return groups


def is_success(row):
    """A map whose depths are right, and not by chance."""
    if row["status"] != "made":
        return False
    error = float(row["median_depth_error"])
    return error < SUCCESS and error < SUCCESS_BY_NULL * float(row["null_depth_error"])


def success_share(trials):
    return sum(map(is_success, trials)) / len(trials) if trials else math.nan


def refused_share(trials):
    return sum(row["status"] != "made" for row in trials) / len(trials) if trials else math.nan


# What a table gives for each value of a factor.
SHARES = {"success": success_share, "refused": refused_share}


def median_of(trials, column):
    """Over the trials that have the figure; not a number where none has."""
    values = [float(row[column]) for row in trials if row[column] != ""]
    return statistics.median(values) if values else math.nan


def figures(trials):
    """Shares of all trials; medians over those with a map, of the time over all."""
    made = [row for row in trials if row["status"] == "made"]
    return {"trials": len(trials), "success": success_share(trials), "refused": refused_share(trials),
            **{column: median_of(made, column) for column in FIGURES[3:-1]}, "ms": median_of(trials, "ms")}


def number(value, digits=2):
    return "-" if math.isnan(value) else f"{value:.{digits}f}"


def percent(share, digits=0):
    return "-" if math.isnan(share) else f"{100 * share:.{digits}f} %"
