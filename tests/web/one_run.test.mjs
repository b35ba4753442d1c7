// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

import assert from "node:assert/strict";
import { eventually, goTo, lonelyPoint, press, screenshot, state, testReport } from "./support.mjs";

const REPORT = "PLIANT_REPORT";
const READABLE_CONTRAST = 4.5;  // WCAG 2.1, level AA, for text
const SMALL = 0.3;              // of the camera, beside the points that it sees
// A click lands within a frame or two: handles and margins take some of the width.
const nearlyThere = (frames) => 0.05 * frames + 2;

function extentOf(places) {
  const span = (values) => Math.max(...values) - Math.min(...values);
  return Math.hypot(span(places.map(({ x }) => x)), span(places.map(({ y }) => y)));
}

async function goToTheMiddle(page) {
  await goTo(page, Math.floor((await state(page)).frames / 2));
  assert.ok((await state(page)).points.length > 0, "the middle frame has no points");
}

// An image is drawn, and not one color.
async function imageIsDrawn(page) {
  await eventually(page, () => {
    const canvas = document.getElementById("image");
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0);
    return new Set(new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer)).size > 1000;
  });
}

testReport("shows the run when it is opened from disk", REPORT, async (page) => {
  assert.equal(await page.locator("body").getAttribute("data-stage"), "ready");
  assert.ok((await page.locator("#title").textContent()).length > 0);
  assert.ok(await page.locator("#plots .plot").count() >= 4);
  assert.ok(await page.locator("#figures tbody tr").count() > 3);
  assert.ok(await page.locator("#options tbody tr").count() > 3);
  await goToTheMiddle(page);
  await imageIsDrawn(page);
  await screenshot(page, "light", { fullPage: true });
});

testReport("plays and pauses with the space key", REPORT, async (page) => {
  const before = (await state(page)).position;
  await press(page, " ");
  assert.equal((await state(page)).playing, true);
  await eventually(page, (position) => window.pliant.state().position > position + 5, before);
  // It may come to its end just before a key is pressed, which then begins it again.
  for (let tries = 0; tries < 5 && (await state(page)).playing; ++tries) await press(page, " ");
  const { position, playing } = await state(page);
  assert.equal(playing, false);
  await page.waitForTimeout(400);
  assert.equal((await state(page)).position, position);
});

testReport("scrubs with the slider, the strip, a plot and the arrow keys", REPORT, async (page) => {
  await goToTheMiddle(page);
  const { position, frames } = await state(page);
  await press(page, "ArrowRight");
  assert.equal((await state(page)).position, position + 1);
  await press(page, "Shift+ArrowLeft");
  assert.equal((await state(page)).position, Math.max(0, position - 9));
  await press(page, "End");
  assert.equal((await state(page)).position, frames - 1);
  await press(page, "Home");
  assert.equal((await state(page)).position, 0);
  const slider = await page.locator("#slider").boundingBox();
  await page.mouse.click(slider.x + 0.75 * slider.width, slider.y + slider.height / 2);
  assert.ok(Math.abs((await state(page)).position - 0.75 * frames) < nearlyThere(frames));
  const strip = await page.locator("#strip").boundingBox();
  await page.mouse.click(strip.x + 0.25 * strip.width, strip.y + 5);
  assert.ok(Math.abs((await state(page)).position - 0.25 * frames) < nearlyThere(frames));
  const plot = page.locator("#plots .u-over").first();
  await plot.scrollIntoViewIfNeeded();
  const box = await plot.boundingBox();
  await page.mouse.click(box.x + 0.6 * box.width, box.y + 20);
  assert.ok(Math.abs((await state(page)).position - 0.6 * frames) < nearlyThere(frames));
});

