// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What every view is given.

import type { Coloring } from "./colors";
import type { Images } from "./images";
import type { Report } from "./report";
import type { Store } from "./state";

export interface Page {
  report: Report;
  store: Store;
  images: Images | null;
  coloring: Coloring;
  // Picks the point of an observation of the current run.
  pick(observation: number | null): void;
}
