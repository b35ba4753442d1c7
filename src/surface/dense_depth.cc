// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/dense_depth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "pliant/base/parallel.h"
#include "pliant/base/statistics.h"
#include "surface/depth_certainty.h"
#include "surface/depth_holes.h"
#include "surface/level_choice.h"
#include "surface/plane_sweep.h"
#include "surface/sized_scene.h"
#include "surface/sparse_surface.h"

namespace pliant {
namespace {

constexpr double kCoarseScale = 0.5;
constexpr int kMinCoarseWidth = 160;
constexpr int kMinHalfWindowPx = 3;
constexpr double kMinNoiseVariance = 0.25;  // gray levels: rounding, and what interpolation makes of images
constexpr double kCoarseStepPx = 0.5;       // of a level, in the view in which it is largest
constexpr double kFineStepPx = 0.5;
constexpr double kRangeQuantile = 0.97;
constexpr double kRangeOfQuantile = 3.0;
constexpr double kMaxRange = 0.9;  // relative, of an inverse distance
constexpr int kMinCoarseHalf = 16;
constexpr int kMaxCoarseHalf = 48;
constexpr double kMinMotionPx = 1e-3;
constexpr int kFineHalf = 4;
constexpr double kCenterWeight = 0.1;  // of the outermost coarse level: where images say nothing the points do
constexpr int kMedianPx = 5;

// (V5) Levels of a part of a pixel's motion each, as many as held-out points ask for.
SweepLevels CoarseLevels(const SizedScene& scene, const SparseSurface& surface, const cv::Mat& center,
                         double center_scale, int threads) {
  const cv::Mat motion = MotionByDistance(scene.views, scene.camera.camera, center, Parallax::kOfAll, threads);
  std::vector<double> errors_px;
  for (const HeldOutPoint& point : surface.held_out) {
    const auto x = std::clamp(static_cast<int>(point.pixel.x() * center_scale), 0, motion.cols - 1);
    const auto y = std::clamp(static_cast<int>(point.pixel.y() * center_scale), 0, motion.rows - 1);
    errors_px.push_back(point.error * motion.at<float>(y, x));
  }
  SweepLevels levels{center, {}, 0};
  levels.half =
      std::clamp(static_cast<int>(std::ceil(kRangeOfQuantile * Quantile(errors_px, kRangeQuantile) / kCoarseStepPx)),
                 kMinCoarseHalf, kMaxCoarseHalf);
  const cv::Mat step = kCoarseStepPx / cv::max(motion, kMinMotionPx);
  levels.step = cv::min(step, kMaxRange / levels.half);
  return levels;
}

SweepLevels FineLevels(const SizedScene& scene, const cv::Mat& center, int threads) {
  const cv::Mat motion = MotionByDistance(scene.views, scene.camera.camera, center, Parallax::kOfAll, threads);
  const cv::Mat step = kFineStepPx / cv::max(motion, kMinMotionPx);
  return {center, cv::min(step, kMaxRange / kFineHalf), kFineHalf};
}

struct JudgedPixel {
  double sigma = 0;  // of the depth, relative, without that of the points
  std::optional<DepthRejection> rejection;
};

cv::Mat InverseDistances(const SweepLevels& levels, const ChosenLevels& chosen) {
  cv::Mat result = levels.center.mul(levels.step).mul(chosen.level);
  result += levels.center;
  return result;
}

}  // namespace

struct DenseDepthEstimator::State {
  DenseDepthOptions options;
  Camera camera;
  SizedCamera fine;
  SizedCamera coarse;
  Comparison fine_comparison;
  Comparison coarse_comparison;
  int threads = 1;

