# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The curves over amplitude, as PNG and SVG: where the rigid reconstruction breaks."""

import pathlib

import baseline
import grid
import plots
from plots import plt

STYLES = [{"color": plots.BLUE, "marker": "o"}, {"color": plots.VERMILION, "marker": "s"},
          {"color": plots.GREEN, "marker": "^"}, {"color": plots.PURPLE, "marker": "v"},
          {"color": plots.ORANGE, "marker": "D"}]
PANELS = [("surface RMSE, mm", "rmse_mm", 1, "log"), ("ATE, % of the path", "ate_percent", 1, "log"),
          ("tracks that go on with another one, %", "continuing_share", 100, "linear"),
          ("reprojection error, median, px", "reprojection_px", 1, "linear")]


def draw(axis, grouped, column, factor):
    """Medians over the seeds joined by a line, and each seed as a small mark."""
    variants = dict.fromkeys(variant for _, variant in grouped)
    for variant, style in zip(variants, STYLES):
        amplitudes, medians = [], []
        for (amplitude, name), rows in grouped.items():
            values = [factor * float(row[column]) for row in rows if row[column] != ""]
            if name != variant or not values:
                continue
            axis.plot([float(amplitude)] * len(values), values, linestyle="none", markersize=4, alpha=0.4, **style)
            amplitudes.append(float(amplitude))
            medians.append(factor * baseline.median(rows, column))
        axis.plot(amplitudes, medians, label=variant, **style)


def write(figures_path, folder):
    grouped = baseline.grouped(grid.read_rows(figures_path))
    figure, axes = plt.subplots(2, 2, figsize=(11, 7.5), sharex=True, constrained_layout=True)
    for axis, (title, column, factor, scale) in zip(axes.flat, PANELS):
        draw(axis, grouped, column, factor)
        axis.set_title(title, fontsize="medium")
        axis.set_yscale(scale)
        axis.grid(axis="y", color="0.9")
        if scale == "log":
            axis.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    nulls = {float(amplitude): baseline.median(rows, "null_rmse_mm") for (amplitude, _), rows in grouped.items() if rows}
    nulls = {amplitude: null for amplitude, null in nulls.items() if null is not None}
    axes.flat[0].plot(list(nulls), list(nulls.values()), label="one constant depth", zorder=0, **plots.NULL)
    axes.flat[0].legend(frameon=False)
    figure.supxlabel("amplitude of the deformation, mm")
    plots.save(figure, [pathlib.Path(folder) / f"comparison.{ending}" for ending in ("png", "svg")], dpi=120)
