#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The pictures of the README and of docs/report.md, from what `./run demo` left.
#   docs/images/report_pictures.sh [BUILD]           (build/release)
# Needs chromium.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=${1:-build/release}
"$build/pliant" report --run build/demo/run --figure 5,30,55 --Figure.panel_width_px 340 -o docs/images/figure.png
"$build/pliant" surface --run build/demo/run --output_path build/demo/surface --overwrite --quiet
"$build/pliant" report --run build/demo/run --surface build/demo/surface -o build/demo/report_surface.html
node docs/images/report_page.mjs "$build/web" build/demo/report_surface.html docs/images
