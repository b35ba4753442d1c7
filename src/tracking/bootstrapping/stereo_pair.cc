// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/bootstrapping/stereo_pair.h"

#include <algorithm>

#include "pliant/image/corners.h"

namespace pliant {

void StereoStartOptions::List(OptionTable& table) {
  matching.List(table);
  table.Add("stereo_min_points", &min_points, "-", "stereo: minimum number of matches", 4, 100000);
}

std::vector<PixelDepth> PointsOfPair(const PreparedFrame& left, const cv::Mat& right, const Camera& camera,
                                     double baseline_mm, const TrackerOptions& options, int threads) {
  std::vector<Corner> corners = DetectCorners(left.gray, left.mask.valid(), {}, options.corners);
  std::stable_sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.score > b.score; });
  std::vector<Eigen::Vector2d> pixels;
  for (const Corner& corner : corners) pixels.push_back(corner.pixel);
  const PreparedFrame other = PrepareFrame(left.frame_idx, left.name, left.timestamp_s, right, {}, options);
  const auto matches = MatchAlongRows(left.pyramid, left.mask, other.pyramid, other.mask, pixels,
                                      options.init.stereo.matching, options.point_tracker.lucas_kanade, threads);
  std::vector<PixelDepth> points;
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (matches[i])
      points.push_back({pixels[i], camera.HorizontalFocalLengthPx() * baseline_mm / matches[i]->disparity_px});
  return points;
}

}  // namespace pliant
