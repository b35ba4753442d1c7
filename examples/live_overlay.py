#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tracks a camera image by image, and draws where every point is and has been over the video.

usage: live_overlay.py SOURCE CAMERA [--output_path FOLDER] [--frames N]

SOURCE: what OpenCV opens, the number of a camera (0), an address, or a video; CAMERA: a calibration that Pliant reads.
Every image of a video is tracked; of a camera or an address the newest one, and those that came meanwhile are left out.
Pictures go into FOLDER, or without one into a window, which Esc closes. Needs python3-opencv.
"""

import argparse
import itertools
import pathlib
import queue
import threading

import cv2
import numpy as np

import pliant

NEAR_BGR, FAR_BGR = np.array([40, 180, 255]), np.array([255, 120, 40])
EXAMPLES = 16  # images that choose the size in which points are tracked
TRAIL = 10     # frames


def all_images(capture):
    while True:
        there, image = capture.read()
        if not there:
            return
        yield image


def newest_images(capture):
    newest = queue.Queue(maxsize=1)

    def receive():
        for image in itertools.chain(all_images(capture), [None]):
            try:
                newest.get_nowait()  # that was not asked for in time
            except queue.Empty:
                pass
            newest.put(image)

    threading.Thread(target=receive, daemon=True).start()
    while (image := newest.get()) is not None:
        yield image


def images_of(source, most):
    capture = cv2.VideoCapture(int(source) if source.isdigit() else source)
    if not capture.isOpened():
        raise SystemExit(f"cannot open {source}")
    is_live = source.isdigit() or "://" in source or source.startswith("/dev/")
    return is_live, itertools.islice((newest_images if is_live else all_images)(capture), most)


def draw(image, report, trails):
    """`trails`: the last pixels of every point, by its id."""
    seen, pose = report.observations, report.cam_from_world
    picture = image.copy()
    if pose is not None and len(seen) > 0:
        depth = seen.position @ pose[2, :3] + pose[2, 3]
        near, far = np.percentile(depth, [5, 95])
        shares = np.clip((depth - near) / max(far - near, 1e-9), 0, 1)
        for point, pixel, share in zip(seen.point_id, seen.pixel, shares):
            trail = trails.setdefault(int(point), [])
            trail.append(pixel)
            del trail[:-TRAIL]
            color = tuple(int(c) for c in (1 - share) * NEAR_BGR + share * FAR_BGR)
            cv2.polylines(picture, [np.rint(trail).astype(np.int32)], False, color, 1, cv2.LINE_AA)
            cv2.circle(picture, tuple(int(c) for c in np.rint(pixel)), 2, color, -1, cv2.LINE_AA)
    for gone in set(trails) - set(seen.point_id.tolist()):
        del trails[gone]
    text = f"{report.frame_idx}: {report.state}"
    if pose is not None:
        x, y, z = report.world_from_cam[:3, 3]
        text += f", camera at {x:.1f} {y:.1f} {z:.1f}, {len(seen)} points"
    cv2.putText(picture, text, (8, 20), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (255, 255, 255), 1, cv2.LINE_AA)
    return picture


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source")
    parser.add_argument("camera")
    parser.add_argument("--output_path", type=pathlib.Path)
    parser.add_argument("--frames", type=int, default=10**9)
    arguments = parser.parse_args()
    if arguments.output_path:
        arguments.output_path.mkdir(parents=True, exist_ok=True)

    is_live, images = images_of(arguments.source, arguments.frames)
    examples = list(itertools.islice(images, EXAMPLES))
    # A map is taken over some frames after it was asked for, when it is there: no frame waits for it.
    options = {"Tracking.handover_frames": 30, "Tracking.handover_waits": "off"} if is_live else {}
    tracker = pliant.Tracker(pliant.read_camera(arguments.camera), options, examples=examples)
    waiting, trails = {}, {}  # images whose report waits for a first map

    def show(reports):
        for report in reports:
            picture = draw(waiting.pop(report.frame_idx), report, trails)
            if arguments.output_path:
                cv2.imwrite(str(arguments.output_path / f"{report.frame_idx:06d}.jpg"), picture)
                continue
            cv2.imshow("pliant", picture)
            if cv2.waitKey(1) == 27:
                raise SystemExit

    for idx, image in enumerate(itertools.chain(examples, images)):
        waiting[idx] = image
        show(tracker.process(image))
    show(tracker.finish())


if __name__ == "__main__":
    main()
