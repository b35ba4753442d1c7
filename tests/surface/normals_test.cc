// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/normals.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace pliant {
namespace {

constexpr double kExact = 2e-3;  // of a unit vector: depths are floats, and a window is 7 px of 300
constexpr int kWindow_px = 7;

// Of a plane n . X = d, where its depth is positive.
cv::Mat DepthOf(const Camera& camera, const Eigen::Vector3d& normal, double distance) {
  cv::Mat depth(camera.height(), camera.width(), CV_32F, cv::Scalar(0));
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      const auto ray = camera.Unproject({x, y});
      const double along = ray ? distance / normal.dot(*ray / ray->z()) : 0.0;
      if (along > 0.0) depth.at<float>(y, x) = static_cast<float>(along);
    }
  return depth;
}

Eigen::Vector3d At(const cv::Mat& normals, int x, int y) {
  const auto& normal = normals.at<cv::Vec3f>(y, x);
  return {normal[0], normal[1], normal[2]};
}

// Also with a wide lens, whose pixels no plane's inverse depth is linear in.
TEST(NormalsOfDepth, AreThoseOfAPlane) {
  const Eigen::Vector3d away = Eigen::Vector3d(0.3, -0.4, 0.9).normalized();
  const Camera pinhole =
      Camera::Create(CameraModelId::kPinhole, 320, 240, std::array{300.0, 300.0, 159.5, 119.5}).value();
  const Camera fisheye =
      Camera::Create("OPENCV_FISHEYE", 320, 240, std::array{160.0, 160.0, 159.5, 119.5, -0.05, 0.01, 0.0, 0.0}).value();
  for (const Camera* camera : {&pinhole, &fisheye}) {
    const cv::Mat normals = NormalsOfDepth(*camera, DepthOf(*camera, away, 50), kWindow_px);
    for (const auto& [x, y] : {std::pair{160, 120}, {40, 60}, {260, 200}})
      EXPECT_LT((At(normals, x, y) + away).norm(), kExact) << x << " " << y;
  }
}

TEST(NormalsOfDepth, AreNoneWithoutDepthsAround) {
  const Camera camera =
      Camera::Create(CameraModelId::kPinhole, 320, 240, std::array{300.0, 300.0, 159.5, 119.5}).value();
  cv::Mat depth(240, 320, CV_32F, cv::Scalar(0));
  depth.at<float>(100, 100) = 50;
  depth(cv::Rect(200, 100, 40, 40)).setTo(50);
  const cv::Mat normals = NormalsOfDepth(camera, depth, kWindow_px);
  EXPECT_EQ(At(normals, 100, 100), Eigen::Vector3d::Zero());  // alone
  EXPECT_EQ(At(normals, 198, 120), Eigen::Vector3d::Zero());  // beside the depths
  EXPECT_LT((At(normals, 200, 120) + Eigen::Vector3d::UnitZ()).norm(), kExact);
  EXPECT_LT((At(normals, 220, 120) + Eigen::Vector3d::UnitZ()).norm(), kExact);
}

}  // namespace
}  // namespace pliant
