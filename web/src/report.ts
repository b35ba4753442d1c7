// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The runs of the page and the time line that they share: the union of their frames. A position is an index into it.

import { type CameraData, type Data, DataError, type ImageData, type RunPart, decodePoses, decodeRun } from "./data";
import { Run } from "./run";

const SECONDS_A_FRAME = 1 / 30;  // where the times say nothing

export class Report {
  readonly title: string;
  readonly version: string;
  readonly unit: string;
  notes: string[];
  camera: CameraData = { width: 1, height: 1, corners: null };
  readonly runs: Run[] = [];
  truth: { frame: number[]; pose: Float32Array } | null = null;

  frames: number[] = [];
  times: number[] = [];
  // Of each run and position: the row of its frames, or -1.
  private rowAt: Int32Array[] = [];

  private constructor(data: Data) {
    this.title = data.title;
    this.version = data.version;
    this.unit = data.unit;
    this.notes = data.notes ?? [];
  }

  static async decode(data: Data): Promise<Report> {
    if (!data.runs?.length) throw new DataError("This report holds no run.");
    const report = new Report(data);
    for (const runData of data.runs) {
      const run = new Run();
      run.append(await decodeRun(runData));
      report.runs.push(run);
    }
    report.camera = data.camera ?? { ...report.extent(data.images), corners: null };
    if (data.truth) report.truth = { frame: data.truth.frame, pose: await decodePoses(data.truth.pose) };
    report.indexFrames();
    if (report.frames.length === 0) throw new DataError("No frame was read in these runs.");
    return report;
  }

  // Rows of the only run of a live view; `from` 0 restarts it.
  append(part: RunPart, from: number): void {
    if (from === 0) this.runs[0] = new Run();
    this.runs[0].append(part);
    this.indexFrames();
  }

  row(run: number, position: number): number {
    return this.rowAt[run]?.[position] ?? -1;
  }

  // The position of the frame, or of the last one before it.
  positionOf(frame: number): number {
    return Math.max(0, lastAtMost(this.frames, frame));
  }

  positionAtTime(time: number): number {
    return Math.max(0, lastAtMost(this.times, time));
  }

  // Of the camera's image, where the camera is not known.
  private extent(images: ImageData | null): { width: number; height: number } {
    if (images) return { width: images.width / images.scale, height: images.height / images.scale };
    let [width, height] = [1, 1];
    for (const { pixel, observations } of this.runs) {
      for (let o = 0; o < observations; ++o) {
        width = Math.max(width, pixel.values[2 * o] + 1);
        height = Math.max(height, pixel.values[2 * o + 1] + 1);
      }
    }
    return { width, height };
  }

  private indexFrames(): void {
    const timeOf = new Map<number, number>();
    for (const { frames } of this.runs) {
      frames.frame.forEach((frame, row) => timeOf.has(frame) || timeOf.set(frame, frames.time[row]));
    }
    this.frames = [...timeOf.keys()].sort((a, b) => a - b);
    this.times = this.frames.map((frame) => timeOf.get(frame) ?? NaN);
    if (this.times.some((time, i) => !(i === 0 ? time >= -Infinity : time > this.times[i - 1]))) {
      this.times = this.frames.map((frame) => frame * SECONDS_A_FRAME);
    }
    const positions = new Map(this.frames.map((frame, position) => [frame, position]));
    this.rowAt = this.runs.map(({ frames }) => {
      const rows = new Int32Array(this.frames.length).fill(-1);
      frames.frame.forEach((frame, row) => { rows[positions.get(frame)!] = row; });
      return rows;
    });
  }
}

// The index of the last number that is at most `value`, of numbers that grow; -1 where there is none.
export function lastAtMost(numbers: number[], value: number): number {
  let low = 0;
  let high = numbers.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}
