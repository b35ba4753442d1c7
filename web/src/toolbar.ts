// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The runs, the color mode with its legend, the layers of the 3D view, the theme.

import { type Mode, colorModes, gradientOf, paletteOf, runColor } from "./colors";
import { byId, element, setText, short } from "./dom";
import { RUN_SHAPES } from "./marks";
import type { Page } from "./page";
import type { Report } from "./report";
import { type Changed, LAYERS, type Layer, THEMES, type Theme, VIEWS, anyOf } from "./state";
import { SURFACE_COLORS, type SurfaceColor, colorMapOf } from "./surface";

const SHAPE_SIGNS = { square: "■", triangle: "▲", diamond: "◆" } as Record<string, string>;
const LAYER_TITLES: Record<Layer, string> = {
  surface: "the surface that pliant surface made (s)", map: "the undeformed map (m)", points: "the points where they are now (o)", trails: "where they were in the last frames, from where they rest (t)",
  path: "the camera's path (p)", truth: "true camera path and surface (g)", grid: "grid and axes (x)",
};
const prefersDark = window.matchMedia("(prefers-color-scheme: dark)");

export class Toolbar {
  private modes: Mode[] = [];
  private readonly color = byId<HTMLSelectElement>("color");
  private readonly surfaceColor = byId<HTMLSelectElement>("surface-color");
  private readonly surfaceColors: SurfaceColor[];
  private readonly trail = byId<HTMLInputElement>("trail");
  private readonly layers: Record<string, HTMLButtonElement> = {};
  private readonly runs: { box: HTMLInputElement; button: HTMLButtonElement }[];

  constructor(private readonly page: Page) {
    const { report, store } = page;
    this.color.addEventListener("change", () => store.change({ color: this.color.value }));
    byId("gradient").style.backgroundImage = gradientOf("viridis");
    this.runs = report.runs.map((run, index) => this.makeRun(run.name, index));
    for (const layer of LAYERS) this.makeLayer(layer);
    byId("surface-tools").hidden = !hasSurface(report);
    this.surfaceColors = SURFACE_COLORS.filter((color) => color !== "error" || hasSurfaceErrors(report));
    this.surfaceColor.append(...this.surfaceColors.map((color) => element("option", { value: color, textContent: color.replace("_", " ") })));
    this.surfaceColor.addEventListener("change", () => store.change({ surfaceColor: this.surfaceColor.value as SurfaceColor }));
    this.trail.addEventListener("input", () => store.change({ trail: Number(this.trail.value) }));
    for (const view of VIEWS) byId(`view-${view}`).addEventListener("click", () => store.change({ view }));
    byId("theme").addEventListener("click", () => this.cycleTheme());
    prefersDark.addEventListener("change", () => this.setTheme(store.state.theme));
    this.setTheme(store.state.theme);
    this.showAll();
  }

  update(changed: Changed): void {
    if (anyOf(changed, "position")) this.showSurfaceLegend();
    if (anyOf(changed, "current", "visible", "color", "layers", "surfaceColor", "trail", "view", "theme", "dark", "revision")) this.showAll();
  }

  cycleColor(step: number): void {
    const { store } = this.page;
    const index = this.modes.findIndex(({ name }) => name === store.state.color);
    store.change({ color: this.modes[(index + step + this.modes.length) % this.modes.length].name });
  }

  cycleSurfaceColor(): void {
    const { store } = this.page;
    store.change({ surfaceColor: this.surfaceColors[(this.surfaceColors.indexOf(store.state.surfaceColor) + 1) % this.surfaceColors.length] });
  }

  cycleView(): void {
    const { store } = this.page;
    store.change({ view: VIEWS[(VIEWS.indexOf(store.state.view) + 1) % VIEWS.length] });
  }

  cycleTheme(): void {
    this.setTheme(THEMES[(THEMES.indexOf(this.page.store.state.theme) + 1) % THEMES.length]);
  }

  toggleLayer(layer: Layer): void {
    const { store } = this.page;
    store.change({ layers: { ...store.state.layers, [layer]: !store.state.layers[layer] } });
  }

  makeCurrent(run: number): void {
    const { report, store } = this.page;
    if (run >= report.runs.length || run === store.state.current) return;
    store.change({ current: run, picked: null, measured: null, measuring: false, visible: store.state.visible.map((visible, i) => visible || i === run) });
  }

  private setTheme(theme: Theme): void {
    const dark = theme === "dark" || (theme === "auto" && prefersDark.matches);
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    this.page.store.change({ theme, dark });
  }

