#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How far a simulated sequence is from real recordings, in what a point tracker notices.

    realism.py --program build/release/pliant --output_path DIR [--recordings DIR]

Simulates the presets of `pliant simulate --realism`, measures them and the recordings that are there with `pliant
dataset statistics`, and prints two tables: in images of about the same size, and in the working images that `pliant
track` would measure. Below each are the medians of the recordings and the ratios of the simulated sequences to them.
Corners, of which small images hold few, are compared with recordings at least as large as the simulated images.
Sequences that are there already are kept. Needs nothing but Python.
"""
import argparse
import re
import statistics
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "common"))
from clips import CLIPS, RECORDINGS  # noqa: E402

SCALES = {"nasal": 0.5}  # in the first table; others are taken as they are
BREATH = "--Trajectory.frames 60 --Deformation.amplitude_mm 2"
# name: arguments of simulate
SIMULATIONS = {
    "colon, clean": f"--realism clean {BREATH}",
    "surface, clean": f"--realism clean --Scene.kind surface {BREATH}",
    "colon, endoscope": f"--realism endoscope {BREATH}",
    "surface, endoscope": f"--realism endoscope --Scene.kind surface {BREATH}",
}
COLUMNS = ("noise", "corners", "alive 1", "alive 9", "track noise")
FORMATS = ("{:.2f}", "{:.0f}", "{:.2f}", "{:.2f}", "{:.3f}")


def run(program, *arguments):
    return subprocess.run([str(program), *map(str, arguments)], check=True, stdout=subprocess.PIPE, text=True).stdout


def measure(program, images, options):
    """The image's description and the five numbers of COLUMNS, as `pliant dataset statistics` prints them."""
    text = run(program, "dataset", "statistics", images, *options)
    rows = dict(line.split(None, 1) for line in text.splitlines())
    values = [float(x) for name in ("noise", "corners", "alive", "tracks")
              for x in re.findall(r"(?<![\w.])\d+\.?\d*(?= (?:gray|in a|after \d+ frame|after 9|px))", rows[name])]
    return rows["image"].strip(), values


def area(image):
    width, height = re.match(r"(\d+)x(\d+)", image).groups()
    return int(width) * int(height)


def print_table(title, real, simulated):
    print(f"\n{title}\n\n| sequence | image | " + " | ".join(COLUMNS) + " |\n|" + " --- |" * (2 + len(COLUMNS)))
    line = lambda name, image, cells: print(f"| {name} | {image} | " + " | ".join(cells) + " |")
    for name, (image, values) in [*real.items(), *simulated.items()]:
        line(name, image, [form.format(value) for form, value in zip(FORMATS, values)])
    if not real:
        return
    smallest = min(area(image) for image, _ in simulated.values())
    large = [values for image, values in real.values() if area(image) >= smallest] or [v for _, v in real.values()]
    middle = [statistics.median(column) for column in zip(*(values for _, values in real.values()))]
    middle[1] = statistics.median(values[1] for values in large)
    line("median of the recordings", "", [form.format(value) for form, value in zip(FORMATS, middle)])
    for name, (_, values) in simulated.items():
        line(f"{name}, by the median", "", [f"{value / m:.2f}" if m else "" for value, m in zip(values, middle)])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--output_path", required=True, type=Path)
    parser.add_argument("--recordings", default=RECORDINGS, type=Path)
    arguments = parser.parse_args()
    arguments.output_path.mkdir(parents=True, exist_ok=True)
    for name, options in SIMULATIONS.items():
        folder = arguments.output_path / name.replace(", ", "_")
        if not (folder / "times.txt").exists():
            run(arguments.program, "simulate", "--quiet", "--overwrite", "--output_path", folder, *options.split())
    for title, fixed in (("Images as they are, nasal at half size", True),
                         ("Working images as pliant track measures them", False)):
        mode = ["--Image.working", "fixed", "--Image.scale"]
        real = {}
        for name, (images, options) in CLIPS.items():
            if (arguments.recordings / images).exists():
                real[name] = measure(arguments.program, arguments.recordings / images,
                                     options.format(arguments.recordings).split() +
                                     (mode + [SCALES.get(name, 1)] if fixed else []))
        simulated = {name: measure(arguments.program, arguments.output_path / name.replace(", ", "_"),
                                   mode + [1] if fixed else []) for name in SIMULATIONS}
        print_table(title, real, simulated)
    return 0


if __name__ == "__main__":
    sys.exit(main())
