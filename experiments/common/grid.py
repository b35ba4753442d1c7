# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A grid of simulated scenes and tracking variants: its names, its options, and the figures of its runs.

A scene is SET_AAMPLITUDE_wOMEGA_sSEED, for example dm_A2.5_w5_s1; a rigid one has A0_w0. A variant is a name and a list
of options of `pliant track`. Python's standard library only.
"""

import csv
import json
import pathlib
import re
import statistics

SCENE = re.compile(r"(?P<set>\w+?)_A(?P<amplitude>[\d.]+)_w(?P<omega>[\d.]+)_s(?P<seed>\d+)")

# One row a run: what it is, then what it gave. A run without a first map has empty figures.
COLUMNS = ["set", "amplitude_mm", "omega_rad_s", "seed", "variant", "status", "rmse_mm", "median_mm", "null_rmse_mm",
           "material_rmse_mm", "points", "frames_read", "frames_tracked", "alive_share", "ate_mm", "frames_per_second",
           "note"]


def words(value):
    """A list given as a list, or as text with commas or spaces between (as on a command line)."""
    if isinstance(value, (list, tuple)):
        return [str(item) for item in value]
    return str(value).replace(",", " ").split()


def selected(names, defined, what):
    """The named ones of what is defined, in the order of the names; `all` are all."""
    names = words(names)
    if names == ["all"]:
        return list(defined)
    unknown = [name for name in names if name not in defined]
    if unknown:
        raise ValueError(f"{what}: '{unknown[0]}' is not one of {', '.join(defined)}")
    return names


class Grid:
    """The selected part of what an experiment's config.yaml defines; a name that it does not define is an error."""

    def __init__(self, config):
        self.config = config
        self.sets = selected(config["sets"], config["set_options"], "sets")
        self.variants = selected(config["variants"], config["variant_options"], "variants")
        self.cells = [tuple(cell.split(":")) for cell in words(config["cells"])]
        for cell in self.cells:
            if len(cell) != 2:
                raise ValueError(f"a cell is AMPLITUDE:OMEGA, not '{':'.join(cell)}'")
        self.seeds = words(config["seeds"])

    def scenes(self):
        return [f"{name}_A{amplitude}_w{omega}_s{seed}" for name in self.sets for amplitude, omega in self.cells
                for seed in self.seeds]

    def runs(self):
        return [f"runs/{variant}/{scene}" for variant in self.variants for scene in self.scenes()
                if self.is_tracked_by(scene, variant)]

    def is_tracked_by(self, scene, variant):
        chosen = self.config.get("set_variants", {}).get(SCENE.fullmatch(scene)["set"], "all")
        return words(chosen) == ["all"] or variant in words(chosen)

    def simulate_options(self, scene):
        parts = SCENE.fullmatch(scene)
        rigid = float(parts["amplitude"]) == 0
        options = ["--Scene.seed", parts["seed"], "--Deformation.amplitude_mm", parts["amplitude"],
                   "--Trajectory.frames", self.config["frames"]]
        if not rigid:
            options += ["--Deformation.omega_rad_s", parts["omega"]]
        return " ".join(map(str, options + words(self.config["set_options"][parts["set"]]) +
                            words(self.config["simulate_options"])))

    def track_options(self, variant):
        return " ".join(words(self.config["variant_options"][variant]) + words(self.config["track_options"]))


def figures_of(run):
    """The row of the run in folder `run` = .../runs/VARIANT/SCENE."""
    run = pathlib.Path(run)
    parts = SCENE.fullmatch(run.name)
    summary = json.loads((run / "run.json").read_text())
    evaluation = json.loads((run / "evaluation/evaluation.json").read_text())
    row = {"set": parts["set"], "amplitude_mm": parts["amplitude"], "omega_rad_s": parts["omega"], "seed": parts["seed"],
           "variant": run.parent.name, "status": summary["status"], "note": summary["note"],
           "frames_read": summary["counts"]["frames_read"], "frames_tracked": summary["counts"]["frames_tracked"],
           "frames_per_second": summary["timings"]["frames_per_second"]}
    surface = evaluation.get("surface")
    if surface:
        row |= {"rmse_mm": surface["estimate"]["mean_rmse_mm"], "median_mm": surface["estimate"]["pooled_median_mm"],
                "null_rmse_mm": surface["null"]["mean_rmse_mm"]}
    if evaluation.get("material"):
        row["material_rmse_mm"] = evaluation["material"]["estimate"]["mean_rmse_mm"]
    if evaluation.get("trajectory"):
        row["ate_mm"] = evaluation["trajectory"]["ate_rmse_mm"]
    if evaluation.get("survival"):
        survival = evaluation["survival"]
        row["points"] = survival["mean_points"]
        row["alive_share"] = survival["last_alive_of_first"] / max(1, survival["first_points"])
    return row


def write_rows(path, columns, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def read_rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Cell:
    """The rows of one cell and variant: one a seed."""

    def __init__(self, rows):
        self.rows = rows
        self.measured = [row for row in rows if row["rmse_mm"] != ""]

    def values(self, column):
        return [float(row[column]) for row in self.measured if row[column] != ""]

    def median(self, column):
        """Over the seeds that have the figure; None where none has."""
        values = self.values(column)
        return statistics.median(values) if values else None

    def median_rmse(self):
        """Over ALL seeds: a run without a map is worse than any with one. None where the median run has no map."""
        values = self.values("rmse_mm") + [float("inf")] * (len(self.rows) - len(self.measured))
        median = statistics.median(values) if values else float("inf")
        return median if median != float("inf") else None

    def spread(self):
        values = self.values("rmse_mm")
        return f"{min(values):.2f}..{max(values):.2f}" if values else "-"


def cells_of(rows):
    """{(set, variant): {(amplitude, omega): Cell}}, everything in the order of the rows."""
    grouped = {}
    for row in rows:
        cells = grouped.setdefault((row["set"], row["variant"]), {})
        cells.setdefault((row["amplitude_mm"], row["omega_rad_s"]), []).append(row)
    return {key: {cell: Cell(rows) for cell, rows in cells.items()} for key, cells in grouped.items()}


def number(value, digits=2):
    return "-" if value is None else f"{value:.{digits}f}"


def markdown(header, rows):
    lines = ["| " + " | ".join(header) + " |", "| " + " | ".join("---" for _ in header) + " |"]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows]) + "\n"


def put_into_readme(readme, table):
    """Replaces what stands between the two marks of a README by the text of the file `table`."""
    begin, end = "<!-- table -->\n", "<!-- end of table -->\n"
    text = pathlib.Path(readme).read_text(encoding="utf-8")
    if text.count(begin) != 1 or text.count(end) != 1:
        raise ValueError(f"{readme} has not the two lines {begin.strip()} and {end.strip()}")
    before, rest = text.split(begin)
    _, after = rest.split(end)
    content = pathlib.Path(table).read_text(encoding="utf-8")
    pathlib.Path(readme).write_text(f"{before}{begin}\n{content}\n{end}{after}", encoding="utf-8")
