// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/tracked_mesh.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pliant/base/statistics.h"
#include "pliant/surface/mesh_geometry.h"
#include "surface/textured_plane.h"

namespace pliant {
namespace {

using test::TexturedPlane;

constexpr int kColumns = 80;  // every fourth pixel
constexpr double kMeshSigma = 0.01;

// The true depth of the plane in a view.
DenseDepth TrueDepth(const TexturedPlane& plane, int view) {
  const cv::Size size(TexturedPlane::kWidth, TexturedPlane::kHeight);
  DenseDepth dense{cv::Mat(size, CV_32F), cv::Mat(size, CV_32F, cv::Scalar(kMeshSigma))};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      dense.depth.at<float>(y, x) = static_cast<float>(plane.PointOn(x, y, view).z());
  return dense;
}

// Undeformed is what view 0 shows.
RestPositions RestOf(const TexturedPlane& plane) {
  RestPositions rest;
  for (const PointObservation& point : plane.Points(0)) rest[point.id] = point.position;
  return rest;
}

TrackedMesh MeshOf(const TexturedPlane& plane, const std::vector<int>& views, int threads = 1) {
  TrackedMesh mesh(plane.camera, RestOf(plane), kColumns, threads);
  for (const int view : views) mesh.Add(plane.View(view), TrueDepth(plane, view));
  mesh.Finish();
  return mesh;
}

TEST(TrackedMesh, OfOneFrameLiesOnTheSurfaceAndFacesTheCamera) {
  const TexturedPlane plane;
  const TrackedMesh tracked = MeshOf(plane, {0});
  const Mesh& mesh = tracked.undeformed();
  EXPECT_EQ(mesh.vertices.size(), 80U * 60U);
  EXPECT_EQ(mesh.triangles.size(), 2U * 79U * 59U);
  const Eigen::Vector3f normal = Eigen::Vector3f(0.3F, 0, -1).normalized();  // of z = 50 + 0.3 x, towards the camera
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    EXPECT_NEAR(mesh.vertices[v].z(), 50 + 0.3 * mesh.vertices[v].x(), 0.05);
    EXPECT_GT(mesh.normals[v].dot(normal), 0.99F);
    EXPECT_NEAR(mesh.sigmas[v], kMeshSigma * mesh.vertices[v].norm(), 1e-2);
  }
}

TEST(TrackedMesh, HasNoTrianglesAcrossHolesAndContours) {
  const TexturedPlane plane;
  DenseDepth dense = TrueDepth(plane, 0);
  dense.depth(cv::Rect(0, 0, 160, 240)) *= 0.5F;  // a fold before the right half
  dense.depth(cv::Rect(200, 100, 40, 40)).setTo(0.0F);
  TrackedMesh tracked(plane.camera, RestOf(plane), kColumns, 1);
  tracked.Add(plane.View(0), dense);
  tracked.Finish();
  const Mesh& mesh = tracked.undeformed();
  EXPECT_NEAR(static_cast<double>(mesh.vertices.size()), 80 * 60 - 10 * 10, 20);  // half a node around the hole
  for (const auto& triangle : mesh.triangles) {
    bool near = false;
    bool far = false;
    for (const auto v : triangle) (mesh.vertices[static_cast<std::size_t>(v)].z() < 35 ? near : far) = true;
    EXPECT_FALSE(near && far);
  }
}

TEST(TrackedMesh, ItsVerticesMoveAsTheMaterialDoes) {
  const TexturedPlane plane;
  const TrackedMesh tracked = MeshOf(plane, {0, 1, 2});
  const Mesh& mesh = tracked.undeformed();
  const auto now = tracked.InFrame(plane.View(2), TrueDepth(plane, 2));
  ASSERT_TRUE(now);
  std::vector<double> errors;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    Eigen::Vector3d expected = mesh.vertices[v].cast<double>();
    const auto pixel = plane.camera.Project(expected);
    if (!pixel || !plane.camera.Contains(*pixel, 20)) continue;  // beyond the points nothing is known
    expected.y() += plane.Slide(expected.x(), 2);
    errors.push_back((now->positions[v] - expected).norm());
  }
  ASSERT_GT(errors.size(), 3000U);
  // Of up to 8 mm, between points that are 4 mm apart.
  EXPECT_LT(Median(errors), 0.1);
  EXPECT_LT(Quantile(errors, 0.95), 0.6);
}

