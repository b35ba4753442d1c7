// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A uPlot over the frames: a line at the current one, a press or a drag sets it, shift + drag or ctrl + wheel zooms.

import uPlot from "uplot";
import { paletteOf } from "./colors";
import type { Column } from "./data";
import { element, setText, short } from "./dom";

export interface Series {
  label: string;
  values: Column;   // an entry for each position of the time line
  color: string;
  dash: number[];
}

export interface PlotOptions {
  title: string;
  unit: string;
  log?: boolean;
  stacked?: boolean;
  note?: string;   // below the legend
  frames: number[];
  series: Series[];
  dark: boolean;
  height: number;
  go: (position: number) => void;
  zoom: (range: [number, number] | null) => void;
}

const ZOOM_A_STEP = 1.25;
const LABEL_FONT = "11px system-ui, sans-serif";
const LABEL_GAP_PX = 4;
const LEAST_LABEL_PX = 42;   // so that plots beside each other begin at the same place

export class Plot {
  readonly element: HTMLElement;
  private readonly body = element("div", { className: "plot-body" });
  private readonly legend = element("ul", { className: "plot-legend" });
  private readonly note = element("p", { className: "muted hint" });
  private readonly line = element("div", { className: "plot-now" });
  private readonly logButton = element("button", { type: "button", textContent: "log", title: "logarithmic scale" });
  private readonly values: HTMLElement[] = [];
  private readonly hidden: boolean[];
  private plot!: uPlot;
  private position = 0;
  private log: boolean;

  constructor(private readonly options: PlotOptions) {
    this.log = options.log ?? false;
    this.hidden = options.series.map(() => false);
    const unit = options.unit ? element("span", { className: "muted", textContent: `, ${options.unit}` }) : "";
    const head = element("figcaption", {}, element("strong", { textContent: options.title }), unit);
    if (!options.stacked) head.append(this.logButton);
    this.logButton.addEventListener("click", () => {
      this.log = !this.log;
      this.make();
    });
    this.element = element("figure", { className: "plot" }, head, this.body, this.legend, this.note);
    setText(this.note, options.note ?? "");
    options.series.forEach((series, i) => this.legend.append(this.legendItem(series, i)));
    this.make();
  }

  get size(): number {
    return this.options.series.length;
  }

  setData(frames: number[], series: Series[], note?: string): void {
    setText(this.note, note ?? "");
    this.options.frames = frames;
    series.forEach(({ values }, i) => { this.options.series[i].values = values; });
    this.plot.setData(this.data());
    this.showPosition(this.position);
  }

  setRange(range: [number, number] | null): void {
    const { frames } = this.options;
    const [min, max] = range ?? [frames[0], frames[frames.length - 1]];
    this.plot.setScale("x", { min, max });
  }

  showPosition(position: number): void {
    this.position = position;
    const x = this.plot.valToPos(this.options.frames[position], "x");
    this.line.hidden = !(x >= 0 && x <= this.plot.over.clientWidth);
    this.line.style.transform = `translateX(${x.toFixed(1)}px)`;
    this.values.forEach((value, i) => setText(value, short(this.options.series[i].values[position])));
  }

