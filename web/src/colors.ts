// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Colors that the color-blind tell apart: viridis for magnitudes, cool to warm for what has a sign (as in figures:
// src/viewer/color_maps.h), Okabe and Ito's for things.

import type { Report } from "./report";
import type { Run } from "./run";

export interface Palette {
  background: string;
  grid: string;
  text: string;
  map: string;
  trails: string;
  truth: string;
  picked: string;
  ruler: string;
  runs: string[];
  series: string[];   // of one plot, after the first
  states: Record<string, string>;
}

// Darkened where the original is too pale on white.
const LIGHT: Palette = {
  background: "#ffffff", grid: "#dde1e6", text: "#57606a", map: "#1b1f23", trails: "#d55e00", truth: "#009e73", picked: "#c2185b", ruler: "#008fa3",
  runs: ["#0072b2", "#c77f00", "#b0548a", "#2f93cc", "#8f8700", "#57606a", "#7a4fb5", "#00796b", "#a13d00"],
  series: ["#00805d", "#b0548a", "#57606a", "#d55e00", "#2f93cc", "#8f8700", "#7a4fb5"],
  states: { tracking: "#0072b2", provisional: "#56b4e9", lost: "#d55e00", initializing: "#8c959f", ambiguous: "#c77f00", waiting_for_reference: "#b0548a" },
};

const DARK: Palette = {
  background: "#101316", grid: "#2b3138", text: "#9aa4ae", map: "#b9c0c7", trails: "#e8721c", truth: "#1fbf92", picked: "#ff79b0", ruler: "#22e6f2",
  runs: ["#56b4e9", "#e69f00", "#cc79a7", "#4a90d9", "#f0e442", "#9aa4ae", "#b39ddb", "#4db6ac", "#ff8a50"],
  series: ["#1fbf92", "#cc79a7", "#9aa4ae", "#e8721c", "#4a90d9", "#f0e442", "#b39ddb"],
  states: { tracking: "#3d9bd6", provisional: "#9fd3f5", lost: "#e8721c", initializing: "#7d8894", ambiguous: "#e69f00", waiting_for_reference: "#cc79a7" },
};

export function paletteOf(dark: boolean): Palette {
  return dark ? DARK : LIGHT;
}

export function runColor(dark: boolean, run: number): string {
  const { runs } = paletteOf(dark);
  return runs[run % runs.length];
}

const VIRIDIS = [
  0x440154, 0x481a6c, 0x472f7d, 0x414487, 0x39568c, 0x31688e, 0x2a788e, 0x23888e, 0x1f988b, 0x22a884, 0x35b779, 0x54c568, 0x7ad151,
  0xa5db36, 0xd2e21b, 0xfde725,
];
// Moreland's, whose gray middle is 0.
const COOL_TO_WARM = [
  0x3b4cc0, 0x4d68d7, 0x6282ea, 0x779af7, 0x8db0fe, 0xa3c2ff, 0xb8d0f9, 0xccd9ee, 0xdddddd, 0xecd3c5, 0xf5c4ad, 0xf7b194, 0xf49a7b,
  0xec7f63, 0xde604d, 0xcb3e38, 0xb40426,
];
const STOPS = { viridis: VIRIDIS, diverging: COOL_TO_WARM };
export type ColorMap = keyof typeof STOPS;

const LEVELS = 65;   // odd: one of them is the middle
const TABLES: Record<ColorMap, number[]> = { viridis: tableOf(VIRIDIS), diverging: tableOf(COOL_TO_WARM) };

function tableOf(stops: number[]): number[] {
  return Array.from({ length: LEVELS }, (_, level) => {
    const at = (level / (LEVELS - 1)) * (stops.length - 1);
    const index = Math.min(Math.floor(at), stops.length - 2);
    const mix = (shift: number) => {
      const from = (stops[index] >> shift) & 255;
      const to = (stops[index + 1] >> shift) & 255;
      return Math.round(from + (to - from) * (at - index)) << shift;
    };
    return mix(16) | mix(8) | mix(0);
  });
}
const UNKNOWN = 0x8c959f;

