// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where an axis has its numbers.
#pragma once

#include <string>
#include <vector>

namespace pliant {

struct Tick {
  double value = 0;
  std::string label;
};

// The multiples of 1, 2 or 5 times a power of ten in [low, high], of the smallest such step that gives no more than
// `max_count`, at least 1. All labels have the same number of digits after the point. low < high, both finite.
std::vector<Tick> LinearTicks(double low, double high, int max_count);

// For an axis with a logarithmic scale, 0 < low < high: 1, 2 and 5 times the powers of ten in [low, high]; where these
// are more than `max_count`, the powers of ten alone, or every second, third, ... of them. Every label has the digits
// that it needs.
std::vector<Tick> LogarithmicTicks(double low, double high, int max_count);

}  // namespace pliant
