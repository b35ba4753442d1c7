// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Figures and options: a row each, a column a run.

import { byId, element } from "./dom";
import type { Page } from "./page";
import type { Run } from "./run";
import { type Changed, anyOf } from "./state";

interface Row {
  group: string;
  name: string;
  values: (string | undefined)[];   // of each run
}

export class Tables {
  private readonly filter = byId<HTMLInputElement>("option-filter");
  private readonly differing = byId<HTMLInputElement>("option-differing");

  constructor(private readonly page: Page) {
    const several = page.report.runs.length > 1;
    this.differing.checked = several;
    this.differing.parentElement!.hidden = !several;
    this.filter.addEventListener("input", () => this.showOptions());
    this.differing.addEventListener("change", () => this.showOptions());
    this.showFigures();
    this.showOptions();
  }

  update(changed: Changed): void {
    if (!anyOf(changed, "revision")) return;
    this.showFigures();
    this.showOptions();
  }

  private showFigures(): void {
    const rows = rowsOf(this.page.report.runs, (run) => [
      ["Run", "ended as", run.status], ...(run.note ? [["Run", "note", run.note] as [string, string, string]] : []), ...run.figures,
    ]);
    byId("figures").replaceChildren(this.table(rows, "figure"));
  }

  private showOptions(): void {
    const text = this.filter.value.trim().toLowerCase();
    const rows = rowsOf(this.page.report.runs, (run) => run.options.map(([name, value]) => ["", name, value]));
    const shown = rows.filter(({ name, values }) =>
      (!this.differing.checked || values.some((value) => value !== values[0])) &&
      (name.toLowerCase().includes(text) || values.some((value) => value?.toLowerCase().includes(text))));
    const why = this.differing.checked && !text ? "All options are the same." : "No option matches.";
    byId("options").replaceChildren(shown.length ? this.table(shown, "option") : element("p", { className: "muted", textContent: why }));
  }

  private table(rows: Row[], what: string): HTMLElement {
    const { runs } = this.page.report;
    const head = element("tr", {}, element("th", { scope: "col", textContent: what }),
      ...runs.map((run) => element("th", { scope: "col" }, ...breakable(run.name))));
    const body = element("tbody");
    let group = "";
    for (const row of rows) {
      if (row.group !== group) {
        group = row.group;
        body.append(element("tr", { className: "group" }, element("th", { scope: "rowgroup", colSpan: runs.length + 1, textContent: group })));
      }
      body.append(element("tr", {}, element("th", { scope: "row" }, ...breakable(row.name)),
        ...row.values.map((value) => element("td", { textContent: value ?? "–" }))));
    }
    return element("table", {}, element("thead", {}, head), body);
  }
}

// May go on in the next line after these signs, as names of options and runs have no spaces.
function breakable(name: string): (Node | string)[] {
  return name.split(/(?<=[._/])/).flatMap((part, i) => (i === 0 ? [part] : [element("wbr"), part]));
}

// Rows of equal group and name are one; groups stay together, in the order in which they come first.
function rowsOf(runs: Run[], entries: (run: Run) => [string, string, string][]): Row[] {
  const groups = new Map<string, Map<string, Row>>();
  runs.forEach((run, index) => {
    for (const [group, name, value] of entries(run)) {
      if (!groups.has(group)) groups.set(group, new Map());
      const rows = groups.get(group)!;
      if (!rows.has(name)) rows.set(name, { group, name, values: new Array(runs.length).fill(undefined) });
      rows.get(name)!.values[index] = value;
    }
  });
  return [...groups.values()].flatMap((rows) => [...rows.values()]);
}
