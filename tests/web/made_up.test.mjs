// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Reports of made-up runs: what they show depends on nothing but their data.

import assert from "node:assert/strict";
import { POINTS, dataOf, runOf, surfaceOf } from "./made_up.mjs";
import { countPixels, goTo, press, redrawn, screenshot, state, testMadeUp } from "./support.mjs";

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

// Labels that need many digits, and frames whose number is long.
const precise = runOf({ from: 9000, to: 10001 });
precise.frames.scale = precise.frames.frame.map((frame) => 0.9912 + 1e-7 * (frame - 9000));
precise.frames.costs = {};   // their axis is logarithmic
precise.frames.reprojection_px = precise.frames.frame.map((frame) => 1e-5 * (frame - 9500));
for (const viewport of [{ width: 1440, height: 900 }, { width: 390, height: 844 }]) {
  testMadeUp(`labels the axes of plots in full, ${viewport.width} pixels wide`, dataOf(precise), async (page) => {
    const labels = await page.evaluate(() => window.labels);
    assert.ok(labels.length > 10);
    for (const { text, left, right, top, bottom, width, height } of labels) {
      assert.ok(left >= 0 && right <= width && top >= 0 && bottom <= height, `${text}: ${left} to ${right} of ${width}, ${top} to ${bottom}`);
    }
    const plots = new Set(labels.map(({ plot }) => plot));
    for (const plot of plots) {
      const texts = labels.filter((label) => label.plot === plot && label.text !== "").map(({ text }) => text);
      const values = texts.map(Number).filter((value) => value < 9000);
      const steps = values.slice(1).map((value, i) => value - values[i]);
      assert.ok(steps.every((step) => Math.abs(step - steps[0]) < 1e-3 * Math.abs(steps[0])) || texts.length === 0, `uneven labels ${texts}`);
    }
  }, { viewport, before: recordLabels });
}

// Runs in the page: what is written into a plot, in pixels of its canvas; of a plot that is drawn again the last time.
function recordLabels() {
  window.labels = [];
  const original = CanvasRenderingContext2D.prototype.fillText;
  const clear = CanvasRenderingContext2D.prototype.clearRect;
  const plots = new Map();
  CanvasRenderingContext2D.prototype.clearRect = function (...rest) {
    window.labels = window.labels.filter(({ plot }) => plot !== plots.get(this.canvas));
    return clear.apply(this, rest);
  };
  CanvasRenderingContext2D.prototype.fillText = function (text, x, y, ...rest) {
    if (!plots.has(this.canvas)) plots.set(this.canvas, plots.size);
    const box = this.measureText(text);
    const at = this.getTransform().transformPoint({ x, y });
    window.labels.push({
      text, plot: plots.get(this.canvas), left: at.x - box.actualBoundingBoxLeft, right: at.x + box.actualBoundingBoxRight,
      top: at.y - box.actualBoundingBoxAscent, bottom: at.y + box.actualBoundingBoxDescent,
      width: this.canvas.width, height: this.canvas.height,
    });
    return original.call(this, text, x, y, ...rest);
  };
}

// The truth may put the world's origin far away.
testMadeUp("shows the axes of a scene that is far from its origin", dataOf(runOf({ to: 20, away: 500 })), async (page) => {
  const box = await page.locator("#scene").boundingBox();
  for (const label of await page.locator("#scene .axis").all()) {
    const { x, y, width, height } = await label.boundingBox();
    assert.ok(x > box.x && x + width < box.x + box.width && y > box.y && y + height < box.y + box.height, `${x}, ${y}`);
  }
});

const BLUE = "#0072b2";    // of the first run
const AMBER = "#c77f00";   // of the second one
const PIXELS_OF_A_POINT = 4;

