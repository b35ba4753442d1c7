# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The jobs of the command line: from files to files.

All of them let other threads of the program run meanwhile. Ctrl-C ends them as it ends the command line's: what there
is so far is on disk, and KeyboardInterrupt is raised; evaluate, compare, export and a page of report leave what was
there before. A figure is too short for that and finishes first. Options are dictionaries with the names of the command
line (pliant.options lists them); one that is not there, or a value that it does not take, is a ValueError. What could
not be done is a pliant.Error. What is odd about an input, and was read all the same, is a UserWarning.
"""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, SupportsIndex, Union

from . import _pliant
from . import arguments as given
from .counted_images import counted
from .extensions import Cost, Initializer, PointFollower, chosen, registered_tracks
from .run import Run
from .sequence import Sequence, sequence_request
from .track_arrays import TrackArrays, are_arrays, are_recorded, file_of, frames_of, without_path

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

StrPath = Union[str, "os.PathLike[str]"]
RunOrPath = Union[Run, StrPath]
OptionValues = Mapping[str, Any]
JobProgress = Callable[[str, int, int], Any]


def _run_path(run: RunOrPath) -> str:
    return given.path(run.folder if isinstance(run, Run) else run, "run")


def _several(paths: Any, name: str) -> list[str]:
    """The run or the path, or those of a list."""
    if isinstance(paths, (Run, str, os.PathLike)):
        paths = [paths]
    return [_run_path(path) for path in given.several(paths, name, "a run or its folder, or a list of them")]


def _refuse_same(runs: list[str], output_path: str, made: str) -> None:
    for run in runs:
        if os.path.exists(run) and os.path.realpath(run) == os.path.realpath(output_path):
            raise ValueError(f"the {made} run would overwrite the run '{run}'; give another output_path")


def _replace_text(path: str, text: str) -> None:
    try:
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        raise given.error("unwritable", f"{path} cannot be written: {error.strerror}") from None


def read_camera(path: StrPath) -> _pliant.Camera:
    """The camera of a calibration file: camera.yaml, COLMAP's cameras.txt or cameras.bin, or OpenCV's YAML or XML.

    Raises pliant.Error where it cannot be read, and ValueError where it cannot be meant.
    """
    return _pliant.read_camera(given.path(path, "path"))


@dataclass(frozen=True)
class Calibration:
    """What pliant.calibrate found.

    Attributes:
        camera: the camera.
        sigmas: standard deviation of each of camera.params.
        error_px: root mean square of the reprojection errors.
        covered_share: share of the image in which there were points of the board, 0 to 1.
        advice: what would make the calibration better, a sentence each.
        images: name, use ("used", "fits badly", "like another", "no board") and reprojection error in px (None where
            the image was not used) of every image in which the board was searched for.
    """

    camera: _pliant.Camera
    sigmas: list[float]
    error_px: float
    covered_share: float
    advice: list[str]
    images: list[tuple[str, str, float | None]]


def calibrate(image_path: StrPath, board: str, output_path: StrPath | None = None,
              options: OptionValues | None = None, *, figure: StrPath | None = None, overwrite: bool = False,
              on_progress: JobProgress | None = None) -> Calibration:
    """Calibrates a camera from images or a video of a flat board.

    Args:
        image_path: folder of images, or a video.
        board: such as "chessboard:9x6:2.0" (inner corners, side of a square in mm); see pliant calibrate --help.
        output_path: of camera.yaml; None: it is not written.
        options: such as {"Calibrate.model": "OPENCV_FISHEYE"}.
        figure: a picture of the errors, .png, .svg or .pdf.
        overwrite: replace files that are there.
        on_progress: called with what is done ("search" in images, their "size", "start", "fit" and "check" of camera
            models), how much of it is done, and how much there is (0: not known).

    Raises:
        pliant.Error: the board is not seen, or the images do not determine the camera. Nothing is written then.
    """
    request = {"image_path": given.path(image_path, "image_path"), "board": given.text(board, "board"),
               "figure": given.optional_path(figure, "figure"), "overwrite": given.truth(overwrite, "overwrite"),
               **given.files(output=output_path)}
    return Calibration(**_pliant.calibrate(request, given.options(options),
                                           given.function(on_progress, "on_progress")))


@dataclass(frozen=True)
class StereoCalibration:
    """What pliant.calibrate_stereo found.

    Attributes:
        left, right: each camera alone.
        left_camera, right_camera: both, estimated together.
        right_from_left: 4 x 4, a point of the left camera in the right one, mm.
        baseline_mm, baseline_sigma_mm: the distance of the cameras, and its standard deviation.
        error_px: root mean square of the reprojection errors in both.
    """

    left: Calibration
    right: Calibration
    left_camera: _pliant.Camera
    right_camera: _pliant.Camera
    right_from_left: NDArray[np.float64]
    baseline_mm: float
    baseline_sigma_mm: float
    error_px: float


def calibrate_stereo(image_path: StrPath, board: str, output_path: StrPath | None = None,
                     options: OptionValues | None = None, *, right_path: StrPath | None = None, pairs: str = "none",
                     overwrite: bool = False,
                     on_progress: JobProgress | None = None) -> StereoCalibration:
    """Calibrates two cameras that see a flat board at the same time.

    Args:
        image_path, board, options, overwrite, on_progress: see pliant.calibrate. The models are perspective ones.
        output_path: of the stereo calibration (OpenCV's YAML), as the camera of a sequence takes it; None: it is not
            written.
        right_path: images or video of the right camera, in the same order.
        pairs: "left_right" or "top_bottom" where each image holds both views.

    Raises:
        pliant.Error: the board is not seen, or the pairs do not determine the cameras. Nothing is written then.
        ValueError: neither or both of right_path and pairs are given.
    """
    if (right_path is None) == (pairs == "none"):
        raise ValueError("give the right camera's images as right_path, or how each image holds both as pairs")
    request = {"image_path": given.path(image_path, "image_path"), "board": given.text(board, "board"),
               "pairs": given.text(pairs, "pairs"), "overwrite": given.truth(overwrite, "overwrite"),
               **given.files(output=output_path, right=right_path)}
    found = _pliant.calibrate_stereo(request, given.options(options), given.function(on_progress, "on_progress"))
    found.update({side: Calibration(**found[side]) for side in ("left", "right")})
    return StereoCalibration(**found)


def simulate(output_path: StrPath, options: OptionValues | None = None, *, realism: str = "clean",
             on_progress: Callable[[int, int], Any] | None = None) -> None:
    """Renders a scene that deforms as a sequence with depth and poses.

    Args:
        output_path: folder of the sequence, made if need be.
        options: such as {"Trajectory.frames": 60}.
        realism: the defaults of the options, clean or endoscope.
        on_progress: called with the frames that are done and the frames that are to be.
    """
    _pliant.simulate(given.path(output_path, "output_path"), given.options(options), given.text(realism, "realism"),
                     given.function(on_progress, "on_progress"))


def track(input: StrPath | Sequence | Iterable[NDArray[np.uint8]], output_path: StrPath,
          options: OptionValues | None = None, *, camera: StrPath | _pliant.Camera | None = None,
          timestamps: given.Numbers | None = None, preset: str = "default", mask_path: StrPath | None = None,
          start: SupportsIndex = 0, end: SupportsIndex | None = None, stride: SupportsIndex = 1,
          initializer: Initializer | str | None = None,
          tracks: PointFollower | StrPath | TrackArrays | None = None, tracks_pixel_origin: str | None = None,
          cost: Cost | str | None = None, depth_prior: StrPath | None = None, resume: bool = False,
          on_frame: Callable[[_pliant.FrameReport], Any] | None = None) -> Run:
    """Camera pose and the motion of every point.

    Args:
        input: a folder of images, a video or a data set; a camera ("device:0"), a stream ("rtsp://...") or standard
            input ("-"), whose images are recorded beside the run; or images: a list or array of them, or anything that
            is iterated over. An image is uint8 (height, width), or (height, width, 3) in the order blue, green, red, as
            OpenCV reads it. What has a length and an index is asked for an image whenever it is needed; the images of
            another iterable are kept in memory to the end, since tracking may go back. Or a pliant.Sequence, with the
            camera, masks and frames that it was opened with.
        output_path: run folder, made if need be.
        options: such as {"Init.method": "window", "Growth.grow": False, "General.seed": 3}.
        camera: of a path the calibration file (None: the one that belongs to the images), of images a pliant.Camera.
        timestamps: of images that are given, seconds, one an image, a list or an array also where the images come one
            by one; None: by the camera's fps, 30 where it has none.
        preset: the defaults of the options, default or paper.
        mask_path: folder of masks, or one image for all frames; 0: ignore this pixel.
        start, end, stride: the first frame, one past the last one (None: to the end), and every which frame.
        initializer: makes first maps in place of Init.method: a function (pliant.extensions.Initializer), or the name
            of one that is registered (pliant.register_initializer), which Init.method takes, too.
        tracks: follows points in place of Pliant's own tracker: an object (pliant.extensions.PointFollower), the name
            of what makes one (pliant.register_tracks), or another program's tracks (docs/tracks.md): their file, or
            arrays, as a pair (tracks, visibility) or by these names. tracks is (T, N, 2), x before y, in pixels of
            the images, and visibility (T, N) bool; entry t of T is frame t of the images.
        tracks_pixel_origin: what (0, 0) is in tracks of a file or of arrays: the center of the first pixel, or its
            upper left corner; None: as the option TrackFile.pixel_origin says (center).
        cost: a term that is added to the joint problem of every frame: an object (pliant.extensions.Cost), or the name
            of one that is registered (pliant.register_cost).
        depth_prior: folder of another program's depth images, a file an image (docs/your_own_video.md).
        resume: go on with the run in output_path that was stopped or killed, from its last checkpoint
            ({"General.checkpoint_frames": N}); the other arguments are given again as they were. Not with images that
            are given.
        on_frame: called with the pliant.FrameReport of every frame, in order, as it is final and on disk. An exception
            ends the run after the frame and is raised.

    Returns:
        The run, also one that ended while the camera was lost (summary["status"] is "lost").

    Raises:
        pliant.Error: the images cannot be read, or there is no map; the run folder has what there was until then.
    """
    images: Any = input
    if isinstance(input, Sequence):
        images, of_sequence = input.path, input.request
        if (camera, mask_path, start, end, stride) != (None, None, 0, None, 1):
            raise ValueError("the input is a pliant.Sequence, which has its camera, masks and frames; open it with "
                             "those that are meant")
    else:
        of_sequence = sequence_request(mask_path, start, end, stride)
    request: dict[str, Any] = {**of_sequence, "resume": given.truth(resume, "resume")}
    output = given.path(output_path, "output_path")
    preset, on_frame = given.text(preset, "preset"), given.function(on_frame, "on_frame")
    tracks = registered_tracks(tracks)
    is_path = isinstance(images, (str, os.PathLike))
    if is_path:
        if timestamps is not None:
            raise ValueError("timestamps are for images that are given; those of a path come from its times.txt")
        request.update(image_path=given.path(images, "input"), camera_path=given.camera_path(camera))
    else:
        if resume:
            raise ValueError("images that are given do not come again, so such a run cannot be resumed; give a path")
        images = given.images(images)
        if not isinstance(camera, _pliant.Camera):
            raise ValueError("images need their camera; give a pliant.Camera (pliant.read_camera reads a file)")
        times = [] if timestamps is None else given.numbers(timestamps, "timestamps")
        if timestamps is not None:
            images = counted(images, len(times), "timestamps")
        if are_arrays(tracks) and (frames := frames_of(tracks)):
            images = counted(images, frames, "frames of tracks")
        request.update(images=images, camera=camera, timestamps=times)
    if resume and are_arrays(tracks):
        raise ValueError("a run with arrays of tracks cannot be resumed; save them with np.savez(path, tracks=tracks, "
                         "visibility=visibility), and give the path")
    if are_recorded(tracks):
        given.refuse_both(options, "TrackFile.path", "tracks", "arrays" if are_arrays(tracks) else tracks)
    given.refuse_both(options, "DepthPrior.path", "depth_prior", depth_prior)
    with file_of(tracks if are_recorded(tracks) else None) as track_file:
        values = given.options_with(options, {
            "TrackFile.path": track_file,
            "TrackFile.pixel_origin": given.optional_text(tracks_pixel_origin, "tracks_pixel_origin"),
            "DepthPrior.path": given.optional_path(depth_prior, "depth_prior")})
        values, extensions = chosen(values, initializer, None if track_file else tracks, cost)
        request.update(extensions)
        track_input = _pliant.track_path if is_path else _pliant.track_images
        track_input(request, output, values, preset, on_frame)
    return Run(output)


def refine(run: RunOrPath, output_path: StrPath, options: OptionValues | None = None, *,
           sequence: StrPath | None = None, camera: StrPath | None = None,
           on_progress: Callable[[str, float, float], Any] | None = None) -> Run:
    """Solves for all frames of a run at once. Ctrl-C ends it with the last solution of all frames, if there is one.

    Args:
        run: a run or its folder.
        output_path: folder of the refined run, made if need be; not the run's.
        options: such as {"Refine.model": "rigid"}.
        sequence, camera: images of a run that has no sparse/, and their calibration file.
        on_progress: called with the stage's name, the share that is done (0 to 1) and the cost.

    Returns:
        The refined run.
    """
    request: dict[str, str] = {"run_path": _run_path(run), "output_path": given.path(output_path, "output_path"),
                               **given.files(sequence=sequence, camera=camera)}
    _refuse_same([request["run_path"]], request["output_path"], "refined")
    _pliant.refine(request, given.options(options), given.function(on_progress, "on_progress"))
    return Run(output_path)


def join(runs: Any, output_path: StrPath, options: OptionValues | None = None, *, sequence: StrPath | None = None,
         camera: StrPath | None = None, on_progress: JobProgress | None = None) -> Run:
    """One run of runs of parts of a recording, which overlap. Where two parts have no map in common, the later one's is
    a submap of its own, with a warning.

    Args:
        runs: two or more runs or their folders, in any order.
        output_path: folder of the joined run, made if need be; none of the runs'.
        options: such as {"Join.min_points": 100}.
        sequence, camera: images of a run that has no sparse/, and their calibration file.
        on_progress: called with what is done ("join", for example), how much of it is done, and how much there is.

    Returns:
        The joined run.
    """
    request: dict[str, Any] = {"run_paths": _several(runs, "runs"),
                               "output_path": given.path(output_path, "output_path"),
                               **given.files(sequence=sequence, camera=camera)}
    _refuse_same(request["run_paths"], request["output_path"], "joined")
    for joint in _pliant.join(request, given.options(options), given.function(on_progress, "on_progress")):
        if joint["failure"]:
            warnings.warn(f"{joint['run']} is not joined to {joint['before']}: {joint['failure']}", stacklevel=2)
    return Run(output_path)


def surface(run: RunOrPath, output_path: StrPath, options: OptionValues | None = None, *,
            frames: given.Wholes | None = None, sequence: StrPath | None = None, camera: StrPath | None = None,
            mask_path: StrPath | None = None,
            on_progress: Callable[[str, int, int], Any] | None = None) -> dict[str, Any]:
    """Dense depth of the frames of a run, and a mesh that moves with the tissue (docs/formats.md).

    Args:
        run: a run or its folder.
        output_path: surface folder, made if need be.
        frames: numbers of the frames; None: all that have a pose.
        sequence, camera, mask_path: the images, their calibration file and masks; None: those of the run.
        on_progress: called with "depth" or "mesh", the frames that are done and the frames that are to be.

    Returns:
        surface.json.
    """
    request = {"run_path": _run_path(run), "output_path": given.path(output_path, "output_path"),
               **given.files(sequence=sequence, camera=camera, mask=mask_path)}
    _pliant.surface(request, given.wholes(frames, "frames"), given.options(options),
                    given.function(on_progress, "on_progress"))
    with open(os.path.join(os.fspath(output_path), "surface.json"), encoding="utf-8") as file:
        return json.load(file)


def evaluate(run: RunOrPath | None, sequence: StrPath | None = None, options: OptionValues | None = None, *,
             camera: StrPath | None = None, other_runs: Any = (), sfm_path: StrPath | None = None,
             surface_path: StrPath | None = None, tracks: StrPath | TrackArrays | None = None,
             tracks_pixel_origin: str = "center", output_path: StrPath | None = None,
             on_progress: JobProgress | None = None) -> dict[str, Any]:
    """How far a run is from the truth of its sequence, from other runs, or from structure from motion.

    Args:
        run: a run or its folder; None: `tracks` are compared.
        sequence: with truth; not needed with other_runs or sfm_path.
        options: such as {"PointError.scale": "global"}.
        camera: calibration file of the sequence; None: the one that belongs to it.
        other_runs: runs of the same recording.
        sfm_path: points of structure from motion, a CSV or a COLMAP model.
        surface_path: a surface folder of the run, whose error is told too.
        tracks: another program's point tracks (docs/tracks.md), compared with the truth of the sequence: their file, or
            arrays as of pliant.track.
        tracks_pixel_origin: what (0, 0) is in them: the center of the first pixel, or its upper left corner.
        output_path: folder for evaluation.json and evaluation.csv; None: they are not written.
        on_progress: called with what is done ("evaluate", for example), how much of it is done, and how much there is.

    Returns:
        evaluation.json; docs/formats.md has its names. NaN is None. Each of its notes is a UserWarning, too.
    """
    others = _several(other_runs, "other_runs")
    if (run is None) == (tracks is None):
        raise ValueError("a run or tracks are evaluated, one at a time; give one of them")
    if tracks is not None and sequence is None:
        raise ValueError("tracks are compared with the truth of a sequence; give sequence")
    if sequence is None and not others and sfm_path is None:
        raise ValueError("there is nothing to compare the run with; give sequence, other_runs or sfm_path")
    request = {"run_path": "" if run is None else _run_path(run), "other_runs": others,
               "tracks_pixel_origin": given.text(tracks_pixel_origin, "tracks_pixel_origin"),
               **given.files(sequence=sequence, camera=camera, sfm=sfm_path, surface=surface_path, output=output_path)}
    with file_of(tracks) as track_file:
        request["tracks_path"] = track_file
        text = _pliant.evaluate(request, given.options(options), given.function(on_progress, "on_progress"))
    if are_arrays(tracks):
        text = without_path(text, json.dumps(track_file, ensure_ascii=False)[1:-1])
        if output_path is not None:
            _replace_text(os.path.join(output_path, "evaluation.json"), text)
    evaluation = json.loads(text)
    for note in evaluation["notes"]:
        warnings.warn(note, UserWarning, stacklevel=2)
    return evaluation


def evaluate_stir(tracked: StrPath, start: StrPath, end: StrPath, *,
                  output_path: StrPath | None = None) -> dict[str, Any]:
    """Scores points at the end of recordings as the STIR challenge does (docs/tracks.md).

    Args:
        tracked: JSON with where the points are at the end, by recording; pliant.export(run, folder, "stir") writes it.
        start, end: the labelled points of the start and the end, likewise: [x, y] in pixels, (0, 0) being the center
            of the first one, or [x, y, z] in the camera, mm.
        output_path: folder for stir.json; None: it is not written.

    Returns:
        stir.json: "unit" (px or mm), "thresholds", and of the "estimate" and of the "null" (nothing moves): "within"
        (share of the points at most that far from the nearest label), "average_within", "end_point_error", "points".

    Raises:
        pliant.Error: a file cannot be read, or the files do not belong together.
    """
    return json.loads(_pliant.evaluate_stir(given.path(tracked, "tracked"), given.path(start, "start"),
                                            given.path(end, "end"), given.optional_path(output_path, "output_path")))


def compare(runs: Any, sequence: StrPath | Iterable[StrPath] | None = None, options: OptionValues | None = None, *,
            camera: StrPath | None = None, output_path: StrPath | None = None, figure: StrPath | None = None,
            on_progress: JobProgress | None = None) -> dict[str, Any]:
    """Sets runs side by side: each is evaluated against the truth of its sequence, or else against the first run.

    Args:
        runs: the runs or their folders.
        sequence: the images, with truth where there is; one for all runs, or a list with one for each. None: each run
            is compared with the first one ("consistency"): depths at the same pixels, ATE and RPE after alignment.
        options: as of pliant.evaluate, such as {"PointError.protocol": "all"}.
        camera: calibration file of the sequences; None: the one that belongs to them.
        output_path: folder for comparison.json and comparison.csv, and for evaluation.json and evaluation.csv of each
            run in 0/, 1/, ... in their order; None: they are not written.
        figure: a figure of the errors over the frames, .png, .svg or .pdf; None: none.
        on_progress: as of pliant.evaluate, run by run.

    Returns:
        comparison.json: in "runs" what pliant.evaluate returns of each run without its frames, in their order ("run" is
        its folder). A run that cannot be evaluated is left out, and is a UserWarning.

    Raises:
        pliant.Error: none of the runs can be evaluated, or a file cannot be written.
        ValueError: there is no run, or one alone without a sequence, or there are neither one sequence nor as many as
            runs.
    """
    sequences: Any = [sequence] if isinstance(sequence, (str, os.PathLike)) else () if sequence is None else sequence
    request: dict[str, Any] = {"run_paths": _several(runs, "runs"),
                               "sequence_paths": [given.path(path, "sequence") for path in given.several(
                                   sequences, "sequence", "a path, or a list with one for each run")],
                               **given.files(camera=camera, output=output_path, figure=figure)}
    return json.loads(_pliant.compare(request, given.options(options), given.function(on_progress, "on_progress")))


def import_result(input_path: StrPath, output_path: StrPath, sequence: StrPath, format: str = "colmap",
                  options: OptionValues | None = None, *, camera: StrPath | None = None,
                  on_progress: JobProgress | None = None) -> Run:
    """Turns what another program made of a sequence into a run. What was left out is a UserWarning.

    Args:
        input_path: a COLMAP model's folder, a result's folder (docs/formats.md), or a file with a camera path.
        output_path: run folder, made if need be.
        sequence: the images that it was made of.
        format: colmap, result, tum, kitti or euroc.
        options: such as {"Import.unit_mm": 1000}.
        camera: calibration file of images that have none; of a model its own, where it is None.
        on_progress: called with what is done, how much of it is done, and how much there is.
    """
    request = {"input_path": given.path(input_path, "input_path"), "sequence_path": given.path(sequence, "sequence"),
               "format": given.text(format, "format"), "as": "run",
               "output_path": given.path(output_path, "output_path"), **given.files(camera=camera)}
    for note in _pliant.import_result(request, given.options(options), given.function(on_progress, "on_progress")):
        warnings.warn(note, UserWarning, stacklevel=2)
    return Run(output_path)


def export(run: RunOrPath, output_path: StrPath, format: str = "canonical", options: OptionValues | None = None, *,
           sequence: StrPath | None = None, camera: StrPath | None = None, mask_path: StrPath | None = None,
           surface_path: StrPath | None = None, on_progress: JobProgress | None = None) -> dict[str, Any]:
    """Writes a run in the format of another program (docs/formats.md lists them).

    Args:
        run: a run or its folder.
        output_path: folder to write, made if need be.
        format: its name, such as canonical, spacetime, ply or nerfstudio.
        sequence, camera, mask_path: the images, their calibration file and masks; None: those of the run.
        surface_path: a surface folder of the run, for formats with depths.
        on_progress: called with what is done, how much of it is done, and how much there is.

    Returns:
        frames, points, observations (how many were written), and notes (what could not be known).
    """
    request = {"run_path": _run_path(run), "format": given.text(format, "format"),
               "output_path": given.path(output_path, "output_path"),
               **given.files(sequence=sequence, camera=camera, mask=mask_path, surface=surface_path)}
    return _pliant.export(request, given.options(options), given.function(on_progress, "on_progress"))


def report(runs: Any, output_path: StrPath, options: OptionValues | None = None, *, figure: given.Wholes | None = None,
           sequence: StrPath | None = None, camera: StrPath | None = None, surface_paths: Any = (),
           on_progress: JobProgress | None = None) -> list[str]:
    """Shows runs: a page for the browser (.html), with `figure` a still (.png, .svg or .pdf), or a film (.mp4).

    Args:
        runs: a run or its folder, or several of them.
        output_path: the file; its ending says what is written.
        options: such as {"Report.image_width_px": 640} or {"Figure.trail_frames": 10}.
        figure: numbers of the frames of a still.
        sequence, camera: the images, with truth where there is truth, and their calibration file.
        surface_paths: surface folders of the runs, whose meshes the page shows.
        on_progress: called with what is done, how much of it is done, and how much there is.

    Returns:
        What is missing or left out, a sentence each.
    """
    request = {"run_paths": _several(runs, "runs"),
               "surface_paths": [given.path(path, "surface_paths") for path in given.several(
                   [surface_paths] if isinstance(surface_paths, (str, os.PathLike)) else surface_paths,
                   "surface_paths", "a surface folder, or a list of them")],
               "output_path": given.path(output_path, "output_path"), **given.files(sequence=sequence, camera=camera)}
    return _pliant.report(request, given.wholes(figure, "figure"), given.options(options),
                          given.function(on_progress, "on_progress"))
