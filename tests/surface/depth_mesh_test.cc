// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/depth_mesh.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "surface/textured_plane.h"

namespace pliant {
namespace {

using test::TexturedPlane;

// The true depth of the plane.
DenseDepth TrueDepth(const TexturedPlane& plane) {
  DenseDepth dense{cv::Mat(TexturedPlane::kHeight, TexturedPlane::kWidth, CV_32F),
                   cv::Mat(TexturedPlane::kHeight, TexturedPlane::kWidth, CV_32F, cv::Scalar(0.01))};
  for (int y = 0; y < dense.depth.rows; ++y)
    for (int x = 0; x < dense.depth.cols; ++x)
      dense.depth.at<float>(y, x) = static_cast<float>(plane.PointOn(x, y, 0).z());
  return dense;
}

TEST(DepthMesh, LiesOnTheSurfaceAndFacesTheCamera) {
  const TexturedPlane plane;
  const Mesh mesh = MeshOfDepth(plane.camera, TrueDepth(plane), plane.Image(0), 4);
  EXPECT_EQ(mesh.vertices.size(), 80U * 60U);
  EXPECT_EQ(mesh.triangles.size(), 2U * 79U * 59U);
  const Eigen::Vector3f normal = Eigen::Vector3f(0.3F, 0, -1).normalized();  // of z = 50 + 0.3 x, towards the camera
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    EXPECT_NEAR(mesh.vertices[v].z(), 50 + 0.3 * mesh.vertices[v].x(), 1e-3);
    EXPECT_GT(mesh.normals[v].dot(normal), 0.999F);
    EXPECT_NEAR(mesh.sigmas[v], 0.01 * mesh.vertices[v].norm(), 1e-4);
  }
}

TEST(DepthMesh, HasNoTrianglesAcrossHolesAndContours) {
  const TexturedPlane plane;
  DenseDepth dense = TrueDepth(plane);
  dense.depth(cv::Rect(0, 0, 160, 240)) *= 0.5F;  // a fold before the right half
  dense.depth(cv::Rect(200, 100, 40, 40)).setTo(0.0F);
  const Mesh mesh = MeshOfDepth(plane.camera, dense, plane.Image(0), 4);
  EXPECT_EQ(mesh.vertices.size(), 80U * 60U - 10U * 10U);
  for (const auto& triangle : mesh.triangles) {
    bool near = false;
    bool far = false;
    for (const auto v : triangle) (mesh.vertices[static_cast<std::size_t>(v)].z() < 35 ? near : far) = true;
    EXPECT_FALSE(near && far);
  }
}

}  // namespace
}  // namespace pliant
