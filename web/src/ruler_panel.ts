// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The ruler in the point's panel: its buttons, what it reads in this frame, or why it reads nothing.

import { byId, setText } from "./dom";
import type { Page } from "./page";
import { type Reading, lengthText, percentOf, readingNow, readingsOf } from "./ruler";
import { type Changed, anyOf } from "./state";

const MAP_UNITS = "map units";
const NO_MEASUREMENT = "In map units it is no measurement: the true size is not known. Changes in per cent can be compared.";

export class RulerPanel {
  private readonly measure = byId("measure");
  private readonly unmeasure = byId("unmeasure");
  private readings = new Map<number, Reading>();

  constructor(private readonly page: Page) {
    const { store } = page;
    this.measure.addEventListener("click", () => store.change({ measuring: !store.state.measuring }));
    this.unmeasure.addEventListener("click", () => store.change({ measured: null, measuring: false }));
  }

  update(changed: Changed): void {
    const { report, store } = this.page;
    const { picked, measured, measuring, current } = store.state;
    if (anyOf(changed, "picked", "measured", "current", "revision")) {
      this.readings = readingsOf(report.runs[current], picked, measured);
    }
    if (!anyOf(changed, "picked", "measured", "measuring", "current", "position", "revision")) return;
    this.measure.setAttribute("aria-pressed", String(measuring));
    this.unmeasure.hidden = measured === null;
    setText(byId("measure-hint"), measuring ? "Click the other point, in the image or in the scene." : "");
    const reading = measured === null ? null : readingNow(this.page);
    setText(byId("ruler-length"), reading ? this.textOf(reading) : "");
    setText(byId("ruler-state"), measured === null || reading ? "" : this.whyNothing());
    setText(byId("ruler-unit"), measured !== null && report.unit === MAP_UNITS ? NO_MEASUREMENT : "");
  }

  private textOf(reading: Reading): string {
    const { report, store } = this.page;
    const { measured, current } = store.state;
    const { value: first } = this.readings.values().next();
    const run = report.runs[current];
    const frame = run.frames.frame[run.row.values[first!.ends[0]]];
    const percent = percentOf(reading, first!);
    const change = Number.isNaN(percent) ? "" : `, ${percent < 0 ? "−" : "+"}${Math.abs(percent).toFixed(1)} % since frame ${frame}`;
    const sigma = reading.sigma > 0 ? " (1 sigma)" : "";
    return `${lengthText(reading, report.unit)}${sigma} to point ${measured}${change}`;
  }

  private whyNothing(): string {
    const { report, store } = this.page;
    const { picked, measured, current, position } = store.state;
    const run = report.runs[current];
    const row = report.row(current, position);
    const missing = [picked!, measured!].filter((id) => run.observationOf(id, row) === undefined);
    const never = this.readings.size === 0 ? " There is no frame in which both have a position." : "";
    if (missing.length === 0) return `No distance: a point has no position in this frame.${never}`;
    const who = missing.length === 2 ? `points ${picked} and ${measured} are` : `point ${missing[0]} is`;
    return `No distance: ${who} not seen in this frame.${never}`;
  }
}
