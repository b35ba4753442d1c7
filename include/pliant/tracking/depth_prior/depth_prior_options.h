// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Depth images of another program, such as a network's: a weak measurement, whose scale and shift are not known
// (docs/method.md, section "Depth from outside").
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "pliant/base/options.h"

namespace pliant {

// What a value of such an image grows with, linearly: each up to a scale and a shift of the image.
enum class DepthPriorKind {
  kInverseDepth,  // 1 / z: MiDaS, Depth Anything; also a disparity
  kDepth,         // z: metric networks, Monodepth's depth
};
template <>
struct EnumNames<DepthPriorKind> {
  static constexpr std::array kNames = {std::pair{DepthPriorKind::kInverseDepth, std::string_view("inverse_depth")},
                                        std::pair{DepthPriorKind::kDepth, std::string_view("depth")}};
};

struct DepthPriorOptions {
  std::string path;  // folder of the images; empty: there is none
  DepthPriorKind kind = DepthPriorKind::kInverseDepth;
  double max_step = 0.1;        // relative difference of the four pixels around a point: more is a contour
  Switch window = Switch::kOn;  // in first maps and re-estimations, where brightness is no depth cue

  bool IsGiven() const { return !path.empty(); }
  void List(OptionTable& table);  // group "DepthPrior"
};

}  // namespace pliant
