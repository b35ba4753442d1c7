# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Small multiples of the rows of a cross: a panel a value of one factor, a line a value of another."""

import math

import matplotlib.ticker
import plots
import two_views
from plots import plt

# A color, marker and dashes a line.
STYLES = [(plots.BLUE, "o", "-"), (plots.VERMILION, "s", "--"), (plots.GREEN, "^", "-."), (plots.PURPLE, "D", ":"),
          (plots.BLACK, "v", "-"), (plots.ORANGE, "x", "--")]
LABELS = {"median_depth_error": "median depth error", "direction_deg": "direction error, deg", "ms": "time, ms",
          "success": "successes", "refused": "refused", "outliers": "share of outliers", "noise_px": "noise, px",
          "gap_frames": "frames between"}
SHARES = ("success", "refused")


def spaced(axis, values, labels):
    """Log where the values allow it, and a tick a value."""
    if min(values) > 0:
        axis.set_xscale("log")
    axis.set_xticks(values)
    axis.set_xticklabels(labels)
    axis.xaxis.set_minor_locator(matplotlib.ticker.NullLocator())


def draw(crosses, name, csv_path, image_paths):
    plot = crosses.plots[name]
    values = crosses.values(plot["cross"])
    rows = [row for row in two_views.grid.read_rows(csv_path)
            if all(row[factor] in wanted for factor, wanted in plot.get("only", {}).items())]
    panels, lines, xs = (values[plot[key]] for key in ("panels", "lines", "x"))
    groups = two_views.grouped(rows, [plot["panels"], plot["lines"], plot["x"]])
    figure, axes = plt.subplots(len(plot["y"]), len(panels), sharex=True, sharey="row", squeeze=False,
                                figsize=(1.2 + 2.0 * len(panels), 0.8 + 1.7 * len(plot["y"])), layout="constrained")
    for row, y in enumerate(plot["y"]):
        for column, panel in enumerate(panels):
            axis = axes[row][column]
            for line, (color, marker, dashes) in zip(lines, STYLES):
                points = [two_views.figures(groups[panel, line, x])[y] if (panel, line, x) in groups else math.nan
                          for x in xs]
                axis.plot([float(x) for x in xs], points, color=color, marker=marker, linestyle=dashes, markersize=4,
                          linewidth=1.2, label=line)
            if y in SHARES:
                axis.set_ylim(-0.05, 1.05)
            else:
                axis.set_yscale("log")
            spaced(axis, [float(x) for x in xs], xs)
            axis.spines[["top", "right"]].set_visible(False)
            if row == 0:
                axis.set_title(panel, fontsize=9)
            if row == len(plot["y"]) - 1:
                axis.set_xlabel(LABELS[plot["x"]], fontsize=8)
            if column == 0:
                axis.set_ylabel(LABELS[y], fontsize=8)
            axis.tick_params(labelsize=7)
    figure.legend(*axes[0][0].get_legend_handles_labels(), loc="lower center", bbox_to_anchor=(0.5, 1.0),
                  ncols=len(lines), fontsize=8, frameon=False)
    plots.save(figure, image_paths, dpi=130, bbox_inches="tight")
