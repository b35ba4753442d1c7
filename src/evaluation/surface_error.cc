// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/surface_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "pliant/base/statistics.h"
#include "pliant/image/depth_lookup.h"

namespace pliant {
namespace {

std::string Describe(const LeftOutCounts& counts) {
  return std::to_string(counts.no_depth) + " without true depth, " + std::to_string(counts.depth_step) +
         " on a depth step, " + std::to_string(counts.outside_image) + " outside the image, " +
         std::to_string(counts.no_ray) + " without a ray, " + std::to_string(counts.not_finite) + " not a number";
}

// Every point of a frame at depth 1 on its pixel's ray: whatever the constant depth, the scale makes it.
std::vector<SurfacePair> NullPairs(std::span<const SurfacePair> pairs) {
  std::vector<SurfacePair> null;
  null.reserve(pairs.size());
  for (const SurfacePair& pair : pairs) null.push_back({pair.truth / pair.truth.z(), pair.truth});
  return null;
}

// Errors of many frames together.
struct Pool {
  std::vector<double> errors_mm;
  std::vector<double> relative_depths;
  std::vector<double> frame_rmses_mm;
  std::vector<double> frame_medians_mm;
  std::vector<double> scales;

  SurfaceFigures Add(std::span<const SurfacePair> pairs, double scale);
  SurfaceSummary Summary() const;
};

SurfaceFigures Pool::Add(std::span<const SurfacePair> pairs, double scale) {
  std::vector<double> errors;
  std::vector<double> relative;
  for (const SurfacePair& pair : pairs) {
    errors.push_back((scale * pair.estimate - pair.truth).norm());
    relative.push_back(std::abs(scale * pair.estimate.z() - pair.truth.z()) / pair.truth.z());
  }
  const SurfaceFigures figures{scale, Rms(errors), Median(errors), Median(relative)};
  errors_mm.insert(errors_mm.end(), errors.begin(), errors.end());
  relative_depths.insert(relative_depths.end(), relative.begin(), relative.end());
  frame_rmses_mm.push_back(figures.rmse_mm);
  frame_medians_mm.push_back(figures.median_mm);
  scales.push_back(scale);
  return figures;
}

SurfaceSummary Pool::Summary() const {
  SurfaceSummary summary;
  summary.mean_rmse_mm = Mean(frame_rmses_mm);
  summary.pooled_rmse_mm = Rms(errors_mm);
  summary.pooled_median_mm = Median(errors_mm);
  summary.mean_median_mm = Mean(frame_medians_mm);
  summary.median_relative_depth = Median(relative_depths);
  summary.min_scale = *std::min_element(scales.begin(), scales.end());
  summary.max_scale = *std::max_element(scales.begin(), scales.end());
  return summary;
}

}  // namespace

void SurfaceErrorOptions::List(OptionTable& table) {
  table.AddChoice("scale", &scale,
                  "what the estimate is multiplied with: the paper's is per_frame after a monocular start");
  table.Add("max_depth_step", &max_depth_step, "-",
            "relative depth step around a pixel above which the true depth is not interpolated", 0.0, 10.0);
}

LeftOutCounts& LeftOutCounts::operator+=(const LeftOutCounts& other) {
  outside_image += other.outside_image;
  no_depth += other.no_depth;
  depth_step += other.depth_step;
  no_ray += other.no_ray;
  not_finite += other.not_finite;
  return *this;
}

SurfaceFrame PairWithSurface(int frame_idx, std::span<const Eigen::Vector3d> points_in_cam,
                             std::span<const Eigen::Vector2d> pixels, const Camera& camera, const cv::Mat& depth_mm,
                             double max_depth_step) {
  assert(points_in_cam.size() == pixels.size());
  const std::vector<std::optional<Eigen::Vector3d>> rays = camera.Unproject(pixels);
  SurfaceFrame frame;
  frame.frame_idx = frame_idx;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const DepthAtPixel truth = LookUpDepth(depth_mm, pixels[i], max_depth_step);
    if (truth.lookup == DepthLookup::kOutsideImage) {
      ++frame.left_out.outside_image;
    } else if (truth.lookup == DepthLookup::kNoDepth) {
      ++frame.left_out.no_depth;
    } else if (truth.lookup == DepthLookup::kDepthStep) {
      ++frame.left_out.depth_step;
    } else if (!rays[i] || !(rays[i]->z() > 0)) {
      ++frame.left_out.no_ray;
    } else if (!points_in_cam[i].allFinite()) {
      ++frame.left_out.not_finite;
    } else {
      frame.pairs.push_back({points_in_cam[i], *rays[i] * (truth.depth_mm / rays[i]->z())});
    }
  }
  return frame;
}

double BestScale(std::span<const SurfacePair> pairs) {
  double across = 0;
  double squared = 0;
  for (const SurfacePair& pair : pairs) {
    across += pair.estimate.dot(pair.truth);
    squared += pair.estimate.squaredNorm();
  }
  return squared > 0 ? across / squared : 1.0;
}

Result<SurfaceError> ComputeSurfaceError(std::span<const SurfaceFrame> frames, const SurfaceErrorOptions& options) {
  SurfaceError error;
  error.protocol = options.scale;
  std::vector<SurfacePair> all;
  for (const SurfaceFrame& frame : frames) {
    error.left_out += frame.left_out;
    error.points += static_cast<int>(frame.pairs.size());
    if (frame.pairs.empty()) ++error.frames_without_pair;
    all.insert(all.end(), frame.pairs.begin(), frame.pairs.end());
  }
  if (all.empty())
    return Status(ErrorCode::kInsufficient, "no point has a true position to compare with: of " +
                                                std::to_string(error.left_out.Total()) + " observations " +
                                                Describe(error.left_out) + "; check that the depth is this run's");

  // The null has no millimetres of its own: without per-frame scales it gets the best one depth of the whole run.
  const bool per_frame = options.scale == SurfaceScale::kPerFrame;
  const double run_scale = options.scale == SurfaceScale::kGlobal ? BestScale(all) : 1.0;
  const double null_depth = BestScale(NullPairs(all));
  Pool estimates;
  Pool nulls;
  for (const SurfaceFrame& frame : frames) {
    if (frame.pairs.empty()) continue;
    const std::vector<SurfacePair> null_pairs = NullPairs(frame.pairs);
    SurfaceFrameError row;
    row.frame_idx = frame.frame_idx;
    row.points = static_cast<int>(frame.pairs.size());
    row.left_out = frame.left_out;
    row.estimate = estimates.Add(frame.pairs, per_frame ? BestScale(frame.pairs) : run_scale);
    row.null = nulls.Add(null_pairs, per_frame ? BestScale(null_pairs) : null_depth);
    error.frames.push_back(row);
  }
  error.estimate = estimates.Summary();
  error.null = nulls.Summary();
  return error;
}

}  // namespace pliant
