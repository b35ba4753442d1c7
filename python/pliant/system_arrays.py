# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The arrays that DROID-SLAM, MegaSaM and TAPIP3D write, as a result that pliant.import_result reads."""

from __future__ import annotations

import csv
import math
import os
import pathlib
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, SupportsFloat, SupportsIndex

import numpy as np

from . import arguments as given
from .arguments import error as _error

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .jobs import StrPath

TRAJECTORY, OBSERVATIONS = "trajectory.txt", "observations.csv"
HEADER = "frame,point_id,u_px,v_px,x,y,z"
# DROID-SLAM and MegaSaM resize images to about this many pixels, and cut them to multiples of 8.
PIXELS = 384 * 512
DROID_INTRINSICS = 8  # they are stored for images of an eighth of the size
# Sides of pixels that differ by more are not square, by less are.
NOT_SQUARE, SQUARE = 1.25, 1.1

Size = tuple[int, int]  # width, height
FrameOf = Callable[[int], int]  # the number of the frame of an image by its place among those that a system was given
# {place of an image: world_from_camera}, and what makes the rows of observations.csv.
Answer = tuple["dict[int, NDArray[Any]]", Callable[[FrameOf], "NDArray[Any]"]]


@dataclass(frozen=True)
class _Request:
    input_path: str
    size: Size
    step_px: int
    path: str
    tracks_path: str


def _numbers_of(name: str, load: Callable[[], Any]) -> NDArray[Any]:
    """The array that a function reads from a file: real numbers or bools."""
    try:
        array = load()
    except OSError as error:
        raise _error("unreadable", f"{name} cannot be read: {error.strerror or error}") from None
    except Exception:  # of damaged files NumPy raises what its tokenizer and zipfile do, too
        array = None
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiub":
        raise _error("unreadable", f"{name} is not an array of real numbers")
    return array


@dataclass
class _Arrays:
    """Named arrays of an .npz, or of a folder of .npy."""

    path: pathlib.Path
    arrays: Any = None
    sizes: dict[str, int] = field(default_factory=dict)  # what letters of shapes stand for

    def __post_init__(self) -> None:
        if self.path.is_dir():
            self.arrays = {file.stem: file for file in self.path.glob("*.npy")}
        elif self.path.is_file():
            try:
                self.arrays = np.load(self.path)
            except Exception:  # as above
                raise _error("unreadable", f"{self.path} is no .npz") from None
            if not hasattr(self.arrays, "files"):
                raise _error("unreadable", f"{self.path} is one array, not an .npz")
        else:
            raise _error("not_found", f"there is no {self.path}")

    def get(self, name: str, shape: Iterable[int | str]) -> NDArray[Any]:
        """The array, of this shape: numbers are demanded; what letters stand for must agree among all arrays."""
        axes = tuple(shape)
        if name not in list(self.arrays):  # `in` itself reads the array of an .npz
            raise _error("mismatch", f"{self.path} has no array '{name}'")
        file = self.arrays[name] if self.path.is_dir() else None
        array = _numbers_of(f"'{name}' of {self.path}", lambda: np.load(file) if file else self.arrays[name])
        if array.ndim != len(axes) or any(isinstance(n, int) and n != m for n, m in zip(axes, array.shape)):
            raise _error("mismatch", f"'{name}' has the shape {array.shape}, not ({', '.join(map(str, axes))})")
        for letter, size in zip(axes, array.shape):
            if isinstance(letter, str) and self.sizes.setdefault(letter, size) != size:
                raise _error("mismatch", f"'{name}' has the shape {array.shape}, but {letter} is {self.sizes[letter]} in "
                                         "another array")
        return array


# Poses.

def matrices(rows: ArrayLike) -> NDArray[np.float64]:
    """4x4 matrices of `tx ty tz qx qy qz qw`."""
    poses = np.asarray(rows, float)
    with np.errstate(invalid="ignore", divide="ignore"):
        x, y, z, w = (poses[:, 3:] / np.linalg.norm(poses[:, 3:], axis=1, keepdims=True)).T
    result = np.tile(np.eye(4), (len(poses), 1, 1))
    result[:, :3, 0] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], 1)
    result[:, :3, 1] = np.stack([2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)], 1)
    result[:, :3, 2] = np.stack([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)], 1)
    result[:, :3, 3] = poses[:, :3]
    return result


