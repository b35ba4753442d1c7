// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The dense surface of a tracked run against the truth of a rigid simulated scene.
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "e2e/e2e_support.h"
#include "pliant/base/statistics.h"
#include "pliant/evaluation/dense_error.h"
#include "pliant/io/gltf.h"
#include "pliant/pipeline/surface_run.h"
#include "pliant/surface/normals.h"

namespace pliant {
namespace {

constexpr double kMinKnown = 0.4;      // of all pixels with a true depth, also those that no other frame shows
constexpr double kMaxAbsRel = 0.012;   // the points' own error is about 0.5 %
constexpr double kShareOfPlate = 0.7;  // of the error of the interpolated points
constexpr double kMinWithinTwoSigma = 0.9;
constexpr double kMinVertices = 2000;      // of 96 x 72 nodes
constexpr int kFilledPx = 400;             // holes of highlights
constexpr double kMaxAbsRelFilled = 0.01;  // twice that of the known pixels
constexpr int kTruthWindowPx = 5;          // the true depth has steps of its 16 bits
constexpr double kUnitInBytes = 0.01;      // of a unit vector with three bytes
constexpr double kMaxMedianAngle_deg = 8;  // folds are sharper than a compared window

TEST(RigidScene, ItsSurfaceIsNearerToTheTruthThanItsPointsInterpolated) {
  const TestFolder folder;
  SurfaceRequest request;
  request.run_path = kDefaultRun;
  request.sequence_path = kSequence;
  request.output_path = folder.Path("surface");
  request.frames = {20, 40};
  const auto summary = MakeSurface(request, {}, {});
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  ASSERT_EQ(summary->frames.size(), 2U);
  for (const char* file :
       {"depth/000020.png", "confidence/000040.png", "mesh/000020.ply", "camera.yaml", "surface.json", "config.yaml",
        "undeformed.ply", "surface.glb", "surface.pvd", "vtp/000040.vtp"})
    EXPECT_TRUE(std::filesystem::exists(folder.Path(std::string("surface/") + file))) << file;
  const auto surface = ReadSurfaceFolder(request.output_path);
  ASSERT_TRUE(surface.ok()) << surface.status().message();
  const auto sequence = OpenSequence({.image_path = kSequence});
  ASSERT_TRUE(sequence.ok());
  const auto run = ReadEvaluationInput(kDefaultRun);
  ASSERT_TRUE(run.ok());
  const auto error = ComputeDenseError(*surface, *run, **sequence, ErrorScale::kPerFrame);
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_EQ(error->frames, 2);
  EXPECT_GT(error->known_share, kMinKnown);
  EXPECT_LT(error->estimate.abs_rel, kMaxAbsRel);
  EXPECT_LT(error->estimate.rmse_mm, kShareOfPlate * error->interpolation.value().rmse_mm);
  EXPECT_GT(error->within_2_sigma, kMinWithinTwoSigma);
  EXPECT_GT(error->mesh_vertices, kMinVertices);
  EXPECT_LT(error->mesh.value().depth.abs_rel, kMaxAbsRel);
}

class SurfaceFiles : public testing::Test {
 protected:
  Result<SurfaceSummary> Make(const SurfaceRunOptions& options, const SurfaceProgress& callback = {},
                              std::vector<int> frames = {30}) const {
    SurfaceRequest request;
    request.run_path = kDefaultRun;
    request.sequence_path = kSequence;
    request.output_path = folder_.Path("surface");
    request.frames = std::move(frames);
    request.stop = &stop_;
    return MakeSurface(request, options, callback);
  }
  SurfaceDepth Depth() const {
    const auto surface = ReadSurfaceFolder(folder_.Path("surface"));
    EXPECT_TRUE(surface.ok()) << surface.status().message();
    auto depth = ReadSurfaceDepth(*surface, surface->frames.front());
    EXPECT_TRUE(depth.ok()) << depth.status().message();
    return *std::move(depth);
  }
  bool Has(const std::string& name) const { return std::filesystem::exists(folder_.Path("surface/" + name)); }

