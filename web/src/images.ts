// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The frames' images, decoded when they are needed; the ones used last are kept.

import { type ImageData, bytesOfBase64 } from "./data";
import { lastAtMost } from "./report";

const KEPT = 60;

type Source = (frame: number) => Promise<Blob | null>;

export class Images {
  // Told when an image that was asked for is there.
  onLoad: () => void = () => {};
  // A Map keeps the order of insertion, which is that of use: undefined is being decoded, null is not to be had.
  private readonly kept = new Map<number, ImageBitmap | null | undefined>();

  private constructor(private readonly source: Source, public listed: number[], public scale: number) {}

  static embedded(data: ImageData): Images {
    const index = new Map(data.frame.map((frame, i) => [frame, i]));
    const source: Source = async (frame) => new Blob([bytesOfBase64(data.jpeg[index.get(frame)!])], { type: "image/jpeg" });
    return new Images(source, data.frame, data.scale);
  }

  static served(frames: number[], scale: number): Images {
    return new Images(async (frame) => {
      const answer = await fetch(`/image/${frame}.jpg`);
      return answer.ok ? answer.blob() : null;
    }, frames, scale);
  }

  // The frame whose image stands for this one: the last before it that has one.
  frameFor(frame: number): number | null {
    const index = lastAtMost(this.listed, frame);
    return index < 0 ? null : this.listed[index];
  }

  // The image if it is there already; if not, it is on its way (undefined) or not to be had (null).
  get(frame: number): ImageBitmap | null | undefined {
    if (!this.kept.has(frame)) {
      void this.load(frame);
      return undefined;
    }
    const image = this.kept.get(frame);
    this.kept.delete(frame);
    this.kept.set(frame, image);
    return image;
  }

  // Starts on the images that come after this frame.
  prefetch(frame: number, count: number): void {
    const index = lastAtMost(this.listed, frame);
    for (const next of this.listed.slice(index + 1, index + 1 + count)) if (!this.kept.has(next)) void this.load(next);
  }

  private async load(frame: number): Promise<void> {
    this.kept.set(frame, undefined);
    let image: ImageBitmap | null = null;
    try {
      const blob = await this.source(frame);
      if (blob) image = await createImageBitmap(blob);
    } catch {
      // Null says it: there is no image.
    }
    this.kept.set(frame, image);
    for (const oldest of this.kept.keys()) {
      if (this.kept.size <= KEPT) break;
      this.kept.delete(oldest);
    }
    this.onLoad();
  }
}
