// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The initializers by name: their options, and the function that makes each. Every one is in the source file of its
// name; a new one is such a file, its options and its name here, its line in MakeInitializer, and the list of sources.
// Monocular maps are scaled once, so that their median depth is nominal_depth_mm.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "pliant/base/options.h"
#include "pliant/base/random.h"
#include "pliant/estimation/two_view/relative_pose.h"
#include "pliant/estimation/two_view/two_view_refinement.h"
#include "pliant/estimation/window/deforming_window.h"
#include "pliant/geometry/triangulation.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/bootstrapping/stereo_start.h"
#include "pliant/tracking/depth_prior/depth_prior_options.h"

namespace pliant {

// One moving camera, the scene taken as rigid over a few frames (Gomez Rodriguez et al., IROS 2022; docs/method.md,
// eq. I1 to I12). The options of two methods:
//   paper  k frames after the reference, whatever the motion: RANSAC essential matrix, the smaller rotation, cheirality
//          vote, IDWM triangulation with its cheirality test.
//   gated  waits until the pair can carry a map: a rotation does not explain it, no second motion explains it as well
//          (a plane has one), parallax and predicted depth accuracy suffice; then refines robustly over some of the
//          frames since the reference, and leaves out points whose depth is uncertain or which contradict the map.
struct MonocularInitOptions {
  RelativePoseSolver solver = RelativePoseSolver::kNister;
  RobustLoop robust = RobustLoop::kRansac;
  RigidRefinement refinement = RigidRefinement::kWindow;  // gated only
  TriangulationMethod triangulation = TriangulationMethod::kIdwm;

  // Both.
  double nominal_depth_mm = 50.0;
  double max_error_px = 1.5;
  int max_iterations = 300;
  // Paper: k.
  int paper_frames = 3;

  // Gated: the pair, and the map.
  int min_points = 40;
  double min_parallax_deg = 2.5;
  double max_rotation_share = 0.8;
  double min_inlier_share = 0.5;
  double min_competing_cost_ratio = 1.3;
  double max_median_depth_sigma = 0.03;
  // Gated: one point.
  double sigma_px = 0.5;
  double max_depth_sigma = 0.05;
  // Gated: how long one reference serves.
  int max_window = 60;
  double min_kept_share = 0.4;
  // Gated: the window's refinement.
  int window_frames = 8;

  void List(OptionTable& table);  // appended to the group "Init"
};

// `random` decides RANSAC's samples; every attempt starts from it anew, so that an outcome depends on the input alone.
std::unique_ptr<Initializer> MakeGatedInitializer(const MonocularInitOptions& options, Random random);
std::unique_ptr<Initializer> MakePaperInitializer(const MonocularInitOptions& options, Random random);

// One moving camera and a scene that deforms meanwhile: all frames since the reference, their poses, the points and the
// points' motions in one problem (pliant/estimation/window/deforming_window.h; docs/method.md, eq. W1 to W12). A map is
// attempted every few frames, of a rigid scene first, then of one that deforms; it answers with a map once most
// points are certain, and demands less of them the longer it waits. Points that are uncertain or contradict the
// solution stay out.
struct WindowInitOptions {
  // Attempts also follow when half of the points are lost, before deforming_frame for a provisional map at most.
  int first_frame = 10;                  // frames after the reference at which a map is first attempted
  int every = 5;                         // frames from one attempt to the next
  int deforming_frame = 20;              // before it only a rigid scene is attempted
  int last_frame = 50;                   // frames after which a reference is given up
  int views = 8;                         // frames in the problem, spread evenly
  int rigid_views = 16;                  // the same for a rigid scene: more cost little there
  int min_views = 5;                     // of `views` a point must be seen in, and as large a share of rigid_views
  double min_frame_share = 0.375;        // of all frames, in which a point must be seen to join the map
  int max_points = 600;                  // in the problem
  int min_points = 40;                   // fewer certain points in the last frame make no map
  double max_correlation = 0.2;          // of neighbors' errors under a rigid motion: above, the scene deforms
  double certain_depth_sigma = 0.02;     // of a point by the median depth, until deforming_frame
  double last_depth_sigma = 0.06;        // the same at last_frame
  double max_depth_sigma = 0.03;         // a point that is less certain than this, and than those, stays out
  double max_error_px = 0.5;             // root mean square, of a point
  double min_certain_share = 0.65;       // of the points still seen
  double min_still_camera_ratio = 1.25;  // of the errors of a camera that stands still by those of one that moves
  Switch provisional = Switch::kOn;      // Init.provisional: a map that is less certain than demanded, where none is
  Switch light = Switch::kOn;
  double gamma = 2.2;
  Switch refine_rigid = Switch::kOn;  // the map is re-estimated as the window grows, while the scene is rigid
  DeformingWindowOptions window;
  // No options of their own: the cue that is asked first, whether a depth prior may be (DepthPrior.window), and whether
  // it is said where the images contradict the focal length.
  DistanceCue cue = DistanceCue::kLight;
  Switch prior = Switch::kOn;
  Switch focal_length_check = Switch::kOn;  // takes as long as the map (W16)

