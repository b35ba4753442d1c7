// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One list for the keyboard and for its help.

import { byId, element } from "./dom";

export interface Command {
  keys: string[];   // as KeyboardEvent.key says, with "Shift+" before
  shown: string;
  what: string;
  run: (key: string) => void;
}

export function listenToKeys(commands: Command[]): void {
  const help = byId<HTMLDialogElement>("help");
  const toggle = () => (help.open ? help.close() : help.showModal());
  const all: Command[] = [...commands, { keys: ["?"], shown: "?", what: "this help", run: toggle }];
  byId("help-keys").replaceChildren(...all.map(({ shown, what }) =>
    element("tr", {}, element("th", { scope: "row" }, element("kbd", { textContent: shown })), element("td", { textContent: what }))));
  byId("help-button").addEventListener("click", toggle);
  byId("help-close").addEventListener("click", () => help.close());

  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || (help.open && event.key !== "?")) return;
    if (isTaken(event)) return;
    const shift = event.shiftKey && (event.key.length > 1 || /[a-z]/i.test(event.key)) ? "Shift+" : "";
    const key = shift + (event.key.length === 1 ? event.key.toLowerCase() : event.key);
    const command = all.find(({ keys }) => keys.includes(key));
    if (!command) return;
    event.preventDefault();
    command.run(key);
  });
}

// By the control that has the focus.
function isTaken(event: KeyboardEvent): boolean {
  const target = event.target as HTMLElement;
  if (event.key === "Escape") return false;
  if (target instanceof HTMLSelectElement) return true;
  if (target instanceof HTMLInputElement) {
    if (target.type === "search") return true;
    if (target.type === "range") return target.id !== "slider" && /^(Arrow|Home|End|Page)/.test(event.key);
    return event.key === " ";
  }
  return target instanceof HTMLButtonElement && (event.key === " " || event.key === "Enter");
}
