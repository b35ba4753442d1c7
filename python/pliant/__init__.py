# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pliant: camera pose and scene deformation from one moving camera.

    import pliant
    run = pliant.track("clip.mp4", "run", camera="camera.yaml")
    print(run.summary["status"], run.poses.world_from_cam.shape)
    points = run.frame(10)                        # of one frame
    frames, positions = run.path(points.point_id[0])   # of one point

docs/python.md has more. Conventions of all of it: a camera looks along z, x is to the right and y down; pixel (0, 0) is
the center of the first pixel; images are uint8, of color in the order blue, green, red (as OpenCV reads them);
b_from_a maps points of frame a to frame b; lengths are map units: millimeters after a metric start, else such that the
first map has Init.nominal_depth_mm as its median depth; times are seconds.
"""

from . import extensions, kernels
from ._pliant import Camera, Error, FrameReport, __version__
from .extensions import FirstMap, NewReference, Wait, register_cost, register_initializer, register_tracks
from .jobs import (Calibration, StereoCalibration, calibrate, calibrate_stereo, compare, evaluate, evaluate_stir,
                   export, import_result, join, read_camera, refine, report, simulate, surface, track)
from .options import Options, options
from .run import Run, open_run
from .sequence import Sequence, SequenceFrame, open_sequence
from .system_arrays import convert_arrays
from .tables import Frames, Observations, Points, Poses
from .tracker import Tracker

__all__ = [
    "Calibration", "Camera", "Error", "FirstMap", "FrameReport", "Frames", "NewReference", "Observations", "Options",
    "Points", "Poses", "Run", "Sequence", "SequenceFrame", "StereoCalibration", "Tracker", "Wait", "__version__",
    "calibrate", "calibrate_stereo", "compare", "convert_arrays", "evaluate", "evaluate_stir", "export", "extensions", "import_result",
    "join", "kernels", "open_run", "open_sequence", "options", "read_camera", "refine", "register_cost",
    "register_initializer", "register_tracks", "report", "simulate", "surface", "track",
]
