// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Reports of made-up runs: what they show depends on nothing but their data.

import assert from "node:assert/strict";
import { POINTS, dataOf, runOf } from "./made_up.mjs";
import { countPixels, goTo, press, screenshot, testMadeUp } from "./support.mjs";

const ORANGE = "#d55e00";      // of trails
const LIGHT_GRAY = "#dde1e6";
const PIXELS_OF_A_TRAIL = 10;  // at least

testMadeUp("shows trails that are not much longer than a point", dataOf(runOf({ to: 20 })), async (page) => {
  await goTo(page, 19);
  await page.waitForTimeout(300);
  assert.ok(await countPixels(page, "#scene", ORANGE) > POINTS * PIXELS_OF_A_TRAIL);
  await screenshot(page, "trails");
  await press(page, "t");
  await page.waitForTimeout(300);
  assert.ok(await countPixels(page, "#scene", ORANGE) < POINTS);
});

// There is no image here, so that they lie on a light gray.
testMadeUp("shows the last positions of points on a light image", dataOf(runOf({ to: 20 })), async (page) => {
  await goTo(page, 0);
  const before = await countPixels(page, "#image", LIGHT_GRAY);
  await goTo(page, 19);
  assert.ok(before - await countPixels(page, "#image", LIGHT_GRAY) > POINTS * PIXELS_OF_A_TRAIL);
});
