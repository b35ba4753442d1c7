// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The history of the picked point: what it looked like, and its numbers over time.

import { paletteOf, runColor } from "./colors";
import { byId, setText } from "./dom";
import type { Page } from "./page";
import { Plot } from "./plot";
import { DISPLACED } from "./plots";
import { percentOf, readingsOf } from "./ruler";
import type { Run } from "./run";
import { type Changed, anyOf } from "./state";

const PATCH_PX = 31;
const ENLARGED = 4;

interface Figure {
  title: string;
  unit: string;
  note?: string;
  series: { label: string; value: (observation: number) => number }[];
}

export class PointPanel {
  private readonly panel = byId("point");
  private readonly plots = byId("point-plots");
  private made: Plot[] = [];
  private observations: number[] = [];

  constructor(private readonly page: Page, private readonly go: (position: number) => void) {
    byId("unpick").addEventListener("click", () => page.unpick());
    byId("point-first").addEventListener("click", () => this.goTo(this.observations[0]));
    byId("point-last").addEventListener("click", () => this.goTo(this.observations[this.observations.length - 1]));
    new ResizeObserver(() => this.made.forEach((plot) => plot.resize())).observe(this.plots);
  }

  update(changed: Changed): void {
    if (anyOf(changed, "picked", "measured", "current", "dark", "revision")) this.build();
    if (anyOf(changed, "picked", "measured", "position", "current", "dark", "revision")) this.showFrame();
  }

  // An image may have come.
  showPatches(): void {
    if (this.observations.length === 0) return;
    const now = this.observationNow();
    this.drawPatch("patch-first", this.observations[0]);
    this.drawPatch("patch-now", now);
  }

  private build(): void {
    const { report, store } = this.page;
    const { picked, current, dark } = store.state;
    const run = report.runs[current];
    const point = picked === null ? undefined : run.pointWithId(picked);
    for (const plot of this.made) plot.destroy();
    this.made = [];
    this.observations = point === undefined ? [] : run.observationsOfPoint(point);
    this.panel.hidden = this.observations.length === 0;
    document.body.classList.toggle("has-point", !this.panel.hidden);
    if (this.panel.hidden) return;
    const frameOf = (o: number) => run.frames.frame[run.row.values[o]];
    const first = frameOf(this.observations[0]);
    const last = frameOf(this.observations[this.observations.length - 1]);
    setText(byId("point-title"), `Point ${picked}`);
    setText(byId("point-first"), `frame ${first}`);
    setText(byId("point-last"), `frame ${last}`);
    const rows = this.observations.map((o) => run.row.values[o]);
    setText(byId("point-length"), `seen in ${rows.length} of ${rows[rows.length - 1] - rows[0] + 1} frames`);
    this.made = this.figures(run).map(({ title, unit, note, series }) => new Plot({
      title, unit, note, frames: report.frames, dark, height: 84, go: this.go,
      series: series.map(({ label, value }, i) => ({
        label, values: this.spread(run, value), color: i === 0 ? runColor(dark, current) : paletteOf(dark).series[0],
        dash: i === 0 ? [] : [6, 4],
      })),
      zoom: (range) => this.made.forEach((plot) => plot.setRange(range ?? [first, last])),
    }));
    this.plots.replaceChildren(...this.made.map((plot) => plot.element));
    for (const plot of this.made) {
      plot.resize();
      plot.setRange(first < last ? [first, last] : null);
    }
  }

  private figures(run: Run): Figure[] {
    const { unit } = this.page.report;
    const { sigma, gain, bias, error } = run;
    const figures = [
      ...this.rulerFigures(run),
      one("Depth", unit, (o) => run.depth.values[o]),
      one("Deformation", unit, (o) => run.deformation(o)),
      { ...one("Reprojection error", "px", (o) => run.reprojection.values[o]), note: Object.keys(run.frames.costs).length > 0 ? DISPLACED : "" },
      one("Similarity", "SSIM", (o) => run.similarity.values[o]),
    ];
    if (sigma) figures.push(one("Uncertainty (1 sigma)", unit, (o) => sigma.values[o]));
    if (gain) figures.push(one("Gain", "", (o) => gain.values[o]));
    if (bias) figures.push(one("Bias", "gray values", (o) => bias.values[o]));
    if (error) figures.push(one("Error against truth", "mm", (o) => error.values[o]));
    return figures.filter(({ series }) => this.observations.some((o) => !Number.isNaN(series[0].value(o))));
  }

