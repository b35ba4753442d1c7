// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What every view is given.

import type { Coloring } from "./colors";
import type { Images } from "./images";
import type { Report } from "./report";
import type { End } from "./ruler";
import type { Store } from "./state";

export interface Page {
  report: Report;
  store: Store;
  images: Images | null;
  coloring: Coloring;
  // Picks a point of the current run, by its id.
  pick(id: number, end: End): void;
  unpick(): void;
}
