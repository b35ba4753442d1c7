// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Asks the server of a live view for new rows, until the run is over.

import { type Data, checkFormat } from "./data";

const PAUSE_MS = 500;
const FAILURES = 4;   // in a row: then the server is gone

export interface Answer {
  epoch: number;
  from: number;
  running: boolean;
  frames_in_sequence: number;
  read: number;
  state: string;
  image_scale: number;
  data: Data;
}

// `use` takes the rows and returns how many there are now.
export async function poll(use: (answer: Answer) => Promise<number>, say: (text: string) => void): Promise<void> {
  let epoch = 0;
  let rows = 0;
  for (let failures = 0; ;) {
    let answer: Answer | null = null;
    try {
      const response = await fetch(`/data?epoch=${epoch}&from=${rows}`);
      if (response.ok) answer = await response.json();
    } catch {
      // The server does not answer.
    }
    if (answer) {
      failures = 0;
      checkFormat(answer.data);
      rows = await use(answer);
      epoch = answer.epoch;
      say(sentence(answer, rows));
      if (!answer.running) return;
    } else if (++failures === FAILURES) {
      say("The program does not answer any more: its run has ended, or goes on without this page. What came until now stays.");
      return;
    }
    await new Promise((resolve) => setTimeout(resolve, PAUSE_MS));
  }
}

function sentence({ running, state, read, frames_in_sequence: total }: Answer, rows: number): string {
  if (!running) return "The run has ended.";
  const frame = total > 0 ? `frame ${read} of ${total}` : `frame ${read}`;
  if (state === "initialising" || state === "waiting_for_reference" || rows === 0) return `Waiting for the first map: ${frame}.`;
  return `Running: ${frame}, ${state}.`;
}
