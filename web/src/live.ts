// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Asks the server of a live view for new rows, until the run is over.

import { type Data, checkFormat } from "./data";

// Between two answers: so many times what showing one took, so that a slow browser leaves the machine to the run.
const PAUSES = 40;
const LEAST_PAUSE_MS = 500;
const MOST_PAUSE_MS = 8000;
const FAILURES = 4;   // in a row: then the server is gone

export interface Answer {
  epoch: number;
  from: number;
  running: boolean;
  kept: boolean;  // where the run has ended: the program goes on serving it
  frames_in_sequence: number;
  read: number;
  state: string;
  image_scale: number;
  image_frames: number[];
  data: Data;
}

// `use` takes the rows and returns how many there are now.
export async function poll(use: (answer: Answer) => Promise<number>, say: (text: string) => void): Promise<void> {
  let epoch = 0;
  let rows = 0;
  let pause = 0;   // the server keeps it, unless the run ends before
  for (let failures = 0; ;) {
    let answer: Answer | null = null;
    try {
      const response = await fetch(`/data?epoch=${epoch}&from=${rows}&wait_ms=${Math.round(pause)}`);
      if (response.ok) answer = await response.json();
    } catch {
      // The server does not answer.
    }
    if (answer) {
      failures = 0;
      checkFormat(answer.data);
      const begin = performance.now();
      rows = await use(answer);
      const spent = performance.now() - begin + await drawing();
      epoch = answer.epoch;
      say(sentence(answer, rows));
      if (!answer.running) return;
      pause = Math.min(MOST_PAUSE_MS, Math.max(LEAST_PAUSE_MS, PAUSES * spent));
    } else {
      if (++failures === FAILURES) {
        say("The program does not answer any more: its run has ended, or goes on without this page. What came until now stays.");
        return;
      }
      await new Promise((resolve) => setTimeout(resolve, LEAST_PAUSE_MS));
    }
  }
}

// How long it takes to draw what was changed, milliseconds; a page that is hidden draws nothing.
function drawing(): Promise<number> {
  if (document.hidden) return Promise.resolve(0);
  return new Promise((resolve) => requestAnimationFrame((begin) => setTimeout(() => resolve(performance.now() - begin))));
}

function sentence({ running, kept, state, read, frames_in_sequence: total }: Answer, rows: number): string {
  if (!running && kept) return "The run has ended. It can be looked at here until the program is ended.";
  if (!running) return "The run has ended, and its images with it: `pliant report` makes a page that keeps them.";
  const frame = total > 0 ? `frame ${read} of ${total}` : `frame ${read}`;
  if (state === "initializing" || state === "ambiguous" || state === "waiting_for_reference" || rows === 0) return `Waiting for the first map: ${frame}.`;
  return `Running: ${frame}, ${state}.`;
}
