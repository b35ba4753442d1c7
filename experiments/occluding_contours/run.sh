#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Simulates scenes with folds, tracks each with and without the two defences against corners on occluding contours, and
# prints one table. See README.md beside this file.
#
# environment: PLIANT  the program (default build/release/pliant)
#              SEEDS   the scenes' seeds (default "1 2 3")
#              MOTIONS the camera's ways (default "insert sway")
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "$here/../.."

pliant=${PLIANT:-build/release/pliant}
seeds=${SEEDS:-1 2 3}
motions=${MOTIONS:-insert sway}
frames=60
out=build/experiments/occluding_contours

# A scene that is there is used again: the same options give the same files.
simulate() {
  local scene=$1 motion=$2 amplitude=$3 seed=$4
  if [[ -d $scene ]]; then return; fi
  rm -rf "$scene.part"
  "$pliant" simulate --output_path "$scene.part" --quiet --Trajectory.kind "$motion" --Trajectory.frames "$frames" \
    --Deformation.amplitude_mm "$amplitude" --Scene.seed "$seed"
  mv "$scene.part" "$scene"
}

# start "depth": the first map is the true one, in true millimeters; "gated": from the images alone, of no scale.
track() {
  local scene=$1 run=$2 start=$3 filter=$4 agreement=$5 scale=per_frame
  if [[ $start == depth ]]; then scale=none; fi
  rm -rf "$run"
  "$pliant" track --image_path "$scene" --output_path "$run" --quiet --Init.method "$start" \
    --Corners.contour_filter "$filter" --Tracking.neighbor_agreement "$agreement" \
    --Growth.grow off --Tracking.find_lost off
  # A run that never found a first map has nothing to evaluate; the table counts it as such.
  "$pliant" evaluate --run "$run" --sequence "$scene" --scale "$scale" --output_path "$run/evaluation" --quiet ||
    echo "not evaluated: $run" >&2
}

mkdir -p "$out/scenes" "$out/runs"
for motion in $motions; do
  for amplitude in 0 2.5; do
    for seed in $seeds; do
      name=$motion-A$amplitude-seed$seed
      simulate "$out/scenes/$name" "$motion" "$amplitude" "$seed"
      for start in depth gated; do
        for filter in on off; do
          for agreement in on off; do
            track "$out/scenes/$name" "$out/runs/$name-$start-filter_$filter-agreement_$agreement" "$start" "$filter" \
              "$agreement"
          done
        done
      done
    done
  done
done
python3 "$here/table.py" "$out/runs" "$frames" | tee "$out/table.md"
