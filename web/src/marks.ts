// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Points in the 3D view: of a size in pixels, each with a color and a shape.

import { BufferAttribute, BufferGeometry, Color, DynamicDrawUsage, Points, ShaderMaterial } from "three";

export const SHAPES = { disc: 0, square: 1, triangle: 2, diamond: 3, cross: 4, ring: 5 } as const;
export type Shape = keyof typeof SHAPES;

// Those of the runs that are not the current one.
export const RUN_SHAPES = ["square", "triangle", "diamond"] as const satisfies Shape[];

const VERTEX = `
attribute float shape;
attribute vec3 color;
uniform float size;
varying vec3 fill;
varying float kind;
void main() {
  fill = color;
  kind = shape;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = shape > 3.5 ? 1.6 * size : size;
}`;

const FRAGMENT = `
uniform vec3 rim;
uniform float rimWidth;
varying vec3 fill;
varying float kind;
void main() {
  vec2 p = 2.0 * gl_PointCoord - 1.0;
  vec2 a = abs(p);
  float r = length(p);
  float edge = r;
  if (kind > 4.5) edge = abs(r - 0.8) / 0.2;
  else if (kind > 3.5) edge = max(abs(a.x - a.y) / 0.36, r);
  else if (kind > 2.5) edge = a.x + a.y;
  else if (kind > 1.5) edge = max(p.y / 0.9, (2.0 * a.x - p.y) / 1.1);
  else if (kind > 0.5) edge = max(a.x, a.y) / 0.8;
  if (edge > 1.0) discard;
  bool plain = kind > 3.5;
  gl_FragColor = vec4(!plain && edge > 1.0 - rimWidth ? mix(fill, rim, 0.55) : fill, 1.0);
}`;

export class Marks extends Points<BufferGeometry, ShaderMaterial> {
  private used = 0;

  constructor(sizePx: number, rimWidth: number) {
    super(new BufferGeometry(), new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { size: { value: sizePx * window.devicePixelRatio }, rim: { value: new Color() }, rimWidth: { value: rimWidth } },
    }));
    this.frustumCulled = false;
    this.visible = false;
    this.reserve(256);
  }

  setRim(color: string): void {
    this.material.uniforms.rim.value.set(color);
  }

  begin(count: number): void {
    this.used = 0;
    if (count > this.geometry.getAttribute("position").count) this.reserve(2 * count);
  }

  addMark(positions: Float32Array, index: number, color: number, shape: Shape): void {
    const { position, color: colors, shape: shapes } = this.geometry.attributes;
    const p = 3 * this.used;
    for (let axis = 0; axis < 3; ++axis) {
      position.array[p + axis] = positions[3 * index + axis];
      colors.array[p + axis] = (color >> (16 - 8 * axis)) & 255;
    }
    shapes.array[this.used++] = SHAPES[shape];
  }

  end(): void {
    this.geometry.setDrawRange(0, this.used);
    this.visible = this.used > 0;
    for (const name of ["position", "color", "shape"]) {
      const attribute = this.geometry.getAttribute(name) as BufferAttribute;
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, this.used * attribute.itemSize);
      attribute.needsUpdate = true;
    }
  }

  private reserve(count: number): void {
    this.geometry.dispose();
    this.geometry = new BufferGeometry();
    const make = (array: Float32Array | Uint8Array, size: number, normalized: boolean) =>
      new BufferAttribute(array, size, normalized).setUsage(DynamicDrawUsage);
    this.geometry.setAttribute("position", make(new Float32Array(3 * count), 3, false));
    this.geometry.setAttribute("color", make(new Uint8Array(3 * count), 3, true));
    this.geometry.setAttribute("shape", make(new Float32Array(count), 1, false));
  }
}
