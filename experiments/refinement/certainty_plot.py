# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether runs know how far they are off: errors over the sigmas that were said, and what is left without the least
certain points."""

import json
import pathlib
import statistics

import plots
from before_after import REFINED
from plots import plt

STYLES = {False: {"color": plots.BLUE, "marker": "o", "label": "online"},
          True: {"color": plots.VERMILION, "marker": "s", "label": "refined"}}


def uncertainties(runs):
    """{whether it is refined: [uncertainty of its evaluation.json, ...]} of the runs that have one."""
    found = {False: [], True: []}
    for run in map(pathlib.Path, runs):
        if part := json.loads((run / "evaluation/evaluation.json").read_text()).get("uncertainty"):
            found[run.parent.name.startswith(REFINED)].append(part)
    return found


def draw_errors(axis, found):
    """A mark a tenth of the points of a run, by their sigma."""
    values = []
    for refined, parts in found.items():
        bins = [entry for part in parts for entry in part["bins"]]
        sigmas, errors = ([entry[key] for entry in bins] for key in ("sigma_mm", "rmse_mm"))
        axis.plot(sigmas, errors, linestyle="none", markersize=3, alpha=0.5, **STYLES[refined])
        values += sigmas
    ends = [min(values), max(values)]
    axis.plot(ends, ends, color=plots.BLACK, linewidth=1, label="as large as said")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("sigma, mm")
    axis.set_title("RMSE of the distance, mm", fontsize="medium")


def mean_curve(parts, key):
    return [statistics.fmean(values) for values in zip(*(part["sparsification"][key] for part in parts))]


def draw_sparsification(axis, found):
    for refined, parts in found.items():
        if not parts:
            continue
        style = STYLES[refined]
        curve = mean_curve(parts, "curve")
        left_out = [100 * i / len(curve) for i in range(len(curve))]
        axis.plot(left_out, curve, markersize=3, **style)
        axis.plot(left_out, mean_curve(parts, "oracle"), color=style["color"], linestyle="--",
                  label=f"{style['label']}, by their errors")
    axis.set_ylim(0, 1.05)
    axis.set_xlabel("least certain points left out, %")
    axis.set_title("RMSE of the others, by that of all", fontsize="medium")


def write(runs, paths):
    found = uncertainties(runs)
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.5), constrained_layout=True)
    draw_errors(axes[0], found)
    draw_sparsification(axes[1], found)
    for axis in axes:
        axis.grid(color="0.9")
        axis.legend(frameon=False)
    plots.save(figure, paths, dpi=120)