  private makeRun(name: string, index: number): { box: HTMLInputElement; button: HTMLButtonElement } {
    const { store } = this.page;
    const box = element("input", { type: "checkbox", ariaLabel: `show ${name}` });
    box.addEventListener("change", () => {
      store.change({ visible: store.state.visible.map((visible, i) => (i === index ? box.checked : visible)) });
    });
    const button = element("button", { type: "button", title: `show ${name} in full (${index + 1})` },
      element("span", { className: "swatch", ariaHidden: "true" }), name);
    button.addEventListener("click", () => this.makeCurrent(index));
    byId("runs").append(element("li", {}, box, button));
    return { box, button };
  }

  private makeLayer(layer: Layer): void {
    const button = element("button", { type: "button", title: LAYER_TITLES[layer] },
      element("span", { className: "swatch", ariaHidden: "true" }), layer);
    button.addEventListener("click", () => this.toggleLayer(layer));
    const { report } = this.page;
    button.hidden = (layer === "truth" && !report.truth && !report.runs.some((run) => run.truth)) ||
      (layer === "surface" && !hasSurface(report));
    this.layers[layer] = button;
    byId("layers").append(button);
  }

  private showAll(): void {
    const { state } = this.page.store;
    this.showModes();
    this.showRuns();
    this.showLegend();
    this.showSurfaceLegend();
    const palette = paletteOf(state.dark);
    const swatches: Partial<Record<Layer, string>> = {
      map: palette.map, trails: palette.trails, path: runColor(state.dark, state.current), truth: palette.truth,
    };
    for (const layer of LAYERS) {
      const button = this.layers[layer];
      button.setAttribute("aria-pressed", String(state.layers[layer]));
      const swatch = button.firstElementChild as HTMLElement;
      swatch.hidden = !swatches[layer];
      swatch.style.background = swatches[layer] ?? "";
    }
    for (const view of VIEWS) byId(`view-${view}`).setAttribute("aria-pressed", String(view === state.view));
    this.trail.value = String(state.trail);
    setText(byId("trail-value"), String(state.trail));
    setText(byId("theme"), `Theme: ${state.theme}`);
  }

  // A live run has some of them only from its first points on.
  private showModes(): void {
    const modes = colorModes(this.page.report);
    if (modes.length === this.modes.length) return;
    this.modes = modes;
    this.color.replaceChildren(...modes.map(({ name, label }) => element("option", { value: name, textContent: label })));
  }

  private showRuns(): void {
    const { visible, current, dark } = this.page.store.state;
    this.runs.forEach(({ box, button }, index) => {
      box.checked = visible[index];
      button.setAttribute("aria-pressed", String(index === current));
      const swatch = button.firstElementChild as HTMLElement;
      swatch.style.color = runColor(dark, index);
      swatch.textContent = index === current ? "●" : SHAPE_SIGNS[RUN_SHAPES[index % RUN_SHAPES.length]];
    });
  }

  private showSurfaceLegend(): void {
    const { report, store } = this.page;
    const { surfaceColor, current, position } = store.state;
    this.surfaceColor.value = surfaceColor;
    const run = report.runs[current];
    const submap = run.frames.submap[report.row(current, position)];
    const surface = run.surfaces.find((candidate) => candidate.submap === submap) ?? run.surfaces[0];
    byId("surface-scale").hidden = surfaceColor === "image" || !surface;
    if (surfaceColor === "image" || !surface) return;
    const { low, high } = surface.range(surfaceColor);
    byId("surface-gradient").style.backgroundImage = gradientOf(colorMapOf(surfaceColor));
    const change = surfaceColor === "area_change";
    setText(byId("surface-low"), change ? `${short(100 * low)}` : short(low));
    setText(byId("surface-high"), change ? `${short(100 * high)} %` : `${short(high)} ${surfaceColor === "error" ? "mm" : report.unit}`);
  }

  private showLegend(): void {
    const { mode, low, high } = this.page.coloring;
    this.color.value = mode.name;
    byId("scale").hidden = mode.value === null;
    const known = !Number.isNaN(low);
    setText(byId("scale-low"), known ? short(low) : "no values");
    setText(byId("scale-high"), known ? `${short(high)} ${mode.unit}` : "");
  }
}

function hasSurface(report: Report): boolean {
  return report.runs.some((run) => run.surfaces.length > 0);
}

function hasSurfaceErrors(report: Report): boolean {
  return report.runs.some((run) => run.surfaces.some(({ arrays }) => arrays.errors.length > 0));
}
