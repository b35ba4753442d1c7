# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The plots of first maps, a panel a set of scenes, each as PNG and SVG."""

import pathlib
import statistics

import grid
import plots
import rendered
from plots import plt

# A color a family of starts (window_no_light is of `window`), a marker a start.
COLORS = [plots.BLUE, plots.VERMILION, plots.GREEN, plots.BLACK, plots.PURPLE, plots.ORANGE, plots.SKY]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "*", "<", ">", "h"]
LIMIT = {"color": "0.4", "linewidth": 1, "linestyle": "--"}
LEAST_DEPTH_ERROR = 1e-4  # smaller ones are drawn here: the axis is logarithmic, and the true map's error is rounding


def styles_of(grouped):
    variants = dict.fromkeys(variant for cells in grouped.values() for starts in cells.values() for variant in starts)
    families = list(dict.fromkeys(variant.split("_")[0] for variant in variants))
    return {variant: {"color": COLORS[families.index(variant.split("_")[0]) % len(COLORS)],
                      "marker": MARKERS[index % len(MARKERS)]} for index, variant in enumerate(variants)}


def quartiles(values):
    return statistics.quantiles(values, n=4, method="inclusive") if len(values) > 1 else values * 3


def panels(count):
    """Small multiples, two in a row."""
    columns = min(2, count)
    figure, axes = plt.subplots(-(-count // columns), columns, figsize=(6.5 * columns, 4 * -(-count // columns)),
                                sharey=True, squeeze=False, constrained_layout=True)
    for axis in axes.flat[count:]:
        axis.set_visible(False)
    return figure, axes.flat


def depth_axis(axis, failed_above):
    axis.set_yscale("log")
    axis.yaxis.set_major_formatter(lambda value, _: f"{100 * value:g} %")
    axis.axhline(failed_above, **LIMIT)
    axis.grid(axis="y", color="0.9")


def save(figure, styles, more_handles, folder, name):
    handles = [plt.Line2D([], [], linestyle="none", label=variant, **style) for variant, style in styles.items()]
    figure.legend(handles=handles + more_handles, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    plots.save(figure, [pathlib.Path(folder) / f"{name}.{ending}" for ending in ("png", "svg")], dpi=120,
               bbox_inches="tight")


def limit_handle(limits):
    return plt.Line2D([], [], label=f"failed above {100 * limits.failed_above:g} %", **LIMIT)


def depth_error(grouped, limits, cell_names, folder):
    """Medians over the seeds, and a line from the lower to the upper quartile; starts side by side within a speed."""
    figure, axes = panels(len(grouped))
    styles = styles_of(grouped)
    for axis, (name, cells) in zip(axes, grouped.items()):
        for place, starts in enumerate(cells.values()):
            for k, (variant, style) in enumerate(styles.items()):
                values = starts[variant].values("median_depth") if variant in starts else []
                if not values:
                    continue
                low, middle, high = (max(value, LEAST_DEPTH_ERROR) for value in quartiles(values))
                x = place + 0.8 * ((k + 0.5) / len(styles) - 0.5)
                axis.plot([x, x], [low, high], color=style["color"], linewidth=1.5)
                axis.plot(x, middle, **style)
            nulls = [value for one in starts.values() for value in one.values("null_median_depth")]
            if nulls:
                axis.plot([place - 0.4, place + 0.4], [statistics.median(nulls)] * 2, zorder=0, **plots.NULL)
        axis.set_xticks(range(len(cells)), [rendered.speed_of(cell, cell_names) for cell in cells])
        axis.set_title(name)
        depth_axis(axis, limits.failed_above)
    figure.supylabel("median relative depth error of the first map")
    save(figure, styles, [plt.Line2D([], [], label="one constant depth", **plots.NULL), limit_handle(limits)], folder,
         "depth_error")


def waiting(grouped, limits, folder):
    """A point a run, of all speeds: what the frames that an initializer waits are good for."""
    figure, axes = panels(len(grouped))
    styles = styles_of(grouped)
    for axis, (name, cells) in zip(axes, grouped.items()):
        for variant, style in styles.items():
            runs = [row for starts in cells.values() if variant in starts for row in starts[variant].declared()
                    if row["median_depth"] != ""]
            axis.plot([float(row["frames_waited"]) for row in runs],
                      [max(float(row["median_depth"]), LEAST_DEPTH_ERROR) for row in runs],
                      linestyle="none", alpha=0.7, **style)
        axis.set_title(name)
        depth_axis(axis, limits.failed_above)
    figure.supxlabel("frames from the reference to the map")
    figure.supylabel("median relative depth error of the first map")
    save(figure, styles, [limit_handle(limits)], folder, "waiting")


def failures(grouped, limits, cell_names, folder):
    """A row a set, a column a speed, a bar a start: the shares of good maps, failed ones, and none."""
    styles = styles_of(grouped)
    names = list(styles)
    speeds = max((list(cells) for cells in grouped.values()), key=len)
    figure, axes = plt.subplots(len(grouped), len(speeds), squeeze=False, sharex=True, sharey=True,
                                figsize=(3 * len(speeds) + 1, (0.25 * len(names) + 0.6) * len(grouped)),
                                constrained_layout=True)
    kinds = {"good": {"facecolor": plots.SKY}, "failed": {"facecolor": plots.VERMILION, "hatch": "////", "edgecolor": "white"},
             "no map": {"facecolor": "white", "edgecolor": "0.6"}}
    for row, (name, cells) in zip(axes, grouped.items()):
        for axis, (cell, starts) in zip(row, cells.items()):
            for variant in starts:
                runs = len(starts[variant].rows)
                failed, declared = len(starts[variant].failed(limits.failed_above)), len(starts[variant].declared())
                left = 0
                for count, look in zip((declared - failed, failed, runs - declared), kinds.values()):
                    axis.barh(names.index(variant), 100 * count / runs, left=left, height=0.8, linewidth=0.5, **look)
                    left += 100 * count / runs
            axis.set_title(f"{name}, {rendered.speed_of(cell, cell_names)}", fontsize="medium")
            axis.set_yticks(range(len(names)), names)
            axis.set_xlim(0, 100)
    axes[0][0].invert_yaxis()
    figure.supxlabel("% of the runs")
    handles = [plt.Rectangle((0, 0), 1, 1, label=label, **look) for label, look in kinds.items()]
    save(figure, {}, handles, folder, "failures")


def write(figures_path, limits, cell_names, folder):
    grouped = rendered.starts_of(grid.read_rows(figures_path))
    depth_error(grouped, limits, cell_names, folder)
    waiting(grouped, limits, folder)
    failures(grouped, limits, cell_names, folder)
