# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parts of a recording, and what their joined run is worth beside that of the whole."""
import csv
import json
import subprocess
from pathlib import Path


def ranges(frames, part_frames, overlap):
    """First frame and end of each part; the last one is no shorter than the others unless it is alone."""
    if not 0 < overlap < part_frames:
        raise ValueError(f"parts of {part_frames} frames cannot overlap by {overlap}")
    step = part_frames - overlap
    starts = [0]
    while starts[-1] + part_frames < frames:
        starts.append(starts[-1] + step)
    return [(max(0, min(start, frames - part_frames)), min(start + part_frames, frames)) for start in starts]


def figures_of(program, run, sequence, others):
    """Of evaluation.json: what there is to say of a run."""
    folder = Path("evaluation") / run
    command = [program, "evaluate", "--run", run, "--output_path", folder]
    command += ["--sequence", sequence] if sequence else []
    command += [word for other in others for word in ("--other_run", other)]
    subprocess.run(command, check=True, capture_output=True)
    return json.loads((folder / "evaluation.json").read_text())


def row_of(program, name, run, sequence, other):
    summary = json.loads((Path(run) / "run.json").read_text())
    counts = summary["counts"]
    row = {"run": name, "frames": f"{counts['frames_tracked']} of {counts['frames_read']}",
           "submaps": counts["submaps"], "points": counts["points"], "RMSE": "", "path": "", "differs": ""}
    if not sequence and not other:
        return row
    figures = figures_of(program, run, sequence, [other] if other else [])
    if figures["surface"]:
        row["RMSE"] = f"{figures['surface']['estimate']['mean_rmse_mm']:.2f} mm"
    if figures["trajectory"]:
        row["path"] = f"{figures['trajectory']['ate_rmse_mm']:.2f} mm"
    compared = figures["consistency"][0].get("estimate") if other else None
    if compared:
        row["differs"] = f"{100 * compared['median_relative_depth']:.1f} %"
    return row


def write(program, count, sequence, compared, markdown, csv_path):
    rows = []
    if compared:
        rows.append(row_of(program, "the whole", "whole", sequence, ""))
    rows.append(row_of(program, f"{count} parts, joined", "joined", sequence, "whole" if compared else ""))
    with open(csv_path, "w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    head = ["run", "frames with a map", "submaps", "points", "surface RMSE", "camera path (ATE)",
            "depths differ from the whole's"]
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    lines += ["| " + " | ".join(str(value) for value in row.values()) + " |" for row in rows]
    Path(markdown).write_text("\n".join(lines) + "\n", encoding="utf-8")
