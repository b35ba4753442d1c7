// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What the page is given (web/README.md), and its packed arrays decoded.

import { Surface } from "./surface";

export const FORMAT = 1;

// A sentence for the reader of the page.
export class DataError extends Error {}

export type Column = (number | null)[];

export interface PackedArray {
  type: "u8" | "u16" | "u32" | "f32";
  rows: number;
  columns: number;
  low?: number[];
  step?: number[];
  delta?: boolean;
  data: string;
}

export interface FrameData {
  frame: number[];
  time: number[];
  state: string[];
  submap: number[];
  note: Record<string, string>;
  tracked: Column;
  optimized: Column;
  lost: Column;
  added: Column;
  reprojection_px: Column;
  costs: Record<string, Column>;
  stages_ms: Record<string, Column>;
  errors: Record<string, Column>;
  scale: Column | null;
  pose: PackedArray;
}

// A mesh of the surface: its undeformed vertices, and what they are displaced by in some of the frames.
export interface MeshData {
  submap: number;
  rest: PackedArray;
  triangles: PackedArray;
  uv: PackedArray;        // from the texture's upper left corner
  sigma: PackedArray;
  texture: string | null; // a JPEG file in base64
  frame: number[];
  gaps?: [number, number][];         // the frames before and after frames that have none
  displacement: PackedArray[];
  error_mm?: PackedArray[] | null;   // one a frame: distances from the true surface
}

export interface RunData {
  name: string;
  unit: string;
  status: string;
  note: string;
  figures: [string, string, string][];
  options: [string, string][];
  frames: FrameData;
  points: { id: PackedArray; rest: PackedArray; rgb: PackedArray };
  observations: {
    count: number[];
    row: PackedArray;
    pixel: PackedArray;
    position: PackedArray;
    depth: PackedArray;
    reprojection_px: PackedArray;
    ssim: PackedArray;
    sigma: PackedArray | null;
    gain: PackedArray | null;
    bias: PackedArray | null;
    truth: PackedArray | null;
    error_mm: PackedArray | null;
  };
  meshes?: MeshData[];
}

export interface CameraData {
  width: number;
  height: number;
  corners: [number, number, number][] | null;
}

export interface ImageData {
  width: number;
  height: number;
  scale: number;
  frame: number[];
  jpeg: string[];
}

export interface Data {
  format: number;
  version: string;
  title: string;
  live: boolean;
  unit: string;
  notes: string[];
  camera: CameraData | null;
  images: ImageData | null;
  truth: { frame: number[]; pose: PackedArray } | null;
  runs: RunData[];
}

// A run, or in a live view the rows of it that are new. Arrays of n columns are interleaved.
export interface RunPart {
  data: RunData;
  pose: Float32Array;
  id: Uint32Array;
  rest: Float32Array;
  rgb: Float32Array;
  row: Uint32Array;
  pixel: Float32Array;
  position: Float32Array;
  depth: Float32Array;
  reprojection: Float32Array;
  similarity: Float32Array;
  sigma: Float32Array | null;
  gain: Float32Array | null;
  bias: Float32Array | null;
  truth: Float32Array | null;
  error: Float32Array | null;
  surfaces: Surface[];
}

export function checkFormat(data: Partial<Data>): void {
  if (data.format === FORMAT) return;
  throw new DataError(`This page reads format ${FORMAT} of the data, and these are of format ${data.format ?? "unknown"}: ` +
    "make the report again with one version of Pliant.");
}

export function decodeRun(data: RunData): Promise<RunPart> {
  const { frames, points, observations } = data;
  return orDamaged(`the run "${data.name}"`, async () => ({
    data,
    pose: await decodeNumbers(frames.pose, 7),
    id: await decodeIntegers(points.id),
    rest: await decodeNumbers(points.rest, 3),
    rgb: await decodeNumbers(points.rgb, 3),
    row: await decodeIntegers(observations.row),
    pixel: await decodeNumbers(observations.pixel, 2),
    position: await decodeNumbers(observations.position, 3),
    depth: await decodeNumbers(observations.depth, 1),
    reprojection: await decodeNumbers(observations.reprojection_px, 1),
    similarity: await decodeNumbers(observations.ssim, 1),
    sigma: observations.sigma && await decodeNumbers(observations.sigma, 1),
    gain: observations.gain && await decodeNumbers(observations.gain, 1),
    bias: observations.bias && await decodeNumbers(observations.bias, 1),
    truth: observations.truth && await decodeNumbers(observations.truth, 3),
    error: observations.error_mm && await decodeNumbers(observations.error_mm, 1),
    surfaces: await Promise.all((data.meshes ?? []).map(decodeMesh)),
  }));
}

