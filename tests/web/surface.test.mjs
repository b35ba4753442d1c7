// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A surface as others see it: the report's page, and Khronos' validator of glTF files.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { test } from "node:test";
import { countPixels, goTo, press, screenshot, state, testReport } from "./support.mjs";

const WHITE = "#ffffff";

testReport("shows the tissue with its texture", "PLIANT_REPORT_SURFACE", async (page) => {
  await goTo(page, 20);
  await page.waitForTimeout(500);
  const white = await countPixels(page, "#scene", WHITE);
  await screenshot(page, "surface_of_a_run");
  await press(page, "s");
  await page.waitForTimeout(500);
  assert.ok(await countPixels(page, "#scene", WHITE) > white + 20000);
});

testReport("begins with the run that has a surface", "PLIANT_REPORT_SECOND_SURFACE", async (page) => {
  const { currentRun, visibleRuns } = await state(page);
  assert.equal(visibleRuns.length, 2);
  assert.equal(currentRun, visibleRuns[1]);
  await goTo(page, 20);
  await page.waitForTimeout(500);
  const shown = await countPixels(page, "#scene", WHITE);
  await press(page, "s");
  await page.waitForTimeout(500);
  assert.ok(await countPixels(page, "#scene", WHITE) > shown);
});

test("Khronos' validator finds nothing in surface.glb", async () => {
  const validator = createRequire(join(resolve(process.env.PLIANT_NODE_MODULES), "package.json"))("gltf-validator");
  const report = await validator.validateBytes(new Uint8Array(readFileSync(join(process.env.PLIANT_SURFACE, "surface.glb"))));
  // Textures need not be powers of two since glTF 2.0's renderers are OpenGL ES 3.
  const issues = report.issues.messages.filter(({ code }) => code !== "IMAGE_NPOT_DIMENSIONS");
  assert.deepEqual(issues, []);
  assert.ok(report.info.hasMorphTargets && report.info.hasTextures && report.info.animationCount === 1);
});
