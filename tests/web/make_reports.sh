#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# usage: make_reports.sh PLIANT SEQUENCE FOLDER
# What the tests of the page open: reports of one run with truth, of two runs, of a run whose images are gone, of one
# with its surface, whose folder stays too, and of two with the surface of the second.
set -euo pipefail
pliant=$1 sequence=$(realpath "$2") folder=$3

rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
ln -s "$sequence" images_that_go
"$pliant" track --image_path images_that_go --output_path ours --end 40 --quiet
"$pliant" track --image_path "$sequence" --output_path fixed_map --end 40 --Growth.grow off --quiet
"$pliant" report --run ours --sequence "$sequence" -o one.html --quiet
"$pliant" report --run ours --run fixed_map --sequence "$sequence" -o two.html --quiet
"$pliant" surface --run ours --sequence "$sequence" --frames 10,20,30 --output_path surface --quiet
"$pliant" report --run ours --sequence "$sequence" --surface surface -o surface.html --quiet
"$pliant" report --run fixed_map --run ours --sequence "$sequence" --surface surface -o second_surface.html --quiet
rm images_that_go
"$pliant" report --run ours -o no_images.html --quiet