async function decodeMesh(data: MeshData): Promise<Surface> {
  return new Surface(data.submap, data.frame, {
    rest: await decodeNumbers(data.rest, 3),
    triangles: Uint32Array.from(await decodeNumbers(data.triangles, 3)),
    uv: await decodeNumbers(data.uv, 2),
    sigma: await decodeNumbers(data.sigma, 1),
    displacements: await Promise.all(data.displacement.map((array) => decodeNumbers(array, 3))),
    errors: await Promise.all((data.error_mm ?? []).map((array) => decodeNumbers(array, 1))),
    texture: data.texture === null ? null : bytesOfBase64(data.texture),
  }, data.gaps ?? []);
}

export function decodePoses(poses: PackedArray): Promise<Float32Array> {
  return orDamaged("the true camera path", () => decodeNumbers(poses, 7));
}

async function orDamaged<T>(what: string, decode: () => Promise<T>): Promise<T> {
  try {
    return await decode();
  } catch (error) {
    if (error instanceof DataError) throw error;
    throw new DataError(`The data of ${what} are damaged (${(error as Error).message}): make the report again.`);
  }
}

async function decodeNumbers(array: PackedArray, columns: number): Promise<Float32Array> {
  if (array.columns !== columns) throw new Error(`${array.columns} columns instead of ${columns}`);
  const { low, step } = array;
  const numbers = new Float32Array(array.rows * columns);
  const none = 2 ** (8 * bytesOf(array)) - 1;
  await eachColumn(array, (column, bits) => {
    if (array.type === "f32") {
      const floats = new Float32Array(bits.buffer);
      for (let row = 0; row < floats.length; ++row) numbers[row * columns + column] = floats[row];
    } else if (low && step) {
      for (let row = 0; row < bits.length; ++row) {
        numbers[row * columns + column] = bits[row] === none ? NaN : low[column] + step[column] * bits[row];
      }
    } else {
      for (let row = 0; row < bits.length; ++row) numbers[row * columns + column] = bits[row];
    }
  });
  return numbers;
}

async function decodeIntegers(array: PackedArray): Promise<Uint32Array> {
  const integers = new Uint32Array(array.rows);
  await eachColumn(array, (_, bits) => integers.set(bits));
  return integers;
}

async function eachColumn(array: PackedArray, use: (column: number, bits: Uint32Array) => void): Promise<void> {
  const { rows, columns } = array;
  const size = bytesOf(array);
  const bytes = await inflate(array.data);
  if (bytes.length !== rows * columns * size) {
    throw new Error(`${bytes.length} bytes instead of ${rows * columns * size}`);
  }
  const mask = 2 ** (8 * size) - 1;
  const bits = new Uint32Array(rows);
  for (let column = 0; column < columns; ++column) {
    bits.fill(0);
    for (let plane = 0; plane < size; ++plane) {
      const begin = (column * size + plane) * rows;
      for (let row = 0; row < rows; ++row) bits[row] |= bytes[begin + row] << (8 * plane);
    }
    if (array.delta) {
      for (let row = 1; row < rows; ++row) bits[row] = (bits[row] + bits[row - 1]) & mask;
    }
    use(column, bits);
  }
}

function bytesOf(array: PackedArray): number {
  const size = { u8: 1, u16: 2, u32: 4, f32: 4 }[array.type];
  if (!size) throw new Error(`an array of the unknown type ${array.type}`);
  return size;
}

async function inflate(base64: string): Promise<Uint8Array> {
  if (typeof DecompressionStream === "undefined") {
    throw new DataError("This browser cannot decompress data (DecompressionStream): open the report in one of 2023 or later.");
  }
  const stream = new Blob([bytesOfBase64(base64)]).stream().pipeThrough(new DecompressionStream("deflate"));
  try {
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw new Error("an array cannot be decompressed");
  }
}

export function bytesOfBase64(base64: string): Uint8Array<ArrayBuffer> {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}
