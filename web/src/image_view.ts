// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The current frame's image with the points of the visible runs: of the current one with their trails, of the others in the runs'
// colors and shapes, as in the 3D view.

import { numberOf, paletteOf, runColor } from "./colors";
import { type Click, byId, onClick, prepare, setText } from "./dom";
import { RUN_SHAPES } from "./marks";
import type { Page } from "./page";
import { pickNearest } from "./picking";
import { lengthText, readingNow, sideOfLabel } from "./ruler";
import type { Run } from "./run";
import { Stamps, strokeOnImage, writeOnImage } from "./stamps";
import { type Changed, anyOf } from "./state";

const TAIL_FRAMES = 10;
const TAIL_COLOR = "rgba(255, 255, 255, 0.9)";   // on an image
const TAIL_STEP_PX = 2.5;   // shorter steps are not drawn by themselves
const MAX_ZOOM = 20;
const PREFETCHED = 6;

export class ImageView {
  private readonly canvas = byId<HTMLCanvasElement>("image");
  private readonly caption = byId("image-caption");
  private readonly stamps = new Stamps();
  // The camera's image as it lies in the canvas: CSS pixels for one of the camera's, and its top left corner.
  private view = { scale: 1, left: 0, top: 0 };
  // The last image that was drawn stays until the next one is decoded.
  private shown: { frame: number; bitmap: ImageBitmap } | null = null;
  private zoom = 1;
  private center = { x: 0.5, y: 0.5 };   // of the view, as a part of the image

