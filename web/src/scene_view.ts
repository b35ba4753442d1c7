// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The 3D view: renderer, camera and picking. World axes are the camera's of the first frame: x right, y down, z ahead.

import { ColorManagement, LinearSRGBColorSpace, PerspectiveCamera, Quaternion, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { type Click, byId, element, onClick, setText } from "./dom";
import type { Page } from "./page";
import { pickNearest } from "./picking";
import { lengthText, readingNow, sideOfLabel } from "./ruler";
import { SceneContent, poseOf } from "./scene_content";
import { type Changed, anyOf } from "./state";

// three.js looks along -z with y up.
const CAMERA_FROM_VIEW = new Quaternion(1, 0, 0, 0);
const FIELD_OF_VIEW_DEG = 45;
const START_DIRECTION = new Vector3(-0.75, -0.65, -1).normalize();
const SHARE = 0.998;   // of the points that are in the first view for certain
const MARGIN = 1.15;

ColorManagement.enabled = false;

export class SceneView {
  private readonly container = byId("scene");
  private readonly renderer: WebGLRenderer;
  private readonly camera = new PerspectiveCamera(FIELD_OF_VIEW_DEG);
  private readonly controls: OrbitControls;
  private readonly content: SceneContent;
  private readonly labels = ["x", "y", "z"].map((name) => element("span", { textContent: name, className: "axis" }));
  private readonly rulerLabel = element("span", { className: "ruler-label" });
  private readonly message = element("p", { className: "message" });
  private requested = false;
  private untouched = true;   // nobody has moved the view since it was fitted

  // Throws where there is no WebGL.
  constructor(private readonly page: Page) {
    this.renderer = new WebGLRenderer({ antialias: hasGpu() });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.setPixelRatio(window.devicePixelRatio);
    const canvas = this.renderer.domElement;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "3D view of the points and of the camera's path");
    this.container.append(canvas, ...this.labels, this.rulerLabel, this.message);
    this.content = new SceneContent(page, () => this.request());
    this.camera.up.set(0, -1, 0);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.request());
    this.controls.addEventListener("start", () => {
      this.untouched = false;
      page.store.change({ view: "free" });
    });
    onClick(canvas, (click) => this.pick(click));
    canvas.addEventListener("dblclick", () => this.reset());
    new ResizeObserver(() => this.resize()).observe(this.container);
    this.content.build();
    this.content.showFrame();
    this.showTexts();
    this.reset();
  }

  update(changed: Changed): void {
    const content = this.content;
    if (anyOf(changed, "revision")) {
      const wasEmpty = content.empty;
      content.build();
      if (wasEmpty && !content.empty) this.reset();
      else if (this.untouched && !this.showsAll()) this.fitView();
      else this.setDepths();
    } else if (anyOf(changed, "current", "dark")) content.paint();
    if (anyOf(changed, "position", "revision", "dark", "playing")) this.showImage();
    if (anyOf(changed, "position", "current", "visible", "color", "layers", "surfaceColor", "trail", "view", "dark", "revision")) content.showFrame();
    if (anyOf(changed, "position", "current", "picked", "measured", "dark", "revision")) content.showPicked();
    if (anyOf(changed, "view") && this.page.store.state.view === "free") this.leaveCamera();
    if (anyOf(changed, "position", "current", "view", "revision")) this.follow();
    if (anyOf(changed, "position", "current", "visible", "picked", "measured", "color", "layers", "surfaceColor", "trail", "view", "dark", "revision")) this.render();
    this.showTexts();
  }

  private showTexts(): void {
    const { report, store } = this.page;
    setText(this.message, report.runs[store.state.current].whyNothing());
    const grid = store.state.layers.grid && !this.content.empty ? `grid ${Number(this.content.gridStep.toPrecision(1))} ${report.unit}` : "";
    const surface = this.content.lacksSurface ? "no surface in this frame" : "";
    setText(byId("scene-caption"), [grid, surface].filter((text) => text !== "").join(", "));
  }

  // Shows the whole scene.
  reset(): void {
    this.page.store.change({ view: "free" });
    this.fitView();
  }

  private fitView(): void {
    this.untouched = true;
    const { middle, distance } = this.fit();
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(START_DIRECTION, distance);
    this.setDepths();
    this.leaveCamera();
  }

  // From where nearly all points, and all cameras and axes, are seen as large as the canvas allows: the point in the middle of the
  // view, and the distance from it. A point at (aside, back) of the center is inside, to one side, where
  // aside - middle <= tangent * (distance - back).
  private fit(): { middle: Vector3; distance: number } {
    const { center, size, extent } = this.content;
    const aspect = this.container.clientWidth / Math.max(1, this.container.clientHeight) || 1;
    const right = new Vector3().crossVectors(this.camera.up, START_DIRECTION).normalize();
    const up = new Vector3().crossVectors(START_DIRECTION, right);
    const tangent = Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360) / MARGIN;
    const middle = center.clone();
    let distance = 0;
    for (const [axis, slope] of [[right, aspect * tangent], [up, tangent]] as const) {
      const reach = (sign: number) => {
        const of = (point: Vector3) => {
          const offset = point.clone().sub(center);
          return (sign * offset.dot(axis)) / slope + offset.dot(START_DIRECTION);
        };
        const points = extent.points.map(of).sort((a, b) => a - b);
        return extent.all.reduce((most, point) => Math.max(most, of(point)), points[Math.ceil(SHARE * (points.length - 1))] ?? -Infinity);
      };
      const [low, high] = [reach(-1), reach(1)];
      if (!Number.isFinite(low)) continue;
      middle.addScaledVector(axis, (slope * (high - low)) / 2);
      distance = Math.max(distance, (high + low) / 2);
    }
    return { middle, distance: distance > 0 ? distance : size / tangent };
  }

  private showsAll(): boolean {
    const { clientWidth, clientHeight } = this.container;
    return this.content.extent.all.every((point) => {
      const [x, y, depth] = this.project(point.toArray());
      return depth < 1 && x >= 0 && x <= clientWidth && y >= 0 && y <= clientHeight;
    });
  }

  // As a live scene grows.
  private setDepths(): void {
    const distance = (0.5 * this.content.size) / Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360);
    this.camera.near = 0.001 * distance;
    this.camera.far = 20 * distance;
    this.camera.updateProjectionMatrix();
  }

  // The frame's image may have come since.
  showImage(): void {
    const { report, images, store } = this.page;
    const frame = images?.frameFor(report.frames[store.state.position]) ?? null;
    const image = images && frame !== null ? images.get(frame) : null;
    if (image !== undefined || !store.state.playing) this.content.showImage(image);
  }

  imageLoaded(): void {
    this.showImage();
    this.content.showFrame();
    this.request();
  }

  project(position: ArrayLike<number>, offset = 0): [number, number, number] {
    const point = new Vector3().fromArray(position, offset).project(this.camera);
    return [(0.5 + 0.5 * point.x) * this.container.clientWidth, (0.5 - 0.5 * point.y) * this.container.clientHeight, point.z];
  }

  // The center of the current run's camera and the corners of its image, where there is one.
  projectFrustum(): [number, number][] {
    const { report, store } = this.page;
    const { current, position } = store.state;
    const run = report.runs[current];
    const row = report.row(current, position);
    if (!report.camera.corners || !run.hasPose(row)) return [];
    return this.content.frustumAt(run.pose.values, row, report.camera.corners).map((end) => {
      const [x, y] = this.project(end.toArray());
      return [x, y];
    });
  }

  private pick(click: Click): void {
    pickNearest(this.page, click, (run, o) => {
      const [px, py, depth] = this.project(run.position.values, 3 * o);
      return depth < 1 ? [px, py] : null;
    });
  }

  private leaveCamera(): void {
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.request();
  }

  // Puts the view where the camera is, or a bit behind it; a frame without a pose leaves it where it was.
  private follow(): void {
    const { report, store } = this.page;
    const { current, position, view } = store.state;
    const run = report.runs[current];
    const row = report.row(current, position);
    if (view === "free" || !run.hasPose(row)) return;
    this.untouched = false;
    const pose = poseOf(run.pose.values, row);
    const ahead = new Vector3(0, 0, 1).applyQuaternion(pose.rotation);
    const depth = this.content.medianDepth;
    this.controls.target.copy(pose.position).addScaledVector(ahead, depth);
    this.camera.position.copy(pose.position);
    this.camera.quaternion.copy(pose.rotation).multiply(CAMERA_FROM_VIEW);
    this.camera.updateProjectionMatrix();
    if (view === "camera") {
      this.takeCorners();
      return;
    }
    const up = new Vector3(0, -1, 0).applyQuaternion(pose.rotation);
    this.camera.position.addScaledVector(ahead, -0.9 * depth).addScaledVector(up, 0.35 * depth);
    this.camera.lookAt(this.controls.target);
  }

  // Of the camera's own field of view, which the image's corners tell; the rest of the canvas shows what lies beside.
  private takeCorners(): void {
    const { corners } = this.page.report.camera;
    if (!corners) return;
    const { near, far } = this.camera;
    const xs = corners.map(([x]) => x);
    const ys = corners.map(([, y]) => y);
    const aspect = this.container.clientWidth / Math.max(1, this.container.clientHeight);
    const width = Math.max(...xs) - Math.min(...xs);
    const height = Math.max(...ys) - Math.min(...ys);
    const x = (Math.max(...xs) + Math.min(...xs)) / 2;
    const y = (Math.max(...ys) + Math.min(...ys)) / 2;
    const halfWidth = Math.max(width, height * aspect) / 2;
    const halfHeight = halfWidth / aspect;
    this.camera.projectionMatrix.makePerspective(near * (x - halfWidth), near * (x + halfWidth), near * (halfHeight - y),
      near * (-halfHeight - y), near, far);
    this.camera.projectionMatrixInverse.copy(this.camera.projectionMatrix).invert();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.container;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    if (this.untouched && this.page.store.state.view === "free") this.fitView();
    this.follow();
    this.render();
  }

  private request(): void {
    if (this.requested) return;
    this.requested = true;
    requestAnimationFrame(() => this.render());
  }

  private render(): void {
    this.requested = false;
    this.camera.updateMatrixWorld();
    this.content.putLamp(this.camera.position, this.controls.target);
    this.renderer.render(this.content.scene, this.camera);
    const grid = this.page.store.state.layers.grid && !this.content.empty;
    this.labels.forEach((label, axis) => {
      const [x, y, depth] = this.project(this.content.axisEnds[axis].toArray());
      label.hidden = !grid || depth >= 1;
      label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    });
    this.showRulerLabel();
  }

  // Beside the middle of the ruler.
  private showRulerLabel(): void {
    const { report, store } = this.page;
    const reading = readingNow(this.page);
    this.rulerLabel.hidden = true;
    if (!reading) return;
    const [from, to] = reading.ends.map((o) => new Vector3().fromArray(report.runs[store.state.current].position.values, 3 * o));
    const side = sideOfLabel(this.project(from.toArray()), this.project(to.toArray()));
    const [x, y, depth] = this.project(from.add(to).divideScalar(2).toArray());
    this.rulerLabel.hidden = depth >= 1;
    this.rulerLabel.classList.toggle("below", side > 0);
    setText(this.rulerLabel, lengthText(reading, report.unit));
    this.rulerLabel.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
  }
}

// Whether WebGL is drawn by a GPU: without one smooth edges cost too much.
function hasGpu(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  if (!context) throw new Error("no WebGL");
  const names = context.getExtension("WEBGL_debug_renderer_info");
  const renderer = String(context.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : context.RENDERER));
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return !/swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer);
}
