// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How one image holds a pair.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "pliant/base/options.h"

namespace pliant {

enum class PairLayout {
  kApart,      // it does not: the right ones are images of their own, or there are none
  kLeftRight,  // left half, right half
  kTopBottom,  // the left eye's on top
};
template <>
struct EnumNames<PairLayout> {
  static constexpr std::array kNames = {std::pair{PairLayout::kApart, std::string_view("none")},
                                        std::pair{PairLayout::kLeftRight, std::string_view("left_right")},
                                        std::pair{PairLayout::kTopBottom, std::string_view("top_bottom")}};
};

}  // namespace pliant
