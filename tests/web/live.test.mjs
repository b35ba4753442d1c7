// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The live view with a server that tells of a made-up run.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { test } from "node:test";
import { POINTS, dataOf, dataTextOf, pageWith, runOf } from "./made_up.mjs";
import { eventually, press, screenshot, state, withPage } from "./support.mjs";

const report = process.env.PLIANT_REPORT;

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
  await eventually(page, () => document.getElementById("message").textContent === "Waiting for the first map: frame 12 of 60.");
  const frames = (count) => eventually(page, (rows) => window.pliant.state?.().frames === rows, count);
  const atEnd = () => eventually(page, () => window.pliant.state().position === window.pliant.state().frames - 1);
  run.rows = 5;
  await frames(5);
  await atEnd();
  assert.equal((await state(page)).points.length, POINTS);
  const colors = () => page.locator("#color option").evaluateAll((options) => options.map(({ value }) => value));
  assert.ok(!(await colors()).includes("uncertainty"), "nothing is known of it yet");
  run.sigma = 0.5;
  run.rows = 40;   // the camera has left what was seen of the scene at first
  await frames(40);
  await atEnd();
  const box = await page.locator("#scene").boundingBox();
  await eventually(page, ({ x, y, width, height }) => window.pliant.frustumOnScreen().every((end) =>
    end.x > x && end.x < x + width && end.y > y && end.y < y + height), box);
  assert.ok((await colors()).includes("uncertainty"));
  await page.locator("#color").selectOption("uncertainty");
  assert.equal((await state(page)).color, "uncertainty");
  await press(page, "n");
  await eventually(page, () => document.getElementById("point-length").textContent === "seen in 40 of 40 frames");

  await press(page, "Home");
  run.rows = 45;
  await frames(45);
  assert.equal((await state(page)).position, 0, "it stays where the user went");
  await page.locator("#newest").click();
  await atEnd();

  // Two maps were joined: all is new, and without the color that was chosen.
  run.sigma = null;
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

function answer(url, response, { epoch, rows, running, sigma = null }) {
  if (url.pathname === "/") {
    response.setHeader("Content-Type", "text/html; charset=utf-8");
    response.end(pageWith('{"format": 1, "live": true}', readFileSync(report, "utf8")));
  } else if (url.pathname === "/data") {
    const from = Number(url.searchParams.get("epoch")) === epoch ? Number(url.searchParams.get("from")) : 0;
    response.end(JSON.stringify({
      epoch, from, running, frames_in_sequence: 60, read: 12, state: rows ? "tracking" : "initializing", image_scale: 0.5, image_frames: [0],
      data: { ...dataOf(runOf({ from, to: rows, sigma })), live: true },
    }));
  } else if (/^\/image\/\d+\.jpg$/.test(url.pathname)) {
    const { images } = JSON.parse(dataTextOf(readFileSync(report, "utf8")));
    response.end(Buffer.from(images.jpeg[0], "base64"));
  } else {
    response.statusCode = 404;
    response.end();
  }
}
