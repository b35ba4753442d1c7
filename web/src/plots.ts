// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What is plotted over the frames: of the current run everything, of the other visible ones the main series.

import { paletteOf, runColor } from "./colors";
import type { Column } from "./data";
import { byId } from "./dom";
import type { Page } from "./page";
import { Plot, type Series } from "./plot";
import type { Run } from "./run";
import { type Changed, anyOf } from "./state";

interface Figure {
  title: string;
  unit: string;
  log?: boolean;
  stacked?: boolean;
  note?: string;    // what its values do not say
  series: { label: string; values: Column }[];   // the main one first
}

export const DISPLACED = "After the first map every point has its own displacement in every frame. It takes up the reprojection error, of " +
  "right and wrong points alike: values near zero do not say that the map is right. Frames in which the map was refined stand out.";
const DASHES = [[6, 4], [2, 3], [10, 3, 2, 3], [4, 2], [1, 2], [12, 4], [8, 2, 2, 2]];

export function figuresOf(run: Run): Figure[] {
  const { frames } = run;
  const listed = (columns: Record<string, Column>) => Object.entries(columns).map(([label, values]) => ({ label, values }));
  const figures: Figure[] = [
    {
      title: "Points", unit: "",
      series: (["tracked", "optimized", "lost", "added"] as const).map((name) => ({ label: name, values: frames[name] })),
    },
    { title: "Error against truth", unit: "mm", series: listed(frames.errors) },
    { title: "Reprojection error", unit: "px", ...reprojectionErrors(run) },
    { title: "Cost by term", unit: "", log: true, series: listed(frames.costs) },
    { title: "Time by stage", unit: "ms", stacked: true, series: listed(frames.stages_ms) },
    {
      title: "Scale against truth", unit: run.unit === "mm" ? "true mm per mm of the run" : "mm per map unit", series: [{ label: "scale", values: frames.scale ?? [] }],
    },
  ];
  for (const figure of figures) figure.series = figure.series.filter(({ values }) => values.some((value) => value !== null));
  return figures;
}

// Where the joint problem was solved, the displacements of the points take up their error: such values cannot be compared with
// others, and are a series of their own.
function reprojectionErrors(run: Run): Pick<Figure, "note" | "series"> {
  const { reprojection_px: errors, costs } = run.frames;
  const isJoint = (row: number) => Object.values(costs).some((values) => values[row] !== null);
  const joint = errors.map((error, row) => (isJoint(row) ? error : null));
  const notes = [];
  if (joint.some((error) => error !== null)) notes.push(DISPLACED);
  const without = errors.filter((error) => error === null).length;
  if (without > 0) notes.push(`No value: ${without} of ${errors.length} frames, which have no pose or no error to measure.`);
  return {
    note: notes.join(" "),
    series: [{ label: "median", values: errors.map((error, row) => (isJoint(row) ? null : error)) }, { label: "median, displaced points", values: joint }],
  };
}

export class Plots {
  private readonly container = byId("plots");
  private plots: Plot[] = [];
  private range: [number, number] | null = null;

  constructor(private readonly page: Page, private readonly go: (position: number) => void) {
    new ResizeObserver(() => this.plots.forEach((plot) => plot.resize())).observe(this.container);
    this.build();
  }

  update(changed: Changed): void {
    if (anyOf(changed, "current", "visible", "dark")) this.build();
    else if (anyOf(changed, "revision")) this.refresh();
    if (anyOf(changed, "position", "current", "visible", "dark", "revision")) this.showPosition();
  }

  private build(): void {
    const { frames } = this.page.report;
    const { dark } = this.page.store.state;
    for (const plot of this.plots) plot.destroy();
    this.plots = this.figures().map(({ title, unit, log, stacked, note, series }) => new Plot({
      title, unit, log, stacked, note, series, frames, dark, height: 170,
      go: this.go,
      zoom: (range) => {
        this.range = range;
        for (const plot of this.plots) plot.setRange(range);
      },
    }));
    this.container.replaceChildren(...this.plots.map((plot) => plot.element));
    for (const plot of this.plots) plot.resize();
    if (this.range) for (const plot of this.plots) plot.setRange(this.range);
    this.showPosition();
  }

  // New rows; a series that was not there before rebuilds all.
  private refresh(): void {
    const figures = this.figures();
    const same = figures.length === this.plots.length && figures.every(({ series }, i) => series.length === this.plots[i].size);
    if (!same) return this.build();
    this.plots.forEach((plot, i) => {
      plot.setData(this.page.report.frames, figures[i].series, figures[i].note);
      if (this.range) plot.setRange(this.range);
    });
  }

  private showPosition(): void {
    for (const plot of this.plots) plot.showPosition(this.page.store.state.position);
  }

  // With the columns spread over the time line.
  private figures(): (Omit<Figure, "series"> & { series: Series[] })[] {
    const { report, store } = this.page;
    const { current, visible, dark } = store.state;
    const colors = paletteOf(dark).series;
    const spread = (run: number, values: Column) => report.frames.map((_, position) => values[report.row(run, position)] ?? null);
    const perRun = report.runs.map((run) => figuresOf(run));
    return perRun[current].map(({ series, ...figure }, i) => {
      const own = visible[current] ? series.map(({ label, values }, s) => ({
        label: report.runs.length > 1 && s === 0 ? `${report.runs[current].name}: ${label}` : label,
        values: spread(current, values),
        color: s === 0 ? runColor(dark, current) : colors[(s - 1) % colors.length],
        dash: s === 0 ? [] : DASHES[(s - 1) % DASHES.length],
      })) : [];
      const others = report.runs.flatMap((run, index) => {
        const main = perRun[index][i].series[0];
        if (index === current || !visible[index] || !main || figure.stacked) return [];
        return [{ label: `${run.name}: ${main.label}`, values: spread(index, main.values), color: runColor(dark, index), dash: [] }];
      });
      return { ...figure, series: [...own, ...others] };
    }).filter(({ series }) => series.length > 0);
  }
}
