// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/mesh_texture.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pliant/image/brightness.h"
#include "surface/textured_plane.h"

namespace pliant {
namespace {

using test::TexturedPlane;

// A mesh of four columns and rows of vertices on the plane, around the middle of view 0, world frame.
Mesh SmallMesh(const TexturedPlane& plane) {
  Mesh mesh;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) {
      mesh.vertices.emplace_back(plane.PointOn(60 + 30 * c, 60 + 30 * r, 0).cast<float>());
      mesh.rgb.push_back({10, 20, 30});
    }
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      const std::int32_t here = 4 * r + c;
      mesh.triangles.push_back({here, here + 4, here + 1});
      mesh.triangles.push_back({here + 4, here + 5, here + 1});
    }
  return mesh;
}

TextureView ViewOf(const TexturedPlane& plane, const Mesh& mesh, int view) {
  TextureView result{plane.Image(view),
                     cv::Mat(TexturedPlane::kHeight, TexturedPlane::kWidth, CV_8U, cv::Scalar(255)),
                     plane.Pose(view),
                     {},
                     1.0};
  for (const Eigen::Vector3f& vertex : mesh.vertices) result.mesh.positions.push_back(vertex.cast<double>());
  result.mesh.views.assign(mesh.vertices.size(), VertexView::kMeasured);
  return result;
}

cv::Vec3b At(const cv::Mat& texture, const Eigen::Vector2f& uv) {
  return texture.at<cv::Vec3b>(static_cast<int>(uv.y() * static_cast<float>(texture.rows)),
                               static_cast<int>(uv.x() * static_cast<float>(texture.cols)));
}

class MeshTextureTest : public testing::Test {
 protected:
  MeshTextureTest() { plane_.slide_mm = 0; }

  TexturedPlane plane_;
};

TEST_F(MeshTextureTest, HasTheImageAtTheVertices) {
  Mesh mesh = SmallMesh(plane_);
  const TextureView view = ViewOf(plane_, mesh, 0);
  const cv::Mat texture = MakeTexture(plane_.camera, std::vector{view}, 4096, &mesh);
  EXPECT_LT(texture.cols, 120);  // the part that the mesh uses
  ASSERT_EQ(mesh.texture_uvs.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d at = mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])].cast<double>();
      EXPECT_EQ(At(texture, mesh.texture_uvs[t][k])[1], ColorAt(view.image, *plane_.camera.Project(at))[1]);
    }
}

TEST_F(MeshTextureTest, TakesAsFewImagesAsShowEverythingWell) {
  Mesh mesh = SmallMesh(plane_);
  std::vector<TextureView> views;
  for (int view = 0; view < 4; ++view) views.push_back(ViewOf(plane_, mesh, view));
  views[2].sharpness = 3;
  views[2].image.setTo(77);
  const cv::Mat texture = MakeTexture(plane_.camera, views, 4096, &mesh);
  for (const auto& uvs : mesh.texture_uvs) EXPECT_EQ(At(texture, uvs[0]), cv::Vec3b(77, 77, 77));
}

TEST_F(MeshTextureTest, AHighlightIsTakenFromAnotherImage) {
  Mesh mesh = SmallMesh(plane_);
  std::vector<TextureView> views = {ViewOf(plane_, mesh, 0), ViewOf(plane_, mesh, 1)};
  views[0].sharpness = 3;
  const cv::Rect highlight(90, 90, 30, 30);
  views[0].image(highlight).setTo(255);
  views[0].valid(highlight).setTo(0);
  const cv::Mat texture = MakeTexture(plane_.camera, views, 4096, &mesh);
  for (const auto& uvs : mesh.texture_uvs)
    for (const Eigen::Vector2f& uv : uvs) EXPECT_LT(At(texture, uv)[0], 255);
}

TEST_F(MeshTextureTest, ImagesAreMadeEquallyBright) {
  Mesh mesh = SmallMesh(plane_);
  std::vector<TextureView> views = {ViewOf(plane_, mesh, 0), ViewOf(plane_, mesh, 1)};
  views[0].image.setTo(100);
  views[0].sharpness = 1.1;
  for (std::size_t v = 0; v < 8; ++v) views[0].mesh.views[v] = VertexView::kOutOfView;  // the upper half
  views[1].image.setTo(150);
  const cv::Mat texture = MakeTexture(plane_.camera, views, 4096, &mesh);
  const int level = At(texture, mesh.texture_uvs[0][0])[0];
  for (const auto& uvs : mesh.texture_uvs) EXPECT_NEAR(At(texture, uvs[0])[0], level, 1);
}

TEST_F(MeshTextureTest, ATriangleThatNoImageShowsHasItsVerticesColor) {
  Mesh mesh = SmallMesh(plane_);
  TextureView view = ViewOf(plane_, mesh, 0);
  view.mesh.views.front() = VertexView::kOutOfView;
  const cv::Mat texture = MakeTexture(plane_.camera, std::vector{view}, 4096, &mesh);
  EXPECT_EQ(At(texture, mesh.texture_uvs[0][0]), cv::Vec3b(30, 20, 10));
  Mesh none = SmallMesh(plane_);
  const cv::Mat of_none = MakeTexture(plane_.camera, {}, 4096, &none);
  EXPECT_EQ(At(of_none, none.texture_uvs[5][1]), cv::Vec3b(30, 20, 10));
}

TEST_F(MeshTextureTest, IsNoLargerThanWanted) {
  Mesh mesh = SmallMesh(plane_);
  const cv::Mat texture = MakeTexture(plane_.camera, std::vector{ViewOf(plane_, mesh, 0)}, 50, &mesh);
  EXPECT_EQ(std::max(texture.cols, texture.rows), 50);
  for (const auto& uvs : mesh.texture_uvs)
    for (const Eigen::Vector2f& uv : uvs) EXPECT_TRUE(uv.minCoeff() >= 0 && uv.maxCoeff() <= 1);
}

}  // namespace
}  // namespace pliant