testReport("zooms the plots", REPORT, async (page) => {
  await press(page, "Home");
  const plot = page.locator("#plots .u-over").first();
  await plot.scrollIntoViewIfNeeded();
  const box = await plot.boundingBox();
  const marks = page.locator("#plots .plot-now");
  const shown = (count) => eventually(page, (wanted) => document.querySelectorAll("#plots .plot-now:not([hidden])").length === wanted, count);
  await page.keyboard.down("Shift");
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 30);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.8 * box.width, box.y + 30, { steps: 4 });
  await page.mouse.up();
  await page.keyboard.up("Shift");
  await shown(0);
  assert.equal((await state(page)).position, 0);
  await page.mouse.dblclick(box.x + 2, box.y + 30);
  await shown(await marks.count());
});

for (const view of ["image", "scene"]) {
  testReport(`picks a point by a click in the ${view} and shows its history`, REPORT, async (page) => {
    await goToTheMiddle(page);
    const { id, x, y } = await lonelyPoint(page, view);
    await page.mouse.click(x, y);
    await eventually(page, (picked) => window.pliant.state().picked === picked, id);
    await page.locator("#point").waitFor();
    assert.equal(await page.locator("#point-title").textContent(), `Point ${id}`);
    assert.ok(await page.locator("#point-plots .plot").count() >= 3);
    await eventually(page, () => document.getElementById("patch-now-caption").textContent.startsWith("frame"));
    await screenshot(page, `picked_in_${view}`);
    await press(page, "Escape");
    assert.equal((await state(page)).picked, null);
    await page.locator("#point").waitFor({ state: "hidden" });
  });
}

// In the first view, in every frame, also where the point's panel makes the scene's narrower.
testReport("shows the camera small and inside the scene's panel", REPORT, async (page) => {
  const { frames } = await state(page);
  for (const position of [0, Math.floor(frames / 2), frames - 1]) {
    await goTo(page, position);
    if (position > 0) await press(page, "n");
    await page.waitForTimeout(300);
    const box = await page.locator("#scene").boundingBox();
    const ends = await page.evaluate(() => window.pliant.frustumOnScreen());
    assert.equal(ends.length, 5);
    for (const { x, y } of ends) {
      assert.ok(x > box.x && x < box.x + box.width && y > box.y && y < box.y + box.height, `frame ${position}: ${x}, ${y}`);
    }
    const points = await page.evaluate(() => window.pliant.state().points.map((id) => window.pliant.screenOf(id, "scene")));
    assert.ok(extentOf(ends) < SMALL * extentOf(points), `frame ${position}: ${extentOf(ends)} of ${extentOf(points)} pixels`);
  }
});

testReport("says when the picked point is not seen", REPORT, async (page) => {
  await goToTheMiddle(page);
  await press(page, "n");
  const id = (await state(page)).picked;
  const { frames } = await state(page);
  for (let position = 0; position < frames && (await state(page)).points.includes(id); position += Math.ceil(frames / 20)) {
    await goTo(page, position);
  }
  const seen = (await state(page)).points.includes(id);
  await eventually(page, (text) => document.getElementById("point-state").textContent === text, seen ? "" : "Not seen in this frame.");
});

testReport("colors by each mode, with a legend", REPORT, async (page) => {
  await goToTheMiddle(page);
  const names = await page.locator("#color option").evaluateAll((options) => options.map(({ value }) => value));
  for (const name of ["age", "residual", "depth", "deformation", "similarity", "error", "rgb"]) assert.ok(names.includes(name), name);
  for (const name of names) {
    await page.locator("#color").selectOption(name);
    await eventually(page, (color) => window.pliant.state().color === color, name);
    await eventually(page, (own) => document.getElementById("scale").hidden === own, name === "rgb");
  }
});

testReport("has a dark and a light theme whose texts can be read", REPORT, async (page) => {
  await goToTheMiddle(page);
  await press(page, "n");
  for (const [theme, dark] of [["dark", true], ["light", false]]) {
    await press(page, "d");
    const shown = await state(page);
    assert.equal(shown.theme, theme);
    assert.equal(shown.dark, dark);
    for (const { name, contrast } of await contrasts(page)) assert.ok(contrast >= READABLE_CONTRAST, `${theme}: ${name} has a contrast of ${contrast.toFixed(2)}`);
    if (dark) await screenshot(page, "dark");
  }
});