// At the same pixels, as those of a run and its refinement.
const two = dataOf(runOf({ name: "one", to: 5 }), runOf({ name: "other", to: 5 }));
testMadeUp("shows the points of every run that is switched on, in the run's color", two, async (page) => {
  const counts = async () => {
    await page.waitForTimeout(300);
    return [await countPixels(page, "#image", BLUE), await countPixels(page, "#image", AMBER)];
  };
  const all = POINTS * PIXELS_OF_A_POINT;
  const [dots, corners] = await counts();   // the second run's points lie under those of the first
  assert.ok(dots > all && corners > POINTS, `${dots}, ${corners}`);
  await screenshot(page, "points_of_two_runs");
  await page.locator("#runs input").nth(1).uncheck();
  const [first, hidden] = await counts();
  assert.ok(first > all && hidden < POINTS, `${first}, ${hidden}`);
  await page.locator("#runs input").nth(1).check();
  await page.locator("#runs input").nth(0).uncheck();
  const [none, second] = await counts();
  assert.ok(none < POINTS && second > all, `${none}, ${second}`);
});

const metric = { ...dataOf({ ...runOf({ to: 5 }), unit: "mm" }), unit: "mm" };
metric.runs[0].frames.scale = [1, 1.01, 1, 0.99, 1];
testMadeUp("says millimeters of a run whose unit it is", metric, async (page) => {
  assert.match(await page.locator("#scale-high").textContent(), /mm$/);
  assert.match(await page.locator("#scene-caption").textContent(), /mm$/);
  assert.doesNotMatch(await page.locator("main").textContent(), /map unit/);
});

const failed = dataOf({ ...runOf({ name: "still", to: 5, isLost: () => true }), status: "failed", note: "the camera did not move" });
testMadeUp("says why a run has nothing to show", failed, async (page) => {
  assert.match(await page.locator("#notes").textContent(), /"still" has no tracked frame: the camera did not move/);
  assert.match(await page.locator("#scene").innerText(), /the camera did not move/);
  assert.equal(await page.locator("#scene-caption").textContent(), "", "a grid without a scene has no unit");
  await screenshot(page, "failed");
});

testMadeUp("says nothing of the kind of a run that was tracked", dataOf(runOf({ to: 5 })), async (page) => {
  assert.ok(await page.locator("#notes").isHidden());
  assert.equal((await page.locator("#scene .message").textContent()), "");
});

// The first map has frames 0 to 3, the camera is lost in 6 and 7.
const gaps = runOf({ to: 12, isLost: (frame) => frame === 6 || frame === 7 });
gaps.frames.costs.reprojection = gaps.frames.costs.reprojection.map((cost, row) => (row < 4 ? null : cost));
testMadeUp("plots errors only where there are any, and says what they do not say", dataOf(gaps), async (page) => {
  const plot = page.locator("#plots .plot").filter({ hasText: "Reprojection error" });
  const values = async (position) => {
    await goTo(page, position);
    return plot.locator(".value").allTextContents();
  };
  assert.deepEqual(await values(2), ["0.520", "–"]);
  assert.deepEqual(await values(5), ["–", "0.550"]);
  assert.deepEqual(await values(6), ["–", "–"]);
  assert.match(await plot.textContent(), /its own displacement.*No value: 2 of 12 frames/);
});

testMadeUp("says nothing of displacements of a rigid result", dataOf({ ...runOf({ to: 5 }), frames: { ...runOf({ to: 5 }).frames, costs: {} } }), async (page) => {
  const plot = page.locator("#plots .plot").filter({ hasText: "Reprojection error" });
  assert.equal(await plot.locator(".value").count(), 1);
  assert.equal(await plot.locator(".hint").textContent(), "");
});

const named = ["rigid_baseline_dm_A2.5", "refined_default_dm_A2.5"].map((name) => ({
  ...runOf({ name, to: 5 }), options: [["WindowInit.min_still_camera_ratio", name], ["Tracking.max_lost_frames", "30"]],
}));
testMadeUp("shows tables with long names on a phone", dataOf(...named), async (page) => {
  for (const table of await page.locator(".table").all()) {
    const [needed, width] = await table.evaluate((box) => [box.scrollWidth, box.clientWidth]);
    assert.ok(needed <= width, `${needed} of ${width} pixels`);
  }
}, { viewport: { width: 390, height: 844 } });

const WHITE = "#ffffff";
const withSurface = { ...runOf({ to: 20 }), meshes: [surfaceOf()] };

