// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/mesh_values.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::FloatEq;
using testing::FloatNear;
using testing::IsNan;

constexpr float kFloat = 1e-5F;

// Two triangles of a unit square, with a seam: of the diagonal each has vertices of its own. It is stretched twofold
// along x in frame 10, and was not yet in frame 0.
ViewedMesh StretchedSquare() {
  ViewedMesh viewed;
  Mesh& mesh = viewed.surface.mesh;
  mesh.vertices = {{0, 0, 5}, {0, 1, 5}, {1, 0, 5}, {0, 1, 5}, {1, 1, 5}, {1, 0, 5}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  mesh.sigmas = {1, 2, 3, 2, 4, 3};
  MeshKey rest{0, 0.0, mesh.vertices};
  MeshKey stretched{10, 0.4, mesh.vertices};
  for (Eigen::Vector3f& position : stretched.positions) position.x() *= 2;
  viewed.surface.keys = {rest, stretched};
  return viewed;
}

TEST(MeshValues, BetweenKeysVerticesMoveEvenly) {
  const ViewedMesh mesh = StretchedSquare();
  EXPECT_FLOAT_EQ(PositionsAt(mesh.surface, 0)[4].x(), 1);
  EXPECT_FLOAT_EQ(PositionsAt(mesh.surface, 5)[4].x(), 1.5F);
  EXPECT_FLOAT_EQ(PositionsAt(mesh.surface, 10)[4].x(), 2);
}

TEST(MeshValues, AMeshIsKnownFromItsFirstKeyToItsLast) {
  GltfMesh surface = StretchedSquare().surface;
  const auto known = [&] {
    std::vector<int> frames_idx;
    for (const int frame_idx : {-1, 0, 5, 10, 11})
      if (IsKnownIn(surface, frame_idx)) frames_idx.push_back(frame_idx);
    return frames_idx;
  };
  EXPECT_THAT(known(), ElementsAre(0, 5, 10));
  surface.keys.erase(surface.keys.begin());
  EXPECT_THAT(known(), ElementsAre(10));
  surface.keys.clear();  // it does not move
  EXPECT_THAT(known(), ElementsAre(-1, 0, 5, 10, 11));
}

// No frame from 4 to 6 has a surface.
TEST(MeshValues, AMeshIsNotKnownInAGapAndDoesNotMoveAcrossIt) {
  ViewedMesh mesh = StretchedSquare();
  mesh.errors_mm = {std::vector<float>(6, 1.0F), std::vector<float>(6, 2.0F)};
  mesh.surface.gaps = {{.last_frame_idx = 3, .next_frame_idx = 7}};
  for (int frame_idx = 0; frame_idx <= 10; ++frame_idx) {
    EXPECT_EQ(IsKnownIn(mesh.surface, frame_idx), frame_idx <= 3 || frame_idx >= 7) << frame_idx;
    if (!IsKnownIn(mesh.surface, frame_idx)) continue;
    EXPECT_FLOAT_EQ(PositionsAt(mesh.surface, frame_idx)[4].x(), frame_idx <= 3 ? 1 : 2) << frame_idx;
    EXPECT_THAT(MeshValues(mesh, SurfaceColor::kError, frame_idx, {}, {}), testing::Each(frame_idx <= 3 ? 1 : 2));
  }
}

TEST(MeshValues, SeamsAreSewn) {
  const std::vector<Triangle> seamless = SeamlessTriangles(StretchedSquare().surface.mesh);
  EXPECT_THAT(seamless, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 4, 2}));
}

TEST(MeshValues, AreThoseOfTheFrame) {
  ViewedMesh mesh = StretchedSquare();
  const auto values = [&](SurfaceColor color, int frame_idx) {
    return MeshValues(mesh, color, frame_idx, PositionsAt(mesh.surface, frame_idx),
                      SeamlessTriangles(mesh.surface.mesh));
  };
  EXPECT_THAT(values(SurfaceColor::kDisplacement, 10), ElementsAre(0, 0, 1, 0, 1, 1));
  EXPECT_THAT(values(SurfaceColor::kDisplacement, 5), ElementsAre(0, 0, 0.5, 0, 0.5, 0.5));
  // Across the seam too; the second vertex of each pair is in no triangle without it.
  EXPECT_THAT(values(SurfaceColor::kAreaChange, 10),
              ElementsAre(FloatNear(1, kFloat), FloatNear(1, kFloat), FloatNear(1, kFloat), IsNan(),
                          FloatNear(1, kFloat), IsNan()));
  EXPECT_THAT(values(SurfaceColor::kUncertainty, 10), ElementsAre(1, 2, 3, 2, 4, 3));
  EXPECT_THAT(values(SurfaceColor::kError, 10), testing::Each(IsNan()));
  mesh.errors_mm = {{1, 1, kUnknown, 1, 1, 1}, {2, 3, 4, 5, kUnknown, 7}};
  EXPECT_THAT(values(SurfaceColor::kError, 0), ElementsAre(1, 1, IsNan(), 1, 1, 1));
  EXPECT_THAT(values(SurfaceColor::kError, 5),
              ElementsAre(FloatEq(1.5F), FloatEq(2), IsNan(), FloatEq(3), IsNan(), FloatEq(4)));
}

TEST(MeshValues, ARangeIsThatOfAllFrames) {
  View view;
  view.runs.resize(2);
  EXPECT_EQ(RangeOfMeshes(view, SurfaceColor::kDisplacement).high, 1);
  view.runs[1].meshes.push_back(StretchedSquare());
  EXPECT_NEAR(RangeOfMeshes(view, SurfaceColor::kDisplacement).high, 1, kFloat);
  EXPECT_EQ(RangeOfMeshes(view, SurfaceColor::kDisplacement).low, 0);
  EXPECT_NEAR(RangeOfMeshes(view, SurfaceColor::kAreaChange).low, -1, kFloat);
  EXPECT_EQ(RangeOfMeshes(view, SurfaceColor::kError).high, 1);  // nothing is known
}

}  // namespace
}  // namespace pliant
