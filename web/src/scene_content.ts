// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What stands in the 3D view. `build` makes what depends on the runs alone, `showFrame` what depends on the frame.

import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, Mesh, MeshBasicMaterial, NearestFilter, Quaternion, Scene, Texture, Vector3,
} from "three";
import { paletteOf, runColor } from "./colors";
import { ChangingWideLines, ThinLines, WideLines } from "./lines";
import { Marks, RUN_SHAPES } from "./marks";
import type { Page } from "./page";
import { lastAtMost } from "./report";
import { readingNow } from "./ruler";
import type { Run } from "./run";
import type { Surface } from "./surface";
import { SurfaceMesh } from "./surface_mesh";

const FRUSTUM_OF_DEPTH = 0.15;   // from the camera's center to a corner of its image, of the median depth
const GRID_LINES = 10;
const TRAIL_STEP_OF_SIZE = 1 / 600;   // shorter steps are not drawn by themselves

export class SceneContent {
  readonly scene = new Scene();
  // Of the points and paths, without what lies far out.
  center = new Vector3();
  size = 1;
  empty = true;   // nothing has a position yet
  lacksSurface = false;   // the current run's surface is to be shown, and is not known in this frame
  medianDepth = 1;
  gridStep = 1;
  private lowest = 0;   // the largest y
  // At the origin of the world, or at the corner of the scene that is nearest to it. Their ends are labeled.
  private readonly axesOrigin = new Vector3();
  readonly axisEnds = [new Vector3(), new Vector3(), new Vector3()];
  // What the first view shows: nearly all of the points in any frame, of a run with surfaces nearly all of their vertices, and all of
  // the cameras and the axes.
  readonly extent: { points: Vector3[]; all: Vector3[] } = { points: [], all: [] };

  private readonly map = new Marks(2.5, 0);
  private readonly points = new Marks(6, 0.28);
  private readonly others = new Marks(6, 0.25);
  private readonly truthPoints = new Marks(4.5, 0);
  private readonly trails = new ChangingWideLines(2);
  private readonly errors = new ThinLines();
  private readonly grid = new ThinLines(0.8);
  private readonly axes = [0, 1, 2].map(() => new WideLines(1.5));
  private readonly paths: { ahead: ThinLines; done: WideLines; count: Uint32Array }[];
  private readonly truePath = new WideLines(2, true);
  private readonly trueFrustum = new WideLines(1.5);
  private readonly frustum = new WideLines(1.5);
  private readonly track = new WideLines(2.5);
  private readonly uncertainty = new WideLines(4);
  private readonly rings = new Marks(11, 0);
  private readonly ruler = new WideLines(3);
  private readonly surfaces: SurfaceMesh[][];   // of each run
  private readonly lamp = new DirectionalLight(0xffffff, 0.7 * Math.PI);
  private readonly picture: Mesh<BufferGeometry, MeshBasicMaterial>;
  // Of each row of the current run: how many points had been seen by then, in the order of the map's vertices.
  private known = new Uint32Array(0);

  // `changed` is called when something that had to be decoded can be seen.
  constructor(private readonly page: Page, changed: () => void) {
    this.surfaces = page.report.runs.map((run) => run.surfaces.map((surface) => new SurfaceMesh(surface, changed)));
    this.paths = page.report.runs.map(() => ({ ahead: new ThinLines(0.4), done: new WideLines(2.5), count: new Uint32Array(0) }));
    this.picture = makePicture();
    this.scene.add(new AmbientLight(0xffffff, 0.3 * Math.PI), this.lamp, this.lamp.target, ...this.surfaces.flat().map(({ object }) => object));
    this.scene.add(this.grid, ...this.axes, this.map, this.trails, this.errors, this.truthPoints, this.others, this.points,
      ...this.paths.flatMap(({ ahead, done }) => [ahead, done]), this.truePath, this.trueFrustum, this.frustum, this.picture,
      this.track, this.uncertainty, this.ruler, this.rings);
    for (const object of [this.track, this.uncertainty, this.ruler, this.rings]) {
      object.renderOrder = 1;
      object.material.depthTest = false;
    }
  }

  build(): void {
    this.measure();
    this.page.report.runs.forEach((run, index) => this.buildPath(run, index));
    const { truth } = this.page.report;
    if (truth) this.truePath.setSegments(segmentsOf(truth.pose, truth.frame.length).coordinates, this.size / 120);
    this.buildGrid();
    this.buildExtent();
    this.paint();
  }

