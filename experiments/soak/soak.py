# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A way that is gone again and again, and what following it costs. Python's standard library only."""

import csv
import json
import os
import pathlib
import shutil
import statistics
import subprocess

COLUMNS = ["run", "frames", "tracked", "points", "ms", "ms_last", "median_ms", "median_ms_last", "frames_per_second", "peak_mb"]
# The first frames make the map; then come as many as the short runs have, and as many at the end.
FIRST = 100


def repeat(way, sequence, period, frames):
    """A sequence of `frames` images, links to those of a way of `period` frames over and over."""
    way, sequence = pathlib.Path(way).resolve(), pathlib.Path(sequence)
    shutil.rmtree(sequence, ignore_errors=True)
    (sequence / "images").mkdir(parents=True)
    shutil.copy(way / "camera.yaml", sequence)
    for frame in range(frames):
        os.symlink(way / "images" / f"{frame % period:06d}.png", sequence / "images" / f"{frame:06d}.png")


def track(program, sequence, run, options):
    """Tracks, and writes process.json with the peak of the memory."""
    shutil.rmtree(run, ignore_errors=True)
    command = [program, "track", "--image_path", sequence, "--output_path", run, "--quiet", *options]
    with subprocess.Popen(list(map(str, command))) as process:
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise subprocess.CalledProcessError(process.returncode, command)
    text = json.dumps({"peak_mb": usage.ru_maxrss / 1024.0})
    pathlib.Path(run, "process.json").write_text(text + "\n", encoding="utf-8")


def milliseconds(rows):
    """Of the tracker, frame by frame: what is prepared while the frame before it is tracked does not count."""
    stages = [name for name in rows[0] if name.startswith("ms_") and name != "ms_prepare"]
    return [sum(float(row[stage]) for stage in stages) for row in rows]


def figures_of(run):
    with open(f"{run}/frames.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    summary = json.loads(pathlib.Path(run, "run.json").read_text(encoding="utf-8"))
    process = json.loads(pathlib.Path(run, "process.json").read_text(encoding="utf-8"))
    return rows, summary, process


def row_of(name, run, length):
    rows, summary, process = figures_of(run)
    begin, end = milliseconds(rows[FIRST:length]), milliseconds(rows[-(length - FIRST):])
    return {"run": name, "frames": len(rows), "tracked": summary["counts"]["frames_tracked"],
            "points": statistics.mean(int(row["tracked"]) for row in rows[FIRST:length]), "ms": statistics.mean(begin),
            "ms_last": statistics.mean(end), "median_ms": statistics.median(begin), "median_ms_last": statistics.median(end),
            "frames_per_second": summary["timings"]["frames_per_second"], "peak_mb": process["peak_mb"]}


def alone_at(points, rows):
    """Milliseconds of tracking alone with so many points, on the line through the two runs nearest to it."""
    near = sorted(sorted(rows, key=lambda row: abs(row["points"] - points))[:2], key=lambda row: row["points"])
    if len(near) < 2 or near[0]["points"] == near[1]["points"]:
        return near[0]["ms"]
    share = (points - near[0]["points"]) / (near[1]["points"] - near[0]["points"])
    return near[0]["ms"] + share * (near[1]["ms"] - near[0]["ms"])


def write(names, markdown, table):
    short = figures_of("runs/short")[0]
    rows = [row_of(name, f"runs/{name}", len(short)) for name in names]
    with open(table, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    lines = ["| run | frames | tracked | points a frame | ms a frame | at the end | median ms | at the end | frames/s | peak memory, MB |",
             "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    for row in rows:
        lines.append(f"| {row['run']} | {row['frames']} | {row['tracked']} | {row['points']:.0f} | {row['ms']:.1f} | "
                     f"{row['ms_last']:.1f} | {row['median_ms']:.1f} | {row['median_ms_last']:.1f} | "
                     f"{row['frames_per_second']:.1f} | {row['peak_mb']:.0f} |")
    full = next(row for row in rows if row["run"] == "short")
    alone = alone_at(full["points"], [row for row in rows if row["run"].startswith("alone_")])
    lines += ["", f"Tracking alone with {full['points']:.0f} points takes {alone:.1f} ms (between the runs nearest to it); with all "
              f"that keeps the map alive it is {full['ms']:.1f} ms, {full['ms'] / alone:.2f} times as much."]
    pathlib.Path(markdown).write_text("\n".join(lines) + "\n", encoding="utf-8")
