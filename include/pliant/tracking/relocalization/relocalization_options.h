// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How the camera is found again after the view was lost.
#pragma once

#include "pliant/base/options.h"
#include "pliant/estimation/pose/absolute_pose.h"

namespace pliant {

struct RelocalizationOptions {
  Switch relocalize = Switch::kOn;
  int describe_every = 40;        // frames from one description of the points in view to the next
  int search_every = 5;           // frames, for maps that were left, while another one is awaited
  Switch merge = Switch::kOn;     // maps that meet become one
  int max_inactive_submaps = 10;  // maps that were left and are remembered
  int merge_every = 20;           // frames, for maps that were left, while another one is tracked
  double max_unit_spread = 0.2;   // of two maps' units: median deviation of its logarithm over the points
  int velocity_frames = 10;       // over which the camera's velocity before the loss is taken
  int max_corners = 1000;         // of a lost frame, to compare with the map's points
  double max_ratio = 0.85;        // nearest by second nearest description
  double max_error_px = 8;        // of a point that agrees with a pose
  double min_share = 0.3;         // of the points that a pose should see: those that agree
  AbsolutePoseOptions pose;

  void List(OptionTable& table);  // groups "Relocalization" and "AbsolutePose"
};

}  // namespace pliant