  void List(OptionTable& table);  // group "WindowInit", and "Window"
};

std::unique_ptr<Initializer> MakeWindowInitializer(const WindowInitOptions& options, double nominal_depth_mm);

// A depth image of the reference frame (an RGB-D camera, a simulator, a network), or a point cloud of what its camera
// saw: metric, at once. Tracking stays monocular from there.
struct DepthInitOptions {
  double max_depth_step = 0.05;  // relative step among the four pixels around a corner, above it: no point
  int min_points = 40;
  std::string cloud_path;    // a point cloud in the first frame's camera; empty: the sequence's depth images
  double cloud_unit_mm = 1;  // what its unit is

  void List(OptionTable& table);  // appended to the group "Init"
};

std::unique_ptr<Initializer> MakeDepthInitializer(const DepthInitOptions& options);

// The points of a sparse model that has the reference image (COLMAP's, say); its own camera motion is not used.
struct ModelInitOptions {
  std::string path;    // the model's folder
  double unit_mm = 0;  // what its unit is; 0: not known, the median depth becomes the nominal one
  int min_points = 40;

  void List(OptionTable& table);  // appended to the group "Init"
};

// Points whose depth in the reference image is known: those of a model, or of a pair of images. At once.
struct KnownPoints {
  std::string_view name;    // of the initializer, as Init.method has it
  std::string_view source;  // for messages: "the model"
  double unit_mm = 0;       // of the depths; 0: not known, as above
  int min_points = 40;
};

std::unique_ptr<Initializer> MakeKnownPointsInitializer(const KnownPoints& known, double nominal_depth_mm);

// The depth prior of the reference image (InitObservation::log_prior), up to a scale, with the shift that the light
// says: at once, and provisional. It needs no parallax. Of `window` the light is used. `kind` as in DepthPriorOptions.
std::unique_ptr<Initializer> MakePriorInitializer(const MonocularInitOptions& options, const WindowInitOptions& window,
                                                  DepthPriorKind kind);

enum class InitMethod { kWindow, kGated, kPaper, kStereo, kDepth, kColmapModel, kDepthPrior };
template <>
struct EnumNames<InitMethod> {
  static constexpr std::array kNames = {std::pair{InitMethod::kWindow, std::string_view("window")},
                                        std::pair{InitMethod::kGated, std::string_view("gated")},
                                        std::pair{InitMethod::kPaper, std::string_view("paper")},
                                        std::pair{InitMethod::kStereo, std::string_view("stereo")},
                                        std::pair{InitMethod::kDepth, std::string_view("depth")},
                                        std::pair{InitMethod::kColmapModel, std::string_view("colmap_model")},
                                        std::pair{InitMethod::kDepthPrior, std::string_view("depth_prior")}};
};

struct InitOptions {
  InitMethod method = InitMethod::kWindow;
  MonocularInitOptions monocular;
  StereoStartOptions stereo;
  DepthInitOptions depth;
  ModelInitOptions model;
  WindowInitOptions window;
  DepthPriorKind prior_kind = DepthPriorKind::kInverseDepth;  // DepthPrior.kind; no option of its own

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

// The initializer that options.method names.
std::unique_ptr<Initializer> MakeInitializer(const InitOptions& options, Random random);

}  // namespace pliant
