# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""One table of the runs that run.sh leaves: means over the scenes' seeds.

usage: table.py RUNS FRAMES
"""

import json
import pathlib
import re
import sys

NAME = re.compile(r"(\w+)-A([\d.]+)-seed(\d+)-(\w+)-filter_(\w+)-agreement_(\w+)")
STARTS = {"depth": "true map", "gated": "monocular"}
# The order in which defences are added.
DEFENCES = [("off", "off"), ("on", "off"), ("off", "on"), ("on", "on")]


def figures_of(run):
    """A run's figures, or None where it never tracked a frame."""
    path = run / "evaluation" / "evaluation.json"
    if not path.exists():
        return None
    evaluation = json.loads(path.read_text())
    counts = json.loads((run / "run.json").read_text())["counts"]
    estimate = evaluation["surface"]["estimate"]
    tracked = counts["frames_tracked"]
    return {
        "rmse": estimate["mean_rmse_mm"],
        "median": estimate["pooled_median_mm"],
        "null": evaluation["surface"]["null"]["mean_rmse_mm"],
        "tracked": tracked,
        "points": counts["observations"] / tracked,
    }


def mean(runs, key):
    return sum(run[key] for run in runs) / len(runs)


def main(folder, frames):
    groups = {}
    for run in sorted(folder.iterdir()):
        match = NAME.fullmatch(run.name)
        if match:
            motion, amplitude, _, start, contour, agreement = match.groups()
            groups.setdefault((motion, amplitude, start), {}).setdefault((contour, agreement), []).append(run)
    print("| motion | A mm | start | contour filter | agreement | RMSE mm | worst seed | median mm | null RMSE mm "
          f"| frames of {frames} | points a frame | runs with a map |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for (motion, amplitude, start), by_defence in sorted(groups.items(), key=lambda item: (item[0][2], item[0])):
        for defence in DEFENCES:
            runs = by_defence.get(defence, [])
            figures = [figure for figure in map(figures_of, runs) if figure]
            row = [motion, amplitude, STARTS[start], *defence]
            if figures:
                row += [f"{mean(figures, 'rmse'):.2f}", f"{max(f['rmse'] for f in figures):.2f}",
                        f"{mean(figures, 'median'):.3f}", f"{mean(figures, 'null'):.1f}",
                        f"{mean(figures, 'tracked'):.0f}", f"{mean(figures, 'points'):.0f}"]
            else:
                row += ["-"] * 6
            print("| " + " | ".join(row + [f"{len(figures)} of {len(runs)}"]) + " |")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), sys.argv[2])
