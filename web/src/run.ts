// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One run in columns, one entry an observation, with the indexes that the views need: from a row to its observations, from an
// observation to the one before of the same point. Rows are only ever appended.

import type { FrameData, RunPart } from "./data";
import type { Surface } from "./surface";

type Numbers = Float32Array | Uint32Array | Int32Array;

export class Growing<T extends Numbers> {
  length = 0;
  // Longer than `length`.
  constructor(public values: T) {}

  append(more: ArrayLike<number>): void {
    this.reserve(this.length + more.length);
    this.values.set(more, this.length);
    this.length += more.length;
  }

  push(value: number): void {
    this.reserve(this.length + 1);
    this.values[this.length++] = value;
  }

  private reserve(length: number): void {
    if (length <= this.values.length) return;
    const grown = new (this.values.constructor as new (length: number) => T)(this.length ? Math.max(length, 2 * this.length) : length);
    grown.set(this.values.subarray(0, this.length));
    this.values = grown;
  }
}

const floats = () => new Growing(new Float32Array(0));
const integers = () => new Growing(new Uint32Array(0));
const indexes = () => new Growing(new Int32Array(0));

const FRAME_COLUMNS = ["tracked", "optimized", "lost", "added", "reprojection_px"] as const;
const FRAME_GROUPS = ["costs", "stages_ms", "errors"] as const;

export class Run {
  name = "";
  unit = "";
  status = "";
  note = "";
  figures: [string, string, string][] = [];
  options: [string, string][] = [];
  surfaces: Surface[] = [];

  frames: Omit<FrameData, "pose"> = emptyFrames();
  pose = floats();

  id = integers();
  rest = floats();
  rgb = floats();
  // Of each point: the row that saw it first, its newest observation (-1: none) and how many it has.
  first = integers();
  newest = indexes();
  count = integers();

  point = integers();
  row = integers();
  pixel = floats();
  position = floats();
  depth = floats();
  reprojection = floats();
  similarity = floats();
  sigma: Growing<Float32Array> | null = null;   // standard deviation of the distance from the camera
  gain: Growing<Float32Array> | null = null;
  bias: Growing<Float32Array> | null = null;
  truth: Growing<Float32Array> | null = null;
  error: Growing<Float32Array> | null = null;
  // The observation before of the same point, or -1.
  previous = indexes();

  private readonly pointOfId = new Map<number, number>();
  private readonly byRow = integers();
  private readonly rowEnd = integers();

  get rows(): number {
    return this.frames.frame.length;
  }

  get observations(): number {
    return this.row.length;
  }

  observationsOfRow(row: number): Uint32Array {
    if (row < 0) return new Uint32Array(0);
    return this.byRow.values.subarray(row > 0 ? this.rowEnd.values[row - 1] : 0, this.rowEnd.values[row]);
  }

  pointWithId(id: number): number | undefined {
    return this.pointOfId.get(id);
  }

  // Of the point with this id in this row.
  observationOf(id: number, row: number): number | undefined {
    const point = this.pointOfId.get(id);
    return this.observationsOfRow(row).find((o) => this.point.values[o] === point);
  }

  // In order of time.
  observationsOfPoint(point: number): number[] {
    const found = [];
    for (let o = this.newest.values[point]; o >= 0; o = this.previous.values[o]) found.push(o);
    return found.reverse();
  }

  // In one sentence, of a run that has no frame with a pose; else nothing.
  whyNothing(): string {
    for (let row = 0; row < this.rows; ++row) if (this.hasPose(row)) return "";
    return `The run "${this.name}" has no tracked frame${this.note ? `: ${this.note}` : ""}.`;
  }

  hasPose(row: number): boolean {
    return row >= 0 && !Number.isNaN(this.pose.values[7 * row]);
  }

  age(observation: number): number {
    const { frame } = this.frames;
    return frame[this.row.values[observation]] - frame[this.first.values[this.point.values[observation]]];
  }

  deformation(observation: number): number {
    const p = 3 * observation;
    const r = 3 * this.point.values[observation];
    const position = this.position.values;
    const rest = this.rest.values;
    return Math.hypot(position[p] - rest[r], position[p + 1] - rest[r + 1], position[p + 2] - rest[r + 2]);
  }

  // Seen here for the last time, though the run goes on.
  isLost(observation: number): boolean {
    return this.newest.values[this.point.values[observation]] === observation && this.row.values[observation] < this.rows - 1;
  }

  // Not seen in the row before, but earlier.
  isReturned(observation: number): boolean {
    const previous = this.previous.values[observation];
    return previous >= 0 && this.row.values[previous] < this.row.values[observation] - 1;
  }

  append(part: RunPart): void {
    const from = this.rows;
    const { name, unit, status, note, figures, options } = part.data;
    Object.assign(this, { name, unit, status, note, figures, options });
    if (part.surfaces.length > 0) this.surfaces = part.surfaces;
    this.appendFrames(part, from);
    this.appendPoints(part);
    this.appendObservations(part, from);
  }

