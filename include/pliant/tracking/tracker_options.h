// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// All options of the tracker: those of its parts, and when it is lost.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "pliant/base/options.h"
#include "pliant/deformation/graph.h"
#include "pliant/estimation/frame/frame_problem.h"
#include "pliant/estimation/pose/camera_pose.h"
#include "pliant/image/corners.h"
#include "pliant/image/masks.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "pliant/tracking/depth_prior/depth_prior_options.h"
#include "pliant/tracking/frame/neighbor_agreement.h"
#include "pliant/tracking/map_upkeep/growth_options.h"
#include "pliant/tracking/relocalization/relocalization_options.h"
#include "pliant/tracking/tracks/oracle.h"
#include "pliant/tracking/tracks/point_tracker.h"

namespace pliant {

// What is known of the camera's motion after the first map.
enum class CameraMotion {
  kFree,  // nothing: its pose is estimated in every frame
  kNone,  // it stands still
};
template <>
struct EnumNames<CameraMotion> {
  static constexpr std::array kNames = {std::pair{CameraMotion::kFree, std::string_view("free")},
                                        std::pair{CameraMotion::kNone, std::string_view("none")}};
};

struct TrackerOptions {
  CornerOptions corners;
  MaskOptions masks;
  PointTrackerOptions point_tracker;
  InitOptions init;
  CameraPoseOptions pose;
  GraphOptions graph;
  FrameProblemOptions problem;
  AgreementOptions agreement;
  GrowthOptions growth;
  RelocalizationOptions relocalization;
  DepthPriorOptions depth_prior;
  OracleOptions oracle;

  double sigma_metric_mm = 55.0;  // instead of graph.sigma_mm after a start from metric depth, as published
  CameraMotion camera_motion = CameraMotion::kFree;
  Switch neighbor_agreement = Switch::kOn;
  double common_motion_share = 0.2;     // of the points' common motion since rest, given to the camera in each frame
  Switch find_lost = Switch::kOn;       // points that were lost are searched where their neighbors moved
  int max_searches = 200;               // a frame, for lost points
  int max_lost_points = 500;            // that are remembered: the oldest is forgotten first
  double max_search_px = 8;             // a lost point found farther from where it is expected is another one
  double max_reprojection_px = 2.4477;  // square root of the 95 % quantile of chi-square at 2 degrees of freedom
  int min_points = 12;                  // fewer: lost
  int min_corners = 40;                 // fewer in an image: it is no reference; of tracks from a file 12 do
  int top_up_frames = 10;               // while the first map is awaited, corners are added every Nth frame
  Switch track_blurred = Switch::kOn;   // into blurred images too; before the first map these are passed over
  double min_sharpness = 0.6;           // relative to the last sharp image: less is blurred, or dark
  int max_blurred_frames = 30;          // in a row: then the blur is taken to stay
  int max_lost_frames = 10;             // after so many lost frames in a row that show something the map is left
  Switch submaps = Switch::kOn;         // another one is begun then; off: the tracker gives up
  // After so many frames a map that was made beside tracking, the first or a re-estimated one, is taken over; 0: made
  // and taken over in the frame in which it is due, which waits for it.
  int handover_frames = 0;
  // A frame waits for such a map that is not there in time, so that results do not depend on how fast the machine is;
  // off: the map is taken over when it is there.
  Switch handover_waits = Switch::kOn;
  // Of the frame numbers, SequenceRequest::stride: what is done every Nth frame is done every Nth that is tracked. Not
  // an option by itself.
  int frame_stride = 1;

  // Groups Corners, Masks, LucasKanade, PointTracker, Init, CameraPose, Deformation, Optimization, Tracking, Growth,
  // Relocalization, AbsolutePose, DepthPrior, Oracle, and those of the initializers.
  void List(OptionTable& table);
};

}  // namespace pliant