testMadeUp("shows the surface, colored by what is chosen", dataOf(withSurface), async (page) => {
  const legend = async () => {
    await redrawn(page);
    return page.locator("#surface-scale").innerText();
  };
  await press(page, "o");   // without points
  await goTo(page, 10);
  assert.equal((await page.evaluate(() => window.pliant.state())).surfaceColor, "image");
  assert.equal(await page.locator("#surface-scale").isVisible(), false);
  await press(page, "u");
  assert.match(await legend(), /0\s*6\s*map units/);   // displaced by 2 to 6
  await screenshot(page, "surface");
  const gradient = () => page.locator("#surface-gradient").evaluate((bar) => bar.style.backgroundImage);
  assert.match(await gradient(), /^linear-gradient\(to right, rgb\(68, 1, 84\)/);
  await press(page, "u");
  assert.match(await legend(), /%/);
  assert.match(await gradient(), /^linear-gradient\(to right, rgb\(59, 76, 192\).* rgb\(221, 221, 221\).* rgb\(180, 4, 38\)\)$/);
  await press(page, "u");
  assert.equal((await page.evaluate(() => window.pliant.state())).surfaceColor, "uncertainty");
  assert.match(await legend(), /0\s*0.660\s*map units/);
  await page.waitForTimeout(300);
  const white = await countPixels(page, "#scene", WHITE);
  await press(page, "s");
  await page.waitForTimeout(300);
  assert.ok(await countPixels(page, "#scene", WHITE) > white + 10000, "the surface is gone");
});

testMadeUp("offers the error of a surface where there is a truth", dataOf(withSurface), async (page) => {
  assert.deepEqual(await page.locator("#surface-color option").allInnerTexts(), ["image", "displacement", "area change", "uncertainty"]);
  for (let i = 0; i < 4; ++i) await press(page, "u");
  assert.equal((await page.evaluate(() => window.pliant.state())).surfaceColor, "image");
});

testMadeUp("colors the surface by its error", dataOf({ ...runOf({ to: 20 }), meshes: [surfaceOf({ errors: true })] }), async (page) => {
  await press(page, "o");
  await goTo(page, 10);
  await page.locator("#surface-color").selectOption("error");
  await page.waitForTimeout(300);
  assert.equal((await page.evaluate(() => window.pliant.state())).surfaceColor, "error");
  assert.match(await page.locator("#surface-scale").innerText(), /0\s*3\s*mm/);
  await screenshot(page, "surface_error");
});

testMadeUp("shows no surface where there is none", dataOf(runOf({ to: 5 })), async (page) => {
  assert.equal(await page.locator("#surface-tools").isVisible(), false);
  assert.equal(await page.getByRole("button", { name: "surface", exact: true }).isVisible(), false);
});

for (const [keys, known] of [[2, [0, 9, 10]], [1, [10]], [0, [0, 9, 10, 11]]]) {
  const made = dataOf({ ...runOf({ to: 20 }), meshes: [surfaceOf({ keys })] });
  testMadeUp(`shows a surface of ${keys} keys from the first to the last, and says where there is none`, made, async (page) => {
    const caption = () => page.locator("#scene-caption").textContent();
    await press(page, "u");   // its texture would be white
    for (const frame of [0, 9, 10, 11]) {
      await goTo(page, frame);
      await page.waitForTimeout(300);
      const shown = await countPixels(page, "#scene", WHITE);
      assert.equal(/no surface in this frame$/.test(await caption()), !known.includes(frame), `frame ${frame}`);
      await press(page, "s");
      await page.waitForTimeout(300);
      assert.equal(await countPixels(page, "#scene", WHITE) > shown + 10000, known.includes(frame), `frame ${frame}`);
      assert.doesNotMatch(await caption(), /surface/, "it is switched off");
      await press(page, "s");
    }
  });
}

// The camera is lost in frames 3 and 4; frames 6 and 7 have a pose, but no surface.
const interrupted = runOf({ to: 11, isLost: (frame) => frame === 3 || frame === 4 });
testMadeUp("shows no surface in lost frames and gaps, and says so", dataOf({ ...interrupted, meshes: [surfaceOf({ gaps: [[5, 8]] })] }), async (page) => {
  await press(page, "u");   // its texture would be white
  for (const frame of [2, 3, 4, 5, 6, 7, 8]) {
    await goTo(page, frame);
    await page.waitForTimeout(300);
    const isShown = [2, 5, 8].includes(frame);
    assert.equal(/no surface in this frame$/.test(await page.locator("#scene-caption").textContent()), !isShown, `frame ${frame}`);
    const shown = await countPixels(page, "#scene", WHITE);
    await press(page, "s");
    await page.waitForTimeout(300);
    assert.equal(await countPixels(page, "#scene", WHITE) > shown + 10000, isShown, `frame ${frame}`);
    await press(page, "s");
  }
});

testMadeUp("begins with all of a surface that reaches farther than the points", dataOf({ ...runOf({ to: 20 }), meshes: [surfaceOf({ step: 24 })] }), async (page) => {
  while ((await page.evaluate(() => document.documentElement.dataset.theme)) !== "dark") await press(page, "d");   // it is white
  const counts = async () => {
    await page.waitForTimeout(300);
    return [await countPixels(page, "#scene", WHITE), await countPixels(page, "#scene", WHITE, 4)];
  };
  const [all, edge] = await counts();
  await screenshot(page, "wide_surface");
  await press(page, "s");
  const [rest, restOfEdge] = await counts();
  assert.ok(all > rest + 10000, `${all}, ${rest}`);
  assert.ok(edge < restOfEdge + 10, `${edge}, ${restOfEdge}`);
});

testMadeUp("shows the surface of the frame's own submap alone", dataOf({ ...runOf({ to: 5 }), meshes: [surfaceOf({ submap: 3 })] }), async (page) => {
  await page.waitForTimeout(300);
  const white = await countPixels(page, "#scene", WHITE);
  assert.match(await page.locator("#scene-caption").textContent(), /no surface in this frame$/);
  await press(page, "s");
  await page.waitForTimeout(300);
  assert.ok(await countPixels(page, "#scene", WHITE) < white + 1000, "more has gone than the caption's words");
});

// Points 0 and 7 are the ends of the first row of the grid: 42 (1 + f / 100) from each other in frame f. Point 7 is not seen in frames
// 4 and 5.
const CYAN = "#22e6f2";    // of the ruler in the image
const TEAL = "#008fa3";    // in the scene
const SIGMA = 0.5;
const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 };
const isSeen = (point, frame) => point !== 7 || frame < 4 || frame > 5;
const stretched = (options) => runOf({ to: 20, step: 0, stretch: 0.01, isSeen, ...options });