  // What depends on the theme and on which run is the current one.
  paint(): void {
    const { dark, current } = this.page.store.state;
    const palette = paletteOf(dark);
    this.scene.background = new Color(palette.background);
    this.grid.material.color.set(palette.grid);
    for (const axis of this.axes) axis.material.color.set(palette.text);
    this.trails.material.color.set(palette.trails);
    this.errors.material.color.set(palette.truth);
    this.truePath.material.color.set(palette.truth);
    this.trueFrustum.material.color.set(palette.truth);
    this.frustum.material.color.set(runColor(dark, current));
    this.track.material.color.set(palette.picked);
    this.uncertainty.material.color.set(palette.picked);
    this.ruler.material.color.set(palette.ruler);
    this.points.setRim(dark ? "#ffffff" : "#000000");
    this.others.setRim(dark ? "#000000" : "#ffffff");
    this.paths.forEach(({ ahead, done }, run) => {
      ahead.material.color.set(runColor(dark, run));
      done.material.color.set(runColor(dark, run));
    });
    this.buildMap();
  }

  showFrame(): void {
    const { report, store } = this.page;
    const { current, position, layers, visible } = store.state;
    const run = report.runs[current];
    const row = report.row(current, position);
    const observations = visible[current] ? run.observationsOfRow(row) : new Uint32Array(0);
    this.map.visible = layers.map && visible[current];
    const lastRow = lastAtMost(run.frames.frame, report.frames[position]);
    this.map.geometry.setDrawRange(0, lastRow < 0 ? 0 : this.known[lastRow] ?? 0);
    this.showSurface(run, row);
    this.showPoints(run, observations);
    this.showTrails(run, observations);
    this.showTruth(run, observations);
    this.showOthers();
    this.showPaths();
    this.showCamera(run, row);
    this.grid.visible = layers.grid && !this.empty;
    for (const axis of this.axes) axis.visible = this.grid.visible;
  }

  showPicked(): void {
    const { report, store } = this.page;
    const { picked, current, position } = store.state;
    const run = report.runs[current];
    const point = picked === null ? undefined : run.pointWithId(picked);
    const observations = point === undefined ? [] : run.observationsOfPoint(point);
    const coordinates: number[] = [];
    for (let i = 1; i < observations.length; ++i) {
      for (const o of [observations[i - 1], observations[i]]) coordinates.push(...run.position.values.subarray(3 * o, 3 * o + 3));
    }
    this.track.setSegments(coordinates);
    const row = report.row(current, position);
    const now = observations.find((o) => run.row.values[o] === row);
    this.uncertainty.setSegments(now === undefined ? [] : uncertaintySegment(run, now));
    const reading = readingNow(this.page);
    this.ruler.setSegments(reading ? reading.ends.flatMap((o) => [...run.position.values.subarray(3 * o, 3 * o + 3)]) : []);
    this.showRings(run, now, reading?.ends[1]);
  }

  private showRings(run: Run, picked: number | undefined, measured: number | undefined): void {
    const palette = paletteOf(this.page.store.state.dark);
    this.rings.begin(2);
    for (const [o, color] of [[picked, palette.picked], [measured, palette.ruler]] as const) {
      if (o !== undefined) this.rings.addMark(run.position.values, o, new Color(color).getHex(), "ring");
    }
    this.rings.end();
  }

  showImage(bitmap: ImageBitmap | null | undefined): void {
    const { material } = this.picture;
    if (!bitmap) {
      material.map = null;
      this.picture.visible = false;
    } else if (material.map?.image !== bitmap) {
      material.map?.dispose();
      material.map = new Texture(bitmap);
      material.map.minFilter = material.map.magFilter = NearestFilter;
      material.map.generateMipmaps = false;
      material.map.needsUpdate = true;
      material.needsUpdate = true;
    }
  }

  private measure(): void {
    const { report } = this.page;
    const axes: number[][] = [[], [], []];
    const depths: number[] = [];
    for (const run of report.runs) {
      sample(run.rest.values, run.id.length, 3, (i) => {
        if (!Number.isNaN(run.rest.values[i])) for (let axis = 0; axis < 3; ++axis) axes[axis].push(run.rest.values[i + axis]);
      });
      sample(run.pose.values, run.rows, 7, (i) => {
        if (!Number.isNaN(run.pose.values[i])) for (let axis = 0; axis < 3; ++axis) axes[axis].push(run.pose.values[i + 4 + axis]);
      });
      sample(run.depth.values, run.observations, 1, (i) => depths.push(run.depth.values[i]));
    }
    if (axes[0].length === 0) return;
    const ends = axes.map((values) => {
      values.sort((a, b) => a - b);
      return [values[Math.floor(0.01 * (values.length - 1))], values[Math.ceil(0.99 * (values.length - 1))]];
    });
    this.center.fromArray(ends.map(([low, high]) => (low + high) / 2));
    this.axesOrigin.fromArray(ends.map(([low, high]) => Math.min(high, Math.max(low, 0))));
    this.size = Math.hypot(...ends.map(([low, high]) => high - low)) || 1;
    this.empty = ends.every(([low, high]) => low === high);
    depths.sort((a, b) => a - b);
    this.medianDepth = depths[depths.length >> 1] || this.size;
    this.lowest = ends[1][1];
  }