  Result<Scene> MakeScene(const SurfaceView& reference, std::span<const SurfaceView> neighbors) const;
  cv::Mat CoarseInverseDistances(const Scene& scene) const;
  DenseDepth FineDepth(const Scene& scene, const cv::Mat& coarse) const;
  template <class Judge>
  DenseDepth Finished(const Scene& scene, const cv::Mat& inverse_distance, const Judge& judge) const;
};

void DenseDepthOptions::List(OptionTable& table) {
  table.BeginGroup("Surface", "dense depth by multi-view stereo through the deformation");
  table.Add("max_width", &max_width, "px", "larger images are reduced to it", 160, 4096);
  table.Add("window", &window, "1", "side of a compared window by that of a tracked patch", 0.1, 10.0);
  table.Add("max_sigma", &max_sigma, "1",
            "standard deviation of a depth by the depth, beside that of the points around it", 1e-4, 10.0);
  table.Add("min_correlation", &min_correlation, "1", "of the windows", -1.0, 1.0);
  table.Add("max_disagreement", &max_disagreement, "1",
            "of the depths from two halves of the images, by its standard deviation", 0.1, 1e6);
}

DenseDepthEstimator::DenseDepthEstimator(std::unique_ptr<State> state) : state_(std::move(state)) {}
DenseDepthEstimator::DenseDepthEstimator(DenseDepthEstimator&&) noexcept = default;
DenseDepthEstimator& DenseDepthEstimator::operator=(DenseDepthEstimator&&) noexcept = default;
DenseDepthEstimator::~DenseDepthEstimator() = default;

Result<DenseDepthEstimator> DenseDepthEstimator::Create(const Camera& camera, const TrackedImage& tracked,
                                                        const DenseDepthOptions& options, int threads) {
  const double scale = std::min({1.0, tracked.working.scale, static_cast<double>(options.max_width) / camera.width()});
  const auto fine = camera.Resized(scale);
  if (!fine.ok()) return fine.status();
  const auto coarse = camera.Resized(fine->width() * kCoarseScale < kMinCoarseWidth ? scale : scale * kCoarseScale);
  if (!coarse.ok()) return coarse.status();
  const double by_working = scale / tracked.working.scale;
  const int half_window_px = std::max(
      kMinHalfWindowPx, static_cast<int>(std::lround((options.window * tracked.patch_px * by_working - 1) / 2)));
  const Comparison of_fine{2 * half_window_px + 1, tracked.working.smoothing_px * by_working,
                           std::max(kMinNoiseVariance, tracked.noise_levels * tracked.noise_levels)};
  // The average of some pixels is as smooth as need be.
  const Comparison of_coarse{of_fine.window_px, 0.0, of_fine.noise_variance};
  return DenseDepthEstimator(std::unique_ptr<State>(
      new State{options, camera, SizedCamera(*fine), SizedCamera(*coarse), of_fine, of_coarse, std::max(1, threads)}));
}

Result<Scene> DenseDepthEstimator::State::MakeScene(const SurfaceView& reference,
                                                    std::span<const SurfaceView> neighbors) const {
  auto surface = FitSparseSurface(reference, fine.camera);
  std::vector<std::optional<SurfaceMotion>> fitted(surface ? neighbors.size() : 0);
  ParallelFor(
      static_cast<int>(fitted.size()), threads,
      [&](int k) {
        const auto at = static_cast<std::size_t>(k);
        fitted[at] = FitMotion(reference, neighbors[at], fine.camera);
      },
      1);
  std::vector<const SurfaceView*> others;
  std::vector<SurfaceMotion> motions;
  for (std::size_t k = 0; k < fitted.size(); ++k) {
    if (!fitted[k]) continue;
    others.push_back(&neighbors[k]);
    motions.push_back(*std::move(fitted[k]));
  }
  if (others.empty())
    return Status(ErrorCode::kInsufficient,
                  "a dense depth needs " + std::to_string(kMinPoints) + " points that another image shows too");
  return Scene{reference, std::move(others), std::move(motions), *std::move(surface), fine.camera.width()};
}

cv::Mat DenseDepthEstimator::State::CoarseInverseDistances(const Scene& scene) const {
  const SizedScene sized(scene, coarse, coarse_comparison, threads);
  const cv::Mat center = scene.surface.inverse_distance.ToImage(
      coarse.size(), static_cast<double>(scene.grid_width) / coarse.camera.width());
  const SweepLevels levels = CoarseLevels(sized, scene.surface, center,
                                          static_cast<double>(coarse.camera.width()) / scene.grid_width, threads);
  const SweepCosts costs = Sweep(sized.reference, sized.views, coarse.camera, levels, false, threads);
  const ChosenLevels chosen = ChooseLevels(costs.all, levels.half, kCenterWeight, threads);
  cv::Mat result = InverseDistances(levels, chosen);
  cv::medianBlur(result, result, kMedianPx);
  return result;
}

template <class Judge>
DenseDepth DenseDepthEstimator::State::Finished(const Scene& scene, const cv::Mat& inverse_distance,
                                                const Judge& judge) const {
  const cv::Mat log_point_sigma = scene.surface.log_relative_sigma.ToImage(fine.size(), 1.0);
  DenseDepth result{cv::Mat(fine.size(), CV_32F, cv::Scalar::all(0)), cv::Mat(fine.size(), CV_32F, cv::Scalar::all(0))};
  const auto reject = [&](DepthRejection why, int pixels) { result.rejected[static_cast<std::size_t>(why)] += pixels; };
  for (int y = 0; y < fine.size().height; ++y)
    for (int x = 0; x < fine.size().width; ++x) {
      const JudgedPixel pixel = judge(y, x);
      if (pixel.rejection) {
        reject(*pixel.rejection, 1);
        continue;
      }
      result.depth.at<float>(y, x) = fine.rays.at<cv::Vec3f>(y, x)[2] / inverse_distance.at<float>(y, x);
      result.sigma.at<float>(y, x) =
          static_cast<float>(std::hypot(pixel.sigma, std::exp(log_point_sigma.at<float>(y, x))));
    }
  const int known = cv::countNonZero(result.depth);
  RemoveSpeckles(&result.depth);
  reject(DepthRejection::kSpeckle, known - cv::countNonZero(result.depth));
  result.sigma.setTo(0.0F, result.depth == 0.0F);
  const cv::Size size(camera.width(), camera.height());
  return {Enlarged(result.depth, size), Enlarged(result.sigma, size), result.rejected};
}

DenseDepth DenseDepthEstimator::State::FineDepth(const Scene& scene, const cv::Mat& coarse_inverse_distances) const {
  const SizedScene sized(scene, fine, fine_comparison, threads);
  cv::Mat center;
  cv::resize(coarse_inverse_distances, center, fine.size(), 0, 0, cv::INTER_LINEAR);
  const SweepLevels levels = FineLevels(sized, center, threads);
  const SweepCosts costs = Sweep(sized.reference, sized.views, fine.camera, levels, true, threads);
  const ChosenLevels chosen = ChooseLevels(costs.all, levels.half, 0.0, threads);
  const cv::Mat disagreement = Disagreement(costs, levels.half, threads);
  const cv::Mat sigmas = LevelSigmas(sized, chosen, disagreement);
  const cv::Mat inverse = InverseDistances(levels, chosen);
  const cv::Mat parallax =
      cv::max(MotionByDistance(sized.views, fine.camera, levels.center, Parallax::kOfCamera, threads), kMinMotionPx);
  const cv::Mat motion_sigmas = MotionSigmas(sized, scene, levels.center, parallax);
  cv::Mat match_sigmas = kFineStepPx * sigmas / parallax;
  match_sigmas *= FactorByPoints(fine, scene.surface, inverse, match_sigmas);
  const cv::Mat near_contours =
      NearContours(inverse, match_sigmas, fine.camera.MeanFocalLengthPx(), fine_comparison.window_px);
  const auto rejection_at = [&](int y, int x, double sigma) -> std::optional<DepthRejection> {
    const float level_sigma = sigmas.at<float>(y, x);
    if (sized.reference.image.valid.at<std::uint8_t>(y, x) == 0 || !(fine.rays.at<cv::Vec3f>(y, x)[2] > 0.0F))
      return DepthRejection::kNotSurface;
    if (chosen.cost.at<float>(y, x) >= kUnknownCost) return DepthRejection::kUnseen;
    if (kMinSigmaLevels * kFineStepPx > options.max_sigma * parallax.at<float>(y, x))
      return DepthRejection::kLittleParallax;
    if (level_sigma == 0.0F) return DepthRejection::kNoMinimum;
    if (chosen.at_end.at<std::uint8_t>(y, x) != 0) return DepthRejection::kOutermost;
    if (near_contours.at<std::uint8_t>(y, x) != 0) return DepthRejection::kNearContour;
    if (disagreement.at<float>(y, x) > options.max_disagreement * 2.0 * level_sigma)
      return DepthRejection::kDisagreement;
    if (!AreAlike(sized.reference, chosen.cost.at<float>(y, x), x, y, options.min_correlation))
      return DepthRejection::kUnlike;
    if (!(sigma > 0.0) || sigma > options.max_sigma) return DepthRejection::kUncertain;
    return std::nullopt;
  };
  const auto judge = [&](int y, int x) -> JudgedPixel {
    const double sigma = std::hypot(match_sigmas.at<float>(y, x), motion_sigmas.at<float>(y, x));
    return {sigma, rejection_at(y, x, sigma)};
  };
  return Finished(scene, inverse, judge);
}

Result<DenseDepth> DenseDepthEstimator::Estimate(const SurfaceView& reference,
                                                 std::span<const SurfaceView> neighbors) const {
  const auto scene = state_->MakeScene(reference, neighbors);
  if (!scene.ok()) return scene.status();
  return state_->FineDepth(*scene, state_->CoarseInverseDistances(*scene));
}

ComparedWindows DenseDepthEstimator::windows() const {
  const Comparison& how = state_->fine_comparison;
  return {state_->fine.camera.width(), how.window_px, how.smoothing_px, std::sqrt(how.noise_variance)};
}

}  // namespace pliant
