# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""examples/live_overlay.py, on the sequence of the end-to-end tests.

usage: overlay_test.py SOURCE
"""

import importlib.util
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from support import SEQUENCE

SKIPPED, FRAMES = 77, 25


def main():
    if importlib.util.find_spec("cv2") is None:
        return SKIPPED
    import cv2
    with tempfile.TemporaryDirectory() as name:
        subprocess.run([sys.executable, "-B", pathlib.Path(sys.argv[1]) / "examples" / "live_overlay.py",
                        str(SEQUENCE / "images" / "%06d.png"), SEQUENCE / "camera.yaml", "--output_path", name, "--frames",
                        str(FRAMES)], check=True)
        pictures = sorted(pathlib.Path(name).iterdir())
        assert [picture.name for picture in pictures] == [f"{k:06d}.jpg" for k in range(FRAMES)], pictures
        last = cv2.imread(str(pictures[-1])).astype(int)
        plain = cv2.imread(str(SEQUENCE / "images" / f"{FRAMES - 1:06d}.png")).astype(int)
        drawn = np.abs(last - plain).max(axis=2) > 60
        assert drawn[40:].mean() > 0.005, "no points are drawn"
    return 0


if __name__ == "__main__":
    sys.exit(main())
