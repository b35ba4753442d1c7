// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/cloud_depth.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

// Points are this far apart at least for a pixel: a denser cloud gains nothing from a smaller mean.
constexpr double kMinSpacing_px = 1.0;
constexpr double kMaxSpacing_px = 20.0;
// A pixel has a depth where the weights around it are this share of those within an even cloud.
constexpr double kMinShare = 0.3;

struct Seen {
  Eigen::Vector2d pixel;
  double depth;
};

// Of points spread evenly over the pixels that they cover.
double SpacingPx(const std::vector<Seen>& seen, cv::Size size) {
  constexpr int kCell_px = 8;
  cv::Mat covered = cv::Mat::zeros(size.height / kCell_px + 1, size.width / kCell_px + 1, CV_8U);
  for (const Seen& point : seen)
    covered.at<unsigned char>(static_cast<int>(point.pixel.y()) / kCell_px,
                              static_cast<int>(point.pixel.x()) / kCell_px) = 1;
  const double area = static_cast<double>(cv::countNonZero(covered)) * kCell_px * kCell_px;
  return std::clamp(std::sqrt(area / static_cast<double>(seen.size())), kMinSpacing_px, kMaxSpacing_px);
}

}  // namespace

cv::Mat DepthOfCloud(std::span<const Eigen::Vector3d> points_in_cam, const Camera& camera) {
  const cv::Size size(camera.width(), camera.height());
  cv::Mat depth = cv::Mat::zeros(size, CV_32FC1);
  std::vector<Seen> seen;
  for (const Eigen::Vector3d& point : points_in_cam)
    if (const auto pixel = camera.Project(point); pixel && point.z() > 0 && pixel->x() >= 0 && pixel->y() >= 0 &&
                                                  pixel->x() <= size.width - 1 && pixel->y() <= size.height - 1)
      seen.push_back({*pixel, point.z()});
  if (seen.empty()) return depth;
  const double spacing_px = SpacingPx(seen, size);
  // Every point adds to the pixel it is in; smoothing both sums alike makes weights of the distances.
  cv::Mat sums = cv::Mat::zeros(size, CV_32FC1);
  cv::Mat weights = cv::Mat::zeros(size, CV_32FC1);
  for (const Seen& point : seen) {
    const cv::Point at(static_cast<int>(std::lround(point.pixel.x())), static_cast<int>(std::lround(point.pixel.y())));
    sums.at<float>(at) += static_cast<float>(point.depth);
    weights.at<float>(at) += 1.0F;
  }
  cv::GaussianBlur(sums, sums, {}, spacing_px, spacing_px, cv::BORDER_CONSTANT);
  cv::GaussianBlur(weights, weights, {}, spacing_px, spacing_px, cv::BORDER_CONSTANT);
  const double within = 1.0 / (spacing_px * spacing_px);  // the mean weight of a pixel inside
  for (int v = 0; v < size.height; ++v)
    for (int u = 0; u < size.width; ++u)
      if (weights.at<float>(v, u) >= kMinShare * within)
        depth.at<float>(v, u) = sums.at<float>(v, u) / weights.at<float>(v, u);
  return depth;
}

}  // namespace pliant
