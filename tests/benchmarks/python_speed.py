#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What Python costs: reading a large run, and tracking through the package beside the program.

usage: PYTHONPATH=build/release/python:tests/python python3 tests/benchmarks/python_speed.py PROGRAM OUT.json
           [REPETITIONS]

Prints, and writes as Google Benchmark does, processor times, the least of the repetitions: of reading a run of 1,000 frames with 500 points each; of tracking
60 simulated frames by the program and by pliant.track, whose callback takes each frame's points; and of what
pliant.Tracker does in Python's service for a frame (the image is copied, the points become arrays) beside the frame.
"""

import json
import pathlib
import resource
import subprocess
import sys
import tempfile

import numpy as np

import pliant
import support

FRAMES, POINTS = 1000, 500
OPTIONS = {"General.threads": 1, "Image.working": "fixed"}


def processor_seconds(who):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def least(repetitions, *calls):
    """The least processor time of each call, (whose time, function), s. They take turns: a machine's speed changes."""
    times = [[] for _ in calls]
    for _ in range(repetitions):
        for (who, function), of_call in zip(calls, times):
            before = processor_seconds(who)
            function()
            of_call.append(processor_seconds(who) - before)
    return [min(of_call) for of_call in times]


def write_run(folder):
    """A run of the given size, as another program would leave it."""
    random = np.random.default_rng(1)
    folder.mkdir()
    rows = FRAMES * POINTS
    numbers = np.column_stack([np.repeat(np.arange(FRAMES), POINTS), np.tile(np.arange(POINTS), FRAMES),
                               random.uniform(0, 640, (rows, 2)), random.normal(60, 20, (rows, 3)),
                               random.uniform(0, 1, (rows, 2))])
    np.savetxt(folder / "observations.csv", numbers, fmt="%d,%d,%.4f,%.4f,%.6f,%.6f,%.6f,%.4f,%.6f", comments="",
               header="frame,point_id,u_px,v_px,x,y,z,ssim,sigma_mm")
    (folder / "trajectory.txt").write_text("".join(f"{i / 30:.6f} 0 0 {i} 0 0 0 1\n" for i in range(FRAMES)))


def reading(folder, repetitions):
    write_run(folder)

    def read():
        run = pliant.open_run(folder)
        assert len(run.observations) == FRAMES * POINTS and len(run.poses) == FRAMES
    return least(repetitions, (resource.RUSAGE_SELF, read))[0]


def tracking(program, sequence, folder, repetitions):
    """Of the program and of pliant.track, s."""
    flags = [part for name, value in OPTIONS.items() for part in (f"--{name}", str(value))]
    command = [program, "track", "--image_path", sequence, "--output_path", folder / "a", "--overwrite", "--quiet",
               *flags]
    return least(repetitions, (resource.RUSAGE_CHILDREN, lambda: subprocess.run(command, check=True)),
                 (resource.RUSAGE_SELF, lambda: pliant.track(
                     sequence, folder / "b", OPTIONS, on_frame=lambda report: report.observations.position.sum())))


def service(sequence, repetitions):
    """Of a frame of pliant.Tracker, and of what it does for Python in it, s."""
    images = [support.read_png(path) for path in sorted((sequence / "images").iterdir())]
    camera = pliant.read_camera(sequence / "camera.yaml")
    reports = []

    def track():
        tracker = pliant.Tracker(camera, OPTIONS)
        reports[:] = [report for image in images for report in tracker.process(image)] + tracker.finish()
    frame = least(repetitions, (resource.RUSAGE_SELF, track))[0] / len(images)

    # An image that is refused for its mask is copied all the same.
    tracker, mask = pliant.Tracker(camera, OPTIONS), np.zeros((1, 1), np.uint8)

    def serve():
        for image, report in zip(images, reports):
            try:
                tracker.process(image, mask)
            except pliant.Error:
                pass
            report.observations, report.cam_from_world
    return frame, least(repetitions, (resource.RUSAGE_SELF, serve))[0] / len(images)


def benchmark(name, seconds, **counters):
    print(f"{name}: {1000 * seconds:.3f} ms", *(f"{label} {value:.4f}" for label, value in counters.items()), flush=True)
    return {"name": f"Python/{name}", "run_type": "iteration", "real_time": seconds, "time_unit": "s", **counters}


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    repetitions = int(sys.argv[3]) if len(sys.argv) > 3 else 5
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        results = [benchmark("read_run", reading(folder / "large", repetitions))]
        sequence = folder / "colon"
        pliant.simulate(sequence, {"Trajectory.frames": 60})
        by_program, by_package = tracking(program, sequence, folder, repetitions)
        results.append(benchmark("track", by_package, cost=by_package / by_program - 1))
        frame, served = service(sequence, repetitions)
        results.append(benchmark("tracker_frame", frame, cost=served / frame))
    pathlib.Path(sys.argv[2]).write_text(json.dumps({"benchmarks": results}, indent=1))


if __name__ == "__main__":
    main()
