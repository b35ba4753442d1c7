# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A frame of a simulated sequence, the depth that was found in it, how far that is off, and how far it says it is."""

import json
import pathlib
import re

import numpy
import plots
from plots import plt

STEPS = 65535  # of a 16-bit image, which matplotlib reads as 0 to 1


def depth_scale(folder):
    return float(re.search(r"^depth_scale: *(\S+)", (folder / "camera.yaml").read_text(), re.MULTILINE)[1])


def write(surface, sequence, frame, path):
    surface, sequence = pathlib.Path(surface), pathlib.Path(sequence)
    names = {entry["frame"]: entry["name"] for entry in json.loads((surface / "surface.json").read_text())["frames"]}
    name = names[frame]
    image = plt.imread(sequence / "images" / name)
    truth = plt.imread(sequence / "depth" / name) * STEPS * depth_scale(sequence)
    depth = plt.imread(surface / "depth" / name) * STEPS * depth_scale(surface)
    sigma = 100 * plt.imread(surface / "confidence" / name)
    known = (depth > 0) & (truth > 0)
    depth *= numpy.median(truth[known] / depth[known])
    masked = [numpy.ma.masked_where(~known, values) for values in (depth, 100 * abs(depth - truth) / numpy.maximum(truth, 1e-9), sigma)]
    figure, axes = plt.subplots(1, 4, figsize=(16, 3.3), constrained_layout=True)
    axes[0].imshow(image)
    near, far = numpy.percentile(depth[known], (1, 99))
    for axis, values, ends, title in zip(axes[1:], masked, ((near, far), (0, 4), (0, 4)),
                                         ("depth, mm", "off by, %", "standard deviation it gives, %")):
        axis.set_facecolor("0.85")
        shown = axis.imshow(values, cmap="viridis", vmin=ends[0], vmax=ends[1], interpolation="nearest")
        figure.colorbar(shown, ax=axis, shrink=0.9)
        axis.set_title(title, fontsize="medium")
    for axis in axes:
        axis.set_xticks([])
        axis.set_yticks([])
    plots.save(figure, [path], dpi=75)