  private appendFrames(part: RunPart, from: number): void {
    const frames = this.frames;
    const more = part.data.frames;
    const rows = from + more.frame.length;
    for (const name of ["frame", "time", "state", "submap"] as const) extend(frames[name] as unknown[], more[name], from, rows);
    for (const name of FRAME_COLUMNS) extend(frames[name], more[name], from, rows);
    for (const group of FRAME_GROUPS) {
      for (const name of Object.keys(more[group] ?? {})) frames[group][name] ??= [];
      for (const name of Object.keys(frames[group])) extend(frames[group][name], more[group]?.[name], from, rows);
    }
    if (more.scale) frames.scale ??= [];
    if (frames.scale) extend(frames.scale, more.scale, from, rows);
    for (const [row, note] of Object.entries(more.note ?? {})) frames.note[from + Number(row)] = note;
    this.pose.append(part.pose);
  }

  private appendPoints(part: RunPart): void {
    for (let i = 0; i < part.id.length; ++i) {
      const known = this.pointOfId.get(part.id[i]);
      const point = known ?? this.id.length;
      if (known === undefined) {
        this.pointOfId.set(part.id[i], point);
        this.id.push(part.id[i]);
        this.first.push(0xffffffff);
        this.newest.push(-1);
        this.count.push(0);
        this.rest.append(part.rest.subarray(3 * i, 3 * i + 3));
        this.rgb.append(part.rgb.subarray(3 * i, 3 * i + 3));
      } else {
        this.rest.values.set(part.rest.subarray(3 * i, 3 * i + 3), 3 * point);
        this.rgb.values.set(part.rgb.subarray(3 * i, 3 * i + 3), 3 * point);
      }
    }
  }

  private appendObservations(part: RunPart, from: number): void {
    const begin = this.observations;
    const size = part.row.length;
    const points = new Uint32Array(size);
    const previous = new Int32Array(size);
    const rows = part.row.map((row) => from + row);
    let o = 0;
    part.data.observations.count.forEach((count, i) => {
      const point = this.pointOfId.get(part.id[i])!;
      if (count > 0 && this.newest.values[point] < 0) this.first.values[point] = rows[o];
      for (const end = o + count; o < end; ++o) {
        points[o] = point;
        previous[o] = this.newest.values[point];
        this.newest.values[point] = begin + o;
      }
      this.count.values[point] += count;
    });
    if (o !== size) throw new Error(`${size} observations, but their points have ${o}`);

    this.point.append(points);
    this.previous.append(previous);
    this.row.append(rows);
    this.pixel.append(part.pixel);
    this.position.append(part.position);
    this.depth.append(part.depth);
    this.reprojection.append(part.reprojection);
    this.similarity.append(part.similarity);
    this.sigma = appendOptional(this.sigma, part.sigma, begin, size);
    this.gain = appendOptional(this.gain, part.gain, begin, size);
    this.bias = appendOptional(this.bias, part.bias, begin, size);
    this.truth = appendOptional(this.truth, part.truth, 3 * begin, 3 * size);
    this.error = appendOptional(this.error, part.error, begin, size);
    this.indexRows(part.row, part.data.frames.frame.length, begin);
  }

  // A counting sort of the new observations by their row.
  private indexRows(rowOfPart: Uint32Array, rows: number, begin: number): void {
    const end = new Uint32Array(rows + 1);
    for (const row of rowOfPart) ++end[row + 1];
    for (let row = 0; row < rows; ++row) end[row + 1] += end[row];
    const sorted = new Uint32Array(rowOfPart.length);
    const next = end.slice();
    for (let i = 0; i < rowOfPart.length; ++i) sorted[next[rowOfPart[i]]++] = begin + i;
    this.byRow.append(sorted);
    this.rowEnd.append(end.subarray(1).map((value) => begin + value));
  }
}

function emptyFrames(): Omit<FrameData, "pose"> {
  return {
    frame: [], time: [], state: [], submap: [], note: {}, tracked: [], optimized: [], lost: [], added: [], reprojection_px: [],
    costs: {}, stages_ms: {}, errors: {}, scale: null,
  };
}

// Writes the rows from `from` on; those that nothing is known of are null.
function extend(column: unknown[], more: unknown[] | null | undefined, from: number, rows: number): void {
  for (let row = column.length; row < rows; ++row) column.push(row < from ? null : more?.[row - from] ?? null);
}

function appendOptional(column: Growing<Float32Array> | null, more: Float32Array | null, begin: number,
                        size: number): Growing<Float32Array> | null {
  if (!column && !more) return null;
  if (!column) {
    column = floats();
    column.append(new Float32Array(begin).fill(NaN));
  }
  column.append(more ?? new Float32Array(size).fill(NaN));
  return column;
}