// The mode in which runs are told apart; it is there where there are several.
export const BY_RUN = "run";

export interface Mode {
  name: string;
  label: string;
  unit: string;
  value: ((run: Run, observation: number) => number) | null;   // null: the point's own color, or its run's
}

export function colorModes(report: Report): Mode[] {
  const { unit } = report;
  const modes: Mode[] = [
    ...(report.runs.length > 1 ? [{ name: BY_RUN, label: "run", unit: "", value: null }] : []),
    { name: "age", label: "age", unit: "frames", value: (run, o) => run.age(o) },
    { name: "residual", label: "reprojection error", unit: "px", value: (run, o) => run.reprojection.values[o] },
    { name: "depth", label: "depth", unit, value: (run, o) => run.depth.values[o] },
    { name: "deformation", label: "deformation", unit, value: (run, o) => run.deformation(o) },
    { name: "similarity", label: "similarity (SSIM)", unit: "", value: (run, o) => run.similarity.values[o] },
  ];
  if (report.runs.some((run) => run.sigma)) {
    modes.push({ name: "uncertainty", label: "uncertainty (1 sigma)", unit, value: (run, o) => run.sigma?.values[o] ?? NaN });
  }
  if (report.runs.some((run) => run.error)) {
    modes.push({ name: "error", label: "error against truth", unit: "mm", value: (run, o) => run.error?.values[o] ?? NaN });
  }
  modes.push({ name: "rgb", label: "own color", unit: "", value: null });
  return modes;
}

// A mode with its range: the 2nd to the 98th percentile over all observations of all runs, so that colors neither flicker from
// frame to frame nor differ between runs.
export class Coloring {
  private constructor(readonly mode: Mode, readonly low: number, readonly high: number, private readonly runs: Run[]) {}

  static of(mode: Mode, report: Report): Coloring {
    if (!mode.value) return new Coloring(mode, 0, 1, report.runs);
    const values: number[] = [];
    for (const run of report.runs) {
      const step = Math.max(1, Math.floor(run.observations / 20000));
      for (let o = 0; o < run.observations; o += step) {
        const value = mode.value(run, o);
        if (!Number.isNaN(value)) values.push(value);
      }
    }
    if (values.length === 0) return new Coloring(mode, NaN, NaN, report.runs);
    values.sort((a, b) => a - b);
    const low = values[Math.floor(0.02 * (values.length - 1))];
    const high = values[Math.ceil(0.98 * (values.length - 1))];
    return new Coloring(mode, low, high > low ? high : low + 1, report.runs);
  }

  color(run: Run, observation: number, dark: boolean): number {
    if (this.mode.name === BY_RUN) return numberOf(runColor(dark, this.runs.indexOf(run)));
    if (!this.mode.value) {
      const c = 3 * run.point.values[observation];
      const rgb = run.rgb.values;
      return Number.isNaN(rgb[c]) ? UNKNOWN : ((rgb[c] & 0xf8) << 16) | ((rgb[c + 1] & 0xf8) << 8) | (rgb[c + 2] & 0xf8);
    }
    return gradientColor(this.mode.value(run, observation), this.low, this.high);
  }
}

export function gradientColor(value: number, low: number, high: number, map: ColorMap = "viridis"): number {
  if (!(value === value)) return UNKNOWN;
  const level = Math.round(((value - low) / (high - low)) * (LEVELS - 1));
  return TABLES[map][level < 0 ? 0 : level >= LEVELS ? LEVELS - 1 : level] ?? UNKNOWN;
}

// Of "#rrggbb".
export function numberOf(color: string): number {
  return parseInt(color.slice(1), 16);
}

export function css(color: number): string {
  return `#${color.toString(16).padStart(6, "0")}`;
}

// Of CSS.
export function gradientOf(map: ColorMap): string {
  return `linear-gradient(to right, ${STOPS[map].map(css).join(", ")})`;
}
