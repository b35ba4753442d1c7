// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The data of a page (web/README.md) about a made-up run: a grid of points before a camera that moves sideways.

import { deflateSync } from "node:zlib";

export const POINTS = 48;
export const WIDTH = 320;
export const HEIGHT = 240;
const FOCAL_PX = 300;
const ELEMENT = '<script type="application/json" id="pliant-data">';

// Frames `from` to `to`, without `to`. Points lie `beside` to the right of the grid and are moved by `step` every frame; in frame f
// the grid is 1 + `stretch` f times as wide. Frames of which `isLost` says so have neither pose nor points; points are seen where
// `isSeen` says so, with the standard deviation `sigma`. The world's origin is `away` behind the camera. `truth`: the surface is
// known, half a unit behind the points.
export function runOf({
  name = "run", from = 0, to, beside = 0, step = 0.05, stretch = 0, isLost = () => false, isSeen = () => true, sigma = null, away = 0, truth = false,
}) {
  const frames = Array.from({ length: Math.max(0, to - from) }, (_, i) => from + i);
  const tracked = frames.filter((frame) => !isLost(frame));
  const seen = tracked.length ? Array.from({ length: POINTS }, (_, i) => i) : [];
  const place = (point) => [(point % 8) * 6 - 21 + beside, Math.floor(point / 8) * 6 - 15, 60 + away];
  const placeIn = (point, frame) => place(point).map((x, axis) => (axis === 0 ? 1 + stretch * frame : 1) * x + step * frame);
  const framesOf = (point) => tracked.filter((frame) => isSeen(point, frame));
  const all = seen.flatMap((point) => framesOf(point).map((frame) => ({ point, frame, position: placeIn(point, frame) })));
  const pixels = all.map(({ frame, position: [x, y, z] }) => [WIDTH / 2 + (FOCAL_PX * (x - frame)) / (z - away), HEIGHT / 2 + (FOCAL_PX * y) / (z - away)]);
  const column = (value) => frames.map(value);
  const count = (value) => column((frame) => (isLost(frame) ? 0 : value));
  return {
    name, unit: "map units", status: "running", note: "", figures: [["Frames", "tracked", String(to)]], options: [["Tracking.option", "1"]],
    frames: {
      frame: frames, time: column((frame) => frame / 30), state: column((frame) => (isLost(frame) ? "lost" : "tracking")),
      submap: column(() => 0), note: {}, tracked: count(POINTS), optimized: count(POINTS), lost: column(() => 0), added: column(() => 0),
      reprojection_px: column((frame) => (isLost(frame) ? null : 0.5 + 0.01 * frame)),
      costs: { reprojection: column((frame) => (isLost(frame) ? null : 10)) }, stages_ms: { track: column(() => 5) }, errors: {}, scale: null,
      pose: pack(frames.map((frame) => (isLost(frame) ? new Array(7).fill(NaN) : [0, 0, 0, 1, frame, 0, away])), 7),
    },
    points: { id: packIntegers(seen), rest: pack(seen.map(place), 3), rgb: pack(seen.map(() => [200, 120, 90]), 3) },
    observations: {
      count: seen.map((point) => framesOf(point).length), row: packIntegers(all.map(({ frame }) => frame - from)), pixel: pack(pixels, 2),
      position: pack(all.map(({ position }) => position), 3), depth: pack(all.map(({ position }) => [position[2] - away]), 1),
      reprojection_px: pack(all.map(() => [0.4]), 1), ssim: pack(all.map(() => [0.9]), 1), sigma: sigma && pack(all.map(() => [sigma]), 1), gain: null, bias: null,
      truth: truth ? pack(all.map(({ position: [x, y, z] }) => [x, y, z + 0.5]), 3) : null,
      error_mm: truth ? pack(all.map(() => [0.5]), 1) : null,
    },
  };
}

// A square before the camera that moves away evenly, and is bent in the end. A JPEG in base64 is its texture.
// With `errors` the true surface is known in both frames, but not at its first vertex. `keys`: how many of the two frames it has.
// `gaps`: the frames before and after frames without a surface. `step`: between its vertices.
export function surfaceOf({ texture = null, submap = 0, errors = false, keys = 2, gaps = [], step = 8 } = {}) {
  const grid = Array.from({ length: 25 }, (_, i) => [(i % 5 - 2) * step, (Math.floor(i / 5) - 2) * step, 62]);
  const cells = Array.from({ length: 16 }, (_, i) => (i % 4) + 5 * Math.floor(i / 4));
  return {
    submap, texture, rest: pack(grid, 3), uv: pack(grid.map(([x, y]) => [x / step / 4 + 0.5, y / step / 4 + 0.5]), 2),
    triangles: pack(cells.flatMap((v) => [[v, v + 5, v + 1], [v + 5, v + 6, v + 1]]), 3), sigma: pack(grid.map(([x]) => [0.5 + x / 100]), 1),
    frame: [0, 10].slice(2 - keys), gaps,
    displacement: [pack(grid.map(() => [0, 0, 0]), 3), pack(grid.map(([x]) => [0, 0, 4 + x / 8]), 3)].slice(2 - keys),
    error_mm: errors ? [0, 1].slice(2 - keys).map((key) => pack(grid.map((_, v) => [v === 0 ? NaN : key + 2]), 1)) : null,
  };
}

export function dataOf(...runs) {
  return {
    format: 1, version: "0", title: "made up", live: false, unit: "map units", notes: [], images: null, truth: null,
    camera: { width: WIDTH, height: HEIGHT, corners: [[-0.53, -0.4, 1], [0.53, -0.4, 1], [0.53, 0.4, 1], [-0.53, 0.4, 1]] },
    runs,
  };
}

// What a report holds.
export function dataTextOf(report) {
  const begin = report.indexOf(ELEMENT) + ELEMENT.length;
  return report.slice(begin, report.indexOf("</script>", begin));
}

// The page of a report with other data.
export function pageWith(dataText, report) {
  const begin = report.indexOf(ELEMENT) + ELEMENT.length;
  return report.slice(0, begin) + dataText.replaceAll("<", "\\u003c") + report.slice(report.indexOf("</script>", begin));
}

function pack(rows, columns) {
  const bytes = Array.from({ length: columns }, (_, column) => planes(new Float32Array(rows.map((row) => row[column])).buffer));
  return { type: "f32", rows: rows.length, columns, data: deflateSync(Buffer.concat(bytes)).toString("base64") };
}

function packIntegers(values) {
  return { type: "u32", rows: values.length, columns: 1, delta: false, data: deflateSync(planes(new Uint32Array(values).buffer)).toString("base64") };
}

// The lowest byte of every number, then the next one.
function planes(buffer) {
  const bytes = Buffer.from(buffer);
  const count = bytes.length / 4;
  return Buffer.from(Array.from({ length: bytes.length }, (_, i) => bytes[4 * (i % count) + Math.floor(i / count)]));
}
