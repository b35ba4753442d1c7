// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A term of the joint problem's cost and what it costs. Who reports, stores or shows costs needs to know no term: a
// list of them is as long as the problem has terms, in its order.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace pliant {

struct CostTerm {
  std::string name;  // "spatial"
  double value = 0;  // 0.5 * lambda * sum of rho

  bool operator==(const CostTerm&) const = default;
};

inline double TotalCost(std::span<const CostTerm> costs) {
  double total = 0;
  for (const CostTerm& cost : costs) total += cost.value;
  return total;
}

// 0 where there is no term of this name.
inline double CostOf(std::span<const CostTerm> costs, std::string_view name) {
  for (const CostTerm& cost : costs)
    if (cost.name == name) return cost.value;
  return 0;
}

}  // namespace pliant
