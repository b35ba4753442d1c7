// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/places.h"

#include <algorithm>

#include "pliant/image/descriptors.h"

namespace pliant {

Places::Places(const CornerOptions& corners, const RelocalizationOptions& options)
    : corners_(corners), options_(options) {
  corners_.max_corners = options.max_corners;
}

void Places::See(const cv::Mat& grey, const std::vector<Landmark>& landmarks) {
  std::vector<Eigen::Vector2d> pixels;
  for (const Landmark& landmark : landmarks) pixels.push_back(landmark.pixel);
  const cv::Mat descriptors = DescribePixels(grey, pixels);
  for (std::size_t k = 0; k < landmarks.size(); ++k)
    seen_[landmarks[k].id] = descriptors.row(static_cast<int>(k)).clone();
}

void Places::Keep(const std::vector<PointId>& known) {
  std::erase_if(seen_, [&](const auto& entry) { return !std::binary_search(known.begin(), known.end(), entry.first); });
}

Result<AbsolutePose> Places::Recognize(const cv::Mat& grey, const SupportMask& mask, const Camera& camera,
                                       const std::vector<Landmark>& landmarks) const {
  std::vector<Eigen::Vector2d> pixels;
  for (const Corner& corner : DetectCorners(grey, mask.valid(), {}, corners_)) pixels.push_back(corner.pixel);
  cv::Mat known;
  std::vector<const Landmark*> described;
  for (const Landmark& landmark : landmarks)
    if (const auto found = seen_.find(landmark.id); found != seen_.end()) {
      known.push_back(found->second);
      described.push_back(&landmark);
    }
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> rays;
  for (const auto& [corner, point] : MatchDescriptors(DescribePixels(grey, pixels), known, options_.max_ratio)) {
    const auto ray = camera.Unproject(pixels[static_cast<std::size_t>(corner)]);
    if (!ray) continue;
    points.push_back(described[static_cast<std::size_t>(point)]->position);
    rays.push_back(*ray);
  }
  return EstimateAbsolutePose(points, rays, camera.MeanFocalLengthPx(), options_.pose);
}

}  // namespace pliant
