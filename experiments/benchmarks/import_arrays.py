#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the arrays of DROID-SLAM, MegaSaM or TAPIP3D as a result that `pliant import --format result` reads.

usage: import_arrays.py SYSTEM INPUT --size WIDTHxHEIGHT --output_path DIR [--start N] [--stride N]
                        [--fps N | --times FILE] [--step PX] [--path FILE] [--tracks FILE]

droid    INPUT is the folder that demo.py --reconstruction_path leaves (tstamps, poses, disps, intrinsics .npy), or an
         .npz of arrays with these names. --path is the array that its terminate() returns, saved with np.save: then
         every frame has a pose. Points are those of the keyframes.
megasam  INPUT is SCENE_droid.npz or SCENE_sgd_cvd_hr.npz.
tapip3d  INPUT is NAME.result.npz. --tracks also writes its points' pixels, for `pliant track --tracks`.

--size is that of the images of the sequence, which the system has resized. --start and --stride say which frames it
was given: by default all. A frame's time is its number by --fps (30), or stands in --times: a sequence's times.txt, or
frames.csv of a run. Depth images become one point for --step x --step pixels (8). Needs NumPy.
"""

import argparse
import csv
import math
import pathlib
import sys

import numpy as np

HEADER = "frame,point_id,u_px,v_px,x,y,z"
# DROID-SLAM and MegaSaM resize images to about this many pixels, and cut them to multiples of 8.
PIXELS = 384 * 512
DROID_INTRINSICS = 8  # they are stored for images of an eighth of the size


class Failure(Exception):
    """What is wrong with the input or the output, in one sentence."""


def numbers_of(name, load):
    """The array that a function reads from a file: real numbers or bools."""
    try:
        array = load()
    except OSError as error:
        raise Failure(f"{name} cannot be read: {error.strerror or error}") from None
    except Exception:  # of damaged files NumPy raises what its tokenizer and zipfile do, too
        array = None
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiub":
        raise Failure(f"{name} is not an array of real numbers")
    return array


class Arrays:
    """Named arrays of an .npz, or of a folder of .npy."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        if self.path.is_dir():
            self.arrays = {file.stem: file for file in self.path.glob("*.npy")}
        elif self.path.is_file():
            try:
                self.arrays = np.load(self.path)
            except Exception:  # as above
                raise Failure(f"{path} is no .npz") from None
            if not hasattr(self.arrays, "files"):
                raise Failure(f"{path} is one array, not an .npz")
        else:
            raise Failure(f"there is no {path}")

    def get(self, name, shape):
        """The array, of this shape: numbers are demanded; what letters stand for must agree among all arrays."""
        if name not in list(self.arrays):  # `in` itself reads the array of an .npz
            raise Failure(f"{self.path} has no array '{name}'")
        file = self.arrays[name] if self.path.is_dir() else None
        array = numbers_of(f"'{name}' of {self.path}", lambda: np.load(file) if file else self.arrays[name])
        if array.ndim != len(shape) or any(isinstance(n, int) and n != m for n, m in zip(shape, array.shape)):
            raise Failure(f"'{name}' has the shape {array.shape}, not ({', '.join(map(str, shape))})")
        sizes = self.__dict__.setdefault("sizes", {})
        for letter, size in zip(shape, array.shape):
            if isinstance(letter, str) and sizes.setdefault(letter, size) != size:
                raise Failure(f"'{name}' has the shape {array.shape}, but {letter} is {sizes[letter]} in another array")
        return array


# Poses.

def matrices(rows):
    """4x4 matrices of `tx ty tz qx qy qz qw`."""
    rows = np.asarray(rows, float)
    with np.errstate(invalid="ignore", divide="ignore"):
        x, y, z, w = (rows[:, 3:] / np.linalg.norm(rows[:, 3:], axis=1, keepdims=True)).T
    result = np.tile(np.eye(4), (len(rows), 1, 1))
    result[:, :3, 0] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], 1)
    result[:, :3, 1] = np.stack([2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)], 1)
    result[:, :3, 2] = np.stack([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)], 1)
    result[:, :3, 3] = rows[:, :3]
    return result


def inverse(poses):
    result = np.tile(np.eye(4), (len(poses), 1, 1))
    result[:, :3, :3] = poses[:, :3, :3].transpose(0, 2, 1)
    result[:, :3, 3] = -np.einsum("nij,nj->ni", result[:, :3, :3], poses[:, :3, 3])
    return result


def quaternion(m):
    """[x, y, z, w] of a rotation: the column of the largest component of its outer product with itself."""
    outer = np.array([[1 + m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]],
                      [m[0, 1] + m[1, 0], 1 - m[0, 0] + m[1, 1] - m[2, 2], m[1, 2] + m[2, 1], m[0, 2] - m[2, 0]],
                      [m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], 1 - m[0, 0] - m[1, 1] + m[2, 2], m[1, 0] - m[0, 1]],
                      [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1 + np.trace(m[:3, :3])]])
    column = outer[np.argmax(np.diag(outer))]
    return column / np.linalg.norm(column)


