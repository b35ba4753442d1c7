// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Strong identifiers. An `_id` is sparse and never reused; an `_idx` is a position in a container and a plain int.
#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <functional>

namespace pliant {

// A material point of the scene: it keeps its id over its whole life. Ids grow in the order of creation, from 0.
struct PointId {
  std::int64_t value = -1;
  bool valid() const { return value >= 0; }
  auto operator<=>(const PointId&) const = default;
};

// The element with this `id` in a vector (or span) that is sorted by it, or null.
template <class Sorted>
auto FindById(Sorted& sorted, PointId id) -> decltype(sorted.data()) {
  const auto found = std::lower_bound(sorted.begin(), sorted.end(), id,
                                      [](const auto& element, PointId wanted) { return element.id < wanted; });
  return found != sorted.end() && found->id == id ? &*found : nullptr;
}

}  // namespace pliant

template <>
struct std::hash<pliant::PointId> {
  std::size_t operator()(pliant::PointId id) const noexcept { return std::hash<std::int64_t>()(id.value); }
};
