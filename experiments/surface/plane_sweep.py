# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A baseline for a rigid scene: a plane sweep with the true poses.

The same reference and neighboring frames as those of a surface folder. Planes parallel to the image, evenly spaced in
inverse depth, half a pixel apart in the view in which they move most, over the range of the true depths of the frame;
normalized cross-correlation over a window; the mean of the better half of the views; semi-global smoothing along eight
directions; a parabola through three levels. NumPy and OpenCV only.

    python3 experiments/surface/plane_sweep.py --sequence SEQ --surface SURFACE
"""
import argparse
import json
import pathlib
import re

import cv2
import numpy

STEPS_PX = 0.5
SMALL_STEP, LARGE_STEP = 0.03, 0.3  # of costs from 0 to 1: of one level, and of any more


def camera_of(folder):
    text = (folder / "camera.yaml").read_text(encoding="utf-8")
    values = re.search(r"params: *\[([^\]]*)\]", text)[1].split(",")
    if "model: PINHOLE" not in text:
        raise SystemExit(f"{folder}/camera.yaml: the baseline needs the camera model PINHOLE; give another sequence")
    fx, fy, cx, cy = map(float, values)
    return numpy.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]]), float(re.search(r"depth_scale: *(\S+)", text)[1])


def poses_of(sequence):
    """world_from_camera of every frame, 4 x 4."""
    poses = []
    for line in (sequence / "groundtruth.txt").read_text(encoding="utf-8").splitlines():
        if line.startswith("#") or not line.strip():
            continue
        tx, ty, tz, x, y, z, w = map(float, line.split()[1:8])
        pose = numpy.eye(4)
        pose[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
        pose[:3, 3] = tx, ty, tz
        poses.append(pose)
    return poses


def depth_of(path, scale):
    return cv2.imread(str(path), cv2.IMREAD_UNCHANGED).astype(numpy.float32) * numpy.float32(scale)


def homographies(intrinsics, other_from_reference, inverse_depth):
    """Of the plane at this inverse depth, from the reference's pixels to the other view's."""
    plane = other_from_reference[:3, :3].copy()
    plane[:, 2] += other_from_reference[:3, 3] * inverse_depth
    return intrinsics @ plane @ numpy.linalg.inv(intrinsics)


def levels_of(intrinsics, others, shape, near, far):
    """Inverse depths, the next one where a corner or the middle of the image moves by STEPS_PX in some view."""
    height, width = shape
    pixels = numpy.array([[0, 0, 1], [width, 0, 1], [0, height, 1], [width, height, 1], [width / 2, height / 2, 1]]).T
    levels = [1 / far]
    while levels[-1] < 1 / near:
        here, change = levels[-1], 1e-5
        moved = 0.0
        for other in others:
            a, b = (homographies(intrinsics, other, rho) @ pixels for rho in (here, here + change))
            moved = max(moved, numpy.abs(a[:2] / a[2] - b[:2] / b[2]).max() / change)
        levels.append(here + STEPS_PX / moved)
    return numpy.array(levels)


def costs_of(reference, images, others, intrinsics, levels, window, noise):
    """One less the mean correlation with the better half of the views, levels x height x width."""
    def mean(values):
        return cv2.blur(values, (window, window), borderType=cv2.BORDER_REPLICATE)

    size = reference.shape[::-1]
    reference_mean = mean(reference)
    reference_variance = mean(reference * reference) - reference_mean ** 2
    damping = 4 * noise ** 2
    costs = numpy.empty((len(levels),) + reference.shape, numpy.float32)
    for index, level in enumerate(levels):
        scores = []
        for image, other in zip(images, others):
            warp = homographies(intrinsics, other, level)
            warped = cv2.warpPerspective(image, warp, size, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
                                         borderMode=cv2.BORDER_CONSTANT, borderValue=-1)
            seen = warped >= 0
            warped = numpy.where(seen, warped, reference_mean)
            warped_mean = mean(warped)
            score = mean(warped * reference) - warped_mean * reference_mean
            score /= numpy.sqrt((reference_variance + damping) * (mean(warped * warped) - warped_mean ** 2 + damping))
            scores.append(numpy.where(seen, score, -1))
        best = -numpy.sort(-numpy.stack(scores), axis=0)[:(len(scores) + 1) // 2]
        costs[index] = numpy.clip(1 - best.mean(axis=0), 0, 1)
    return costs


def smoothed(costs):
    """The sum over eight directions of semi-global matching (Hirschmueller, PAMI 2008)."""
    total = numpy.zeros_like(costs)

    def step(before, cost):
        least = before.min(axis=0)
        best = numpy.minimum(before, least + LARGE_STEP)
        best[1:] = numpy.minimum(best[1:], before[:-1] + SMALL_STEP)
        best[:-1] = numpy.minimum(best[:-1], before[1:] + SMALL_STEP)
        return cost + best - least

    height, width = costs.shape[1:]
    for rows in (range(height), range(height - 1, -1, -1)):
        for shift in (-1, 0, 1):
            before = None
            for y in rows:
                cost = costs[:, y]
                if before is None:
                    now = cost
                else:
                    moved = numpy.roll(before, shift, axis=1)
                    now = step(moved, cost)
                    if shift:
                        rim = 0 if shift > 0 else width - 1
                        now[:, rim] = cost[:, rim]
                total[:, y] += now
                before = now
    for columns in (range(width), range(width - 1, -1, -1)):
        before = None
        for x in columns:
            cost = costs[:, :, x]
            before = cost if before is None else step(before, cost)
            total[:, :, x] += before
    return total


def depth_by(levels, costs):
    """At the parabola through the best level and its neighbors; 0 where the best level is the first or the last."""
    best = costs.argmin(axis=0)
    inner = numpy.clip(best, 1, len(levels) - 2)
    before, here, after = (numpy.take_along_axis(costs, (inner + k)[None], axis=0)[0] for k in (-1, 0, 1))
    curvature = before - 2 * here + after
    part = numpy.clip(0.5 * (before - after) / numpy.maximum(curvature, 1e-9), -0.5, 0.5)
    inverse = numpy.interp(inner + part, numpy.arange(len(levels)), levels)
    return numpy.where(inner == best, 1 / inverse, 0)


def rmse(depth, truth, pixels):
    """After the scale of the frame: the median of the ratios, as `pliant evaluate --surface`."""
    scale = numpy.median(truth[pixels] / depth[pixels])
    error = scale * depth[pixels] - truth[pixels]
    return {"rmse_mm": float(numpy.sqrt((error ** 2).mean())), "abs_rel": float((abs(error) / truth[pixels]).mean()),
            "median_mm": float(numpy.median(abs(error)))}


def of_frame(sequence, surface, frame, poses, window):
    intrinsics, truth_scale = camera_of(sequence)
    _, surface_scale = camera_of(surface)
    truth = depth_of(sequence / "depth" / frame["name"], truth_scale)
    ours = depth_of(surface / "depth" / frame["name"], surface_scale)
    names = sorted(path.name for path in (sequence / "images").iterdir())

    def gray(index):
        return cv2.cvtColor(cv2.imread(str(sequence / "images" / names[index])), cv2.COLOR_BGR2GRAY).astype(numpy.float32)

    noise = json.loads((surface / "surface.json").read_text(encoding="utf-8")).get("windows", {}).get("noise_levels", 1.5)
    others = [numpy.linalg.inv(poses[k]) @ poses[frame["frame"]] for k in frame["neighbors"]]
    levels = levels_of(intrinsics, others, truth.shape, 0.9 * truth[truth > 0].min(), 1.1 * truth.max())
    costs = costs_of(gray(frame["frame"]), [gray(k) for k in frame["neighbors"]], others, intrinsics, levels, window,
                     noise)
    depth = depth_by(levels, smoothed(costs))
    known = (truth > 0) & (depth > 0)
    common = known & (ours > 0)
    return {"frame": frame["frame"], "levels": len(levels), "common_share": common.sum() / (truth > 0).sum(),
            "own_share": known.sum() / (truth > 0).sum(), "sweep_common": rmse(depth, truth, common),
            "surface_common": rmse(ours, truth, common), "sweep_own": rmse(depth, truth, known)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sequence", type=pathlib.Path, required=True, help="a rigid simulated sequence")
    parser.add_argument("--surface", type=pathlib.Path, required=True, help="what pliant surface left of a run of it")
    parser.add_argument("--window", type=int, default=11, help="side of a window, px")
    parser.add_argument("--output", type=pathlib.Path, help="a JSON file")
    arguments = parser.parse_args()
    poses = poses_of(arguments.sequence)
    frames = json.loads((arguments.surface / "surface.json").read_text(encoding="utf-8"))["frames"]
    rows = [of_frame(arguments.sequence, arguments.surface, frame, poses, arguments.window) for frame in frames
            if not frame["note"]]
    for row in rows:
        print(f"frame {row['frame']}: {row['levels']} planes; RMSE at the surface's pixels "
              f"({100 * row['common_share']:.0f} %): sweep {row['sweep_common']['rmse_mm']:.3f} mm, surface "
              f"{row['surface_common']['rmse_mm']:.3f} mm; sweep at all its own ({100 * row['own_share']:.0f} %) "
              f"{row['sweep_own']['rmse_mm']:.3f} mm")
    mean = {name: {key: sum(row[name][key] for row in rows) / len(rows) for key in rows[0][name]}
            for name in ("sweep_common", "surface_common", "sweep_own")}
    print("mean: " + "; ".join(f"{name} RMSE {mean[name]['rmse_mm']:.3f} mm, AbsRel {100 * mean[name]['abs_rel']:.2f} %, "
                               f"median {mean[name]['median_mm']:.3f} mm" for name in mean))
    if arguments.output:
        arguments.output.write_text(json.dumps({"frames": rows, "mean": mean}, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