  resize(): void {
    const width = this.body.clientWidth;
    if (width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: this.options.height });
    this.showPosition(this.position);
  }

  destroy(): void {
    this.plot.destroy();
  }

  private make(): void {
    const old = this.plot as uPlot | undefined;
    const range = old ? [old.scales.x.min!, old.scales.x.max!] as [number, number] : null;
    old?.destroy();
    this.logButton.setAttribute("aria-pressed", String(this.log));
    this.plot = new uPlot(this.uplotOptions(), this.data(), this.body);
    this.plot.over.append(this.line);
    this.hidden.forEach((hidden, i) => hidden && this.plot.setSeries(i + 1, { show: false }));
    this.listen();
    if (range) this.setRange(range);
    this.showPosition(this.position);
  }

  private uplotOptions(): uPlot.Options {
    const { series, stacked, dark, height } = this.options;
    const palette = paletteOf(dark);
    const axis: uPlot.Axis = {
      stroke: palette.text, font: LABEL_FONT, grid: { stroke: palette.grid, width: 1 }, ticks: { show: false }, gap: LABEL_GAP_PX,
    };
    return {
      width: Math.max(100, this.body.clientWidth),
      height,
      // Half of the last frame's label is beyond the end of the axis.
      padding: [7, () => 2 + widthOf(String(this.options.frames[this.options.frames.length - 1])) / 2, 0, 0],
      legend: { show: false },
      scales: { x: { time: false }, y: this.log ? { distr: 3 } : { range: (_, min, max) => rangeOf(min, max, stacked ?? false) } },
      axes: [
        { ...axis, size: 22, space: 60, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000], values: (_, ticks) => ticks.map(String) },
        {
          ...axis, space: 28, values: (_, ticks) => ticks.map((tick) => (tick === null ? "" : compact(tick))),
          size: (_, labels) => LABEL_GAP_PX + Math.max(LEAST_LABEL_PX, ...(labels ?? []).map(widthOf)),
        },
      ],
      cursor: {
        y: false,
        points: { show: false },
        drag: { x: true, y: false, setScale: false },
        // Only with shift is a drag uPlot's own.
        bind: {
          mousedown: (_u, _target, handler) => (event) => { if (event.shiftKey) handler(event); return null; },
          dblclick: () => () => { this.options.zoom(null); return null; },
        },
      },
      series: [
        {},
        ...series.map(({ color, dash }, i) => ({
          stroke: color, width: dash.length ? 1.25 : 1.5, dash, points: { show: false },
          fill: stacked ? `${color}${i % 2 ? "55" : "33"}` : undefined,
        })),
      ],
      bands: stacked ? series.slice(1).map((_, i) => ({ series: [i + 2, i + 1] as [number, number] })) : undefined,
      hooks: {
        setSelect: [(plot) => {
          const { left, width } = plot.select;
          if (width > 3) this.options.zoom([plot.posToVal(left, "x"), plot.posToVal(left + width, "x")]);
          plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
        }],
        setScale: [(plot, key) => { if (key === "x" && plot.over) this.showPositionLater(); }],
      },
    };
  }

  private showPositionLater(): void {
    requestAnimationFrame(() => this.showPosition(this.position));
  }

  private data(): uPlot.AlignedData {
    const { frames, series, stacked } = this.options;
    const shown = series.map(({ values }) => (this.log ? values.map((value) => (value !== null && value > 0 ? value : null)) : values));
    if (!stacked) return [frames, ...shown];
    const sum: number[] = new Array(frames.length).fill(0);
    return [frames, ...shown.map((values, s) => values.map((value, i) => {
      if (!this.hidden[s]) sum[i] += value ?? 0;
      return value === null ? null : sum[i];
    }))];
  }

  private listen(): void {
    const { over } = this.plot;
    const go = (event: PointerEvent) => {
      if (event.buttons !== 1 || event.shiftKey) return;
      const value = this.plot.posToVal(event.clientX - over.getBoundingClientRect().left, "x");
      this.options.go(nearestIndex(this.options.frames, value));
    };
    over.addEventListener("pointerdown", go);
    over.addEventListener("pointermove", go);
    over.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.metaKey && !event.shiftKey) return;
      event.preventDefault();
      const { min, max } = this.plot.scales.x;
      const at = this.plot.posToVal(event.clientX - over.getBoundingClientRect().left, "x");
      const factor = (event.deltaY || event.deltaX) > 0 ? ZOOM_A_STEP : 1 / ZOOM_A_STEP;
      const { frames } = this.options;
      const low = Math.max(frames[0], at - (at - min!) * factor);
      const high = Math.min(frames[frames.length - 1], at + (max! - at) * factor);
      if (high - low > 2) this.options.zoom([low, high]);
    }, { passive: false });
  }

  // A button that hides and shows its series, with the value at the current frame.
  private legendItem({ label, color, dash }: Series, i: number): HTMLElement {
    const swatch = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    swatch.setAttribute("width", "22");
    swatch.setAttribute("height", "8");
    swatch.setAttribute("aria-hidden", "true");
    swatch.innerHTML = `<line x1="0" y1="4" x2="22" y2="4" stroke="${color}" stroke-width="2" stroke-dasharray="${dash.join(" ")}"/>`;
    const value = element("span", { className: "value" });
    this.values.push(value);
    const button = element("button", { type: "button" }, swatch, label, value);
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      this.hidden[i] = !this.hidden[i];
      button.setAttribute("aria-pressed", String(!this.hidden[i]));
      this.plot.setSeries(i + 1, { show: !this.hidden[i] });
      if (this.options.stacked) this.plot.setData(this.data());
    });
    return element("li", {}, button);
  }
}

function rangeOf(min: number, max: number, stacked: boolean): [number, number] {
  if (min === null || max === null || !Number.isFinite(min)) return [0, 1];
  const [low, high] = uPlot.rangeNum(min, max, 0.1, true) as [number, number];
  return [stacked || (min >= 0 && min < 0.5 * max) ? 0 : low, high];
}

// All digits that a tick has: those next to it may differ in the last one.
function compact(value: number): string {
  const size = Math.abs(value);
  const digits = Number(value.toPrecision(10));
  return size >= 1e5 || (size < 1e-3 && size > 0) ? digits.toExponential() : String(digits);
}

const ruler = document.createElement("canvas").getContext("2d")!;

function widthOf(label: string): number {
  ruler.font = LABEL_FONT;
  return Math.ceil(ruler.measureText(label).width);
}

function nearestIndex(numbers: number[], value: number): number {
  let best = 0;
  for (let i = 1; i < numbers.length; ++i) if (Math.abs(numbers[i] - value) < Math.abs(numbers[best] - value)) best = i;
  return best;
}
