// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What the page shows. Views read the state, change it through `change`, and are told once a redraw what has changed.

import { BY_RUN } from "./colors";
import type { SurfaceColor } from "./surface";

export const LAYERS = ["surface", "map", "points", "trails", "path", "truth", "grid"] as const;
export type Layer = (typeof LAYERS)[number];

export const VIEWS = ["free", "camera", "chase"] as const;
export type View = (typeof VIEWS)[number];

export const THEMES = ["auto", "dark", "light"] as const;
export type Theme = (typeof THEMES)[number];

export interface State {
  position: number;       // of the time line
  playing: boolean;
  speed: number;
  loop: boolean;
  current: number;        // index of the run that is shown in full
  visible: boolean[];     // of each run
  picked: number | null;  // id of a point of the current run
  measured: number | null;   // id of the point at the other end of the ruler
  measuring: boolean;     // the next pick is the ruler's other end
  color: string;         // name of a color mode
  layers: Record<Layer, boolean>;
  surfaceColor: SurfaceColor;
  trail: number;          // frames
  view: View;
  theme: Theme;
  dark: boolean;          // what the theme comes to
  newest: boolean;        // live: follow the newest frame
  revision: number;       // grows when rows come in
}

export type Changed = ReadonlySet<keyof State>;
type Listener = (changed: Changed) => void;

export class Store {
  private readonly listeners: Listener[] = [];
  private changed = new Set<keyof State>();

  constructor(readonly state: Readonly<State>) {}

  listen(listener: Listener): void {
    this.listeners.push(listener);
  }

  change(part: Partial<State>): void {
    const scheduled = this.changed.size > 0;
    for (const key of Object.keys(part) as (keyof State)[]) {
      if (this.state[key] !== part[key]) this.changed.add(key);
    }
    Object.assign(this.state, part);
    if (!scheduled && this.changed.size > 0) requestAnimationFrame(() => this.flush());
  }

  // Tells the views at once.
  flush(): void {
    if (this.changed.size === 0) return;
    const changed = this.changed;
    this.changed = new Set();
    for (const listener of this.listeners) listener(changed);
  }
}

export function anyOf(changed: Changed, ...keys: (keyof State)[]): boolean {
  return keys.some((key) => changed.has(key));
}

// `current`: the run that is shown in full at first.
export function firstState(runs: number, current: number): State {
  return {
    position: 0,
    playing: false,
    speed: 1,
    loop: false,
    current,
    visible: new Array(runs).fill(true),
    picked: null,
    measured: null,
    measuring: false,
    color: runs > 1 ? BY_RUN : "depth",
    surfaceColor: "image",
    layers: { surface: true, map: true, points: true, trails: true, path: true, truth: true, grid: true },
    trail: 30,
    view: "free",
    theme: "auto",
    dark: false,
    newest: true,
    revision: 0,
  };
}
