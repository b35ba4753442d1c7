// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A press on a view picks the point of this frame that is closest to it there, if one is near; with shift as the ruler's other end.

import { CLICK_RADIUS_PX, type Click } from "./dom";
import type { Page } from "./page";
import type { Run } from "./run";

// `project` says where an observation is in the view, or null where it does not show it.
export function pickNearest(page: Page, { x, y, shift }: Click, project: (run: Run, observation: number) => [number, number] | null): void {
  const { report, store } = page;
  const run = report.runs[store.state.current];
  let best: number | null = null;
  let least = CLICK_RADIUS_PX;
  for (const o of run.observationsOfRow(report.row(store.state.current, store.state.position))) {
    const at = project(run, o);
    const distance = at ? Math.hypot(at[0] - x, at[1] - y) : Infinity;
    if (distance >= least) continue;
    least = distance;
    best = o;
  }
  if (best !== null) page.pick(run.id.values[run.point.values[best]], shift ? "measured" : "picked");
}
