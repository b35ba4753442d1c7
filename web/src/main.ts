// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Puts the parts together, and offers `window.pliant` to tests.

import { Coloring, colorModes } from "./colors";
import { type Data, DataError, checkFormat, decodeRun } from "./data";
import { byId, element, setText } from "./dom";
import { ImageView } from "./image_view";
import { Images } from "./images";
import { listenToKeys } from "./keys";
import { type Answer, poll } from "./live";
import type { Page } from "./page";
import { Plots } from "./plots";
import { PointPanel } from "./point_panel";
import { Report } from "./report";
import { type End, changeOfEscape, changeOfPick, endOfPick } from "./ruler";
import { RulerPanel } from "./ruler_panel";
import { SceneView } from "./scene_view";
import { type Changed, Store, anyOf, firstState } from "./state";
import { Tables } from "./tables";
import { Timeline } from "./timeline";
import { Toolbar } from "./toolbar";

const RANGE_GROWTH = 1.25;   // of the observations, until a live view recomputes the colors' range

declare global {
  interface Window {
    pliant: {
      ready: Promise<void>;   // the page shows its data, or why it cannot
      state?: () => object;
      // Where a point of the current frame is, in the page's pixels.
      screenOf?: (pointId: number, view: "image" | "scene") => { x: number; y: number } | null;
      frustumOnScreen?: () => { x: number; y: number }[];   // likewise: the camera's center and the corners of its image
      framesPerSecond?: () => number;   // over the last second of playing
    };
  }
}

window.pliant = { ready: load().catch(showError) };

async function load(): Promise<void> {
  const data = readData();
  checkFormat(data);
  // Lets the browser show that it is loading.
  await new Promise((resolve) => setTimeout(resolve));
  if (data.live) return follow();
  start(await Report.decode(data), data.images ? Images.embedded(data.images) : null, false);
}

function readData(): Data {
  const holder = byId("pliant-data");
  const text = holder.textContent ?? "";
  holder.textContent = "";
  if (!text.trim()) throw new DataError("This page holds no data: `pliant report` makes one that does.");
  try {
    return JSON.parse(text);
  } catch {
    throw new DataError("The data of this page are damaged or cut off: make the report again.");
  }
}

function showError(error: Error): void {
  if (!(error instanceof DataError)) console.error(error);
  const text = error instanceof DataError ? error.message : `The data of this page cannot be shown (${error.message}): make the report again.`;
  document.body.dataset.stage = "failed";
  setText(byId("message"), text);
}

function follow(): Promise<void> {
  let show: ((answer: Answer) => Promise<number>) | null = null;
  const say = (text: string) => {
    setText(byId("live-state"), text);
    if (!show) setText(byId("message"), text);
  };
  return new Promise((resolve, reject) => {
    poll(async (answer) => {
      if (show) return show(answer);
      if (!answer.data.runs?.[0]?.frames.frame.length) return 0;
      const report = await Report.decode(answer.data);
      show = start(report, Images.served(answer.image_frames, answer.image_scale), true);
      resolve();
      return report.runs[0].rows;
    }, say).catch((error) => (show ? say(`${error.message}`) : reject(error)));
  });
}

