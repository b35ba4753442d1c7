// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A ruler from the picked point to the measured one, of the current run: what a pick does to it, and what it reads.

import { short } from "./dom";
import type { Page } from "./page";
import type { Run } from "./run";
import type { State } from "./state";

export type End = "picked" | "measured";

// What it reads in a frame in which both ends were seen. Lengths are in the report's unit.
export interface Reading {
  ends: [number, number];   // observations: the picked point's, the measured one's
  distance: number;
  sigma: number;            // standard deviation of the distance; NaN: that of an end is not known
}

// The end that the next pick sets. There is no second end without a first one.
export function endOfPick({ picked, measuring }: Readonly<State>, wanted: End): End {
  if (picked === null) return "picked";
  return measuring ? "measured" : wanted;
}

// What a pick of this point changes.
export function changeOfPick(state: Readonly<State>, id: number, wanted: End): Partial<State> {
  if (endOfPick(state, wanted) === "measured") return id === state.picked ? {} : { measured: id, measuring: false };
  return { picked: id, measured: id === state.measured ? null : state.measured };
}

// What the escape key changes: it takes away what was added last.
export function changeOfEscape({ measured, measuring }: Readonly<State>): Partial<State> {
  if (measuring) return { measuring: false };
  return measured === null ? { picked: null } : { measured: null };
}

// By row, in order of time.
export function readingsOf(run: Run, picked: number | null, measured: number | null): Map<number, Reading> {
  const readings = new Map<number, Reading>();
  const other = new Map(observationsOf(run, measured).map((o) => [run.row.values[o], o]));
  for (const o of observationsOf(run, picked)) {
    const row = run.row.values[o];
    const end = other.get(row);
    const reading = end === undefined ? null : readingOf(run, o, end);
    if (reading) readings.set(row, reading);
  }
  return readings;
}

// Of the current frame.
export function readingNow(page: Page): Reading | null {
  const { picked, measured, current, position } = page.store.state;
  const run = page.report.runs[current];
  const row = page.report.row(current, position);
  const [from, to] = [picked, measured].map((id) => (id === null ? undefined : run.observationOf(id, row)));
  return from === undefined || to === undefined ? null : readingOf(run, from, to);
}

// "12.34 ± 0.21 mm", "12.3 mm"
export function lengthText({ distance, sigma }: Reading, unit: string): string {
  if (!(sigma > 0)) return `${short(distance)} ${unit}`;
  const decimals = Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(sigma))));
  return `${distance.toFixed(decimals)} ± ${sigma.toFixed(decimals)} ${unit}`;
}

// The change of the distance since then; not a number where it was nothing then.
export function percentOf(reading: Reading, first: Reading): number {
  return first.distance > 0 ? 100 * (reading.distance / first.distance - 1) : NaN;
}

// Where a label at the middle of the ruler, to the right of it, does not cross it: above, or below a ruler that rises to the right.
export function sideOfLabel([x0, y0]: number[], [x1, y1]: number[]): 1 | -1 {
  return (x1 - x0) * (y1 - y0) < 0 ? 1 : -1;
}

function observationsOf(run: Run, id: number | null): number[] {
  const point = id === null ? undefined : run.pointWithId(id);
  return point === undefined ? [] : run.observationsOfPoint(point);
}

// Null where an end has no position.
function readingOf(run: Run, from: number, to: number): Reading | null {
  const distance = distanceOf(pointOf(run, from), pointOf(run, to));
  return Number.isNaN(distance) ? null : { ends: [from, to], distance, sigma: sigmaOf(run, from, to, distance) };
}

// The uncertainty of an end is that of its distance from the camera: it lies along its ray. The two are taken as independent. The
// root mean square of d(s_1, s_2) - d, where each end is moved by its own standard deviation along its ray, away from the camera or
// toward it, s = +1 or -1: what first-order propagation gives where sigmas are small against d, and more where the ends
// lie across their rays, where the first order vanishes.
function sigmaOf(run: Run, from: number, to: number, distance: number): number {
  const [firsts, seconds] = [from, to].map((o) => [-1, 1].map((sign) => movedAlongRay(run, o, sign)));
  const squares = firsts.flatMap((a) => seconds.map((b) => (distanceOf(a, b) - distance) ** 2));
  return Math.sqrt(squares.reduce((sum, square) => sum + square, 0) / squares.length);
}

// Not a number where the pose or the point's sigma is not known.
function movedAlongRay(run: Run, o: number, sigmas: number): number[] {
  const row = run.row.values[o];
  const camera = [4, 5, 6].map((column) => run.pose.values[7 * row + column]);
  const point = pointOf(run, o);
  const part = (sigmas * (run.sigma?.values[o] ?? NaN)) / distanceOf(camera, point);
  return point.map((x, axis) => x + part * (x - camera[axis]));
}

function pointOf(run: Run, o: number): number[] {
  return [...run.position.values.subarray(3 * o, 3 * o + 3)];
}

function distanceOf(a: number[], b: number[]): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}
