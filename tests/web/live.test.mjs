// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The live view with a server that tells of a made-up run: a grid of points before a camera that moves sideways.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { test } from "node:test";
import { deflateSync } from "node:zlib";
import { eventually, press, screenshot, state, withPage } from "./support.mjs";

const report = process.env.PLIANT_REPORT;
const POINTS = 48;
const FOCAL_PX = 300;

test("follows a run while it goes on", { skip: report ? false : "PLIANT_REPORT is not set" }, async () => {
  const run = { epoch: 1, rows: 0, running: true };
  const server = createServer((request, response) => answer(new URL(request.url, "http://localhost"), response, run));
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const url = `http://127.0.0.1:${server.address().port}/`;
  try {
    await withPage(url, (page) => follow(page, run), { allowed: url, wait: false });
  } finally {
    server.closeAllConnections();
    server.close();
  }
});

async function follow(page, run) {
  await eventually(page, () => document.getElementById("message").textContent === "Waiting for the first map: frame 12 of 40.");
  const frames = (count) => eventually(page, (rows) => window.pliant.state?.().frames === rows, count);
  const atEnd = () => eventually(page, () => window.pliant.state().position === window.pliant.state().frames - 1);
  run.rows = 5;
  await frames(5);
  await atEnd();
  assert.equal((await state(page)).points.length, POINTS);
  run.rows = 12;
  await frames(12);
  await atEnd();
  await press(page, "n");
  await eventually(page, () => document.getElementById("point-length").textContent === "seen in 12 of 12 frames");

  await press(page, "Home");
  run.rows = 15;
  await frames(15);
  assert.equal((await state(page)).position, 0, "it stays where the user went");
  await page.locator("#newest").click();
  await atEnd();

  // Two maps were joined: all is new.
  run.epoch = 2;
  run.rows = 9;
  await frames(9);
  await atEnd();
  await screenshot(page, "live");
  run.running = false;
  await eventually(page, () => document.getElementById("live-state").textContent.startsWith("The run has ended"));
  assert.equal((await state(page)).frames, 9);
}

test("says that the program of a live view is gone", { skip: report ? false : "PLIANT_REPORT is not set" }, async () => {
  const run = { epoch: 1, rows: 6, running: true };
  const server = createServer((request, response) => answer(new URL(request.url, "http://localhost"), response, run));
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const url = `http://127.0.0.1:${server.address().port}/`;
  await withPage(url, async (page) => {
    await eventually(page, () => window.pliant.state?.().frames === 6);
    server.closeAllConnections();
    server.close();
    await eventually(page, () => /does not answer any more/.test(document.getElementById("live-state").textContent));
    assert.equal((await state(page)).frames, 6);
  }, { allowed: url, wait: false, tolerated: /ERR_CONNECTION_REFUSED|ERR_EMPTY_RESPONSE|ERR_CONNECTION_RESET/ });
});

function answer(url, response, { epoch, rows, running }) {
  if (url.pathname === "/") {
    const [head, rest] = split(readFileSync(report, "utf8"), '<script type="application/json" id="pliant-data">');
    response.setHeader("Content-Type", "text/html; charset=utf-8");
    response.end(`${head}{"format": 1, "live": true}${rest.slice(rest.indexOf("</script>"))}`);
  } else if (url.pathname === "/data") {
    const from = Number(url.searchParams.get("epoch")) === epoch ? Number(url.searchParams.get("from")) : 0;
    response.end(JSON.stringify({
      epoch, from, running, frames_in_sequence: 40, read: 12, state: rows ? "tracking" : "initializing", image_scale: 0.5, image_frames: [0],
      data: dataOf(from, rows),
    }));
  } else if (/^\/image\/\d+\.jpg$/.test(url.pathname)) {
    const { images } = JSON.parse(dataTextOf(readFileSync(report, "utf8")));
    response.end(Buffer.from(images.jpeg[0], "base64"));
  } else {
    response.statusCode = 404;
    response.end();
  }
}

function split(text, mark) {
  const at = text.indexOf(mark);
  return [text.slice(0, at + mark.length), text.slice(at + mark.length)];
}

function dataTextOf(text) {
  const [, rest] = split(text, '<script type="application/json" id="pliant-data">');
  return rest.slice(0, rest.indexOf("</script>"));
}

function dataOf(from, to) {
  const frames = Array.from({ length: Math.max(0, to - from) }, (_, i) => from + i);
  const seen = frames.length ? Array.from({ length: POINTS }, (_, i) => i) : [];
  const place = (point) => [(point % 8) * 6 - 21, Math.floor(point / 8) * 6 - 15, 60];
  const all = seen.flatMap((point) => frames.map((frame) => ({ point, frame, position: place(point).map((x) => x + 0.05 * frame) })));
  const pixels = all.map(({ frame, position: [x, y, z] }) => [160 + (FOCAL_PX * (x - frame)) / z, 120 + (FOCAL_PX * y) / z]);
  const column = (value) => frames.map(value);
  return {
    format: 1, version: "0", title: "live", live: true, unit: "map units", notes: [], images: null, truth: null,
    camera: { width: 320, height: 240, corners: [[-0.53, -0.4, 1], [0.53, -0.4, 1], [0.53, 0.4, 1], [-0.53, 0.4, 1]] },
    runs: [{
      name: "run", status: "running", note: "", figures: [["Frames", "tracked", String(to)]], options: [["Tracking.option", "1"]],
      frames: {
        frame: frames, time: column((frame) => frame / 30), state: column(() => "tracking"), submap: column(() => 0), note: {},
        tracked: column(() => POINTS), optimized: column(() => POINTS), lost: column(() => 0), added: column(() => 0),
        reprojection_px: column((frame) => 0.5 + 0.01 * frame), costs: { reprojection: column(() => 10) }, stages_ms: { track: column(() => 5) },
        errors: {}, scale: null, pose: pack(frames.map((frame) => [0, 0, 0, 1, frame, 0, 0]), 7),
      },
      points: { id: packIntegers(seen), rest: pack(seen.map(place), 3), rgb: pack(seen.map(() => [200, 120, 90]), 3) },
      observations: {
        count: seen.map(() => frames.length), row: packIntegers(all.map(({ frame }) => frame - from)), pixel: pack(pixels, 2),
        position: pack(all.map(({ position }) => position), 3), depth: pack(all.map(({ position }) => [position[2]]), 1),
        reprojection_px: pack(all.map(() => [0.4]), 1), ssim: pack(all.map(() => [0.9]), 1), gain: null, bias: null, truth: null, error_mm: null,
      },
    }],
  };
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
