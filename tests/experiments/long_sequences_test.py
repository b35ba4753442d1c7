# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures of runs that are long or come back.

usage: long_sequences_test.py staying|soak PLIANT
"""

from support import ROUND_OFF, experiment_modules, main

experiment_modules("long_sequences", "soak")

MIN_SHELL_MB, MAX_SHELL_MB = 0.5, 100  # what a shell that runs one line takes


def staying(folder):
    """What counts as visible, as survived, and as an end-point's error; of a run and a sequence made by hand."""
    import staying as figures

    sequence, run = folder / "seq", folder / "runs/default/loop_A2.5_w2.5_s3"
    (run / "evaluation").mkdir(parents=True)
    sequence.mkdir()
    (sequence / "simulation.yaml").write_text(
        "Sensor:  # levels\n  blackout_period_s: 9\nInterruption:  # what\n  blackout_period_s: 1  # [s] how often\n"
        "  blackout_s: 0.2  # [s]\n  blur_period_s: 0\n  blur_s: 1\nCamera:\n  blackout_s: 7\n", encoding="utf-8")
    times = [0.1 * i for i in range(32)]
    (sequence / "groundtruth.txt").write_text("".join(f"{t:.6f} {t:.6f} 0 0 0 0 0 1\n" for t in times), encoding="utf-8")
    dark = {10, 11, 20, 21, 30, 31}
    # Lost in the dark; after the second black-out another map is there, after the third nothing follows.
    rows = [{"frame": i, "state": "lost" if i in dark or i == 22 else "tracking", "submap": int(i > 22),
             "optimized": 0 if i in dark else 100 + i, "ms_a": 3, "ms_b": 4} for i in range(32)]
    figures.grid.write_rows(run / "frames.csv", list(rows[0]), rows)
    (run / "run.json").write_text('{"counts": {"submaps": 1}}', encoding="utf-8")
    (run / "trajectory.txt").write_text("".join(f"{t:.6f} {2.1 * t:.6f} 0 0 0 0 0 1\n" for i, t in enumerate(times)
                                                if rows[i]["state"] == "tracking"), encoding="utf-8")
    (run / "evaluation/evaluation.json").write_text(
        '{"surface": {"estimate": {"mean_rmse_mm": 1.5}}, "trajectory": {"scale": 0.5}}', encoding="utf-8")
    figures.grid.write_rows(run / "evaluation/evaluation.csv", ["frame", "rmse_mm", "scale"],
                            [{"frame": i, "rmse_mm": 1 + i, "scale": 2} for i in range(30) if i not in dark])
    row = figures.figures_of(run, sequence)
    assert row["visible_frames"] == 26 and row["tracked_visible"] == 25, row
    assert row["blackouts"] == 3 and row["blackouts_survived"] == 1, row
    assert row["fewest_points"] == 100 and row["ms_per_frame"] == 7, row
    assert abs(row["path_mm"] - 2.9) < ROUND_OFF and abs(row["end_point_mm"] - 0.05 * 2.9) < ROUND_OFF, row
    assert row["scale_drift"] == 0 and row["rmse_mm"] == 1.5, row
    figures.write([(run, sequence)], folder / "table.md", folder / "table.csv")
    line = (folder / "table.md").read_text(encoding="utf-8").splitlines()[2]
    assert line.startswith("| loop | 2.5 | default | 96.2 | 1 of 3 | 1.0 |") and line.endswith("| 5.00 |"), line


def soak(folder):
    """A way repeated, a program's memory, the frames that count, and the line between two runs; by hand."""
    import soak as figures

    (folder / "way/images").mkdir(parents=True)
    (folder / "way/camera.yaml").write_text("model: PINHOLE\n", encoding="utf-8")
    for i in range(3):
        (folder / f"way/images/{i:06d}.png").write_text(str(i), encoding="utf-8")
    figures.repeat(folder / "way", folder / "long", 3, 8)
    images = sorted((folder / "long/images").iterdir())
    assert [path.read_text(encoding="utf-8") for path in images] == list("01201201"), images
    assert (folder / "long/camera.yaml").exists()

    program = folder / "program"
    program.write_text('#!/bin/sh\nmkdir -p "$5"\necho "$@" > "$5/arguments"\n', encoding="utf-8")
    program.chmod(0o755)
    figures.track(program, "sequence", folder / "run", ["--a", "b"])
    assert (folder / "run/arguments").read_text(encoding="utf-8").endswith("--quiet --a b\n")
    assert MIN_SHELL_MB < figures.json.loads((folder / "run/process.json").read_text(encoding="utf-8"))["peak_mb"] < MAX_SHELL_MB

    # 40 slow frames make the map, 100 are told at either end of 1000; the reader's time does not count.
    figures.FIRST = 40
    with open(folder / "run/frames.csv", "w", encoding="utf-8") as file:
        file.write("frame,tracked,ms_prepare,ms_pose,ms_joint\n")
        for i in range(1000):
            file.write(f"{i},{500 if i < 140 else 0},77,{90 if i < 40 else 3 if i < 140 else 5},1\n")
    (folder / "run/run.json").write_text('{"counts": {"frames_tracked": 1000}, "timings": {"frames_per_second": 25}}',
                                         encoding="utf-8")
    row = figures.row_of("long", folder / "run", 140)
    assert (row["points"], row["ms"], row["ms_last"], row["median_ms"]) == (500, 4, 6, 4), row
    runs = [{"points": points, "ms": ms} for points, ms in ((100, 1), (400, 10), (600, 20))]
    assert figures.alone_at(450, runs) == 12.5 and figures.alone_at(700, runs) == 25, "on the line through the nearest"


if __name__ == "__main__":
    main(staying, soak)