  private buildMap(): void {
    const { report, store } = this.page;
    const run = report.runs[store.state.current];
    const count = run.id.length;
    const order = Array.from({ length: count }, (_, point) => point).filter((point) => run.count.values[point] > 0);
    order.sort((a, b) => run.first.values[a] - run.first.values[b]);
    this.known = new Uint32Array(run.rows);
    const color = new Color(paletteOf(store.state.dark).map).getHex();
    this.map.begin(order.length);
    for (const point of order) {
      this.map.addMark(run.rest.values, point, color, "disc");
      ++this.known[run.first.values[point]];
    }
    for (let row = 1; row < run.rows; ++row) this.known[row] += this.known[row - 1];
    this.map.end();
  }

  private buildPath(run: Run, index: number): void {
    const path = this.paths[index];
    const { coordinates, count } = segmentsOf(run.pose.values, run.rows);
    path.count = count;
    path.done.setSegments(coordinates);
    const ends = new Float32Array(coordinates);
    path.ahead.begin();
    for (let i = 0; i + 1 < ends.length / 3; i += 2) path.ahead.addSegment(ends, i, ends, i + 1);
    path.ahead.end();
  }

  private buildExtent(): void {
    const { report } = this.page;
    const { points, all } = this.extent;
    points.length = all.length = 0;
    const addCameras = (pose: Float32Array, rows: number) => sample(pose, rows, 7, (i) => {
      if (Number.isNaN(pose[i])) return;
      all.push(...(report.camera.corners ? this.frustumAt(pose, i / 7, report.camera.corners) : [poseOf(pose, i / 7).position]));
    });
    for (const run of report.runs) {
      for (const surface of run.surfaces) points.push(...verticesOf(surface).map((vertex) => new Vector3(...vertex)));
      if (run.surfaces.length === 0) sample(run.position.values, run.observations, 3, (i) => {
        if (!Number.isNaN(run.position.values[i])) points.push(new Vector3().fromArray(run.position.values, i));
      });
      addCameras(run.pose.values, run.rows);
    }
    if (report.truth) addCameras(report.truth.pose, report.truth.frame.length);
    all.push(this.axesOrigin, ...this.axisEnds);
  }

  private buildGrid(): void {
    this.gridStep = niceStep(this.size / GRID_LINES);
    const half = (GRID_LINES / 2) * this.gridStep;
    const round = (value: number) => Math.round(value / this.gridStep) * this.gridStep;
    const x = round(this.center.x);
    const z = round(this.center.z);
    const y = this.lowest;
    this.grid.begin();
    for (let i = -GRID_LINES / 2; i <= GRID_LINES / 2; ++i) {
      const at = i * this.gridStep;
      const ends = new Float32Array([x + at, y, z - half, x + at, y, z + half, x - half, y, z + at, x + half, y, z + at]);
      this.grid.addSegment(ends, 0, ends, 1);
      this.grid.addSegment(ends, 2, ends, 3);
    }
    this.grid.end();
    this.axes.forEach((axis, i) => {
      this.axisEnds[i].copy(this.axesOrigin);
      this.axisEnds[i].setComponent(i, this.axesOrigin.getComponent(i) + this.gridStep);
      axis.setSegments([...this.axesOrigin.toArray(), ...this.axisEnds[i].toArray()]);
    });
  }

  // Seen from `position`, what is around `target` is lit best.
  putLamp(position: Vector3, target: Vector3): void {
    this.lamp.position.copy(position);
    this.lamp.target.position.copy(target);
  }

  // Of the current run: that of the frame's submap, if the frame has a pose.
  private showSurface(run: Run, row: number): void {
    const { report, store } = this.page;
    const { current, position, layers, visible, surfaceColor } = store.state;
    const frame = report.frames[position];
    const wanted = visible[current] && layers.surface;
    this.lacksSurface = wanted && run.surfaces.length > 0;
    this.surfaces.forEach((meshes, index) => meshes.forEach(({ object, surface }, k) => {
      object.visible = index === current && wanted && run.hasPose(row) && run.frames.submap[row] === surface.submap && surface.isKnownIn(frame);
      if (!object.visible) return;
      this.lacksSurface = false;
      meshes[k].show(frame, surfaceColor);
    }));
  }