  constructor(private readonly page: Page) {
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    onClick(this.canvas, (click) => this.pick(click));
    this.canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoomAt(event.offsetX, event.offsetY, Math.exp(-0.0015 * event.deltaY));
    }, { passive: false });
    this.canvas.addEventListener("dblclick", () => this.reset());
    this.listenToDrags();
  }

  update(changed: Changed): void {
    if (anyOf(changed, "position", "current", "visible", "picked", "measured", "color", "layers", "dark", "revision")) this.draw();
  }

  reset(): void {
    this.zoom = 1;
    this.center = { x: 0.5, y: 0.5 };
    this.draw();
  }

  draw(): void {
    const { report, store, images } = this.page;
    const { state } = store;
    const { context, width } = prepare(this.canvas);
    if (width === 0) return;
    this.layOut();
    const frame = report.frames[state.position];
    const wanted = images?.frameFor(frame) ?? null;
    const bitmap = images && wanted !== null ? images.get(wanted) : null;
    if (bitmap) this.shown = { frame: wanted!, bitmap };
    else if (bitmap === null) this.shown = null;
    if (state.playing) images?.prefetch(frame, PREFETCHED);
    setText(this.caption, this.captionOf(frame));

    this.drawImage(context);
    if (!state.layers.points) return;
    this.drawOthers(context);
    const row = report.row(state.current, state.position);
    if (row < 0 || !state.visible[state.current]) return;
    const run = report.runs[state.current];
    this.drawPoints(context, run, row);
    this.drawPicked(context, run, row);
    this.drawRuler(context, run);
  }

  // Where the canvas shows a pixel of the camera.
  project(u: number, v: number): [number, number] {
    const { scale, left, top } = this.view;
    return [left + scale * (u + 0.5), top + scale * (v + 0.5)];
  }

  private captionOf(frame: number): string {
    const { images } = this.page;
    if (!images) return "The images are not in this report: only the points are drawn; everything else works without.";
    if (!this.shown) return images.frameFor(frame) === null || images.get(frame) === null ? "There is no image of this frame." : "";
    return this.shown.frame === frame ? "" : `image of frame ${this.shown.frame}`;
  }

  private layOut(): void {
    const { width, height } = this.page.report.camera;
    const { clientWidth, clientHeight } = this.canvas;
    const scale = this.zoom * Math.min(clientWidth / width, clientHeight / height);
    const edge = (size: number, whole: number, center: number) =>
      size <= whole ? (whole - size) / 2 : Math.min(0, Math.max(whole - size, whole / 2 - center * size));
    this.view = {
      scale,
      left: edge(scale * width, clientWidth, this.center.x),
      top: edge(scale * height, clientHeight, this.center.y),
    };
  }

  private drawImage(context: CanvasRenderingContext2D): void {
    const { report, store, images } = this.page;
    const { scale, left, top } = this.view;
    context.fillStyle = paletteOf(store.state.dark).grid;
    context.fillRect(left, top, scale * report.camera.width, scale * report.camera.height);
    if (!this.shown || !images) return;
    const { bitmap } = this.shown;
    context.imageSmoothingEnabled = scale < 4;
    context.drawImage(bitmap, left, top, (scale / images.scale) * bitmap.width, (scale / images.scale) * bitmap.height);
  }

  private drawPoints(context: CanvasRenderingContext2D, run: Run, row: number): void {
    const observations = run.observationsOfRow(row);
    this.drawTails(context, run, observations);
    for (const o of observations) {
      const [x, y] = this.project(run.pixel.values[2 * o], run.pixel.values[2 * o + 1]);
      const color = this.page.coloring.color(run, o, this.page.store.state.dark);
      const lost = run.isLost(o);
      const returned = run.isReturned(o);
      if (!lost && !returned) this.stamps.draw(context, x, y, color, "dot");
      if (lost) this.stamps.draw(context, x, y, color, "cross");
      if (returned) this.stamps.draw(context, x, y, color, "ring");
    }
  }

  private drawOthers(context: CanvasRenderingContext2D): void {
    const { report, store } = this.page;
    const { visible, current, position, dark } = store.state;
    report.runs.forEach((run, index) => {
      if (index === current || !visible[index]) return;
      const color = numberOf(runColor(dark, index));
      for (const o of run.observationsOfRow(report.row(index, position))) {
        const [x, y] = this.project(run.pixel.values[2 * o], run.pixel.values[2 * o + 1]);
        this.stamps.draw(context, x, y, color, RUN_SHAPES[index % RUN_SHAPES.length]);
      }
    });
  }

  // In one path: a path a color is much slower.
  private drawTails(context: CanvasRenderingContext2D, run: Run, observations: Uint32Array): void {
    const row = run.row.values;
    const previous = run.previous.values;
    const pixel = run.pixel.values;
    const { scale, left, top } = this.view;
    context.beginPath();
    for (const observation of observations) {
      const oldest = row[observation] - TAIL_FRAMES;
      let x = left + scale * (pixel[2 * observation] + 0.5);
      let y = top + scale * (pixel[2 * observation + 1] + 0.5);
      context.moveTo(x, y);
      for (let o = previous[observation]; o >= 0 && row[o] >= oldest; o = previous[o]) {
        const px = left + scale * (pixel[2 * o] + 0.5);
        const py = top + scale * (pixel[2 * o + 1] + 0.5);
        if (Math.abs(px - x) + Math.abs(py - y) < TAIL_STEP_PX) continue;
        context.lineTo(x = px, y = py);
      }
    }
    context.lineWidth = 1.5;
    context.strokeStyle = this.shown ? TAIL_COLOR : paletteOf(this.page.store.state.dark).text;
    context.stroke();
  }

  private drawPicked(context: CanvasRenderingContext2D, run: Run, row: number): void {
    const { state } = this.page.store;
    const point = state.picked === null ? undefined : run.pointWithId(state.picked);
    if (point === undefined) return;
    const observations = run.observationsOfPoint(point);
    const color = paletteOf(true).picked;
    context.beginPath();
    observations.forEach((o, i) => (i === 0 ? this.moveTo(context, run, o) : this.lineTo(context, run, o)));
    strokeOnImage(context, color);
    const now = observations.find((o) => run.row.values[o] === row);
    if (now === undefined) return;
    this.drawRing(context, run, now, color);
  }

  private drawRuler(context: CanvasRenderingContext2D, run: Run): void {
    const reading = readingNow(this.page);
    if (!reading) return;
    const color = paletteOf(true).ruler;
    const [from, to] = reading.ends;
    context.beginPath();
    this.moveTo(context, run, from);
    this.lineTo(context, run, to);
    strokeOnImage(context, color);
    this.drawRing(context, run, to, color);
    const [a, b] = reading.ends.map((o) => this.project(run.pixel.values[2 * o], run.pixel.values[2 * o + 1]));
    const text = lengthText(reading, this.page.report.unit);
    writeOnImage(context, text, (a[0] + b[0]) / 2, (a[1] + b[1]) / 2, sideOfLabel(a, b), color);
  }

  private drawRing(context: CanvasRenderingContext2D, run: Run, o: number, color: string): void {
    const [x, y] = this.project(run.pixel.values[2 * o], run.pixel.values[2 * o + 1]);
    context.beginPath();
    context.arc(x, y, 8, 0, 2 * Math.PI);
    strokeOnImage(context, color);
  }

  private moveTo(context: CanvasRenderingContext2D, run: Run, o: number): void {
    context.moveTo(...this.project(run.pixel.values[2 * o], run.pixel.values[2 * o + 1]));
  }

  private lineTo(context: CanvasRenderingContext2D, run: Run, o: number): void {
    context.lineTo(...this.project(run.pixel.values[2 * o], run.pixel.values[2 * o + 1]));
  }

  private pick(click: Click): void {
    pickNearest(this.page, click, (run, o) => this.project(run.pixel.values[2 * o], run.pixel.values[2 * o + 1]));
  }

  private zoomAt(x: number, y: number, factor: number): void {
    const { width, height } = this.page.report.camera;
    const before = this.view;
    const u = (x - before.left) / before.scale;
    const v = (y - before.top) / before.scale;
    this.zoom = Math.min(MAX_ZOOM, Math.max(1, this.zoom * factor));
    this.layOut();
    const { scale } = this.view;
    this.setCenter(u / width + (this.canvas.clientWidth / 2 - x) / (scale * width),
      v / height + (this.canvas.clientHeight / 2 - y) / (scale * height));
  }

  private setCenter(x: number, y: number): void {
    const inside = (value: number) => Math.min(1, Math.max(0, value));
    this.center = { x: inside(x), y: inside(y) };
    this.canvas.classList.toggle("zoomed", this.zoom > 1);
    this.draw();
  }

  // One pointer moves a zoomed image, two zoom it.
  private listenToDrags(): void {
    const pointers = new Map<number, { x: number; y: number }>();
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    });
    for (const type of ["pointerup", "pointercancel"] as const) {
      this.canvas.addEventListener(type, (event) => pointers.delete(event.pointerId));
    }
    this.canvas.addEventListener("pointermove", (event) => {
      const from = pointers.get(event.pointerId);
      if (!from) return;
      const to = { x: event.offsetX, y: event.offsetY };
      pointers.set(event.pointerId, to);
      const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
      if (other) {
        const distance = (p: { x: number; y: number }) => Math.hypot(p.x - other.x, p.y - other.y);
        this.zoomAt((to.x + other.x) / 2, (to.y + other.y) / 2, distance(to) / Math.max(1, distance(from)));
      } else if (this.zoom > 1) {
        const { width, height } = this.page.report.camera;
        const { scale } = this.view;
        this.setCenter(this.center.x - (to.x - from.x) / (scale * width), this.center.y - (to.y - from.y) / (scale * height));
      }
    });
  }
}
