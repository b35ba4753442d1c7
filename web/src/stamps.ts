// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Marks on an image with a dark rim. Each shape and color is drawn once and then copied: thousands of paths a frame are slow,
// and very slow where there is no GPU.

import { css } from "./colors";

const RADIUS_PX = 3;
const SIZE_PX = 14;
const SLOTS = 24;   // a side of the sheet
const RIM = "rgba(0, 0, 0, 0.6)";
const LABEL_FONT = "600 13px system-ui, sans-serif";
const LABEL_GAP_PX = 10;   // from the text's middle line to the edge

export const STAMPS = ["dot", "cross", "ring", "square", "triangle", "diamond"] as const;
export type Stamp = (typeof STAMPS)[number];

// Larger than a dot, whose corners they show under it: runs often have points at the same pixels.
const CORNERS: Record<"square" | "triangle" | "diamond", [number, number][]> = {
  square: [[-4.2, -4.2], [4.2, -4.2], [4.2, 4.2], [-4.2, 4.2]],
  triangle: [[0, -6.2], [5.6, 3.8], [-5.6, 3.8]],
  diamond: [[0, -6], [6, 0], [0, 6], [-6, 0]],
};

export class Stamps {
  private readonly sheet = document.createElement("canvas");
  private readonly slots = new Map<number, number>();
  private ratio = 0;

  draw(context: CanvasRenderingContext2D, x: number, y: number, color: number, stamp: Stamp): void {
    if (this.ratio !== window.devicePixelRatio) this.clear();
    const key = color + STAMPS.indexOf(stamp) * 0x1000000;
    const slot = this.slots.get(key) ?? this.make(key, color, stamp);
    const side = SIZE_PX * this.ratio;
    context.drawImage(this.sheet, (slot % SLOTS) * side, Math.floor(slot / SLOTS) * side, side, side, x - SIZE_PX / 2, y - SIZE_PX / 2,
      SIZE_PX, SIZE_PX);
  }

  private make(key: number, color: number, stamp: Stamp): number {
    if (this.slots.size === SLOTS * SLOTS) this.clear();
    const slot = this.slots.size;
    this.slots.set(key, slot);
    const context = this.sheet.getContext("2d")!;
    const side = SIZE_PX * this.ratio;
    context.setTransform(this.ratio, 0, 0, this.ratio, ((slot % SLOTS) + 0.5) * side, (Math.floor(slot / SLOTS) + 0.5) * side);
    context.beginPath();
    if (stamp === "cross") {
      context.moveTo(-4.5, -4.5);
      context.lineTo(4.5, 4.5);
      context.moveTo(-4.5, 4.5);
      context.lineTo(4.5, -4.5);
    } else if (stamp === "dot" || stamp === "ring") {
      context.arc(0, 0, stamp === "dot" ? RADIUS_PX : RADIUS_PX + 1.5, 0, 2 * Math.PI);
    } else {
      CORNERS[stamp].forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
      context.closePath();
    }
    if (stamp !== "cross" && stamp !== "ring") {
      context.fillStyle = css(color);
      context.fill();
      context.lineWidth = 1;
      context.strokeStyle = RIM;
      context.stroke();
    } else {
      strokeOnImage(context, css(color));
    }
    return slot;
  }

  private clear(): void {
    this.ratio = window.devicePixelRatio;
    this.slots.clear();
    this.sheet.width = this.sheet.height = SLOTS * SIZE_PX * this.ratio;
  }
}

// With a dark rim, so that it is seen on any image.
export function strokeOnImage(context: CanvasRenderingContext2D, color: string): void {
  context.lineWidth = 4;
  context.strokeStyle = RIM;
  context.stroke();
  context.lineWidth = 2;
  context.strokeStyle = color;
  context.stroke();
}

// On a dark plate, to the right of this place, above (side -1) or below it (1), and inside the canvas.
export function writeOnImage(context: CanvasRenderingContext2D, text: string, x: number, y: number, side: 1 | -1, color: string): void {
  context.font = LABEL_FONT;
  context.textBaseline = "middle";
  const { clientWidth, clientHeight } = context.canvas;
  const { width } = context.measureText(text);
  const left = Math.max(LABEL_GAP_PX, Math.min(x + LABEL_GAP_PX, clientWidth - width - LABEL_GAP_PX));
  const middle = Math.max(LABEL_GAP_PX, Math.min(y + side * (LABEL_GAP_PX + 4), clientHeight - LABEL_GAP_PX));
  context.fillStyle = RIM;
  context.fillRect(left - 4, middle - LABEL_GAP_PX, width + 8, 2 * LABEL_GAP_PX);
  context.fillStyle = color;
  context.fillText(text, left, middle);
}
