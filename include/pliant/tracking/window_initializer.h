// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The first map from one moving camera and a scene that deforms meanwhile: all frames since the reference, their poses,
// the points and the points' motions in one problem (pliant/estimation/deforming_window.h; docs/method.md, eq. W1 to
// W10). A map is sought every few frames; it answers with a map once most points are certain, or else when the window is
// as long as allowed. Points that are uncertain or contradict the solution stay out. The map is scaled once, so that
// its median depth is nominal_depth_mm.
#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <utility>

#include "pliant/base/options.h"
#include "pliant/estimation/deforming_window.h"
#include "pliant/tracking/initializer.h"

namespace pliant {

enum class LightCue { kOff, kOn };
template <>
struct EnumNames<LightCue> {
  static constexpr std::array kNames = {std::pair{LightCue::kOff, std::string_view("off")},
                                        std::pair{LightCue::kOn, std::string_view("on")}};
};

struct WindowInitOptions {
  int first_frame = 30;             // frames after the reference at which a map is first sought
  int every = 15;                   // frames from one attempt to the next
  int last_frame = 60;              // after so many a reference is given up
  int views = 11;                   // frames in the problem, spread evenly
  int min_views = 5;                // a point must be seen in as many of them
  int max_points = 600;             // in the problem
  int min_points = 40;              // fewer certain points in the last frame make no map
  double max_depth_sigma = 0.06;    // of a point by the median depth
  double max_error_px = 0.5;        // root mean square, of a point
  double min_certain_share = 0.65;  // of the points still seen
  LightCue light = LightCue::kOn;
  double gamma = 2.2;
  DeformingWindowOptions window;

  void List(OptionTable& table);  // group "WindowInit", and "Window"
};

std::unique_ptr<Initializer> MakeWindowInitializer(const WindowInitOptions& options, double nominal_depth_mm);

}  // namespace pliant