def _inverse(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    result = np.tile(np.eye(4), (len(poses), 1, 1))
    result[:, :3, :3] = poses[:, :3, :3].transpose(0, 2, 1)
    result[:, :3, 3] = -np.einsum("nij,nj->ni", result[:, :3, :3], poses[:, :3, 3])
    return result


def quaternion(m: NDArray[Any]) -> NDArray[np.float64]:
    """[x, y, z, w] of a rotation: the column of the largest component of its outer product with itself."""
    outer = np.array([[1 + m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]],
                      [m[0, 1] + m[1, 0], 1 - m[0, 0] + m[1, 1] - m[2, 2], m[1, 2] + m[2, 1], m[0, 2] - m[2, 0]],
                      [m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], 1 - m[0, 0] - m[1, 1] + m[2, 2], m[1, 0] - m[0, 1]],
                      [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1 + np.trace(m[:3, :3])]])
    column = outer[np.argmax(np.diag(outer))]
    return np.asarray(column / np.linalg.norm(column))


def _is_pose(pose: NDArray[Any]) -> bool:
    r = pose[:3, :3]
    return bool(np.isfinite(pose).all() and np.allclose(r @ r.T, np.eye(3), atol=1e-3) and np.linalg.det(r) > 0)


# Pixels.

def resized(size: Size) -> Size:
    """(width, height) to which DROID-SLAM and MegaSaM resize, before they cut to multiples of 8."""
    width, height = size
    factor = math.sqrt(PIXELS / (width * height))
    return int(width * factor), int(height * factor)


