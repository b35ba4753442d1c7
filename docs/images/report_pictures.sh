#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The pictures of the README, of docs/report.md and of docs/gallery.md, from what `./run demo` left.
#   docs/images/report_pictures.sh [BUILD]           (build/release)
# Needs chromium, and Python with OpenCV and Pillow.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=${1:-build/release}
"$build/pliant" report build/demo/run --figure 5,30,55 --Figure.panel_width_px 340 -o docs/images/figure.png
"$build/pliant" surface build/demo/run --output_path build/demo/surface --overwrite --quiet
"$build/pliant" report build/demo/run --surface build/demo/surface -o build/demo/report_surface.html
node docs/images/report_page.mjs "$build/web" build/demo/report_surface.html docs/images
"$build/pliant" report build/demo/run --surface build/demo/surface --Figure.surface_color displacement \
  --Figure.panel_width_px 300 --video -o build/demo/film.mp4 --quiet
python3 - build/demo/film.mp4 docs/images/film.webp <<'PYTHON'
import sys

import cv2
from PIL import Image

film = cv2.VideoCapture(sys.argv[1])
frames = []
while True:
    is_read, frame = film.read()
    if not is_read:
        break
    frames.append(Image.fromarray(cv2.cvtColor(frame, cv2.COLOR_BGR2RGB)))
first, *others = frames[::2]
first.save(sys.argv[2], save_all=True, append_images=others, duration=100, loop=0, quality=45, method=6)
PYTHON