  TestFolder folder_;
  std::atomic<bool> stop_ = false;
};

TEST_F(SurfaceFiles, AreThoseThatAreWanted) {
  SurfaceRunOptions options;
  options.vtk = false;
  options.obj = true;
  ASSERT_TRUE(Make(options).ok());
  for (const char* name : {"mesh/000030.ply", "obj/000030.obj", "texture.jpg", "texture.mtl", "surface.glb"})
    EXPECT_TRUE(Has(name)) << name;
  for (const char* name : {"vtp", "surface.pvd"}) EXPECT_FALSE(Has(name)) << name;
  // Those of an earlier surface go.
  options.mesh_columns = 0;
  ASSERT_TRUE(Make(options).ok());
  EXPECT_TRUE(Has("depth/000030.png"));
  for (const char* name : {"mesh", "obj", "texture.jpg", "texture.mtl", "surface.glb", "undeformed.ply"})
    EXPECT_FALSE(Has(name)) << name;
}

TEST_F(SurfaceFiles, OfAMeshThatIsTooCoarseAreMissedAloud) {
  SurfaceRunOptions options;
  options.mesh_columns = 1;
  const auto summary = Make(options);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_THAT(summary->warnings, testing::Contains(testing::StartsWith("there is no mesh: ")));
  EXPECT_FALSE(Has("surface.glb"));
}

TEST_F(SurfaceFiles, AreThoseOfFramesThatTheRunHas) {
  SurfaceRunOptions options;
  options.mesh_columns = 0;
  const auto summary = Make(options, {}, {30, 9998, 9999});
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_THAT(
      summary->warnings,
      testing::ElementsAre(testing::StartsWith("frames 9998, 9999 are not in the run, whose frames are 0 to ")));
  EXPECT_THAT(Make(options)->warnings, testing::IsEmpty());
}

// A copy of the run in which these frames are lost.
void CopyRunWithLostFrames(const TestFolder& folder, int first, int last) {
  std::filesystem::copy(kDefaultRun, folder.Path("run"), std::filesystem::copy_options::recursive);
  std::istringstream rows(folder.Read("run/frames.csv"));
  std::istringstream poses(folder.Read("run/trajectory.txt"));
  std::string row;
  std::string pose;
  std::string kept_rows;
  std::string kept_poses;
  const std::string tracking = ",tracking,";
  while (std::getline(rows, row)) {
    const std::size_t state = row.find(tracking);
    const bool has_pose = state != std::string::npos && std::getline(poses, pose);
    const int frame_idx = std::atoi(row.c_str());
    const bool is_lost = has_pose && first <= frame_idx && frame_idx <= last;
    if (is_lost) row.replace(state, tracking.size(), ",lost,");
    kept_rows += row + "\n";
    if (has_pose && !is_lost) kept_poses += pose + "\n";
  }
  folder.Write("run/frames.csv", kept_rows);
  folder.Write("run/trajectory.txt", kept_poses);
}

TEST(RigidScene, ItsSurfaceHasAGapWhereAWantedFrameIsLost) {
  const TestFolder folder;
  CopyRunWithLostFrames(folder, 31, 33);
  SurfaceRequest request;
  request.run_path = folder.Path("run");
  request.sequence_path = kSequence;
  request.output_path = folder.Path("surface");
  request.frames = {26, 30, 32, 34, 38};
  SurfaceRunOptions options;
  options.animation_keys = 2;
  ASSERT_TRUE(MakeSurface(request, options, {}).ok());
  const auto mesh = ReadGlb(folder.Path("surface/surface.glb"));
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  ASSERT_EQ(mesh->gaps.size(), 1U);
  EXPECT_EQ(mesh->gaps[0].last_frame_idx, 30);
  EXPECT_EQ(mesh->gaps[0].next_frame_idx, 34);
  const double step_s = 0.25 * (mesh->gaps[0].next_time_s - mesh->gaps[0].last_time_s);
  EXPECT_NEAR(mesh->gaps[0].held_until_s, mesh->gaps[0].next_time_s - step_s, 0.1 * step_s);
  std::vector<int> keys;
  for (const MeshKey& key : mesh->keys) keys.push_back(key.frame_idx);
  EXPECT_THAT(keys, testing::ElementsAre(26, 30, 34, 38));
}

// What is filled is nearly as good as what is measured around it, and changes nothing of the mesh.
TEST_F(SurfaceFiles, MarkWhatWasFilled) {
  SurfaceRunOptions options;
  options.gltf = options.vtk = false;
  ASSERT_TRUE(Make(options).ok());
  EXPECT_FALSE(Has("filled"));
  const std::string mesh = folder_.Read("surface/undeformed.ply");
  const auto measured = Depth();
  options.fill = kFilledPx;
  const auto summary = Make(options);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_GT(summary->frames[0].filled_share, 0.0);
  EXPECT_EQ(folder_.Read("surface/undeformed.ply"), mesh);
  auto filled = Depth();
  ASSERT_GT(cv::countNonZero(filled.filled), 0);
  EXPECT_EQ(cv::countNonZero((filled.filled != 0) & (measured.depth > 0)), 0);
  EXPECT_EQ(cv::countNonZero((filled.filled != 0) & (filled.depth == 0)), 0);
  filled.KeepMeasured();
  EXPECT_EQ(cv::countNonZero(filled.depth != measured.depth), 0);

  const auto sequence = OpenSequence({.image_path = kSequence});
  ASSERT_TRUE(sequence.ok());
  const auto surface = ReadSurfaceFolder(folder_.Path("surface"));
  const auto error = ComputeDenseError(*surface, *ReadEvaluationInput(kDefaultRun), **sequence, ErrorScale::kPerFrame);
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_GT(error->filled_share, 0.0);
  EXPECT_LT(error->filled.value().abs_rel, kMaxAbsRelFilled);
}

TEST_F(SurfaceFiles, HaveNormalsAndFloatsOnRequest) {
  SurfaceRunOptions options;
  options.mesh_columns = 0;
  options.exr = options.normals_png = true;
  ASSERT_TRUE(Make(options).ok());
  EXPECT_TRUE(Has("exr/000030.exr"));
  const cv::Mat normals = cv::imread(folder_.Path("surface/normals/000030.png"));
  const auto sequence = OpenSequence({.image_path = kSequence});
  ASSERT_TRUE(sequence.ok());
  const auto true_depth = (*sequence)->Depth(30);
  ASSERT_TRUE(true_depth.ok() && true_depth->has_value());
  const cv::Mat truth = NormalsOfDepth((*sequence)->camera(), **true_depth, kTruthWindowPx);
  ASSERT_EQ(normals.size(), truth.size());
  std::vector<double> angles_deg;
  for (int y = 0; y < normals.rows; ++y)
    for (int x = 0; x < normals.cols; ++x) {
      const auto& bgr = normals.at<cv::Vec3b>(y, x);
      const auto& expected = truth.at<cv::Vec3f>(y, x);
      if (bgr == cv::Vec3b(0, 0, 0) || expected == cv::Vec3f(0, 0, 0)) continue;
      const Eigen::Vector3d n = Eigen::Vector3d(bgr[2], bgr[1], bgr[0]) / 127.5 - Eigen::Vector3d::Ones();
      EXPECT_NEAR(n.norm(), 1, kUnitInBytes);
      const double cosine = n.normalized().dot(Eigen::Vector3d(expected[0], expected[1], expected[2]));
      angles_deg.push_back(kDegPerRad * std::acos(std::min(1.0, cosine)));
    }
  ASSERT_GT(angles_deg.size(), 0.3 * static_cast<double>(normals.total()));
  EXPECT_LT(Median(angles_deg), kMaxMedianAngle_deg);
  // Those of an earlier surface go.
  options.exr = options.normals_png = false;
  ASSERT_TRUE(Make(options).ok());
  EXPECT_FALSE(Has("exr"));
  EXPECT_FALSE(Has("normals"));
}

TEST_F(SurfaceFiles, OfASurfaceThatWasStoppedAreWhole) {
  const auto summary = Make({}, [&](SurfaceStage stage, int done, int, double) {
    if (stage == SurfaceStage::kMesh && done == 1) stop_ = true;
  });
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_TRUE(summary->stopped);
  EXPECT_THAT(folder_.Read("surface/surface.json"), testing::HasSubstr("\"status\": \"interrupted\""));
  EXPECT_TRUE(Has("depth/000030.png"));
  EXPECT_FALSE(Has("surface.glb"));
  EXPECT_FALSE(Has("mesh"));
}

}  // namespace
}  // namespace pliant