  // Of the frames in which both ends of the ruler were seen.
  private rulerFigures(run: Run): Figure[] {
    const { picked, measured } = this.page.store.state;
    const readings = readingsOf(run, picked, measured);
    const [first] = readings.values();
    if (!first) return [];
    const at = (o: number) => readings.get(run.row.values[o]);
    const offset = (sigmas: number) => (o: number) => (at(o)?.distance ?? NaN) + (sigmas === 0 ? 0 : sigmas * (at(o)?.sigma ?? NaN));
    const certain = ![...readings.values()].some(({ sigma }) => sigma > 0);
    const distance = one(certain ? "Distance" : "Distance ± 1 sigma", this.page.report.unit, offset(0));
    if (!certain) distance.series.push({ label: "less", value: offset(-1) }, { label: "more", value: offset(1) });
    const since = run.frames.frame[run.row.values[first.ends[0]]];
    return [distance, one(`Its change since frame ${since}`, "%", (o) => {
      const reading = at(o);
      return reading ? percentOf(reading, first) : NaN;
    })];
  }

  private spread(run: Run, value: (o: number) => number): (number | null)[] {
    const { report } = this.page;
    const values: (number | null)[] = new Array(report.frames.length).fill(null);
    for (const o of this.observations) {
      const number = value(o);
      if (!Number.isNaN(number)) values[report.positionOf(run.frames.frame[run.row.values[o]])] = number;
    }
    return values;
  }

  private showFrame(): void {
    if (this.observations.length === 0) return;
    setText(byId("point-state"), this.observationNow() === undefined ? "Not seen in this frame." : "");
    for (const plot of this.made) plot.showPosition(this.page.store.state.position);
    this.showPatches();
  }

  private observationNow(): number | undefined {
    const { report, store } = this.page;
    const { current, position } = store.state;
    const row = report.row(current, position);
    return this.observations.find((o) => report.runs[current].row.values[o] === row);
  }

  private drawPatch(id: string, observation: number | undefined): void {
    const { report, store, images } = this.page;
    const run = report.runs[store.state.current];
    const canvas = byId<HTMLCanvasElement>(id);
    const caption = byId(`${id}-caption`);
    canvas.width = canvas.height = PATCH_PX * ENLARGED;
    if (observation === undefined) return setText(caption, "not seen");
    const frame = run.frames.frame[run.row.values[observation]];
    const imageFrame = images?.frameFor(frame) ?? null;
    if (!images || imageFrame === null) return setText(caption, "no image");
    // Of a frame without an image: where the point was in the one whose image stands for it.
    const source = imageFrame === frame ? observation : this.observations.find((o) => run.frames.frame[run.row.values[o]] === imageFrame);
    if (source === undefined) return setText(caption, "no image");
    const image = images.get(imageFrame);
    setText(caption, image === null ? "no image" : `frame ${imageFrame}`);
    if (!image) return;
    const { scale } = images;
    const context = canvas.getContext("2d")!;
    const left = run.pixel.values[2 * source] + 0.5 - PATCH_PX / 2;
    const top = run.pixel.values[2 * source + 1] + 0.5 - PATCH_PX / 2;
    context.imageSmoothingEnabled = false;
    context.setTransform(ENLARGED / scale, 0, 0, ENLARGED / scale, -left * ENLARGED, -top * ENLARGED);
    context.drawImage(image, 0, 0);
    context.setTransform(1, 0, 0, 1, (PATCH_PX * ENLARGED) / 2, (PATCH_PX * ENLARGED) / 2);
    for (const [width, color] of [[3, "rgba(0, 0, 0, 0.7)"], [1, "#ffffff"]] as const) {
      context.lineWidth = width;
      context.strokeStyle = color;
      context.beginPath();
      for (const [x, y] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        context.moveTo(4 * x, 4 * y);
        context.lineTo(10 * x, 10 * y);
      }
      context.stroke();
    }
  }

  private goTo(observation: number | undefined): void {
    const { report, store } = this.page;
    if (observation === undefined) return;
    const run = report.runs[store.state.current];
    this.go(report.positionOf(run.frames.frame[run.row.values[observation]]));
  }
}

function one(title: string, unit: string, value: (observation: number) => number): Figure {
  return { title, unit, series: [{ label: "", value }] };
}
