// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Playing, scrubbing, and the strip that shows the state of every frame.

import { paletteOf } from "./colors";
import { byId, element, prepare, setText } from "./dom";
import type { Page } from "./page";
import { type Changed, anyOf } from "./state";

const STATE_TEXTS: Record<string, string> = {
  tracking: "tracking", provisional: "provisional map", lost: "lost", initializing: "initializing", ambiguous: "camera and scene cannot be told apart", waiting_for_reference: "waiting for the reference",
};
const LANE_PX = 14;
const BAR_PX = 12;
const HEIGHTS: Record<string, number> = { tracking: 1, provisional: 1, lost: 0.5, initializing: 0.7, ambiguous: 0.5, waiting_for_reference: 0.3 };

export class Timeline {
  private readonly slider = byId<HTMLInputElement>("slider");
  private readonly strip = byId<HTMLCanvasElement>("strip");
  private readonly playButton = byId<HTMLButtonElement>("play");
  private readonly loopButton = byId<HTMLButtonElement>("loop");
  private readonly speed = byId<HTMLSelectElement>("speed");
  private startedAt = { clock: 0, time: 0 };
  private shownAt: number[] = [];   // when the last frames were shown, ms

  constructor(private readonly page: Page) {
    const { store } = page;
    this.slider.addEventListener("input", () => this.go(Number(this.slider.value)));
    this.playButton.addEventListener("click", () => this.toggle());
    this.loopButton.addEventListener("click", () => store.change({ loop: !store.state.loop }));
    byId("step-back").addEventListener("click", () => this.step(-1));
    byId("step-on").addEventListener("click", () => this.step(1));
    this.speed.addEventListener("change", () => {
      store.change({ speed: Number(this.speed.value) });
      this.restart();
    });
    const scrub = (event: PointerEvent) => {
      if (event.buttons === 1) this.go(Math.floor((event.offsetX / this.strip.clientWidth) * page.report.frames.length));
    };
    this.strip.addEventListener("pointerdown", (event) => {
      this.strip.setPointerCapture(event.pointerId);
      scrub(event);
    });
    this.strip.addEventListener("pointermove", scrub);
    new ResizeObserver(() => this.drawStrip()).observe(this.strip);
    this.showFrame();
    this.showButtons();
  }

  update(changed: Changed): void {
    if (anyOf(changed, "dark", "visible", "revision")) this.drawStrip();
    if (anyOf(changed, "position", "current", "revision")) this.showFrame();
    if (anyOf(changed, "playing", "loop", "speed")) this.showButtons();
  }

  step(frames: number): void {
    this.go(this.page.store.state.position + frames);
  }

  // By hand: this ends playing and following.
  go(position: number): void {
    const last = this.page.report.frames.length - 1;
    const to = Math.min(last, Math.max(0, position));
    this.page.store.change({ position: to, playing: false, newest: to === last });
  }

  toggle(): void {
    const { store, report } = this.page;
    if (store.state.playing) {
      store.change({ playing: false });
      return;
    }
    const atEnd = store.state.position === report.frames.length - 1;
    store.change({ playing: true, newest: false, position: atEnd ? 0 : store.state.position });
    this.restart();
    this.shownAt = [];
    requestAnimationFrame((clock) => this.play(clock));
  }

  // Over the last second of playing.
  framesPerSecond(): number {
    const shown = this.shownAt;
    return shown.length < 2 ? 0 : (1000 * (shown.length - 1)) / (shown[shown.length - 1] - shown[0]);
  }

  private restart(): void {
    this.startedAt = { clock: performance.now(), time: this.page.report.times[this.page.store.state.position] };
  }

  // The frame of this time: frames are skipped where the page is slower than they are.
  private play(clock: number): void {
    const { report, store } = this.page;
    if (!store.state.playing) return;
    const last = report.frames.length - 1;
    const time = this.startedAt.time + ((clock - this.startedAt.clock) / 1000) * store.state.speed;
    const position = report.positionAtTime(time);
    if (position !== store.state.position) {
      store.change({ position });
      store.flush();
      this.shownAt = [...this.shownAt.filter((shown) => shown > clock - 1000), clock];
    }
    if (position === last) {
      if (!store.state.loop) {
        store.change({ playing: false });
        return;
      }
      store.change({ position: 0 });
      this.restart();
    }
    requestAnimationFrame((next) => this.play(next));
  }

  private showButtons(): void {
    const { playing, loop, speed } = this.page.store.state;
    setText(this.playButton, playing ? "Pause" : "Play");
    this.loopButton.setAttribute("aria-pressed", String(loop));
    this.speed.value = String(speed);
  }

  private showFrame(): void {
    const { report, store } = this.page;
    const { position, current } = store.state;
    const frame = report.frames[position];
    const row = report.row(current, position);
    const { frames } = report.runs[current];
    const state = row < 0 ? "not in this run" : STATE_TEXTS[frames.state[row]] ?? frames.state[row];
    const note = row < 0 ? "" : frames.note[row] ?? "";
    this.slider.max = String(report.frames.length - 1);
    this.slider.value = String(position);
    this.slider.setAttribute("aria-valuetext", `frame ${frame}, ${state}`);
    setText(byId("frame"), `frame ${frame} of ${report.frames[report.frames.length - 1]}`);
    setText(byId("time"), `${report.times[position].toFixed(2)} s`);
    setText(byId("frame-state"), state);
    byId("frame-state").dataset.state = row < 0 ? "" : frames.state[row];
    setText(byId("frame-note"), note);
  }

  // A lane for each visible run, a bar for each frame.
  private drawStrip(): void {
    const { report, store } = this.page;
    const { visible, dark } = store.state;
    const lanes = report.runs.map((_, run) => run).filter((run) => visible[run]);
    this.strip.style.height = `${Math.max(1, lanes.length) * LANE_PX}px`;
    const { context, width } = prepare(this.strip);
    if (width === 0) return;
    const shown = new Set<string>();
    lanes.forEach((run, lane) => {
      const { frames } = report.runs[run];
      for (let from = 0, to; from < report.frames.length; from = to) {
        const state = frames.state[report.row(run, from)];
        for (to = from + 1; to < report.frames.length && frames.state[report.row(run, to)] === state;) ++to;
        if (!state) continue;
        shown.add(state);
        const x = (from / report.frames.length) * width;
        drawState(context, state, dark, x, LANE_PX * (lane + 1) - 1, ((to - from) / report.frames.length) * width);
      }
    });
    this.strip.title = lanes.length > 1 ? `from above: ${lanes.map((run) => report.runs[run].name).join(", ")}` : "";
    this.showLegend([...shown]);
  }

  private showLegend(states: string[]): void {
    const legend = byId("states");
    legend.replaceChildren();
    for (const state of states) {
      const canvas = element("canvas");
      legend.append(element("span", {}, canvas, STATE_TEXTS[state] ?? state));
      const { context, width, height } = prepare(canvas);
      drawState(context, state, this.page.store.state.dark, 0, height, width);
    }
  }
}

// Its height and pattern tell the state as well as its color.
function drawState(context: CanvasRenderingContext2D, state: string, dark: boolean, x: number, bottom: number, width: number): void {
  const { states } = paletteOf(dark);
  const height = BAR_PX * (HEIGHTS[state] ?? 0.5);
  const top = bottom - height;
  context.fillStyle = states[state] ?? states.initializing;
  if (state === "tracking") return context.fillRect(x, top, width, height);
  context.fillRect(x, top, width, 2);
  const step = state === "lost" ? 3 : 5;
  for (let at = x; at < x + width; at += step) context.fillRect(at, top, Math.min(step / 2, x + width - at), height);
}
