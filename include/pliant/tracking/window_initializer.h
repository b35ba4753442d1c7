// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The first map from one moving camera and a scene that deforms meanwhile: all frames since the reference, their poses,
// the points and the points' motions in one problem (pliant/estimation/deforming_window.h; docs/method.md, eq. W1 to
// W12). A map is sought every few frames, first of a rigid scene, and if it is none of one that deforms; it answers
// with a map once most points are certain, and demands less of them the longer it waits. Points that are uncertain or
// contradict the solution stay out. The map is scaled once, so that its median depth is nominal_depth_mm.
#pragma once

#include <memory>

#include "pliant/base/options.h"
#include "pliant/estimation/deforming_window.h"
#include "pliant/tracking/initializer.h"

namespace pliant {

struct WindowInitOptions {
  int first_frame = 10;               // frames after the reference at which a map is first sought
  int every = 5;                      // frames from one attempt to the next
  int deforming_frame = 20;           // before it a map is sought of a rigid scene alone
  int last_frame = 50;                // after so many a reference is given up
  int views = 8;                      // frames in the problem, spread evenly
  int min_views = 5;                  // a point must be seen in as many of them
  double min_frame_share = 0.375;     // of all frames, in which a point must be seen to join the map
  int max_points = 600;               // in the problem
  int min_points = 40;                // fewer certain points in the last frame make no map
  double max_correlation = 0.25;      // of neighbors' errors under a rigid motion: above, the scene deforms
  double certain_depth_sigma = 0.02;  // of a point by the median depth, until deforming_frame
  double last_depth_sigma = 0.06;     // the same at last_frame
  double max_depth_sigma = 0.03;      // a point that is less certain than this, and than those, stays out
  double max_error_px = 0.5;          // root mean square, of a point
  double min_certain_share = 0.65;    // of the points still seen
  Switch light = Switch::kOn;
  double gamma = 2.2;
  Switch refine_rigid = Switch::kOn;  // the map is made again as the window grows, while the scene is rigid
  DeformingWindowOptions window;

  void List(OptionTable& table);  // group "WindowInit", and "Window"
};

std::unique_ptr<Initializer> MakeWindowInitializer(const WindowInitOptions& options, double nominal_depth_mm);

}  // namespace pliant
