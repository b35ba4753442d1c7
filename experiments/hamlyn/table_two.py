# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The recordings and stand-ins of an experiment, and their figures beside those that others reported."""

import json
import pathlib
import sys

import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "common"))
import grid

COLUMNS = ["set", "start", "truth", "rmse_mm", "median_mm", "null_rmse_mm", "truth_sigma_mm", "left_out", "frames", "frames_tracked",
           "points", "frames_per_second"]
RECORDINGS = ["hamlyn_20", "hamlyn_21"]


class Recording:
    """A video of pairs that is there, and the protocol that it is known by."""

    truths = ["pairs"]

    def __init__(self, path, protocol, folder):
        self.path, self.protocol, self.frames = str(path), protocol, protocol["frames"]
        # A folder has a calibration of its own.
        self.camera = "" if path.is_dir() else f" --camera {folder / protocol['camera']}"

    def source(self, _truth):
        return self.path

    def track_options(self, _truth):
        start = self.protocol["start"]
        return f"--image_path '{self.path}'{self.camera} --start {start} --end {start + self.frames}"

    def evaluate_options(self, _truth):
        return f"--sequence '{self.path}'{self.camera}"

    def reported(self):
        return self.protocol["reported"]


class StandIn:
    """A simulated scene of the same optics: as a film of pairs, and as it was rendered with its exact depth."""

    truths = ["pairs", "depth"]

    def __init__(self, name, options, frames, camera):
        self.name, self.simulate_options, self.frames, self.camera = name, options, frames, camera

    def source(self, truth):
        return f"films/{self.name}.avi" if truth == "pairs" else f"simulated/{self.name}/done"

    def track_options(self, truth):
        return f"--image_path {self.source(truth)} --camera {self.camera}" if truth == "pairs" else (
            f"--image_path simulated/{self.name}")

    def evaluate_options(self, truth):
        return f"--sequence {self.source(truth)} --camera {self.camera}" if truth == "pairs" else (
            f"--sequence simulated/{self.name}")

    def reported(self):
        return {}


def sets(config, root):
    """By name, recordings first."""
    file = root / config["protocols"]
    protocols = yaml.safe_load(file.read_text(encoding="utf-8"))
    found = {name: Recording((root / config[name]).resolve(), protocols[name], file.parent)
             for name in RECORDINGS if config[name]}
    names = [] if grid.words(config["stand_ins"]) == ["none"] else grid.selected(
        config["stand_ins"], config["stand_in_options"], "stand_ins")
    camera = pathlib.Path(__file__).resolve().parent / "stand_in.yaml"
    for name in names:
        for seed in grid.words(config["seeds"]):
            options = " ".join([config["stand_in_options"][name], config["optics"], "--Scene.seed", seed,
                                "--Trajectory.frames", str(config["frames"])])
            found[f"{name}_s{seed}"] = StandIn(f"{name}_s{seed}", options, int(config["frames"]), camera)
    return found


def figures(name, item, start, truth):
    run = pathlib.Path("runs") / truth / start / name
    summary = json.loads((run / "run.json").read_text(encoding="utf-8"))
    surface = json.loads((run / "evaluation/evaluation.json").read_text(encoding="utf-8")).get("surface")
    row = {"set": name, "start": f"{start} start", "truth": truth, "frames": item.frames,
           "frames_tracked": summary["counts"]["frames_tracked"],
           "frames_per_second": grid.number(summary["timings"]["frames_per_second"], 1)}
    if surface:
        left_out = sum(surface["left_out"].values())
        row |= {"rmse_mm": grid.number(surface["estimate"]["mean_rmse_mm"]),
                "median_mm": grid.number(surface["estimate"]["pooled_median_mm"]),
                "null_rmse_mm": grid.number(surface["null"]["mean_rmse_mm"]),
                "truth_sigma_mm": grid.number(surface["truth_sigma_mm"]),
                "left_out": grid.number(100 * left_out / (left_out + surface["points"]), 1),
                "points": grid.number(surface["points"] / max(1, len(surface["frames"])), 0)}
    return row


def write(found, starts, markdown_path, csv_path):
    rows = []
    for name, item in found.items():
        rows += [{"set": name, "start": who, "truth": "pairs", "rmse_mm": rmse, "frames_tracked": frames}
                 for who, (rmse, frames) in item.reported().items()]
        rows += [figures(name, item, start, truth) for truth in item.truths for start in starts]
    titles = {"rmse_mm": "RMSE mm", "median_mm": "median mm", "null_rmse_mm": "null mm", "truth_sigma_mm": "truth's sigma mm", "left_out": "without truth %",
              "frames": "of", "frames_tracked": "frames", "frames_per_second": "frames/s"}
    text = grid.markdown([titles.get(name, name) for name in COLUMNS],
                         [[row.get(name, "-") for name in COLUMNS] for row in rows])
    pathlib.Path(markdown_path).write_text(text, encoding="utf-8")
    grid.write_rows(csv_path, COLUMNS, rows)