def grid_of(shape: Size, size: Size, step_px: int) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any]]:
    """(rows, columns) of the pixels taken of images of this (height, width), and where they are in the images of the
    sequence."""
    height, width = shape
    full_width, full_height = resized(size)
    if (full_width // 8 * 8, full_height // 8 * 8) != (width, height):
        raise _error("mismatch", f"its images have {width}x{height} pixels; of {size[0]}x{size[1]} it would have made "
                                 f"{full_width // 8 * 8}x{full_height // 8 * 8}: is size (width, height) of the "
                                 "sequence's images?")
    rows, columns = np.mgrid[step_px // 2:height:step_px, step_px // 2:width:step_px].reshape(2, -1)
    u = (columns + 0.5) * size[0] / full_width - 0.5
    v = (rows + 0.5) * size[1] / full_height - 0.5
    return rows, columns, u, v


def _checked_intrinsics(name: str, intrinsics: NDArray[Any], shape: Size) -> None:
    """Refuses fx fy cx cy that are no camera's whose images have this (width, height)."""
    if not (np.isfinite(intrinsics).all() and (intrinsics[:, :2] > 0).all()):
        raise _error("mismatch", f"'{name}' has focal lengths that are not above 0, or values that are not finite")
    if not (np.abs(intrinsics[:, 2:] / shape - 0.5) <= 1).all():
        raise _error("mismatch", f"'{name}' has principal points far outside of its images of {shape[0]}x{shape[1]} "
                                 "pixels")


def _refuse_turned_size(intrinsics: NDArray[Any], shape: Size, size: Size) -> None:
    """Refuses a (height, width): pixels of the sequence are not square by it, and would be by (width, height)."""
    fx, fy = np.median(intrinsics[:, :2], axis=0)
    ratio = fx / fy * shape[1] / shape[0]
    off, off_turned = (math.exp(abs(math.log(ratio * w / h))) for w, h in (size, size[::-1]))
    if off > NOT_SQUARE and off_turned < SQUARE:
        raise _error("mismatch", f"images of {size[0]}x{size[1]} do not fit the focal lengths in 'intrinsics', and "
                                 f"images of {size[1]}x{size[0]} do; size is (width, height)")


def _dense_points(depths: NDArray[Any], intrinsics: NDArray[Any], poses: NDArray[Any], frames: Iterable[int],
                  request: _Request) -> NDArray[Any]:
    """Rows of observations.csv: pixels of depth images, each a point of its own. `intrinsics`: fx fy cx cy an image."""
    rows, columns, u, v = grid_of((depths.shape[1], depths.shape[2]), request.size, request.step_px)
    result, next_id = [], 0
    for depth, (fx, fy, cx, cy), pose, frame in zip(depths, intrinsics, poses, frames):
        z = np.asarray(depth[rows, columns], float)
        ok = np.isfinite(z) & (z > 0)
        if not _is_pose(pose) or not ok.any():
            continue
        camera = np.stack([(columns - cx) / fx * z, (rows - cy) / fy * z, z], 1)[ok]
        world = camera @ pose[:3, :3].T + pose[:3, 3]
        ids = next_id + np.arange(len(world))
        next_id += len(world)
        result.append(np.column_stack([np.full(len(world), frame), ids, u[ok], v[ok], world]))
    return np.concatenate(result) if result else np.empty((0, 7))


# Systems.

def _droid(request: _Request) -> Answer:
    arrays = _Arrays(pathlib.Path(request.input_path))
    numbers = np.rint(arrays.get("tstamps", "N"))
    if not (np.isfinite(numbers) & (numbers >= 0)).all():
        raise _error("mismatch", "'tstamps' has values that are no numbers of frames")
    indices = numbers.astype(int)
    poses = _inverse(matrices(arrays.get("poses", ("N", 7))))
    disparities = np.asarray(arrays.get("disps", ("N", "H", "W")), float)
    intrinsics = DROID_INTRINSICS * np.asarray(arrays.get("intrinsics", ("N", 4)), float)
    if not (np.abs(intrinsics[:, 2] / disparities.shape[2] - 0.5) < 0.25).all():
        raise _error("mismatch", "'intrinsics' is not of images of an eighth of the size of 'disps', as DROID-SLAM "
                                 "stores it")
    _checked_intrinsics("intrinsics", intrinsics, (disparities.shape[2], disparities.shape[1]))
    with np.errstate(divide="ignore", invalid="ignore"):
        depths = np.where(disparities > 0, 1 / disparities, np.nan)
    found = dict(zip(indices.tolist(), poses))
    if request.path:
        path = _camera_path(request.path)
        if len(path) <= indices.max(initial=-1):
            raise _error("mismatch", f"{request.path} has {len(path)} poses, but there is a keyframe {indices.max()}")
        # The points stay where the keyframes have them, so their poses are kept.
        found = {**dict(enumerate(matrices(path))), **found}
    return found, lambda frame_of: _dense_points(depths, intrinsics, poses, map(frame_of, indices), request)


def _camera_path(path: str) -> NDArray[Any]:
    rows = _numbers_of(path, lambda: np.load(path))
    if rows.ndim != 2 or rows.shape[1] != 7:
        raise _error("mismatch", f"{path} has the shape {rows.shape}, not (frames, 7)")
    return rows


def _megasam(request: _Request) -> Answer:
    arrays = _Arrays(pathlib.Path(request.input_path))
    poses = np.asarray(arrays.get("cam_c2w", ("N", 4, 4)), float)
    depths = arrays.get("depths", ("N", "H", "W"))
    k = np.asarray(arrays.get("intrinsic", (3, 3)), float)
    intrinsics = np.tile([k[0, 0], k[1, 1], k[0, 2], k[1, 2]], (len(poses), 1))
    _checked_intrinsics("intrinsic", intrinsics, (depths.shape[2], depths.shape[1]))
    return (dict(enumerate(poses)),
            lambda frame_of: _dense_points(depths, intrinsics, poses, map(frame_of, range(len(poses))), request))


def _tapip3d(request: _Request) -> Answer:
    arrays = _Arrays(pathlib.Path(request.input_path))
    points = np.asarray(arrays.get("coords", ("T", "N", 3)), float)
    visible = arrays.get("visibs", "TN")
    if not np.isin(visible, (0, 1)).all():
        raise _error("mismatch", "'visibs' has values other than 0 and 1; save bools, for example visibs > 0.5")
    visible = visible.astype(bool)
    k = np.asarray(arrays.get("intrinsics", ("T", 3, 3)), float)
    camera_from_world = np.asarray(arrays.get("extrinsics", ("T", 4, 4)), float)
    height, width = arrays.get("video", ("T", 3, "H", "W")).shape[2:]
    if min(height, width) < 2:
        raise _error("mismatch", f"'video' has images of {width}x{height} pixels")
    intrinsics = np.stack([k[:, 0, 0], k[:, 1, 1], k[:, 0, 2], k[:, 1, 2]], 1)
    _checked_intrinsics("intrinsics", intrinsics, (width, height))
    _refuse_turned_size(intrinsics, (width, height), request.size)
    camera = np.einsum("tij,tnj->tni", camera_from_world[:, :3, :3], points) + camera_from_world[:, None, :3, 3]
    with np.errstate(divide="ignore", invalid="ignore"):
        pixels = np.einsum("tij,tnj->tni", k, camera / camera[:, :, 2:])[:, :, :2]
    pixels = pixels * [(request.size[0] - 1) / (width - 1), (request.size[1] - 1) / (height - 1)]
    inside = (pixels > -0.5).all(2) & (pixels < np.array(request.size) - 0.5).all(2)  # not where it is no number
    seen = visible & inside & (camera[:, :, 2] > 0) & np.isfinite(points).all(2)

    def observations(frame_of: FrameOf) -> NDArray[Any]:
        frames, ids = np.nonzero(seen)
        return np.column_stack([np.array([frame_of(t) for t in frames], float), ids, pixels[seen], points[seen]])

    if request.tracks_path:
        tracks = np.where(np.isfinite(pixels), pixels, 0).astype(np.float32)
        _write(request.tracks_path, lambda: _write_tracks(request.tracks_path, tracks, seen))
    return dict(enumerate(_inverse(camera_from_world))), observations


SYSTEMS: dict[str, Callable[[_Request], Answer]] = {"droid": _droid, "megasam": _megasam, "tapip3d": _tapip3d}
SYSTEM_OF = {"path": "droid", "tracks_path": "tapip3d"}  # which alone takes an argument


# Output.

def _times_of(path: str, fps: float) -> Callable[[int], float]:
    """A function of the frame's number: its time in s."""
    if not path:
        return lambda frame: frame / fps
    times: dict[int, float]
    try:
        with open(path, newline="", encoding="utf-8") as file:
            if pathlib.Path(path).suffix == ".csv":
                times = {int(row["frame"]): float(row["timestamp"]) for row in csv.DictReader(file)}
            else:
                times = dict(enumerate(float(line) for line in file if line.strip() and line[0] != "#"))
    except (OSError, KeyError, TypeError, ValueError, csv.Error):
        raise _error("unreadable", f"{path} is neither a list of times nor frames.csv of a run") from None

    def time(frame: int) -> float:
        if not math.isfinite(times.get(frame, math.nan)):
            raise _error("mismatch", f"{path} has no time of frame {frame}")
        return times[frame]
    return time


def _write(path: str, write: Callable[[], None]) -> None:
    """Calls a function that writes to a path."""
    try:
        write()
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        reason = getattr(error, "strerror", None) or error
        raise _error("unwritable", f"{path} cannot be written: {reason}") from None


def _refuse_other_files(folder: str, tracks_path: str) -> None:
    """A former result is replaced; files of a run, or of anything else, are not."""
    try:
        names = {name for name in os.listdir(folder)
                 if not (tracks_path and os.path.realpath(os.path.join(folder, name)) == os.path.realpath(tracks_path))}
    except (OSError, ValueError):  # not there, or not to be written, which is said then
        return
    if names - {TRAJECTORY, OBSERVATIONS}:
        raise ValueError(f"the folder '{folder}' holds files that are not a converted result's, such as "
                         f"{min(names - {TRAJECTORY, OBSERVATIONS})}; give a new or an empty folder")


def _write_tracks(path: str, tracks: NDArray[np.float32], seen: NDArray[np.bool_]) -> None:
    with open(path, "wb") as file:  # to a path without .npz NumPy appends it
        np.savez(file, tracks=tracks, visibility=seen)


def _write_result(folder: pathlib.Path, lines: list[str], rows: NDArray[Any]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / TRAJECTORY).write_text("".join(lines), encoding="utf-8")
    np.savetxt(folder / OBSERVATIONS, rows, fmt="%d,%d,%.4f,%.4f,%.9g,%.9g,%.9g", header=HEADER, comments="")


def _size(value: Any) -> Size:
    size = [given.whole(side, "size") for side in given.numbers(value, "size")]
    if len(size) != 2 or min(size) < 2:
        raise ValueError(f"size is {value}; give (width, height) of the sequence's images, in pixels")
    return size[0], size[1]


def _at_least(least: int, value: Any, name: str) -> int:
    return given.whole(value, name, low=least)


def convert_arrays(input_path: StrPath, output_path: StrPath, system: str, size: given.Wholes, *,
                   start: SupportsIndex = 0, stride: SupportsIndex = 1, fps: SupportsFloat = 30.0,
                   times: StrPath | None = None, step_px: SupportsIndex = 8,
                   path: StrPath | None = None, tracks_path: StrPath | None = None) -> dict[str, int]:
    """Writes the arrays of DROID-SLAM, MegaSaM or TAPIP3D as a result (docs/exchange.md), which
    pliant.import_result(..., format="result") makes a run.

    Args:
        input_path: of droid the folder that its demo.py --reconstruction_path leaves (tstamps, poses, disps,
            intrinsics .npy), or an .npz of arrays with these names; of megasam SCENE_droid.npz or
            SCENE_sgd_cvd_hr.npz; of tapip3d NAME.result.npz.
        output_path: folder of the result, made if need be. A former result in it is replaced; a folder with other
            files, such as a run's, is refused.
        system: droid, megasam or tapip3d.
        size: (width, height) of the images of the sequence, which the system has resized, pixels.
        start, stride: which frames of the sequence the system was given; by default all.
        fps: a frame's time is its number by this, where there are no `times`.
        times: times.txt of the sequence, or frames.csv of a run on it.
        step_px: depth images become one point for this many pixels in both directions.
        path: of droid the array that terminate() returns, saved with np.save: then every frame has a pose.
        tracks_path: of tapip3d a file for the points' pixels (in NumPy's format .npz), which pliant.track takes as
            tracks.

    Returns:
        How many "poses" and "points" in how many "frames" were written, and how many poses were "left_out", which are
        not finite, or no rotation. That there are no points at all is a UserWarning.

    Raises:
        pliant.Error: the arrays are not there, or not those of the system, or nothing can be written.
        ValueError: an argument that cannot be meant.
    """
    if given.text(system, "system") not in SYSTEMS:
        raise ValueError(f"system is '{system}'; give {', '.join(SYSTEMS)}")
    first, every = _at_least(0, start, "start"), _at_least(1, stride, "stride")
    rate = given.number(fps, "fps")
    if not (math.isfinite(rate) and rate > 0):
        raise ValueError(f"fps is {rate}; give a number of frames a second above 0")
    request = _Request(given.path(input_path, "input_path"), _size(size), _at_least(1, step_px, "step_px"),
                       given.optional_path(path, "path"), given.optional_path(tracks_path, "tracks_path"))
    for name, taker in SYSTEM_OF.items():
        if getattr(request, name) and system != taker:
            raise ValueError(f"{name} is for {taker}, and system is {system}; leave it out")
    if request.tracks_path and (first, every) != (0, 1):
        raise ValueError("tracks are of all frames of the sequence; leave out start and stride, or tracks_path")
    output, times_path = given.path(output_path, "output_path"), given.optional_path(times, "times")
    _refuse_other_files(output, request.tracks_path)
    poses, observations = SYSTEMS[system](request)
    time = _times_of(times_path, rate)

    def frame_of(place: int) -> int:
        return first + every * int(place)

    good = {frame_of(place): pose for place, pose in sorted(poses.items()) if _is_pose(pose)}
    if not good:
        raise _error("mismatch", f"none of the {len(poses)} poses is one")
    lines = [f"{time(frame):.6f} " + " ".join(f"{v:.9g}" for v in [*pose[:3, 3], *quaternion(pose)]) + "\n"
             for frame, pose in good.items()]
    rows = observations(frame_of)
    rows = rows[np.isin(rows[:, 0], list(good))]
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    _write(output, lambda: _write_result(pathlib.Path(output), lines, rows))
    if not len(rows):
        warnings.warn(f"no point of {request.input_path} is seen in a frame with a pose: the result has the camera "
                      "path alone", UserWarning, stacklevel=2)
    return {"poses": len(good), "left_out": len(poses) - len(good), "points": len(rows),
            "frames": len(np.unique(rows[:, 0]))}