async function click(page, id, view, modifiers = []) {
  const box = await page.locator(`#${view}`).boundingBox();
  const { x, y } = await page.evaluate(([point, where]) => window.pliant.screenOf(point, where), [id, view]);
  await page.locator(`#${view}`).click({ position: { x: x - box.x, y: y - box.y }, modifiers });
  await redrawn(page);
}

async function measure(page) {
  await click(page, 0, "image");
  await click(page, 7, "image", ["Shift"]);
  assert.deepEqual(await endsOf(page), [0, 7]);
}

async function endsOf(page) {
  const { picked, measured } = await state(page);
  return [picked, measured];
}

async function textOf(page, id) {
  await redrawn(page);
  return page.locator(id).textContent();
}

async function plotted(page, title) {
  return page.locator("#point-plots .plot").filter({ hasText: title }).locator(".value").allTextContents();
}

testMadeUp("measures the distance of two points in every frame", dataOf(stretched()), async (page) => {
  await measure(page);
  assert.equal(await textOf(page, "#ruler-length"), "42 map units to point 7, +0.0 % since frame 0");
  assert.match(await textOf(page, "#ruler-unit"), /no measurement/);
  await goTo(page, 10);
  assert.equal(await textOf(page, "#ruler-length"), "46.2 map units to point 7, +10.0 % since frame 0");
  assert.equal(await textOf(page, "#scene .ruler-label"), "46.2 map units");
  assert.deepEqual(await plotted(page, "Distance"), ["46.2"]);
  assert.deepEqual(await plotted(page, "Its change since frame 0"), ["10.0"]);
  await screenshot(page, "ruler");
  await press(page, "d");
  await screenshot(page, "ruler_dark");
});

