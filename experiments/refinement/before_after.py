# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The table of runs before and after refinement: errors, and whether the runs know them. Standard library only."""
import json
import pathlib
import statistics

import grid

REFINED = "refined_"
COLUMNS = ["set", "amplitude_mm", "omega_rad_s", "seed", "variant", "rmse_mm", "ate_mm", "within_1_sigma",
           "within_2_sigma", "nees", "area", "oracle_area", "seconds"]


def row_of(run):
    """The figures of the run in folder `run` = runs/VARIANT/SCENE; None where it has no map."""
    run = pathlib.Path(run)
    evaluation = json.loads((run / "evaluation/evaluation.json").read_text())
    if not evaluation.get("surface"):
        return None
    parts = grid.SCENE.fullmatch(run.name)
    row = {"set": parts["set"], "amplitude_mm": parts["amplitude"], "omega_rad_s": parts["omega"],
           "seed": parts["seed"], "variant": run.parent.name,
           "rmse_mm": evaluation["surface"]["estimate"]["mean_rmse_mm"],
           "ate_mm": evaluation["trajectory"]["ate_rmse_mm"] if evaluation.get("trajectory") else "",
           "seconds": evaluation["run_seconds"]}
    if uncertainty := evaluation.get("uncertainty"):
        row |= {key: uncertainty[key] for key in ("within_1_sigma", "within_2_sigma", "nees")}
        row |= {key: uncertainty["sparsification"][key] for key in ("area", "oracle_area")}
    return row


def median(rows, column):
    values = [float(row[column]) for row in rows if row.get(column, "") != ""]
    return statistics.median(values) if values else None


def write(runs, markdown_path, csv_path):
    """Of the runs of a grid.Grid: a row a run in the CSV, a row a cell and variant in the Markdown."""
    rows = [row for row in map(row_of, runs.runs()) if row]
    grid.write_rows(csv_path, COLUMNS, rows)
    cells = {}
    for row in rows:
        cells.setdefault((row["set"], row["amplitude_mm"], row["omega_rad_s"]), []).append(row)
    body = []
    variants = [name for name in runs.variants if not name.startswith(REFINED)]
    for (name, amplitude, omega), members in cells.items():
        for variant in variants:
            before = {row["seed"]: row for row in members if row["variant"] == variant}
            after = {row["seed"]: row for row in members if row["variant"] == REFINED + variant}
            both = sorted(before.keys() & after.keys())
            ratios = [after[seed]["rmse_mm"] / before[seed]["rmse_mm"] for seed in both]
            if not ratios:
                continue
            line = [name, amplitude, omega, variant, f"{len(both)} of {len(runs.seeds)}"]
            for column in ("rmse_mm", "ate_mm"):
                line += [grid.number(median([side[seed] for seed in both], column)) for side in (before, after)]
            line += [grid.number(statistics.median(ratios)), f"{min(ratios):.2f}..{max(ratios):.2f}"]
            for side in (before, after):
                inside = [median([side[seed] for seed in both], f"within_{k}_sigma") for k in (1, 2)]
                line.append("-" if inside[0] is None else f"{100 * inside[0]:.0f}, {100 * inside[1]:.0f}")
            body.append(line)
    header = ["set", "A, mm", "omega, rad/s", "run", "seeds with a map", "RMSE online, mm", "refined", "ATE online, mm",
              "refined", "RMSE refined by online", "range", "within 1, 2 sigma online, %", "refined"]
    pathlib.Path(markdown_path).write_text(grid.markdown(header, body), encoding="utf-8")
