// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/landmark_descriptors.h"

#include <algorithm>

#include "pliant/image/descriptors.h"
#include "pliant/image/serialize.h"
#include "pliant/scene/serialize.h"

namespace pliant {

DescribedImage Describe(const cv::Mat& gray, const SupportMask& mask, const CornerOptions& corners,
                        const RelocalizationOptions& options) {
  CornerOptions as_many = corners;
  as_many.max_corners = options.max_corners;
  DescribedImage image;
  for (const Corner& corner : DetectCorners(gray, mask.valid(), {}, as_many)) image.pixels.push_back(corner.pixel);
  image.descriptors = DescribePixels(gray, image.pixels);
  return image;
}

void LandmarkDescriptors::See(const cv::Mat& gray, const std::vector<Landmark>& landmarks) {
  std::vector<Eigen::Vector2d> pixels;
  for (const Landmark& landmark : landmarks) pixels.push_back(landmark.pixel);
  const cv::Mat descriptors = DescribePixels(gray, pixels);
  for (std::size_t k = 0; k < landmarks.size(); ++k)
    descriptors_[landmarks[k].id] = descriptors.row(static_cast<int>(k)).clone();
}

void LandmarkDescriptors::Keep(const std::vector<PointId>& known) {
  std::erase_if(descriptors_,
                [&](const auto& entry) { return !std::binary_search(known.begin(), known.end(), entry.first); });
}

Result<AbsolutePose> LandmarkDescriptors::Recognize(const DescribedImage& image, const Camera& camera,
                                                    const std::vector<Landmark>& landmarks) const {
  cv::Mat known;
  std::vector<const Landmark*> described;
  for (const Landmark& landmark : landmarks)
    if (const auto found = descriptors_.find(landmark.id); found != descriptors_.end()) {
      known.push_back(found->second);
      described.push_back(&landmark);
    }
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> rays;
  for (const auto& [corner, point] : MatchDescriptors(image.descriptors, known, options_.max_ratio)) {
    const auto ray = camera.Unproject(image.pixels[static_cast<std::size_t>(corner)]);
    if (!ray) continue;
    points.push_back(described[static_cast<std::size_t>(point)]->position);
    rays.push_back(*ray);
  }
  return EstimateAbsolutePose(points, rays, camera.MeanFocalLengthPx(), options_.pose);
}

void LandmarkDescriptors::Serialize(StateArchive& archive) { archive(descriptors_); }

}  // namespace pliant
