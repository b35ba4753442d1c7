// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/plane_sweep.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <opencv2/imgproc.hpp>

#include "pliant/base/parallel.h"

namespace pliant {
namespace {

constexpr std::size_t kMinSeen = 2;  // views, where there are as many; of a half of them one
constexpr float kSmallChange = 0.02F;
constexpr int kSmoothingPx = 15;

// Of the views first, first + stride, ...
cv::Mat CostOf(const std::vector<cv::Mat>& correlations, std::size_t first, std::size_t stride, std::size_t min_seen) {
  std::vector<const float*> rows;
  std::vector<float> seen;
  cv::Mat cost(correlations.front().size(), CV_32F);
  for (int y = 0; y < cost.rows; ++y) {
    rows.clear();
    for (std::size_t v = first; v < correlations.size(); v += stride) rows.push_back(correlations[v].ptr<float>(y));
    auto* out = cost.ptr<float>(y);
    for (int x = 0; x < cost.cols; ++x) {
      seen.clear();
      for (const float* row : rows)
        if (row[x] != kNotSeen) seen.push_back(row[x]);
      if (seen.size() < min_seen) {
        out[x] = kUnknownCost;
        continue;
      }
      std::ranges::sort(seen, std::greater<>());
      const std::size_t better = (seen.size() + 1) / 2;
      float sum = 0.0F;
      for (std::size_t k = 0; k < better; ++k) sum += seen[k];
      out[x] = std::clamp(1.0F - sum / static_cast<float>(better), 0.0F, 1.0F);
    }
  }
  return cost;
}

}  // namespace

cv::Mat SweepLevels::InverseDistances(int level) const {
  cv::Mat result = center.mul(step) * (level - half);
  result += center;
  return result;
}

SweepCosts Sweep(const ReferenceWindows& reference, const std::vector<MatchingView>& views, const Camera& camera,
                 const SweepLevels& levels, bool in_halves, int threads) {
  const auto count = static_cast<std::size_t>(levels.count());
  in_halves = in_halves && views.size() > 1;
  SweepCosts costs{std::vector<cv::Mat>(count), std::vector<cv::Mat>(in_halves ? count : 0),
                   std::vector<cv::Mat>(in_halves ? count : 0)};
  ParallelFor(
      levels.count(), threads,
      [&](int level) {
        const cv::Mat inverse_distance = levels.InverseDistances(level);
        std::vector<cv::Mat> correlations;
        for (const MatchingView& view : views)
          correlations.push_back(Correlation(reference, view, camera, inverse_distance));
        const auto k = static_cast<std::size_t>(level);
        costs.all[k] = CostOf(correlations, 0, 1, std::min(kMinSeen, views.size()));
        if (!in_halves) return;
        costs.first[k] = CostOf(correlations, 0, 2, 1);
        costs.second[k] = CostOf(correlations, 1, 2, 1);
      },
      1);
  return costs;
}

cv::Mat MotionByDistance(const std::vector<MatchingView>& views, const Camera& camera, const cv::Mat& inverse_distance,
                         Parallax parallax, int threads) {
  std::vector<cv::Mat> motions(views.size());
  ParallelFor(
      static_cast<int>(views.size()), threads,
      [&](int v) {
        MatchingView view = views[static_cast<std::size_t>(v)];
        if (parallax == Parallax::kOfCamera)
          view.by_inverse_distance = cv::Mat(inverse_distance.size(), CV_32FC3, cv::Scalar(view.of_camera));
        const cv::Mat near = ProjectInto(view, camera, inverse_distance * (1.0 + kSmallChange));
        const cv::Mat here = ProjectInto(view, camera, inverse_distance);
        cv::Mat& motion = motions[static_cast<std::size_t>(v)];
        motion.create(inverse_distance.size(), CV_32F);
        const float outside = static_cast<float>(-camera.width());
        for (int y = 0; y < motion.rows; ++y)
          for (int x = 0; x < motion.cols; ++x) {
            const auto& a = here.at<cv::Vec2f>(y, x);
            const auto& b = near.at<cv::Vec2f>(y, x);
            const bool seen = a[0] > outside && b[0] > outside;
            motion.at<float>(y, x) = seen ? std::hypot(a[0] - b[0], a[1] - b[1]) / kSmallChange : 0.0F;
          }
      },
      1);
  cv::Mat largest = motions.front();
  for (const cv::Mat& motion : motions) largest = cv::max(largest, motion);
  cv::blur(largest, largest, {kSmoothingPx, kSmoothingPx});
  return largest;
}

}  // namespace pliant