  private showPoints(run: Run, observations: Uint32Array): void {
    this.points.begin(observations.length);
    const { layers, dark } = this.page.store.state;
    if (layers.points) {
      for (const o of observations) {
        const shape = run.isLost(o) ? "cross" : run.isReturned(o) ? "ring" : "disc";
        this.points.addMark(run.position.values, o, this.page.coloring.color(run, o, dark), shape);
      }
    }
    this.points.end();
  }

  // From where a point is back through the last frames, and on to where it rests.
  private showTrails(run: Run, observations: Uint32Array): void {
    const { layers, trail } = this.page.store.state;
    this.trails.begin();
    if (layers.trails) {
      const row = run.row.values;
      const previous = run.previous.values;
      const position = run.position.values;
      const shortest = TRAIL_STEP_OF_SIZE * this.size;
      for (const observation of observations) {
        const oldest = row[observation] - trail;
        let from = observation;
        for (let o = previous[observation]; o >= 0 && row[o] >= oldest; o = previous[o]) {
          const length = Math.abs(position[3 * o] - position[3 * from]) + Math.abs(position[3 * o + 1] - position[3 * from + 1]) +
            Math.abs(position[3 * o + 2] - position[3 * from + 2]);
          if (length < shortest) continue;
          this.trails.addSegment(position, from, position, o);
          from = o;
        }
        this.trails.addSegment(position, from, run.rest.values, run.point.values[from]);
      }
    }
    this.trails.end();
  }

  private showTruth(run: Run, observations: Uint32Array): void {
    const { layers, dark } = this.page.store.state;
    const color = new Color(paletteOf(dark).truth).getHex();
    const truth = layers.truth ? run.truth?.values : undefined;
    this.truthPoints.begin(observations.length);
    this.errors.begin();
    if (truth) {
      for (const o of observations) {
        if (Number.isNaN(truth[3 * o])) continue;
        this.truthPoints.addMark(truth, o, color, "diamond");
        this.errors.addSegment(truth, o, run.position.values, o);
      }
    }
    this.truthPoints.end();
    this.errors.end();
  }

  private showOthers(): void {
    const { report, store } = this.page;
    const { visible, current, position, dark, layers } = store.state;
    const shown = report.runs
      .map((run, index) => ({ run, index, observations: run.observationsOfRow(report.row(index, position)) }))
      .filter(({ index }) => visible[index] && index !== current && layers.points);
    this.others.begin(shown.reduce((sum, { observations }) => sum + observations.length, 0));
    for (const { run, index, observations } of shown) {
      const color = new Color(runColor(dark, index)).getHex();
      for (const o of observations) this.others.addMark(run.position.values, o, color, RUN_SHAPES[index % RUN_SHAPES.length]);
    }
    this.others.end();
  }

  private showPaths(): void {
    const { report, store } = this.page;
    const { layers, visible, position } = store.state;
    this.paths.forEach(({ ahead, done, count }, index) => {
      const row = lastAtMost(report.runs[index].frames.frame, report.frames[position]);
      const segments = row < 0 ? 0 : count[row] ?? 0;
      ahead.visible = layers.path && visible[index];
      done.visible = ahead.visible && segments > 0;
      done.show(segments);
    });
    this.truePath.visible = layers.truth && report.truth !== null;
  }

  private showCamera(run: Run, row: number): void {
    const { report, store } = this.page;
    const { layers, visible, current, position, view } = store.state;
    const corners = report.camera.corners;
    const shown = corners !== null && layers.path && visible[current] && run.hasPose(row);
    const inside = view === "camera";
    this.picture.visible = shown && this.picture.material.map !== null;
    this.putBehind(inside);
    if (shown) {
      const ends = this.frustumAt(run.pose.values, row, corners);
      this.frustum.setSegments(frustumSegments(ends));
      setPicture(this.picture, ends);
    }
    this.frustum.visible = shown && !inside;
    const index = report.truth && layers.truth && corners && !inside ? report.truth.frame.indexOf(report.frames[position]) : -1;
    this.trueFrustum.visible = index >= 0;
    if (index >= 0) this.trueFrustum.setSegments(frustumSegments(this.frustumAt(report.truth!.pose, index, corners!)));
  }

  // The camera's center and the corners of its image, as they are drawn. Their size does not depend on the field of view.
  frustumAt(pose: Float32Array, row: number, corners: [number, number, number][]): Vector3[] {
    const longest = Math.max(...corners.map((ray) => Math.hypot(...ray)));
    return cornersInWorld(pose, row, corners, (FRUSTUM_OF_DEPTH * this.medianDepth) / longest);
  }