// Returns what takes the rows of a live view.
function start(report: Report, images: Images | null, live: boolean): (answer: Answer) => Promise<number> {
  document.body.dataset.stage = "ready";
  document.title = `${report.title} – Pliant`;
  setText(byId("title"), report.title);
  setText(byId("version"), `Pliant ${report.version}`);
  // Of several runs the one with a surface, which is shown of the current run alone.
  const withSurface = report.runs.findIndex((run) => run.surfaces.length > 0);
  const store = new Store(firstState(report.runs.length, Math.max(0, withSurface)));
  const { state } = store;
  const coloring = () => {
    const modes = colorModes(report);
    return Coloring.of(modes.find(({ name }) => name === state.color) ?? modes[0], report);
  };
  const page: Page = {
    report, store, images,
    coloring: coloring(),
    pick: (id, end) => store.change(changeOfPick(state, id, end)),
    unpick: () => store.change({ picked: null, measured: null, measuring: false }),
  };

  const toolbar = new Toolbar(page);
  const timeline = new Timeline(page);
  const go = (position: number) => timeline.go(position);
  const image = new ImageView(page);
  const scene = makeScene(page);
  const point = new PointPanel(page, go);
  const views = [toolbar, timeline, image, ...(scene ? [scene] : []), new Plots(page, go), point, new RulerPanel(page), new Tables(page)];
  let observations = report.runs[0].observations;
  store.listen((changed: Changed) => {
    const grown = report.runs[0].observations > RANGE_GROWTH * observations || report.runs[0].observations < observations;
    if (anyOf(changed, "color") || grown) {
      page.coloring = coloring();
      observations = report.runs[0].observations;
    }
    for (const view of views) view.update(changed);
  });
  if (images) {
    images.onLoad = () => {
      image.draw();
      scene?.imageLoaded();
      point.showPatches();
    };
  }

  showNotes(report);
  byId("notes-close").addEventListener("click", () => { byId("notes").hidden = true; });
  byId("reset").addEventListener("click", () => reset());
  const reset = () => {
    image.reset();
    scene?.reset();
  };
  const goNewest = () => store.change({ position: report.frames.length - 1, newest: true, playing: false });
  byId("live").hidden = !live;
  byId("newest").addEventListener("click", goNewest);
  store.listen(() => byId("newest").setAttribute("aria-pressed", String(state.newest)));

  listenToKeys([
    { keys: [" "], shown: "space", what: "play, pause", run: () => timeline.toggle() },
    { keys: ["ArrowLeft", "ArrowRight"], shown: "← →", what: "a frame back, on", run: (key) => timeline.step(key === "ArrowLeft" ? -1 : 1) },
    {
      keys: ["Shift+ArrowLeft", "Shift+ArrowRight"], shown: "shift ← →", what: "ten frames back, on",
      run: (key) => timeline.step(key === "Shift+ArrowLeft" ? -10 : 10),
    },
    {
      keys: ["Home", "End"], shown: "home, end", what: "first, last frame",
      run: (key) => timeline.go(key === "Home" ? 0 : report.frames.length - 1),
    },
    { keys: ["c", "Shift+c"], shown: "c, shift c", what: "next color, the one before", run: (key) => toolbar.cycleColor(key === "c" ? 1 : -1) },
    { keys: ["s"], shown: "s", what: "surface", run: () => toolbar.toggleLayer("surface") },
    { keys: ["u"], shown: "u", what: "next color of the surface", run: () => toolbar.cycleSurfaceColor() },
    { keys: ["m"], shown: "m", what: "undeformed map", run: () => toolbar.toggleLayer("map") },
    { keys: ["o"], shown: "o", what: "points", run: () => toolbar.toggleLayer("points") },
    { keys: ["t"], shown: "t", what: "trails", run: () => toolbar.toggleLayer("trails") },
    { keys: ["p"], shown: "p", what: "camera path", run: () => toolbar.toggleLayer("path") },
    { keys: ["g"], shown: "g", what: "truth", run: () => toolbar.toggleLayer("truth") },
    { keys: ["x"], shown: "x", what: "grid and axes", run: () => toolbar.toggleLayer("grid") },
    { keys: ["f"], shown: "f", what: "3D view: free, from the camera, behind it", run: () => toolbar.cycleView() },
    { keys: ["r"], shown: "r", what: "show the whole scene and image", run: reset },
    { keys: ["n", "b"], shown: "n, b", what: "pick the next point, the one before", run: (key) => pickNext(page, key === "n" ? 1 : -1, "picked") },
    {
      keys: ["Shift+n", "Shift+b"], shown: "shift n, shift b", what: "the same for the other end of a ruler",
      run: (key) => pickNext(page, key === "Shift+n" ? 1 : -1, "measured"),
    },
    { keys: ["Escape"], shown: "esc", what: "remove the ruler, then unpick", run: () => store.change(changeOfEscape(state)) },
    {
      keys: ["1", "2", "3", "4", "5", "6", "7", "8", "9"], shown: "1 … 9", what: "show this run in full",
      run: (key) => toolbar.makeCurrent(Number(key) - 1),
    },
    { keys: ["l"], shown: "l", what: "live: follow the newest frame", run: () => live && goNewest() },
    { keys: ["d"], shown: "d", what: "theme: auto, dark, light", run: () => toolbar.cycleTheme() },
  ]);

  offerToTests(page, timeline, image, scene);
  if (live) goNewest();
  return async ({ data, from, running, image_scale, image_frames }) => {
    const newest = data.runs?.[0];
    // No rows change nothing, except that the last answer has the final figures.
    if (!newest || (newest.frames.frame.length === 0 && (from === 0 || running))) return from;
    report.append(await decodeRun(newest), from);
    images!.scale = image_scale;
    images!.listed = image_frames;
    const before = notesOf(report).length;
    report.notes = data.notes;
    if (notesOf(report).length !== before) showNotes(report);
    const last = report.frames.length - 1;
    store.change({ revision: state.revision + 1, position: state.newest ? last : Math.min(state.position, last) });
    return report.runs[0].rows;
  };
}

