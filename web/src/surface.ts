// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A mesh of the tissue that a run has seen, where it is in a frame, and the figures that it can be colored by.

import type { ColorMap } from "./colors";

export const SURFACE_COLORS = ["image", "displacement", "area_change", "uncertainty", "error"] as const;
export type SurfaceColor = (typeof SURFACE_COLORS)[number];

// A change of area has a sign.
export function colorMapOf(color: SurfaceColor): ColorMap {
  return color === "area_change" ? "diverging" : "viridis";
}

export interface SurfaceArrays {
  rest: Float32Array;             // x y z, undeformed
  triangles: Uint32Array;         // three vertices
  uv: Float32Array;
  sigma: Float32Array;            // standard deviation of the distance from the camera
  displacements: Float32Array[];  // of each key, from the undeformed positions
  texture: Uint8Array<ArrayBuffer> | null;   // a JPEG file
  errors: Float32Array[];         // of each key, from the true surface; NaN: not seen, or not known; none: there is no truth
}

export interface Range {
  low: number;
  high: number;
}

export class Surface {
  // The triangles without the seams of the texture, at which a vertex is there once for each side: of these the first.
  readonly seamless: Uint32Array;
  private readonly ranges = new Map<SurfaceColor, Range>();

  // `frames`: those of the keys, which grow. `gaps`: the frames before and after frames that have no surface.
  constructor(readonly submap: number, readonly frames: number[], readonly arrays: SurfaceArrays, private readonly gaps: [number, number][] = []) {
    const { rest, triangles } = arrays;
    const first = new Map<string, number>();
    this.seamless = triangles.map((v) => {
      const place = rest.subarray(3 * v, 3 * v + 3).join();
      if (!first.has(place)) first.set(place, v);
      return first.get(place)!;
    });
  }

  get vertices(): number {
    return this.arrays.rest.length / 3;
  }

  // Whether it is known where it is in the frame: from the first key to the last, but not in gaps; and without keys in every frame.
  isKnownIn(frame: number): boolean {
    const { frames } = this;
    if (this.gaps.some(([last, next]) => last < frame && frame < next)) return frames.length === 0;
    return frames.length === 0 || (frames[0] <= frame && frame <= frames[frames.length - 1]);
  }

  // In a frame in which it is known. Between two keys a vertex moves evenly.
  positionsAt(frame: number): Float32Array {
    const { rest, displacements } = this.arrays;
    const positions = rest.slice();
    if (displacements.length === 0) return positions;
    const { before, after, share } = this.keysAround(frame);
    for (let i = 0; i < positions.length; ++i) {
      positions[i] += (1 - share) * displacements[before][i] + share * displacements[after][i];
    }
    return positions;
  }

  // One a vertex, where it is in the frame.
  values(color: SurfaceColor, frame: number, positions: Float32Array): Float32Array {
    if (color === "uncertainty") return this.arrays.sigma;
    if (color === "error") return this.errorsAt(frame);
    return color === "displacement" ? this.displacementsOf(positions) : this.areaChangesOf(positions);
  }

  // Of the colors, the same in all frames: up to the 98th percentile over the keys; of a change, as far to both sides.
  range(color: SurfaceColor): Range {
    const known = this.ranges.get(color);
    if (known) return known;
    const values: number[] = [];
    const step = Math.max(1, Math.floor((this.vertices * Math.max(1, this.frames.length)) / 100000));
    for (const frame of this.frames.length > 0 && color !== "uncertainty" ? this.frames : [0]) {
      const all = this.values(color, frame, this.positionsAt(frame));
      for (let v = 0; v < all.length; v += step) if (Number.isFinite(all[v])) values.push(Math.abs(all[v]));
    }
    values.sort((a, b) => a - b);
    const high = values[Math.ceil(0.98 * (values.length - 1))] || 1;
    const range = { low: color === "area_change" ? -high : 0, high };
    this.ranges.set(color, range);
    return range;
  }

  // The two keys around a frame, and the share of the later one; where they lie on both sides of a gap, the key on the frame's own side.
  private keysAround(frame: number): { before: number; after: number; share: number } {
    let next = this.frames.findIndex((key) => key > frame);
    if (next < 0) next = this.frames.length;
    const before = Math.max(0, next - 1);
    const after = Math.min(next, this.frames.length - 1);
    const gap = this.gaps.find(([last, next]) => this.frames[before] <= last && next <= this.frames[after]);
    if (gap) {
      const own = frame <= gap[0] ? before : after;
      return { before: own, after: own, share: 0 };
    }
    const length = this.frames[after] - this.frames[before];
    return { before, after, share: length > 0 ? (frame - this.frames[before]) / length : 0 };
  }

  // Between two keys they change evenly, where both know them.
  private errorsAt(frame: number): Float32Array {
    const { errors } = this.arrays;
    if (errors.length === 0) return new Float32Array(this.vertices).fill(NaN);
    const { before, after, share } = this.keysAround(frame);
    return share === 0 ? errors[before] : errors[before].map((error, v) => (1 - share) * error + share * errors[after][v]);
  }

  private displacementsOf(positions: Float32Array): Float32Array {
    const { rest } = this.arrays;
    return Float32Array.from({ length: this.vertices }, (_, v) => {
      const i = 3 * v;
      return Math.hypot(positions[i] - rest[i], positions[i + 1] - rest[i + 1], positions[i + 2] - rest[i + 2]);
    });
  }

  // Area of the triangles around a vertex by that of the undeformed ones, minus 1.
  private areaChangesOf(positions: Float32Array): Float32Array {
    const { rest } = this.arrays;
    const triangles = this.seamless;
    const before = new Float32Array(this.vertices);
    const after = new Float32Array(this.vertices);
    for (let t = 0; t < triangles.length; t += 3) {
      const [a, b, c] = triangles.subarray(t, t + 3);
      const areaBefore = areaOf(rest, a, b, c);
      const areaAfter = areaOf(positions, a, b, c);
      for (const v of [a, b, c]) {
        before[v] += areaBefore;
        after[v] += areaAfter;
      }
    }
    return after.map((area, v) => (before[v] > 0 ? area / before[v] - 1 : NaN));
  }
}

// Twice it.
function areaOf(positions: Float32Array, a: number, b: number, c: number): number {
  const side = (from: number, to: number, axis: number) => positions[3 * to + axis] - positions[3 * from + axis];
  const x = side(a, b, 1) * side(a, c, 2) - side(a, b, 2) * side(a, c, 1);
  const y = side(a, b, 2) * side(a, c, 0) - side(a, b, 0) * side(a, c, 2);
  const z = side(a, b, 0) * side(a, c, 1) - side(a, b, 1) * side(a, c, 0);
  return Math.hypot(x, y, z);
}
