// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The dense surface of a tracked run against the truth of a rigid simulated scene.
#include <filesystem>

#include <gtest/gtest.h>

#include "e2e/e2e_support.h"
#include "pliant/evaluation/dense_error.h"
#include "pliant/pipeline/surface_run.h"

namespace pliant {
namespace {

constexpr double kMinKnown = 0.4;      // of all pixels with a true depth, also those that no other frame shows
constexpr double kMaxAbsRel = 0.012;   // the points' own error is about 0.5 %
constexpr double kShareOfPlate = 0.7;  // of the error of the interpolated points
constexpr double kMinWithinTwoSigma = 0.9;

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
       {"depth/000020.png", "confidence/000040.png", "mesh/000020.ply", "camera.yaml", "surface.json", "config.yaml"})
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
  EXPECT_LT(error->estimate.rmse_mm, kShareOfPlate * error->interpolation.rmse_mm);
  EXPECT_GT(error->within_2_sigma, kMinWithinTwoSigma);
}

}  // namespace
}  // namespace pliant
