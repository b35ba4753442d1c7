// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A surface in the 3D view: with its texture, which has the light that it was seen in, or colored and lit by the viewer's lamp.

import { BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, MeshBasicMaterial, MeshLambertMaterial, Texture } from "three";
import { type ColorMap, gradientColor } from "./colors";
import { type Range, type Surface, type SurfaceColor, colorMapOf } from "./surface";

export class SurfaceMesh {
  readonly object: Mesh;
  private readonly geometry = new BufferGeometry();
  private readonly withSeams: BufferAttribute;
  private readonly seamless: BufferAttribute;
  private readonly textured = new MeshBasicMaterial({ side: DoubleSide });
  private readonly colored = new MeshLambertMaterial({ side: DoubleSide, vertexColors: true });

  // `changed` is called when the texture has been decoded.
  constructor(readonly surface: Surface, changed: () => void) {
    const { rest, triangles, uv, texture } = surface.arrays;
    this.geometry.setAttribute("position", new BufferAttribute(rest.slice(), 3));
    this.geometry.setAttribute("color", new BufferAttribute(new Float32Array(rest.length), 3));
    this.geometry.setAttribute("uv", new BufferAttribute(uv, 2));
    this.withSeams = new BufferAttribute(triangles, 1);
    this.seamless = new BufferAttribute(surface.seamless, 1);
    this.geometry.setIndex(this.withSeams);
    this.object = new Mesh(this.geometry, this.textured);
    this.object.frustumCulled = false;
    if (!texture) return;
    createImageBitmap(new Blob([texture], { type: "image/jpeg" })).then((bitmap) => {
      this.textured.map = new Texture(bitmap);
      this.textured.map.needsUpdate = true;
      this.textured.needsUpdate = true;
      changed();
    }, () => changed());   // damaged: it stays white
  }

  show(frame: number, color: SurfaceColor): void {
    const positions = this.surface.positionsAt(frame);
    const attribute = this.geometry.getAttribute("position") as BufferAttribute;
    attribute.array.set(positions);
    attribute.needsUpdate = true;
    this.geometry.setIndex(color === "image" ? this.withSeams : this.seamless);
    if (color === "image") {
      this.object.material = this.textured;
      return;
    }
    this.object.material = this.colored;
    this.geometry.computeVertexNormals();
    this.paint(this.surface.values(color, frame, positions), this.surface.range(color), colorMapOf(color));
  }

  private paint(values: Float32Array, { low, high }: Range, map: ColorMap): void {
    const attribute = this.geometry.getAttribute("color") as BufferAttribute;
    const color = new Color();
    values.forEach((value, v) => {
      color.setHex(gradientColor(value, low, high, map));
      attribute.setXYZ(v, color.r, color.g, color.b);
    });
    attribute.needsUpdate = true;
  }
}