testMadeUp("says why there is no distance, and leaves a gap in its plot", dataOf(stretched()), async (page) => {
  await measure(page);
  await goTo(page, 4);
  assert.equal(await textOf(page, "#ruler-length"), "");
  assert.equal(await textOf(page, "#ruler-state"), "No distance: point 7 is not seen in this frame.");
  assert.deepEqual(await plotted(page, "Distance"), ["–"]);
  assert.equal(await page.locator("#scene .ruler-label").isVisible(), false);
  await screenshot(page, "ruler_gap");
  await goTo(page, 6);
  assert.equal(await textOf(page, "#ruler-state"), "");
  assert.deepEqual(await plotted(page, "Distance"), ["44.5"]);
});

for (const [view, color] of [["image", CYAN], ["scene", TEAL]]) {
  testMadeUp(`draws the ruler in the ${view} where both points are seen`, dataOf(stretched()), async (page) => {
    const pixels = async () => {
      await page.waitForTimeout(300);
      return countPixels(page, `#${view}`, color);
    };
    await click(page, 0, view);
    const without = await pixels();
    await click(page, 7, view, ["Shift"]);
    assert.deepEqual(await endsOf(page), [0, 7]);
    const [a, b] = await page.evaluate((where) => [0, 7].map((id) => window.pliant.screenOf(id, where)), view);
    const line = await pixels() - without;
    assert.ok(line > 1.5 * Math.hypot(a.x - b.x, a.y - b.y), `${line} pixels`);
    assert.ok(Math.hypot(a.x - b.x, a.y - b.y) > 100, "too short to tell");
    await goTo(page, 4);
    assert.ok(await pixels() < without + 20);
    await goTo(page, 6);
    assert.ok(await pixels() - without > 100);
  });
}

// To the first order: each end's standard deviation times the cosine of its ray and the ruler.
function sigmaOfRow(frame) {
  const half = 21 * (1 + 0.01 * frame);
  return Math.hypot(...[-half, half].map((x) => (SIGMA * (x - frame)) / Math.hypot(x - frame, -15, 60)));
}

testMadeUp("says how uncertain a distance is", { ...dataOf(stretched({ sigma: SIGMA })), unit: "mm" }, async (page) => {
  await measure(page);
  for (const frame of [0, 10]) {
    await goTo(page, frame);
    const [, distance, sigma, rest] = (await textOf(page, "#ruler-length")).match(/^([\d.]+) ± ([\d.]+) mm (.*)$/);
    assert.equal(Number(distance), 42 + 0.42 * frame);
    assert.ok(Math.abs(Number(sigma) - sigmaOfRow(frame)) < 0.006, `${sigma} instead of ${sigmaOfRow(frame)}`);
    assert.match(rest, /^\(1 sigma\) to point 7/);
    assert.equal(await textOf(page, "#scene .ruler-label"), `${distance} ± ${sigma} mm`);
  }
  const [value, low, high] = (await plotted(page, "Distance")).map(Number);
  assert.ok(low < value && value < high);
  assert.equal(await textOf(page, "#ruler-unit"), "");
  await screenshot(page, "ruler_sigma");
});

testMadeUp("removes the ruler with escape, then the pick", dataOf(stretched()), async (page) => {
  await measure(page);
  await press(page, "Escape");
  assert.deepEqual(await endsOf(page), [0, null]);
  assert.equal(await textOf(page, "#ruler-length"), "");
  assert.deepEqual(await plotted(page, "Distance"), []);
  await press(page, "Escape");
  assert.deepEqual(await endsOf(page), [null, null]);
  await page.locator("#point").waitFor({ state: "hidden" });
});