def is_pose(pose):
    r = pose[:3, :3]
    return bool(np.isfinite(pose).all() and np.allclose(r @ r.T, np.eye(3), atol=1e-3) and np.linalg.det(r) > 0)


# Pixels.

def resized(size):
    """(width, height) to which DROID-SLAM and MegaSaM resize, before they cut to multiples of 8."""
    width, height = size
    factor = math.sqrt(PIXELS / (width * height))
    return int(width * factor), int(height * factor)


def grid_of(shape, size, step):
    """(rows, columns) of the pixels taken, and where they are in the images of the sequence."""
    height, width = shape
    full_width, full_height = resized(size)
    if (full_width // 8 * 8, full_height // 8 * 8) != (width, height):
        raise Failure(f"its images have {width}x{height} pixels; of {size[0]}x{size[1]} it would have made "
                      f"{full_width // 8 * 8}x{full_height // 8 * 8}: is --size right?")
    rows, columns = np.mgrid[step // 2:height:step, step // 2:width:step].reshape(2, -1)
    u = (columns + 0.5) * size[0] / full_width - 0.5
    v = (rows + 0.5) * size[1] / full_height - 0.5
    return rows, columns, u, v


def dense_points(depths, intrinsics, poses, frames, size, step):
    """Rows of observations.csv: pixels of depth images, each a point of its own. `intrinsics`: fx fy cx cy an image."""
    rows, columns, u, v = grid_of(depths.shape[1:], size, step)
    result, next_id = [], 0
    for depth, (fx, fy, cx, cy), pose, frame in zip(depths, intrinsics, poses, frames):
        z = np.asarray(depth[rows, columns], float)
        ok = np.isfinite(z) & (z > 0)
        if not is_pose(pose) or not ok.any():
            continue
        camera = np.stack([(columns - cx) / fx * z, (rows - cy) / fy * z, z], 1)[ok]
        world = camera @ pose[:3, :3].T + pose[:3, 3]
        ids = next_id + np.arange(len(world))
        next_id += len(world)
        result.append(np.column_stack([np.full(len(world), frame), ids, u[ok], v[ok], world]))
    return np.concatenate(result) if result else np.empty((0, 7))


# Systems. Each gives {index of an image given to it: world_from_camera}, and a function of the frames' numbers that
# makes the rows of observations.csv.

def droid(arguments):
    arrays = Arrays(arguments.input)
    indices = np.rint(arrays.get("tstamps", "N"))
    if not (np.isfinite(indices) & (indices >= 0)).all():
        raise Failure("'tstamps' has values that are no numbers of frames")
    indices = indices.astype(int)
    poses = inverse(matrices(arrays.get("poses", ("N", 7))))
    disparities = np.asarray(arrays.get("disps", ("N", "H", "W")), float)
    intrinsics = DROID_INTRINSICS * np.asarray(arrays.get("intrinsics", ("N", 4)), float)
    if not (np.abs(intrinsics[:, 2] / disparities.shape[2] - 0.5) < 0.25).all():
        raise Failure("'intrinsics' is not of images of an eighth of the size of 'disps', as DROID-SLAM stores it")
    with np.errstate(divide="ignore", invalid="ignore"):
        depths = np.where(disparities > 0, 1 / disparities, np.nan)
    found = dict(zip(indices.tolist(), poses))
    if arguments.path:
        path = camera_path(arguments.path)
        if len(path) <= indices.max(initial=-1):
            raise Failure(f"{arguments.path} has {len(path)} poses, but there is a keyframe {indices.max()}")
        # The points stay where the keyframes have them, so their poses are kept.
        found = dict(enumerate(matrices(path))) | found
    return found, lambda frame_of: dense_points(
        depths, intrinsics, poses, [frame_of(k) for k in indices], arguments.size, arguments.step)


def camera_path(path):
    rows = numbers_of(path, lambda: np.load(path))
    if rows.ndim != 2 or rows.shape[1] != 7:
        raise Failure(f"{path} has the shape {rows.shape}, not (frames, 7)")
    return rows


def megasam(arguments):
    arrays = Arrays(arguments.input)
    poses = np.asarray(arrays.get("cam_c2w", ("N", 4, 4)), float)
    depths = arrays.get("depths", ("N", "H", "W"))
    k = np.asarray(arrays.get("intrinsic", (3, 3)), float)
    intrinsics = np.tile([k[0, 0], k[1, 1], k[0, 2], k[1, 2]], (len(poses), 1))
    return dict(enumerate(poses)), lambda frame_of: dense_points(
        depths, intrinsics, poses, [frame_of(n) for n in range(len(poses))], arguments.size, arguments.step)


def tapip3d(arguments):
    arrays = Arrays(arguments.input)
    points = np.asarray(arrays.get("coords", ("T", "N", 3)), float)
    visible = arrays.get("visibs", "TN").astype(bool)
    k = np.asarray(arrays.get("intrinsics", ("T", 3, 3)), float)
    camera_from_world = np.asarray(arrays.get("extrinsics", ("T", 4, 4)), float)
    height, width = arrays.get("video", ("T", 3, "H", "W")).shape[2:]
    if min(height, width) < 2:
        raise Failure(f"'video' has images of {width}x{height} pixels")
    poses = inverse(camera_from_world)
    camera = np.einsum("tij,tnj->tni", camera_from_world[:, :3, :3], points) + camera_from_world[:, None, :3, 3]
    with np.errstate(divide="ignore", invalid="ignore"):
        pixels = np.einsum("tij,tnj->tni", k, camera / camera[:, :, 2:])[:, :, :2]
    pixels = pixels * [(arguments.size[0] - 1) / (width - 1), (arguments.size[1] - 1) / (height - 1)]
    inside = (pixels > -0.5).all(2) & (pixels < np.array(arguments.size) - 0.5).all(2)  # not where it is no number
    seen = visible & inside & (camera[:, :, 2] > 0) & np.isfinite(points).all(2)

    def observations(frame_of):
        frames, ids = np.nonzero(seen)
        return np.column_stack([np.array([frame_of(t) for t in frames], float), ids, pixels[seen], points[seen]])

    if arguments.tracks:
        if arguments.start != 0 or arguments.stride != 1:
            raise Failure("--tracks needs all frames of the sequence: leave out --start and --stride")
        tracks = np.where(np.isfinite(pixels), pixels, 0).astype(np.float32)
        written(arguments.tracks, lambda: np.savez(arguments.tracks, tracks=tracks, visibility=seen))
    return dict(enumerate(poses)), observations


SYSTEMS = {"droid": droid, "megasam": megasam, "tapip3d": tapip3d}


# Output.

def times_of(arguments):
    """A function of the frame's number: its time in s."""
    if not arguments.times:
        return lambda frame: frame / arguments.fps
    try:
        with open(arguments.times, newline="", encoding="utf-8") as file:
            if pathlib.Path(arguments.times).suffix == ".csv":
                times = {int(row["frame"]): float(row["timestamp"]) for row in csv.DictReader(file)}
            else:
                times = dict(enumerate(float(line) for line in file if line.strip() and line[0] != "#"))
    except (OSError, KeyError, TypeError, ValueError, csv.Error):
        raise Failure(f"{arguments.times} is neither a list of times nor frames.csv of a run") from None

    def time(frame):
        if not math.isfinite(times.get(frame, math.nan)):
            raise Failure(f"{arguments.times} has no time of frame {frame}")
        return times[frame]
    return time


def written(path, write):
    """Calls a function that writes to a path."""
    try:
        write()
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        raise Failure(f"{path} cannot be written: {getattr(error, 'strerror', None) or error}") from None


def write_result(folder, lines, rows):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "trajectory.txt").write_text("".join(lines), encoding="utf-8")
    np.savetxt(folder / "observations.csv", rows, fmt="%d,%d,%.4f,%.4f,%.9g,%.9g,%.9g", header=HEADER, comments="")


def convert(arguments):
    """Writes the result; a sentence about it."""
    poses, observations = SYSTEMS[arguments.system](arguments)
    time = times_of(arguments)
    frame_of = lambda index: arguments.start + arguments.stride * int(index)
    good = {frame_of(index): pose for index, pose in sorted(poses.items()) if is_pose(pose)}
    if not good:
        raise Failure(f"none of the {len(poses)} poses is one")
    lines = [f"{time(frame):.6f} " + " ".join(f"{v:.9g}" for v in [*pose[:3, 3], *quaternion(pose)]) + "\n"
             for frame, pose in good.items()]
    rows = observations(frame_of)
    rows = rows[np.isin(rows[:, 0], list(good))]
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    written(arguments.output_path, lambda: write_result(pathlib.Path(arguments.output_path), lines, rows))
    bad = len(poses) - len(good)
    left_out = f" ({bad} left out: not finite, or not a rotation)" if bad else ""
    return f"{len(good)} poses{left_out}, {len(rows)} points in {len(np.unique(rows[:, 0]))} frames"


def size(text):
    width, cross, height = text.partition("x")
    if not (cross and width.isdigit() and height.isdigit() and int(width) > 1 and int(height) > 1):
        raise argparse.ArgumentTypeError(f"'{text}' is not WIDTHxHEIGHT")
    return int(width), int(height)


def positive(text):
    if not text.isdigit() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 1 on")
    return int(text)


def frame_number(text):
    if not text.isdigit():
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 0 on")
    return int(text)


def rate(text):
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value > 0):
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of frames a second above 0")
    return value


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("system", choices=SYSTEMS)
    parser.add_argument("input")
    parser.add_argument("--size", type=size, required=True, metavar="WIDTHxHEIGHT")
    parser.add_argument("--output_path", required=True)
    parser.add_argument("--start", type=frame_number, default=0)
    parser.add_argument("--stride", type=positive, default=1)
    parser.add_argument("--fps", type=rate, default=30)
    parser.add_argument("--times")
    parser.add_argument("--step", type=positive, default=8)
    parser.add_argument("--path", help="droid: the poses of all frames")
    parser.add_argument("--tracks", help="tapip3d: file to write, .npz")
    arguments = parser.parse_args()
    try:
        print(convert(arguments))
    except Failure as failure:
        print(f"import_arrays.py: {failure}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