TEST(TrackedMesh, AFrameAddsOnlyWhatIsNotThereYet) {
  TexturedPlane plane;
  plane.slide_mm = 0;
  const std::size_t once = MeshOf(plane, {0}).undeformed().vertices.size();
  EXPECT_EQ(MeshOf(plane, {0, 0, 0}).undeformed().vertices.size(), once);
  // The second view shows two millimeters more along x and 0.4 along y, of about 53 and 40.
  const std::size_t both = MeshOf(plane, {0, 1}).undeformed().vertices.size();
  EXPECT_GT(both, once + once * 3 / 100);
  EXPECT_LT(both, once + once * 8 / 100);
}

TEST(TrackedMesh, IsOnePieceThoughItIsOfTwoFrames) {
  TexturedPlane plane;
  plane.slide_mm = 0;
  const TrackedMesh tracked = MeshOf(plane, {0, 2});
  const Mesh& mesh = tracked.undeformed();
  std::vector<std::size_t> piece(mesh.vertices.size());
  for (std::size_t v = 0; v < piece.size(); ++v) piece[v] = v;
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& triangle : mesh.triangles) {
      std::size_t least = piece[static_cast<std::size_t>(triangle[0])];
      for (const auto v : triangle) least = std::min(least, piece[static_cast<std::size_t>(v)]);
      for (const auto v : triangle) {
        changed = changed || piece[static_cast<std::size_t>(v)] != least;
        piece[static_cast<std::size_t>(v)] = least;
      }
    }
  }
  EXPECT_EQ(std::ranges::count(piece, 0U), static_cast<std::ptrdiff_t>(piece.size()));
}

// Of the triangles in a view of the plane, by what they cover there together.
double LayersOf(const TexturedPlane& plane, const Mesh& mesh) {
  constexpr int kFine = 4;
  constexpr int kMargin = 100;
  cv::Mat covered(kFine * (TexturedPlane::kHeight + 2 * kMargin), kFine * (TexturedPlane::kWidth + 2 * kMargin), CV_8U,
                  cv::Scalar(0));
  double area = 0;
  for (const Triangle& triangle : mesh.triangles) {
    std::vector<cv::Point2f> corners;
    for (const std::int32_t v : triangle) {
      const auto pixel = plane.camera.Project(mesh.vertices[static_cast<std::size_t>(v)].cast<double>());
      corners.emplace_back(static_cast<float>(kFine * (pixel->x() + kMargin)),
                           static_cast<float>(kFine * (pixel->y() + kMargin)));
    }
    area += std::abs(cv::contourArea(corners));
    std::vector<cv::Point> fixed;  // 1/16 of a pixel
    for (const cv::Point2f& corner : corners) fixed.emplace_back(cvRound(16 * corner.x), cvRound(16 * corner.y));
    cv::fillConvexPoly(covered, fixed, cv::Scalar(255), cv::LINE_8, 4);
  }
  return area / cv::countNonZero(covered);
}

TEST(TrackedMesh, IsOneLayerThoughItIsOfManyFrames) {
  TexturedPlane plane;
  const TrackedMesh tracked = MeshOf(plane, {0, 1, 2, 1, 0, 2});
  const Mesh& mesh = tracked.undeformed();
  EXPECT_LT(LayersOf(plane, mesh), 1.02);
  std::set<std::pair<std::int32_t, std::int32_t>> edges;
  for (const Triangle& triangle : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(edges.insert({triangle[k], triangle[(k + 1) % 3]}).second);
}

TEST(TrackedMesh, SigmaIsThatOfTheMeanOfDepthsThatAreWrongAlike) {
  TexturedPlane plane;
  plane.slide_mm = 0;
  TrackedMesh tracked(plane.camera, RestOf(plane), kColumns, 1);
  DenseDepth worse = TrueDepth(plane, 0);
  worse.sigma *= 2.0;
  tracked.Add(plane.View(0), TrueDepth(plane, 0));
  tracked.Add(plane.View(0), worse);
  tracked.Finish();
  const Mesh& mesh = tracked.undeformed();
  int inside = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    // Rounding may put those at the image's border outside.
    const Eigen::Vector2d pixel = *plane.camera.Project(mesh.vertices[v].cast<double>());
    if (pixel.minCoeff() < 1 || pixel.x() > TexturedPlane::kWidth - 2 || pixel.y() > TexturedPlane::kHeight - 2)
      continue;
    ++inside;
    EXPECT_NEAR(mesh.sigmas[v], 1.2 * kMeshSigma * mesh.vertices[v].norm(), 2e-2);  // by weights of 1 and 1/4
  }
  EXPECT_GT(inside, 4000);
}