testMadeUp("picks both ends of the ruler with the keyboard", dataOf(stretched()), async (page) => {
  await press(page, "Shift+N");
  assert.deepEqual(await endsOf(page), [0, null], "the first pick is the first end");
  await press(page, "Shift+N", "Shift+N");
  assert.deepEqual(await endsOf(page), [0, 2]);
  await press(page, "Shift+B", "Shift+B");
  assert.deepEqual(await endsOf(page), [0, 1], "not the picked point itself");
  assert.equal(await textOf(page, "#ruler-length"), "6 map units to point 1, +0.0 % since frame 0");
  await press(page, "n");
  assert.deepEqual(await endsOf(page), [2, 1], "the ruler's first end moves, past the other one");
  await page.locator("#measure").focus();
  await press(page, "Enter", "n");
  assert.deepEqual(await endsOf(page), [2, 3]);
  await press(page, "?");
  assert.match(await page.locator("#help").innerText(), /shift n.*ruler/);
});

testMadeUp("measures by touch", dataOf(stretched()), async (page) => {
  const tap = async (id) => {
    await page.locator("#image").scrollIntoViewIfNeeded();
    const { x, y } = await page.evaluate((point) => window.pliant.screenOf(point, "image"), id);
    await page.touchscreen.tap(x, y);
    await redrawn(page);
  };
  await tap(0);
  await page.locator("#measure").tap();
  assert.match(await textOf(page, "#measure-hint"), /other point/);
  await press(page, "Escape");
  assert.equal((await state(page)).measuring, false);
  assert.equal((await state(page)).picked, 0, "only what was begun is given up");
  await page.locator("#measure").tap();
  await tap(0);
  assert.deepEqual(await endsOf(page), [0, null], "a point is no distance from itself");
  await tap(7);
  assert.deepEqual(await endsOf(page), [0, 7]);
  assert.equal(await textOf(page, "#measure-hint"), "");
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), "it scrolls sideways");
  await screenshot(page, "ruler_phone", { fullPage: true });
  await page.locator("#unmeasure").tap();
  assert.deepEqual(await endsOf(page), [0, null]);
}, PHONE);

testMadeUp("removes the ruler and the pick when another run is shown", dataOf(stretched({ name: "one" }), stretched({ name: "other" })), async (page) => {
  await measure(page);
  await press(page, "2");
  assert.equal((await state(page)).currentRun, "other");
  assert.deepEqual(await endsOf(page), [null, null]);
});

const apart = runOf({ to: 20, isSeen: (point, frame) => (point === 7) === (frame >= 10) });
testMadeUp("says so of points that are never seen together", dataOf(apart), async (page) => {
  await click(page, 0, "image");
  await goTo(page, 10);
  await click(page, 7, "image", ["Shift"]);
  assert.match(await textOf(page, "#ruler-state"), /point 0 is not seen in this frame\. There is no frame in which both/);
  assert.deepEqual(await plotted(page, "Distance"), []);
});

// Names of runs, notes, options and states come from files of strangers.
const markup = '<img src="x" onerror="window.hit = 1"><script>window.hit = 1</script></script><b>bold</b>';
const hostile = runOf({ name: markup, to: 4 });
hostile.note = markup;
hostile.status = markup;
hostile.figures = [[markup, markup, markup]];
hostile.options = [[markup, markup]];
hostile.frames.note = { 0: markup };
hostile.frames.costs = { [markup]: [1, 2, 3, 4] };
testMadeUp("shows markup as text, and runs none of it", { ...dataOf(hostile), title: markup, notes: [markup] }, async (page) => {
  await goTo(page, 3);
  assert.equal(await page.evaluate(() => window.hit), undefined);
  assert.equal(await page.locator("img[src=x], b").count(), 0);
  assert.ok((await page.evaluate(() => document.body.textContent)).includes("onerror"));
  // What would run all the same could send nothing anywhere: the page's policy.
  const stopped = await page.evaluate(async () => {
    const refused = [];
    document.addEventListener("securitypolicyviolation", (event) => refused.push(event.effectiveDirective));
    await fetch("https://example.org/").catch(() => {});
    document.body.append(Object.assign(new Image(), { src: "https://example.org/?secret" }));
    await new Promise((resolve) => setTimeout(resolve, 100));
    return refused;
  });
  assert.deepEqual([...stopped].sort(), ["connect-src", "img-src"]);
}, { allowed: "https://example.org/", tolerated: /Content Security Policy|violates the following/ });
