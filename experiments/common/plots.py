# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""matplotlib as the experiments use it: without a window, in Okabe and Ito's colors, which everybody can tell apart, and
with the same file from the same figures. Nothing is told by color alone."""

import pathlib

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "pliant"
import matplotlib.pyplot as plt

BLUE, VERMILION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
ORANGE, SKY, BLACK = "#E69F00", "#56B4E9", "#000000"
# What an answer that knows nothing gets.
NULL = {"color": "0.6", "linewidth": 3}


def save(figure, paths, **options):
    for path in map(pathlib.Path, paths):
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None, **options)
    plt.close(figure)
