// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/stereo_pair.h"

#include <algorithm>

#include "pliant/image/corners.h"

namespace pliant {

std::vector<std::optional<RowMatch>> MatchPair(const TrackerFrame& left, const cv::Mat& right,
                                               std::span<const Eigen::Vector2d> pixels, const TrackerOptions& options,
                                               int threads) {
  const TrackerFrame other = PrepareFrame(left.frame_idx, left.name, left.timestamp_s, right, {}, options);
  return MatchAlongRows(left.pyramid, left.mask, other.pyramid, other.mask, pixels, options.init.stereo,
                        options.point_tracker.lucas_kanade, threads);
}

std::vector<PixelDepth> PointsOfPair(const TrackerFrame& left, const cv::Mat& right, const Camera& camera,
                                     double baseline_mm, const TrackerOptions& options, int threads) {
  std::vector<Corner> corners = DetectCorners(left.gray, left.mask.valid(), {}, options.corners);
  std::stable_sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.score > b.score; });
  std::vector<Eigen::Vector2d> pixels;
  for (const Corner& corner : corners) pixels.push_back(corner.pixel);
  const auto matches = MatchPair(left, right, pixels, options, threads);
  std::vector<PixelDepth> points;
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (matches[i])
      points.push_back({pixels[i], camera.HorizontalFocalLengthPx() * baseline_mm / matches[i]->disparity_px});
  return points;
}

}  // namespace pliant
