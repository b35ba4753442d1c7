// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A report in a headless Chromium. From the environment:
//   PLIANT_NODE_MODULES   the folder that holds node_modules with playwright-core
//   PLIANT_CHROMIUM       the browser; else `chromium` of the path
//   PLIANT_REPORT, PLIANT_REPORT_TWO, PLIANT_REPORT_NO_IMAGES   the reports: one run with truth and images, two runs, no images
//   PLIANT_REPORT_SURFACE, PLIANT_SURFACE   a report with a surface, and the surface's folder
//   PLIANT_REPORT_SECOND_SURFACE   a report of two runs with a surface of the second
//   PLIANT_SCREENSHOTS    a folder for pictures of the page, if any are wanted

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { pageWith } from "./made_up.mjs";

const TIMEOUT_MS = 120000;   // of a step, on a machine that has other things to do
const { chromium } = createRequire(join(resolve(process.env.PLIANT_NODE_MODULES), "package.json"))("playwright-core");
let browser;

before(async () => {
  const executablePath = process.env.PLIANT_CHROMIUM || execFileSync("which", ["chromium"], { encoding: "utf8" }).trim();
  browser = await chromium.launch({
    executablePath,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-compositing"],
  });
});

after(() => browser?.close());

// A test of the report that the environment variable names; it fails on any error of the page and on any request of a network.
export function testReport(name, variable, run, options = {}) {
  const path = process.env[variable];
  test(name, { skip: path ? false : `${variable} is not set` }, async () => {
    await withPage(pathToFileURL(resolve(path)).href, run, options);
  });
}

// `allowed` begins the addresses that may be asked for, `tolerated` is an error that is none, `before` runs in the page before its own
// script; without `wait` the page may still load.
export async function withPage(url, run, { allowed, tolerated, before: prepare, wait = true, ...options } = {}) {
  const page = await browser.newPage({ viewport: { width: 1440, height: 900 }, colorScheme: "light", ...options });
  page.setDefaultTimeout(TIMEOUT_MS);
  const problems = [];
  page.on("console", (message) => message.type() === "error" && !tolerated?.test(message.text()) && problems.push(message.text()));
  page.on("pageerror", (error) => problems.push(error.stack));
  page.on("request", (request) => {
    const address = request.url();
    if (!/^(file|data|blob):/.test(address) && !(allowed && address.startsWith(allowed))) problems.push(`asked for ${address}`);
  });
  try {
    if (prepare) await page.addInitScript(prepare);
    await page.goto(url, { timeout: TIMEOUT_MS });
    if (wait) await page.evaluate(() => window.pliant.ready);
    await run(page);
    assert.deepEqual(problems, []);
  } finally {
    await page.close();
  }
}

// The page of this text, opened from disk.
export async function withPageOf(text, run, options) {
  const folder = mkdtempSync(join(tmpdir(), "pliant-"));
  try {
    const file = join(folder, "report.html");
    writeFileSync(file, text);
    await withPage(pathToFileURL(file).href, run, options);
  } finally {
    rmSync(folder, { recursive: true });
  }
}

// A test of a report with these data (made_up.mjs).
export function testMadeUp(name, data, run, options) {
  const path = process.env.PLIANT_REPORT;
  test(name, { skip: path ? false : "PLIANT_REPORT is not set" }, async () => {
    await withPageOf(pageWith(JSON.stringify(data), readFileSync(path, "utf8")), run, options);
  });
}

// How many pixels of an element, as it is shown, have nearly this color ("#rrggbb"), not farther than `margin` from its edges.
export async function countPixels(page, selector, color, margin = Infinity) {
  const png = (await page.locator(selector).screenshot()).toString("base64");
  return page.evaluate(async ([base64, wanted, farthest]) => {
    const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const context = Object.assign(document.createElement("canvas"), { width: bitmap.width, height: bitmap.height }).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const rgb = [1, 3, 5].map((at) => parseInt(wanted.slice(at, at + 2), 16));
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
      const [x, y] = [(i / 4) % bitmap.width, Math.floor(i / 4 / bitmap.width)];
      if (Math.min(x, y, bitmap.width - 1 - x, bitmap.height - 1 - y) > farthest) continue;
      if (rgb.every((value, channel) => Math.abs(data[i + channel] - value) < 24)) ++count;
    }
    return count;
  }, [png, color, margin === Infinity ? 1e9 : margin]);
}

export function state(page) {
  return page.evaluate(() => window.pliant.state());
}

// Waits until the page's state is so.
export async function eventually(page, condition, argument) {
  await page.waitForFunction(condition, argument, { timeout: TIMEOUT_MS });
}

export async function press(page, ...keys) {
  for (const key of keys) await page.keyboard.press(key);
}

export async function goTo(page, position) {
  await page.locator("#slider").evaluate((slider, value) => {
    slider.value = value;
    slider.dispatchEvent(new Event("input"));
  }, position);
  await eventually(page, (value) => window.pliant.state().position === value, position);
  await redrawn(page);
}

// Waits until the views show what the state says.
export function redrawn(page) {
  return page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
}

// A frame in which there are many points, and of these the one that lies farthest from the others in this view.
export async function lonelyPoint(page, view) {
  return page.evaluate((where) => {
    const box = document.getElementById(where).getBoundingClientRect();
    const places = window.pliant.state().points.map((id) => ({ id, ...window.pliant.screenOf(id, where) }))
      .filter(({ x, y }) => x > box.left + 20 && x < box.right - 20 && y > box.top + 50 && y < box.bottom - 50);
    const room = (place) => Math.min(...places.filter((other) => other !== place).map((other) => Math.hypot(other.x - place.x, other.y - place.y)));
    return places.reduce((best, place) => (room(place) > room(best) ? place : best));
  }, view);
}

export async function screenshot(page, name, options = {}) {
  const folder = process.env.PLIANT_SCREENSHOTS;
  if (!folder) return;
  mkdirSync(folder, { recursive: true });
  await page.waitForTimeout(500);
  await page.screenshot({ path: join(folder, `${name}.png`), ...options });
}