TEST(TrackedMesh, WhatMoreFramesContradictThanConfirmGoes) {
  TexturedPlane plane;
  plane.slide_mm = 0;
  DenseDepth wrong = TrueDepth(plane, 0);
  wrong.depth(cv::Rect(80, 80, 40, 40)) *= 0.7F;  // a bump that no other frame sees
  TrackedMesh tracked(plane.camera, RestOf(plane), kColumns, 1);
  tracked.Add(plane.View(0), wrong);
  for (int k = 0; k < 4; ++k) tracked.Add(plane.View(0), TrueDepth(plane, 0));
  tracked.Finish();
  int in_patch = 0;
  for (const Eigen::Vector3f& vertex : tracked.undeformed().vertices) {
    EXPECT_NEAR(vertex.z(), 50 + 0.3 * vertex.x(), 1.5);
    const Eigen::Vector2d pixel = *plane.camera.Project(vertex.cast<double>());
    in_patch += cv::Rect(80, 80, 40, 40).contains(cv::Point(static_cast<int>(pixel.x()), static_cast<int>(pixel.y())));
  }
  EXPECT_GT(in_patch, 80);  // of ten times ten nodes: the tissue behind has taken its place
}

TEST(TrackedMesh, HasNoSmallPieces) {
  const TexturedPlane plane;
  DenseDepth dense = TrueDepth(plane, 0);
  cv::Mat keep(dense.depth.size(), CV_8U, cv::Scalar(0));
  keep(cv::Rect(0, 0, 200, 240)).setTo(1);
  keep(cv::Rect(240, 100, 10, 10)).setTo(1);  // of two times two nodes
  dense.depth.setTo(0.0F, keep == 0);
  TrackedMesh tracked(plane.camera, RestOf(plane), kColumns, 1);
  tracked.Add(plane.View(0), dense);
  tracked.Finish();
  for (const Eigen::Vector3f& vertex : tracked.undeformed().vertices)
    EXPECT_LT(plane.camera.Project(vertex.cast<double>())->x(), 202);
}

TEST(TrackedMesh, FramesTogetherAreNearerThanOne) {
  TexturedPlane plane;
  plane.slide_mm = 0;
  const auto noisy = [&](int seed) {
    DenseDepth dense = TrueDepth(plane, 0);
    Random random(static_cast<std::uint64_t>(seed + 1));
    for (int y = 0; y < dense.depth.rows; ++y)
      for (int x = 0; x < dense.depth.cols; ++x)
        dense.depth.at<float>(y, x) *= static_cast<float>(1.0 + kMeshSigma * random.Normal());
    return dense;
  };
  const auto error_of = [&](int views) {
    TrackedMesh tracked(plane.camera, RestOf(plane), kColumns, 1);
    for (int k = 0; k < views; ++k) tracked.Add(plane.View(0), noisy(k));
    tracked.Finish();
    std::vector<double> errors;
    for (const Eigen::Vector3f& vertex : tracked.undeformed().vertices)
      errors.push_back(std::abs(vertex.z() - 50 - 0.3 * vertex.x()));
    return Median(errors);
  };
  EXPECT_LT(error_of(9), 0.7 * error_of(1));
}

TEST(TrackedMesh, SaysWhatTheFrameShows) {
  TexturedPlane plane;
  plane.slide_mm = 0;
  const TrackedMesh tracked = MeshOf(plane, {0});
  DenseDepth dense = TrueDepth(plane, 0);
  dense.depth.rowRange(0, 80).setTo(0.0F);  // not known
  dense.depth.rowRange(160, 240) *= 0.5F;   // something else before it
  const auto now = tracked.InFrame(plane.View(0), dense);
  ASSERT_TRUE(now);
  const auto view_at = [&](std::size_t row) { return now->views[row * 80 + 40]; };
  EXPECT_EQ(view_at(10), VertexView::kInView);
  EXPECT_EQ(view_at(30), VertexView::kMeasured);
  EXPECT_EQ(view_at(50), VertexView::kOutOfView);
}

TEST(TrackedMesh, AFrameWithFewPointsAddsNothing) {
  const TexturedPlane plane;
  TrackedMesh tracked(plane.camera, RestOf(plane), kColumns, 1);
  SurfaceView view = plane.View(0);
  view.observations.resize(11);
  tracked.Add(view, TrueDepth(plane, 0));
  tracked.Finish();
  EXPECT_TRUE(tracked.undeformed().vertices.empty());
  EXPECT_FALSE(tracked.InFrame(view, {}));
}

TEST(TrackedMesh, IsTheSameOnAnyNumberOfThreads) {
  const TexturedPlane plane;
  const TrackedMesh one = MeshOf(plane, {0, 1}, 1);
  const TrackedMesh three = MeshOf(plane, {0, 1}, 3);
  EXPECT_EQ(one.undeformed().vertices, three.undeformed().vertices);
  EXPECT_EQ(one.undeformed().triangles, three.undeformed().triangles);
}

}  // namespace
}  // namespace pliant
