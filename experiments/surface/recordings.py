#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The dense surface of a real stereo pair, against a disparity map that others made.

    recordings.py --program build/release/pliant --output_path RESULTS

Of the first image of the recording `porcine_stereo`, in the folder that experiments/common/clips.py names. Tracks it
from its first pair, makes the surface of the first frame from the pair and from the left images alone, and prints how
many of the map's pixels have a depth, how many of those that both images show, and how far depths are off after one
scale. `--picture FILE` shows where. NumPy and OpenCV; what is there already is kept.
"""
import argparse
import re
import sys
from pathlib import Path

import cv2
import numpy

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "common"))
from clips import RECORDINGS  # noqa: E402
from scenes import call  # noqa: E402

HIGHLIGHT, NEAR_HIGHLIGHT, PALE, ABOVE = 235, 190, 0.25, 40  # (P13)
GROWN_PX, MEDIAN_PX = 3, 31


def number(path, key):
    return float(re.search(rf"^{key}: *(\S+)", path.read_text(encoding="utf-8"), re.MULTILINE)[1])


def focal_length(path):
    return float(re.search(r"params: *\[([^,]*),", path.read_text(encoding="utf-8"))[1])


def highlights(image):
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).astype(int)
    largest, least = image.max(axis=2).astype(int), image.min(axis=2).astype(int)
    above = gray - cv2.medianBlur(gray.astype(numpy.uint8), MEDIAN_PX) >= ABOVE
    found = (gray >= HIGHLIGHT) | ((gray >= NEAR_HIGHLIGHT) & (largest - least <= PALE * largest) & above)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * GROWN_PX + 1,) * 2)
    return cv2.dilate(found.astype(numpy.uint8), kernel) > 0


def shown_by_both(left, right, disparity):
    """Pixels with a disparity that lie in the right image too, and in a highlight of neither."""
    there = numpy.arange(disparity.shape[1])[None, :] - disparity
    inside = (disparity > 0) & (there >= 0)
    bright = numpy.take_along_axis(highlights(right), numpy.maximum(numpy.rint(there), 0).astype(int), axis=1)
    return inside & ~bright & ~highlights(left)


def picture(path, left, depth, off):
    def colored(values, least, most, known):
        gray = numpy.clip((numpy.nan_to_num(values) - least) / (most - least) * 255, 0, 255).astype(numpy.uint8)
        image = cv2.applyColorMap(gray, cv2.COLORMAP_VIRIDIS)
        image[~known] = 215
        return image

    known = depth > 0
    near, far = numpy.percentile(depth[known], (1, 99))
    images = [left, colored(depth, near, far, known), colored(100 * off, 0, 4, known & numpy.isfinite(off))]
    cv2.imwrite(str(path), cv2.resize(numpy.hstack(images), None, fx=0.4, fy=0.4, interpolation=cv2.INTER_AREA))


def line(name, surface, sequence, disparity, picture_path):
    left, right = (cv2.imread(str(sequence / side / "000000.png")) for side in ("images", "right"))
    camera = sequence / "camera.yaml"
    with numpy.errstate(divide="ignore"):
        truth = focal_length(camera) * number(camera, "baseline") / disparity
    depth = cv2.imread(str(surface / "depth/000000.png"), cv2.IMREAD_UNCHANGED).astype(float)
    depth *= number(surface / "camera.yaml", "depth_scale")
    known = (depth > 0) & (disparity > 0)
    depth *= numpy.median(truth[known] / depth[known])
    off = abs(depth / truth - 1)
    off[disparity == 0] = numpy.nan
    seen = shown_by_both(left, right, disparity)
    if picture_path:
        picture(picture_path, left, depth, off)
    return (f"| {name} | {100 * known.sum() / (disparity > 0).sum():.0f} | {100 * seen.sum() / (disparity > 0).sum():.0f} | "
            f"{100 * (known & seen).sum() / seen.sum():.0f} | {100 * off[known].mean():.2f} | "
            f"{100 * numpy.median(off[known]):.2f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--output_path", type=Path, required=True)
    parser.add_argument("--picture", type=Path, help="a PNG of the pair's depth and of how far it is off")
    arguments = parser.parse_args()
    sequence = RECORDINGS / "porcine_stereo"
    if not sequence.is_dir():
        raise SystemExit(f"there is no recording at {sequence}; name the folder of the recordings with PLIANT_RECORDINGS")
    run = arguments.output_path / "run"
    if not (run / "run.json").exists():
        call(arguments.program, "track", "--image_path", sequence, "--output_path", run, "--Init.method", "stereo",
             "--quiet").check_returncode()
    disparity = cv2.imread(str(sequence / "disparity_0000.png"), cv2.IMREAD_UNCHANGED).astype(float)
    print("| from | with a depth, % | shown by both, % | of these with a depth, % | AbsRel, % | median, % |")
    print("| --- | --- | --- | --- | --- | --- |")
    for name, pairs in (("the pair", "on"), ("the left images alone", "off")):
        surface = arguments.output_path / f"pairs_{pairs}"
        made = call(arguments.program, "surface", "--run", run, "--frames", 0, "--Surface.pairs", pairs,
                    "--Surface.mesh_columns", 0, "--output_path", surface, "--quiet", "--overwrite")
        if made.returncode != 0:
            print(f"| {name} | 0: {made.stderr.strip().split(': ', 1)[-1]} | | | | |")
        else:
            print(line(name, surface, sequence, disparity, arguments.picture if pairs == "on" else None))


if __name__ == "__main__":
    main()
