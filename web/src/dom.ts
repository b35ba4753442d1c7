// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  return document.getElementById(id) as T;
}

export function element<K extends keyof HTMLElementTagNameMap>(tag: K, properties: Partial<HTMLElementTagNameMap[K]> = {},
                                                               ...children: (Node | string)[]): HTMLElementTagNameMap[K] {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

export function setText(node: HTMLElement, text: string): void {
  if (node.textContent !== text) node.textContent = text;
}

// Three significant digits.
export function short(value: number | null | undefined): string {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (Number.isInteger(value) && Math.abs(value) < 1e6) return String(value);
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return value.toExponential(1);
  return value.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3);
}

// A canvas' context in CSS pixels, cleared, as large as its element shows it.
export function prepare(canvas: HTMLCanvasElement): { context: CanvasRenderingContext2D; width: number; height: number } {
  const { clientWidth: width, clientHeight: height } = canvas;
  const ratio = window.devicePixelRatio;
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  const context = canvas.getContext("2d")!;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

export const CLICK_RADIUS_PX = 12;
const DRAG_PX = 4;

// A press that did not become a drag, at the element's pixel.
export interface Click {
  x: number;
  y: number;
  shift: boolean;
}

export function onClick(target: HTMLElement, use: (click: Click) => void): void {
  let from: PointerEvent | null = null;
  target.addEventListener("pointerdown", (event) => { from = event.button === 0 ? event : null; });
  target.addEventListener("pointerup", (event) => {
    if (from && Math.hypot(event.clientX - from.clientX, event.clientY - from.clientY) < DRAG_PX) {
      const box = target.getBoundingClientRect();
      use({ x: event.clientX - box.left, y: event.clientY - box.top, shift: event.shiftKey });
    }
    from = null;
  });
  // Else the browser selects the page's text up to here.
  target.addEventListener("mousedown", (event) => { if (event.shiftKey) event.preventDefault(); });
}
