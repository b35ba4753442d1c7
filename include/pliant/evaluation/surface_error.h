// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far the estimated points lie from the true surface (Gomez Rodriguez et al., IROS 2022, section IV):
//   e_t = sqrt( sum_i | s_t X_i - X_i^gt |^2 / n_t )        plain: no point is trimmed
// X_i is the point in the camera's frame, X_i^gt the true surface point on the ray of the pixel where it was observed:
// z is the depth map interpolated bilinearly at that pixel (never at a rounded one, which costs half a pixel times the
// slope), and no truth is taken across a depth step or next to a hole. What is left out is counted by reason.
// Beside every figure stands its NULL: the same pixels, all at one constant depth, through the same protocol. A figure
// no better than its null says that nothing was reconstructed. Millimetres throughout.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"

namespace pliant {

// What the estimate is multiplied with before it is compared.
enum class SurfaceScale {
  kPerFrame,  // the best scale of each frame: the paper's protocol for maps of a monocular start
  kGlobal,    // one best scale for all frames: drift of the scale counts as error
  kNone,      // 1: for maps that claim millimetres (stereo, depth). The null gets its one best depth all the same
};

template <>
struct EnumNames<SurfaceScale> {
  static constexpr std::array kNames = {std::pair{SurfaceScale::kPerFrame, std::string_view("per_frame")},
                                        std::pair{SurfaceScale::kGlobal, std::string_view("global")},
                                        std::pair{SurfaceScale::kNone, std::string_view("none")}};
};

struct SurfaceErrorOptions {
  SurfaceScale scale = SurfaceScale::kPerFrame;
  double max_depth_step = 0.05;  // relative step among the four pixels around an observation, above it no truth

  void List(OptionTable& table);
};

// A point estimated and its truth, both in the camera's frame of the moment.
struct SurfacePair {
  Eigen::Vector3d estimate;
  Eigen::Vector3d truth;
};

// Observations without a pair, by reason.
struct LeftOutCounts {
  int outside_image = 0;  // no four pixels around
  int no_depth = 0;       // the truth has a hole there
  int depth_step = 0;     // the truth is discontinuous there
  int no_ray = 0;         // the camera model has no forward ray there
  int not_finite = 0;     // the estimate is not a number

  int Total() const { return outside_image + no_depth + depth_step + no_ray + not_finite; }
  LeftOutCounts& operator+=(const LeftOutCounts& other);
};

// All of one frame that has truth.
struct SurfaceFrame {
  int frame_idx = 0;
  std::vector<SurfacePair> pairs;
  LeftOutCounts left_out;
};

// Pairs the points of one frame with the truth. `points_in_cam` and `pixels` have one length.
SurfaceFrame PairWithSurface(int frame_idx, std::span<const Eigen::Vector3d> points_in_cam,
                             std::span<const Eigen::Vector2d> pixels, const Camera& camera, const cv::Mat& depth_mm,
                             double max_depth_step);

// The figures of one set of pairs, of the estimate or of its null.
struct SurfaceFigures {
  double scale = 1;
  double rmse_mm = 0;
  double median_mm = 0;
  double median_relative_depth = 0;  // median of |s z - z_gt| / z_gt
};

struct SurfaceFrameError {
  int frame_idx = 0;
  int points = 0;
  SurfaceFigures estimate;
  SurfaceFigures null;
  LeftOutCounts left_out;
};

// Over all frames that have a pair.
struct SurfaceSummary {
  double mean_rmse_mm = 0;           // mean over frames of the frames' RMSE: the paper's figure
  double pooled_rmse_mm = 0;         // over all observations at once
  double pooled_median_mm = 0;       // median over all observations
  double mean_median_mm = 0;         // mean over frames of the frames' medians
  double median_relative_depth = 0;  // over all observations
  double min_scale = 1;              // smallest and largest of the frames' scales
  double max_scale = 1;
};

struct SurfaceError {
  SurfaceScale protocol = SurfaceScale::kPerFrame;
  std::vector<SurfaceFrameError> frames;  // those with at least one pair, in order
  SurfaceSummary estimate;
  SurfaceSummary null;
  int points = 0;               // pairs in all
  int frames_without_pair = 0;  // tracked, with truth, but every observation was left out
  LeftOutCounts left_out;
};

// The scale s that minimises sum |s estimate - truth|^2; 1 where every estimate is zero.
double BestScale(std::span<const SurfacePair> pairs);

// Fails with kInsufficient when no frame has a pair; the sentence says what was left out and why.
Result<SurfaceError> ComputeSurfaceError(std::span<const SurfaceFrame> frames, const SurfaceErrorOptions& options);

}  // namespace pliant
