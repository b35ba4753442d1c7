// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/normals.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

constexpr double kMinKnownShare = 0.5;  // of a window
constexpr std::size_t kSums = 9;

// Of every known pixel, what the normal equations of a plane add up: with (x, y, 1) the point of its ray at z = 1 and w
// its inverse depth, 1, x, y, x x, x y, y y, w, w x, w y.
std::array<cv::Mat, kSums> ProductsOf(const Camera& camera, const cv::Mat& depth) {
  std::array<cv::Mat, kSums> products;
  for (cv::Mat& product : products) product = cv::Mat(depth.size(), CV_64F, cv::Scalar(0));
  for (int row = 0; row < depth.rows; ++row) {
    std::vector<Eigen::Vector2d> pixels;
    for (int column = 0; column < depth.cols; ++column) pixels.emplace_back(column, row);
    const auto rays = camera.Unproject(pixels);
    for (int column = 0; column < depth.cols; ++column) {
      const auto& ray = rays[static_cast<std::size_t>(column)];
      const float z = depth.at<float>(row, column);
      if (!(z > 0.0F) || !ray || !(ray->z() > 0.0)) continue;
      const double x = ray->x() / ray->z();
      const double y = ray->y() / ray->z();
      const double w = 1.0 / z;
      const std::array<double, kSums> values = {1.0, x, y, x * x, x * y, y * y, w, w * x, w * y};
      for (std::size_t k = 0; k < kSums; ++k) products[k].at<double>(row, column) = values[k];
    }
  }
  return products;
}

}  // namespace

cv::Mat NormalsOfDepth(const Camera& camera, const cv::Mat& depth, int window_px) {
  std::array<cv::Mat, kSums> sums = ProductsOf(camera, depth);
  for (cv::Mat& sum : sums)
    cv::boxFilter(sum, sum, CV_64F, {window_px, window_px}, {-1, -1}, true, cv::BORDER_CONSTANT);
  cv::Mat normals(depth.size(), CV_32FC3, cv::Scalar::all(0));
  for (int row = 0; row < depth.rows; ++row)
    for (int column = 0; column < depth.cols; ++column) {
      const auto sum = [&](std::size_t k) { return sums[k].at<double>(row, column); };
      const double known = sum(0);  // share of the window
      if (!(depth.at<float>(row, column) > 0.0F) || known < kMinKnownShare) continue;
      // About the means: a window is small beside the distance from the axis.
      const double x = sum(1) / known;
      const double y = sum(2) / known;
      const double w = sum(6) / known;
      Eigen::Matrix2d spread;
      spread << sum(3) / known - x * x, sum(4) / known - x * y, sum(4) / known - x * y, sum(5) / known - y * y;
      const Eigen::Vector2d slope =
          spread.ldlt().solve(Eigen::Vector2d(sum(7) / known - w * x, sum(8) / known - w * y));
      // The inverse depth (n . ray) / d is positive, so that n points away from the camera.
      const Eigen::Vector3d away(slope.x(), slope.y(), w - slope.x() * x - slope.y() * y);
      const Eigen::Vector3d normal = -away.normalized();
      if (!normal.allFinite()) continue;
      normals.at<cv::Vec3f>(row, column) = cv::Vec3d(normal.x(), normal.y(), normal.z());
    }
  return normals;
}

}  // namespace pliant