testReport("takes the dark theme where the system has it", REPORT, async (page) => {
  assert.equal((await state(page)).dark, true);
}, { colorScheme: "dark" });

testReport("fits a phone", REPORT, async (page) => {
  await goToTheMiddle(page);
  await press(page, "n");
  await page.locator("#point").waitFor();
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), "it scrolls sideways");
  await screenshot(page, "phone", { fullPage: true });
  const { x, y } = await lonelyPoint(page, "image");
  await page.touchscreen.tap(x, y);
  await page.locator("#point").waitFor();
}, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 });

testReport("works with the keyboard alone", REPORT, async (page) => {
  const shown = async () => state(page);
  for (const [key, layer] of [["m", "map"], ["o", "points"], ["t", "trails"], ["p", "path"], ["g", "truth"], ["x", "grid"]]) {
    await press(page, key);
    assert.equal((await shown()).layers[layer], false, layer);
    await press(page, key);
    assert.equal((await shown()).layers[layer], true, layer);
  }
  await press(page, "f");
  assert.equal((await shown()).view, "camera");
  await press(page, "f");
  assert.equal((await shown()).view, "chase");
  await press(page, "r");
  assert.equal((await shown()).view, "free");
  const { color } = await shown();
  await press(page, "c");
  assert.notEqual((await shown()).color, color);
  await press(page, "Shift+C");
  assert.equal((await shown()).color, color);
  await press(page, "?");
  assert.ok(await page.locator("#help").isVisible());
  await press(page, "Escape");
  assert.ok(await page.locator("#help").isHidden());
  await goToTheMiddle(page);
  await press(page, "n");
  const first = (await shown()).picked;
  await press(page, "n");
  const second = (await shown()).picked;
  assert.ok(second > first);
  await press(page, "b");
  assert.equal((await shown()).picked, first);
  const focused = new Set();
  for (let i = 0; i < 60; ++i) {
    await press(page, "Tab");
    focused.add(await page.evaluate(() => document.activeElement.id || document.activeElement.textContent));
  }
  for (const id of ["theme", "help-button", "color", "trail", "view-camera", "reset", "slider", "play", "loop", "speed"]) {
    assert.ok(focused.has(id), `${id} cannot be reached`);
  }
});

// WCAG's contrast of texts with what is behind them.
function contrasts(page) {
  return page.evaluate(() => {
    const numbers = (color) => {
      const [r, g, b, a = 1] = color.match(/[\d.]+/g).map(Number);
      return color.startsWith("color(") ? [255 * r, 255 * g, 255 * b, a] : [r, g, b, a];
    };
    const behind = (element) => {
      const [r, g, b, a] = numbers(getComputedStyle(element).backgroundColor);
      if (a >= 0.99 || !element.parentElement) return [r, g, b];
      const below = behind(element.parentElement);
      return [r, g, b].map((value, i) => a * value + (1 - a) * below[i]);
    };
    const luminance = (color) => {
      const [r, g, b] = color.map((value) => (value <= 10.31475 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const names = ["#title", "#version", "#theme", "#runs button", "#color", "#scale-low", ".key", "#layers button", "#play", "#frame",
      "#frame-state", "#states", ".hint", "h2", ".plot figcaption strong", ".plot figcaption .muted", ".plot figcaption button",
      ".plot-legend button", "#figures th", "#figures td", "#figures tr.group th", "#option-filter", "#point-title", "#point-first",
      ".patches figcaption", "#scene-caption"];
    return names.filter((name) => document.querySelector(name)).map((name) => {
      const element = document.querySelector(name);
      const [low, high] = [luminance(numbers(getComputedStyle(element).color).slice(0, 3)), luminance(behind(element))].sort((a, b) => a - b);
      return { name, contrast: (high + 0.05) / (low + 0.05) };
    });
  });
}
