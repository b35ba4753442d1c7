#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# A picture of a COLMAP model in COLMAP's own viewer, under a virtual screen.
#   docs/images/colmap_viewer.sh MODEL DATABASE IMAGES PICTURE
# Needs colmap, xvfb, xdotool and imagemagick. The viewer hides points that fewer than 3 images see, or that are off by
# more than 2 px, unless it is told otherwise.
set -euo pipefail
if [[ -z ${INSIDE:-} ]]; then
  INSIDE=1 exec xvfb-run -a -s "-screen 0 1400x900x24" "$0" "$@"
fi
export LIBGL_ALWAYS_SOFTWARE=1
colmap gui --import_path "$1" --database_path "$2" --image_path "$3" --Render.min_track_len 1 --Render.max_error 100 &>/dev/null &
viewer=$!
trap 'kill "$viewer"' EXIT
sleep "${SECONDS_TO_START:-25}"
window=$(xdotool search --onlyvisible --name COLMAP | tail -1)
xdotool windowsize "$window" 1400 900 mousemove 550 480
sleep 2
times() { for _ in $(seq "$1"); do xdotool "${@:2}"; sleep 0.2; done; }
times 8 keydown ctrl click 4 keyup ctrl                                      # larger points
times 14 keydown alt click 4 keyup alt                                        # and cameras
times "${STEPS_AWAY:-9}" click 5                                             # from further away
xdotool mousedown 1; times 12 mousemove_relative -- 10 3; xdotool mouseup 1  # from the side
xdotool mousemove 350 300 mousedown 3; times 15 mousemove_relative -- 14 10; xdotool mouseup 3
sleep 2
import -window root -crop 720x520+160+170 +repage "$4"