function makeScene(page: Page): SceneView | null {
  try {
    return new SceneView(page);
  } catch {
    byId("scene").replaceChildren(element("p", {
      className: "absent", textContent: "This browser has no WebGL, which the 3D view needs; the image, the plots and the tables work without.",
    }));
    return null;
  }
}

function notesOf(report: Report): string[] {
  return [...report.notes, ...report.runs.map((run) => run.whyNothing()).filter((sentence) => sentence !== "")];
}

function showNotes(report: Report): void {
  const notes = notesOf(report);
  byId("notes").hidden = notes.length === 0;
  byId("notes-list").replaceChildren(...notes.map((text) => element("li", { textContent: text })));
}

// Of the points of this frame, by id, without the ruler's other end; a new ruler begins beside the picked point.
function pickNext(page: Page, step: number, wanted: End): void {
  const { report, store } = page;
  const { current, position, picked, measured } = store.state;
  const run = report.runs[current];
  const end = endOfPick(store.state, wanted);
  const [from, other] = end === "measured" ? [measured ?? picked, picked] : [picked, measured];
  const ids = [...run.observationsOfRow(report.row(current, position))].map((o) => run.id.values[run.point.values[o]])
    .filter((id) => id !== other).sort((a, b) => a - b);
  if (ids.length === 0) return;
  const next = from === null ? (step > 0 ? 0 : ids.length - 1)
    : step > 0 ? ids.findIndex((id) => id > from) : ids.length - 1 - [...ids].reverse().findIndex((id) => id < from);
  page.pick(ids[(next + ids.length) % ids.length], end);
}

function offerToTests(page: Page, timeline: Timeline, image: ImageView, scene: SceneView | null): void {
  const { report, store } = page;
  window.pliant.state = () => {
    const { position, playing, color, picked, measured, measuring, current, visible, theme, dark, view, layers, surfaceColor, trail, speed, loop, newest } = store.state;
    const observations = report.runs[current].observationsOfRow(report.row(current, position));
    const run = report.runs[current];
    return {
      frame: report.frames[position], position, frames: report.frames.length, playing, color, picked, measured, measuring,
      currentRun: report.runs[current].name, visibleRuns: report.runs.filter((_, i) => visible[i]).map(({ name }) => name),
      theme, dark, view, layers, surfaceColor, trail, speed, loop, newest, points: [...observations].map((o) => run.id.values[run.point.values[o]]),
    };
  };
  window.pliant.framesPerSecond = () => timeline.framesPerSecond();
  window.pliant.frustumOnScreen = () => {
    const box = byId("scene").getBoundingClientRect();
    return (scene?.projectFrustum() ?? []).map(([x, y]) => ({ x: box.left + x, y: box.top + y }));
  };
  window.pliant.screenOf = (pointId, view) => {
    const run = report.runs[store.state.current];
    const row = report.row(store.state.current, store.state.position);
    const o = [...run.observationsOfRow(row)].find((observation) => run.id.values[run.point.values[observation]] === pointId);
    if (o === undefined || (view === "scene" && !scene)) return null;
    const box = byId(view === "image" ? "image" : "scene").getBoundingClientRect();
    const [x, y] = view === "image" ? image.project(run.pixel.values[2 * o], run.pixel.values[2 * o + 1])
      : scene!.project(run.position.values, 3 * o);
    return { x: box.left + x, y: box.top + y };
  };
}
