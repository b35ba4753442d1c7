// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// node report_page.mjs NODE_MODULES_PARENT REPORT.html FOLDER: report_light.png and report_dark.png, of a report with a point picked.

import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [modules, report, folder] = process.argv.slice(2);
const { chromium } = createRequire(join(resolve(modules), "package.json"))("playwright-core");
const browser = await chromium.launch({
  executablePath: process.env.PLIANT_CHROMIUM || "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-compositing"],
});
for (const colorScheme of ["light", "dark"]) {
  const page = await browser.newPage({ viewport: { width: 1440, height: 1000 }, colorScheme });
  await page.goto(pathToFileURL(resolve(report)).href);
  await page.evaluate(() => window.pliant.ready);
  for (let i = 0; i < 4; ++i) await page.keyboard.press("Shift+ArrowRight");
  for (let i = 0; i < 3; ++i) await page.keyboard.press("c");
  for (let i = 0; i < 60; ++i) await page.keyboard.press("n");
  await page.waitForTimeout(2000);
  await page.screenshot({ path: join(folder, `report_${colorScheme}.png`) });
  await page.close();
}
await browser.close();
