#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the arrays of DROID-SLAM, MegaSaM or TAPIP3D as a result that `pliant import --format result` reads:
pliant.convert_arrays of the Python package, for the command line.

usage: import_arrays.py SYSTEM INPUT --size WIDTHxHEIGHT --output_path DIR [--start N] [--stride N]
                        [--fps N | --times FILE] [--step PX] [--path FILE] [--tracks FILE]

droid    INPUT is the folder that demo.py --reconstruction_path leaves (tstamps, poses, disps, intrinsics .npy), or an
         .npz of arrays with these names. --path is the array that its terminate() returns, saved with np.save: then
         every frame has a pose. Points are those of the keyframes.
megasam  INPUT is SCENE_droid.npz or SCENE_sgd_cvd_hr.npz.
tapip3d  INPUT is NAME.result.npz. --tracks also writes its points' pixels, for `pliant track --tracks`.

--size is that of the images of the sequence, which the system has resized. --start and --stride say which frames it
was given: by default all. A frame's time is its number by --fps (30), or stands in --times: a sequence's times.txt, or
frames.csv of a run. Depth images become one point for --step x --step pixels (8). Needs Pliant's Python package: with
PYTHONPATH=build/release/python that of the build tree.
"""

import argparse
import sys
import warnings

import pliant
from pliant.system_arrays import SYSTEMS


def size(text):
    width, cross, height = text.partition("x")
    if not (cross and width.isdigit() and height.isdigit()):
        raise argparse.ArgumentTypeError(f"'{text}' is not WIDTHxHEIGHT")
    return int(width), int(height)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("system", choices=SYSTEMS)
    parser.add_argument("input")
    parser.add_argument("--size", type=size, required=True, metavar="WIDTHxHEIGHT")
    parser.add_argument("--output_path", required=True)
    parser.add_argument("--start", type=int, default=0)
    parser.add_argument("--stride", type=int, default=1)
    parser.add_argument("--fps", type=float, default=30)
    parser.add_argument("--times")
    parser.add_argument("--step", type=int, default=8)
    parser.add_argument("--path", help="droid: the poses of all frames")
    parser.add_argument("--tracks", help="tapip3d: file to write, .npz")
    arguments = parser.parse_args()
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", UserWarning)
            written = pliant.convert_arrays(
                arguments.input, arguments.output_path, arguments.system, arguments.size, start=arguments.start,
                stride=arguments.stride, fps=arguments.fps, times=arguments.times, step_px=arguments.step,
                path=arguments.path, tracks_path=arguments.tracks)
    except ValueError as error:
        parser.error(str(error))
    except pliant.Error as error:
        print(f"import_arrays.py: {error}", file=sys.stderr)
        return 1
    for warning in caught:
        print(f"import_arrays.py: {warning.message}", file=sys.stderr)
    left_out = f" ({written['left_out']} left out: not finite, or not a rotation)" if written["left_out"] else ""
    print(f"{written['poses']} poses{left_out}, {written['points']} points in {written['frames']} frames")
    return 0


if __name__ == "__main__":
    sys.exit(main())
