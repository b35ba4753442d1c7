# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Depth images as a network might have made them, from the true ones of a simulated sequence.

What networks for one image do wrong (MiDaS, Depth Anything, their fine-tuned kin for endoscopes): an unknown scale and
shift in every image, a relief that is too flat, a bias that varies smoothly over the image and slowly over time, edges
that are smoothed across contours, and a flicker from image to image.
"""
import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter, zoom


@dataclass(frozen=True)
class Errors:
    """Standard deviations are of log depth, sizes are shares of the image's width."""

    scale: float = 0.2       # of an image's scale
    shift: float = 0.1       # of its shift, by the median of its values
    flatness: float = 0.85   # exponent of the relief
    bias: float = 0.1        # of the smooth error
    bias_size: float = 0.15  # over which it varies
    bias_frames: float = 60  # over which it lasts
    flicker: float = 0.015   # of the error that is new in every image
    flicker_size: float = 0.03
    blur: float = 0.012


def smooth_field(random: np.random.Generator, shape: tuple[int, int], size: float) -> np.ndarray:
    """Of unit variance, changing over `size` of the width."""
    step = 8
    small = random.standard_normal((shape[0] // step + 9, shape[1] // step + 9))
    field = gaussian_filter(small, size * shape[1] / step, mode="wrap")
    field /= field.std() + 1e-12
    return zoom(field, step, order=1)[:shape[0], :shape[1]]


class Network:
    def __init__(self, errors: Errors, seed: int):
        self.errors, self.random, self.bias = errors, np.random.default_rng(seed), None

    def inverse_depth(self, depth: np.ndarray) -> np.ndarray:
        """16-bit values; 0 where there is no depth. `depth`: 0 where there is none."""
        e, random, known = self.errors, self.random, depth > 0
        if not known.any():
            return np.zeros(depth.shape, np.uint16)
        fresh = smooth_field(random, depth.shape, e.bias_size)
        keep = np.exp(-1 / e.bias_frames)
        self.bias = fresh if self.bias is None else keep * self.bias + np.sqrt(1 - keep**2) * fresh
        log_depth = np.log(np.where(known, depth, np.median(depth[known])))
        middle = np.median(log_depth[known])
        log_depth = middle + e.flatness * (log_depth - middle) + e.bias * self.bias
        log_depth += e.flicker * smooth_field(random, depth.shape, e.flicker_size)
        inverse = gaussian_filter(np.exp(-log_depth), e.blur * depth.shape[1])
        inverse *= np.exp(random.normal(0, e.scale))
        inverse += np.median(inverse[known]) * random.normal(0, e.shift)
        least = inverse[known].min()
        if least <= 0:  # networks answer with values above 0
            inverse += 1e-3 * np.median(inverse[known]) - least
        values = np.clip(np.rint(inverse * 20000 / np.median(inverse[known])), 1, 65535).astype(np.uint16)
        return np.where(known, values, 0).astype(np.uint16)


def degrade(sequence: Path, output: Path, seed: int, errors: Errors = Errors()) -> None:
    part = output.with_name(output.name + ".part")
    part.mkdir(parents=True, exist_ok=True)
    network = Network(errors, seed)
    for file in sorted((sequence / "depth").glob("*.png")):
        depth = np.asarray(Image.open(file)).astype(float)
        Image.fromarray(network.inverse_depth(depth)).save(part / file.name)
    part.rename(output)  # whole or not at all


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sequence", type=Path, help="a simulated sequence, with depth/")
    parser.add_argument("output", type=Path, help="folder of the depth priors")
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args(arguments)
    degrade(chosen.sequence, chosen.output, chosen.seed)


if __name__ == "__main__":
    main(sys.argv[1:])
