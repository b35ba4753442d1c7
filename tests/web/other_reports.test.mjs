// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { dataTextOf, pageWith } from "./made_up.mjs";
import { eventually, goTo, lonelyPoint, press, screenshot, state, testReport, withPageOf } from "./support.mjs";

const TWO = "PLIANT_REPORT_TWO";
const NO_IMAGES = "PLIANT_REPORT_NO_IMAGES";

testReport("shows two runs, and either of them in full", TWO, async (page) => {
  const { frames, currentRun, visibleRuns } = await state(page);
  await goTo(page, Math.floor(frames / 2));
  assert.equal(visibleRuns.length, 2);
  assert.equal(currentRun, visibleRuns[0]);
  await page.locator("#runs input").nth(1).uncheck();
  await eventually(page, () => window.pliant.state().visibleRuns.length === 1);
  await press(page, "2");
  const second = await state(page);
  assert.equal(second.currentRun, visibleRuns[1]);
  assert.equal(second.visibleRuns.length, 2, "the run that is shown in full is visible");
  await page.locator("#runs button").first().click();
  assert.equal((await state(page)).currentRun, visibleRuns[0]);
  await screenshot(page, "two_runs", { fullPage: true });
});

testReport("compares two runs in tables, and their options where they differ", TWO, async (page) => {
  assert.equal(await page.locator("#figures thead th").count(), 3);
  assert.ok(await page.locator("#option-differing").isChecked());
  const differing = await page.locator("#options tbody tr").count();
  for (const row of await page.locator("#options tbody tr").all()) {
    const [one, two] = await row.locator("td").allTextContents();
    assert.notEqual(one, two);
  }
  await page.locator("#option-differing").uncheck();
  const all = await page.locator("#options tbody tr").count();
  assert.ok(all > differing);
  const name = await page.locator("#options tbody th").first().textContent();
  await page.locator("#option-filter").fill(name);
  assert.ok(await page.locator("#options tbody tr").count() < all);
});

testReport("overlays the main series of two runs", TWO, async (page) => {
  const names = (await state(page)).visibleRuns;
  const legend = await page.locator("#plots .plot").first().locator(".plot-legend").textContent();
  for (const name of names) assert.ok(legend.includes(name), name);
});

testReport("works without images, and says so", NO_IMAGES, async (page) => {
  const { frames } = await state(page);
  await goTo(page, Math.floor(frames / 2));
  assert.match(await page.locator("#image-caption").textContent(), /images are not in this report/);
  const { id, x, y } = await lonelyPoint(page, "scene");
  await page.mouse.click(x, y);
  await eventually(page, (picked) => window.pliant.state().picked === picked, id);
  await eventually(page, () => document.getElementById("patch-now-caption").textContent === "no image");
});

// Reports that cannot be shown, made of one that can.
const broken = [
  ["says that data are cut off", (data) => data.slice(0, data.length / 2), /damaged or cut off/],
  ["says that an array is damaged", (data) => data.replace(/"data":"[^"]{40}/, '"data":"'), /damaged/],
  ["says that the format is another one", (data) => data.replace(/"format":\s*1/, '"format":999'), /format 1 .* format 999/],
  ["says that there are no data", () => "", /holds no data/],
];

for (const [name, change, sentence] of broken) {
  const path = process.env[NO_IMAGES];
  test(name, { skip: path ? false : `${NO_IMAGES} is not set` }, async () => {
    const report = readFileSync(path, "utf8");
    await withPageOf(pageWith(change(dataTextOf(report)), report), async (page) => {
      assert.match(await page.locator("#message").textContent(), sentence);
      assert.ok(await page.locator("#message").isVisible());
    });
  });
}

testReport("works without WebGL, and says so", "PLIANT_REPORT", async (page) => {
  assert.match(await page.locator("#scene").textContent(), /no WebGL/);
  const { frames } = await state(page);
  await goTo(page, Math.floor(frames / 2));
  const { id, x, y } = await lonelyPoint(page, "image");
  await page.mouse.click(x, y);
  await eventually(page, (picked) => window.pliant.state().picked === picked, id);
  assert.ok(await page.locator("#plots .plot").count() > 0);
}, {
  before: () => {
    const original = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      return kind.startsWith("webgl") ? null : original.call(this, kind, ...rest);
    };
  },
});

testReport("says that the browser is too old to decompress data", "PLIANT_REPORT", async (page) => {
  assert.match(await page.locator("#message").textContent(), /cannot decompress/);
}, { before: () => { delete window.DecompressionStream; } });