  // Seen from the camera the image is the background.
  private putBehind(behind: boolean): void {
    const { material } = this.picture;
    if (material.depthTest !== behind) return;
    material.depthTest = material.depthWrite = material.transparent = !behind;
    material.needsUpdate = true;
    this.picture.renderOrder = behind ? -1 : 0;
  }
}

// Segments between poses that follow each other, and of each row how many end there or before.
function segmentsOf(pose: Float32Array, rows: number): { coordinates: number[]; count: Uint32Array } {
  const coordinates: number[] = [];
  const count = new Uint32Array(rows);
  for (let row = 0; row < rows; ++row) {
    if (row > 0 && !Number.isNaN(pose[7 * row]) && !Number.isNaN(pose[7 * row - 7])) {
      coordinates.push(...pose.subarray(7 * row - 3, 7 * row), ...pose.subarray(7 * row + 4, 7 * row + 7));
    }
    count[row] = coordinates.length / 6;
  }
  return { coordinates, count };
}

export function poseOf(pose: Float32Array, row: number): { rotation: Quaternion; position: Vector3 } {
  const [qx, qy, qz, qw, x, y, z] = pose.subarray(7 * row, 7 * row + 7);
  return { rotation: new Quaternion(qx, qy, qz, qw), position: new Vector3(x, y, z) };
}

// Two standard deviations of the distance to both sides along the point's ray; across it a point is known to a pixel.
function uncertaintySegment(run: Run, observation: number): number[] {
  const sigma = run.sigma?.values[observation] ?? NaN;
  const row = run.row.values[observation];
  if (!(sigma > 0) || !run.hasPose(row)) return [];
  const point = new Vector3().fromArray(run.position.values, 3 * observation);
  const reach = point.clone().sub(poseOf(run.pose.values, row).position).setLength(2 * sigma);
  return [...point.clone().sub(reach).toArray(), ...point.clone().add(reach).toArray()];
}

// The camera's center and the corners of its image.
function cornersInWorld(pose: Float32Array, row: number, corners: [number, number, number][], length: number): Vector3[] {
  const { rotation, position } = poseOf(pose, row);
  return [position, ...corners.map((ray) => new Vector3(...ray).multiplyScalar(length).applyQuaternion(rotation).add(position))];
}

function frustumSegments([center, ...corners]: Vector3[]): number[] {
  return corners.flatMap((corner, i) => [center, corner, corner, corners[(i + 1) % 4]]).flatMap((end) => end.toArray());
}

function makePicture(): Mesh<BufferGeometry, MeshBasicMaterial> {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(12), 3));
  // An ImageBitmap's first row is at v = 0.
  geometry.setAttribute("uv", new BufferAttribute(new Float32Array([0, 0, 1, 0, 1, 1, 0, 1]), 2));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  const mesh = new Mesh(geometry, new MeshBasicMaterial({ side: DoubleSide, transparent: true, opacity: 0.85 }));
  mesh.frustumCulled = false;
  mesh.visible = false;
  return mesh;
}

function setPicture(picture: Mesh<BufferGeometry, MeshBasicMaterial>, [, ...corners]: Vector3[]): void {
  const attribute = picture.geometry.getAttribute("position") as BufferAttribute;
  corners.forEach((corner, i) => corner.toArray(attribute.array, 3 * i));
  attribute.needsUpdate = true;
}

// At most about 20,000, where they are in any of its frames.
function verticesOf(surface: Surface): [number, number, number][] {
  const { rest, displacements } = surface.arrays;
  const count = surface.vertices * Math.max(1, displacements.length);
  const step = Math.max(1, Math.floor(count / 20000));
  const vertices: [number, number, number][] = [];
  for (let index = 0; index < count; index += step) {
    const i = 3 * (index % surface.vertices);
    const moved = displacements[Math.floor(index / surface.vertices)];
    const at = (axis: number) => rest[i + axis] + (moved ? moved[i + axis] : 0);
    vertices.push([at(0), at(1), at(2)]);
  }
  return vertices;
}

// At most 20,000 entries of an array whose rows have n numbers.
function sample(values: Float32Array, rows: number, n: number, use: (index: number) => void): void {
  const step = Math.max(1, Math.floor(rows / 20000));
  for (let row = 0; row < rows && row * n < values.length; row += step) use(row * n);
}

// 1, 2 or 5 times a power of ten.
function niceStep(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const times = value / power;
  return power * (times < 1.5 ? 1 : times < 3.5 ? 2 : times < 7.5 ? 5 : 10);
}
