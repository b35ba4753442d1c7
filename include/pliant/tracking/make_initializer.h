// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The initializers by name.
#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <utility>

#include "pliant/base/random.h"
#include "pliant/tracking/depth_initializer.h"
#include "pliant/tracking/known_points_initializer.h"
#include "pliant/tracking/monocular_initializer.h"
#include "pliant/tracking/stereo_start.h"
#include "pliant/tracking/window_initializer.h"

namespace pliant {

enum class InitMethod { kWindow, kGated, kPaper, kStereo, kDepth, kColmapModel };
template <>
struct EnumNames<InitMethod> {
  static constexpr std::array kNames = {std::pair{InitMethod::kWindow, std::string_view("window")},
                                        std::pair{InitMethod::kGated, std::string_view("gated")},
                                        std::pair{InitMethod::kPaper, std::string_view("paper")},
                                        std::pair{InitMethod::kStereo, std::string_view("stereo")},
                                        std::pair{InitMethod::kDepth, std::string_view("depth")},
                                        std::pair{InitMethod::kColmapModel, std::string_view("colmap_model")}};
};

struct InitOptions {
  InitMethod method = InitMethod::kWindow;
  MonocularInitOptions monocular;
  StereoStartOptions stereo;
  DepthInitOptions depth;
  ModelInitOptions model;
  WindowInitOptions window;

  // Whether the map has true units (then the published sigma for metric starts applies).
  bool IsMetric() const {
    return method == InitMethod::kStereo || method == InitMethod::kDepth ||
           (method == InitMethod::kColmapModel && model.unit_mm > 0);
  }
  // Whether the map comes from what is known of the reference image, which therefore has to be read.
  bool TakesKnownDepth() const {
    return method == InitMethod::kStereo || method == InitMethod::kDepth || method == InitMethod::kColmapModel;
  }

  void List(OptionTable& table);  // groups "Init", "WindowInit", "Window"
};

std::unique_ptr<Initializer> MakeInitializer(const InitOptions& options, Random random);

}  // namespace pliant
