// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/ticks.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "pliant/base/text.h"

namespace pliant {
namespace {

// Of an interval's length (of a decade, in logarithms): an end that is off by rounding only is still in it.
constexpr double kRounding = 1e-9;

constexpr std::array kLeadingDigits = {1, 2, 5};

double Power(int exponent) { return std::pow(10.0, exponent); }

int DigitsAfterPoint(int exponent) { return std::max(0, -exponent); }

}  // namespace

std::vector<Tick> LinearTicks(double low, double high, int max_count) {
  assert(std::isfinite(low) && std::isfinite(high) && low < high && max_count >= 1);
  const double slack = kRounding * (high - low);
  const int smallest = static_cast<int>(std::floor(std::log10((high - low) / max_count))) - 1;
  for (int exponent = smallest;; ++exponent) {
    for (const int digit : kLeadingDigits) {
      const double step = digit * Power(exponent);
      const double first = std::ceil((low - slack) / step);
      const double last = std::floor((high + slack) / step);
      if (last - first + 1 > max_count) continue;
      std::vector<Tick> ticks;
      for (double i = first; i <= last; ++i) {
        const double value = i == 0 ? 0 : i * step;  // never -0
        ticks.push_back({value, Digits(value, DigitsAfterPoint(exponent))});
      }
      return ticks;
    }
  }
}

std::vector<Tick> LogarithmicTicks(double low, double high, int max_count) {
  assert(std::isfinite(high) && 0 < low && low < high && max_count >= 1);
  const int first = static_cast<int>(std::floor(std::log10(low)));
  const int last = static_cast<int>(std::floor(std::log10(high) + kRounding));
  const auto ticks_of = [&](std::size_t digits, int every) {
    std::vector<Tick> ticks;
    for (int exponent = first; exponent <= last; ++exponent) {
      if (exponent % every != 0) continue;
      for (std::size_t i = 0; i < digits; ++i) {
        const double value = kLeadingDigits[i] * Power(exponent);
        if (value < low * (1 - kRounding) || value > high * (1 + kRounding)) continue;
        ticks.push_back({value, Digits(value, DigitsAfterPoint(exponent))});
      }
    }
    return ticks;
  };
  std::vector<Tick> ticks = ticks_of(kLeadingDigits.size(), 1);
  for (int every = 1; static_cast<int>(ticks.size()) > max_count; ++every) ticks = ticks_of(1, every);
  return ticks;
}

}  // namespace pliant
