// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/mesh_geometry.h"

#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pliant {
namespace {

using testing::ElementsAre;

const std::vector<Triangle> kTwo = {{0, 1, 2}, {1, 3, 2}};

std::vector<Eigen::Vector3f> Square() { return {{0, 0, 5}, {2, 0, 5}, {0, 2, 5}, {2, 2, 5}}; }

TEST(MeshGeometry, NormalsAreThoseOfTheTrianglesByTheirArea) {
  for (const Eigen::Vector3f& normal : VertexNormals(Square(), kTwo))
    EXPECT_TRUE(normal.isApprox(Eigen::Vector3f::UnitZ()));
  const std::vector<Eigen::Vector3f> alone = VertexNormals(Square(), {});
  EXPECT_EQ(alone[0], Eigen::Vector3f(Eigen::Vector3f::Zero()));
  const std::vector<Triangle> back_to_back = {{0, 1, 2}, {2, 1, 0}};
  EXPECT_TRUE(VertexNormals(Square(), back_to_back)[0].isApprox(Eigen::Vector3f::UnitZ()));
}

TEST(MeshGeometry, APartHasWhatIsKnownOfItsVertices) {
  Mesh mesh{
      Square(), Square(), {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}}, {1, 2, 3, 4}, {10, 11, 12, 13}, {1, 2, 1, 2},
      kTwo,     {}};
  mesh.texture_uvs.resize(2);
  mesh.texture_uvs[1][0] = {0.5F, 0.5F};
  const Mesh part = PartOfMesh(mesh, {false, true, true, true});
  EXPECT_THAT(part.ids, ElementsAre(11, 12, 13));
  EXPECT_THAT(part.sigmas, ElementsAre(2, 3, 4));
  EXPECT_THAT(part.views, ElementsAre(2, 1, 2));
  EXPECT_THAT(part.triangles, ElementsAre(Triangle{0, 2, 1}));
  EXPECT_EQ(part.vertices[2], Eigen::Vector3f(2, 2, 5));
  EXPECT_EQ(part.rgb[0][0], 2);
  ASSERT_EQ(part.texture_uvs.size(), 1U);
  EXPECT_EQ(part.texture_uvs[0][0], Eigen::Vector2f(0.5F, 0.5F));
  EXPECT_TRUE(PartOfMesh(mesh, {true, true, false, true}).vertices.empty());  // no triangle has them
}

TEST(MeshGeometry, StretchesAreThoseOfAnAffineMotion) {
  // Stretched by 1.2 and 0.7 along directions of the plane, then moved and turned in space.
  const Eigen::Rotation2Df turn(0.4F);
  const Eigen::Matrix2f stretch =
      turn.toRotationMatrix() * Eigen::Vector2f(1.2F, 0.7F).asDiagonal() * turn.toRotationMatrix().transpose();
  const Eigen::Quaternionf rotation(Eigen::AngleAxisf(0.9F, Eigen::Vector3f(1, 2, 3).normalized()));
  std::vector<Eigen::Vector3f> moved;
  for (const Eigen::Vector3f& vertex : Square()) {
    const Eigen::Vector2f plane = stretch * vertex.head<2>();
    moved.push_back(rotation * Eigen::Vector3f(plane.x(), plane.y(), 5) + Eigen::Vector3f(3, 4, 5));
  }
  for (const TriangleStrain& strain : Strains(Square(), moved, kTwo)) {
    EXPECT_NEAR(strain.largest_stretch, 1.2, 1e-5);
    EXPECT_NEAR(strain.least_stretch, 0.7, 1e-5);
    EXPECT_NEAR(strain.area_change, 1.2 * 0.7 - 1, 1e-5);
  }
}

TEST(MeshGeometry, ATriangleWithoutAreaHasNoStrain) {
  const std::vector<Eigen::Vector3f> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const std::vector<TriangleStrain> strains = Strains(line, line, std::vector<Triangle>{{0, 1, 2}});
  EXPECT_EQ(strains[0].area_change, 0);
  EXPECT_EQ(strains[0].largest_stretch, 1);
}

}  // namespace
}  // namespace pliant
