# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The real recordings that experiments look for, which are not part of this project."""
import os
from pathlib import Path

RECORDINGS = Path(os.environ.get("PLIANT_RECORDINGS", Path(__file__).resolve().parents[3] / "shared" / "data"))

# name: images, other arguments of pliant; {0} is the folder of the recordings
CLIPS = {
    "nasal": ("nasal/images", "--camera {0}/nasal/camera.yaml --mask_path {0}/nasal/mask.png"),
    "laparoscopy": ("laparoscopy/endo.mp4", ""),
    "instruments": ("clips/instruments.mp4", ""),
    "gallbladder": ("clips/gallbladder.mp4", ""),
}
