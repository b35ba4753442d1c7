// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Segments in the 3D view: ones that change with every frame, thin or with a width, and ones with a width or dashes that are set
// once.

import {
  BufferAttribute, BufferGeometry, DynamicDrawUsage, InstancedInterleavedBuffer, InterleavedBufferAttribute, LineBasicMaterial, LineSegments,
} from "three";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";

// The ends of segments, six numbers each, in an array that grows.
class Segments {
  used = 0;
  array = new Float32Array(0);

  // `grown` is called with every new array.
  constructor(private readonly grown: (array: Float32Array) => void) {}

  // From point i of `from` to point j of `to`.
  add(from: Float32Array, i: number, to: Float32Array, j: number): void {
    if (this.used + 6 > this.array.length) this.reserve(this.array.length / 3);
    const { array, used } = this;
    for (let axis = 0; axis < 3; ++axis) {
      array[used + axis] = from[3 * i + axis];
      array[used + 3 + axis] = to[3 * j + axis];
    }
    this.used += 6;
  }

  reserve(segments: number): void {
    const array = new Float32Array(6 * segments);
    array.set(this.array.subarray(0, this.used));
    this.array = array;
    this.grown(array);
  }
}

export class ThinLines extends LineSegments<BufferGeometry, LineBasicMaterial> {
  private readonly segments: Segments;

  constructor(opacity = 1) {
    super(new BufferGeometry(), new LineBasicMaterial({ transparent: opacity < 1, opacity }));
    this.frustumCulled = false;
    this.segments = new Segments((array) => {
      this.geometry.dispose();
      this.geometry = new BufferGeometry();
      this.geometry.setAttribute("position", new BufferAttribute(array, 3).setUsage(DynamicDrawUsage));
    });
    this.segments.reserve(1024);
  }

  begin(): void {
    this.segments.used = 0;
  }

  addSegment(from: Float32Array, i: number, to: Float32Array, j: number): void {
    this.segments.add(from, i, to, j);
  }

  end(): void {
    const { used } = this.segments;
    const attribute = this.geometry.getAttribute("position") as BufferAttribute;
    attribute.clearUpdateRanges();
    attribute.addUpdateRange(0, used);
    attribute.needsUpdate = true;
    this.geometry.setDrawRange(0, used / 3);
  }
}

export class ChangingWideLines extends LineSegments2 {
  private readonly segments: Segments;

  constructor(widthPx: number) {
    super(new LineSegmentsGeometry(), new LineMaterial({ linewidth: widthPx }));
    this.frustumCulled = false;
    this.segments = new Segments((array) => {
      this.geometry.dispose();
      this.geometry = new LineSegmentsGeometry();
      const ends = new InstancedInterleavedBuffer(array, 6, 1).setUsage(DynamicDrawUsage);
      this.geometry.setAttribute("instanceStart", new InterleavedBufferAttribute(ends, 3, 0));
      this.geometry.setAttribute("instanceEnd", new InterleavedBufferAttribute(ends, 3, 3));
    });
    this.segments.reserve(1024);
  }

  begin(): void {
    this.segments.used = 0;
  }

  addSegment(from: Float32Array, i: number, to: Float32Array, j: number): void {
    this.segments.add(from, i, to, j);
  }

  end(): void {
    const { used } = this.segments;
    const { data } = this.geometry.getAttribute("instanceStart") as InterleavedBufferAttribute;
    data.clearUpdateRanges();
    data.addUpdateRange(0, used);
    data.needsUpdate = true;
    this.geometry.instanceCount = used / 6;
    this.visible = used > 0;
  }
}

export class WideLines extends LineSegments2 {
  constructor(widthPx: number, dashed = false) {
    super(new LineSegmentsGeometry(), new LineMaterial({ linewidth: widthPx, dashed }));
    this.frustumCulled = false;
    this.visible = false;
  }

  setSegments(coordinates: number[], dash = 0): void {
    this.geometry.dispose();
    this.geometry = new LineSegmentsGeometry();
    this.visible = coordinates.length > 0;
    if (!this.visible) return;
    this.geometry.setPositions(coordinates);
    if (dash === 0) return;
    this.computeLineDistances();
    this.material.dashSize = dash;
    this.material.gapSize = 0.6 * dash;
  }

  // Only the first ones.
  show(segments: number): void {
    this.geometry.instanceCount = segments;
  }
}
