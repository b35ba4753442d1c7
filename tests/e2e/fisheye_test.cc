// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A scene that deforms, seen through a fisheye of 160 degrees: nothing is undistorted on the way.
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "e2e/e2e_support.h"
#include "pliant/simulation/write_sequence.h"

namespace pliant {
namespace {

constexpr double kMinMeanPoints = 100;       // a map of some hundred points, of which few are lost
constexpr double kFisheyeShareOfNull = 0.2;  // the shape is known, not the mean depth alone
constexpr double kAsWell = 1.3;              // the same scene, with fewer pixels a degree

std::string Render(const TestFolder& folder, CameraModelId lens, double fov_deg) {
  SimulationOptions options;
  options.camera.model = lens;
  options.camera.horizontal_fov_deg = fov_deg;
  options.camera.width = 400;
  options.camera.height = 300;
  options.sensor.samples = 1;
  options.texture.texel_mm = 0.2;
  options.trajectory.frames = 60;
  options.deformation.amplitude_mm = 3;
  options.deformation.omega_rad_s = 2.5;
  std::string path = folder.Path(std::string(EnumName(lens)));
  EXPECT_TRUE(WriteSequence(options, path).ok());
  return path;
}

TEST(Fisheye, IsTrackedAsWellAsAPinhole) {
  const TestFolder folder;
  double rmses_mm[2] = {};
  for (const auto& [k, lens, fov_deg] :
       {std::tuple(0, CameraModelId::kPinhole, 70.0), std::tuple(1, CameraModelId::kOpenCvFisheye, 160.0)}) {
    const std::string sequence = Render(folder, lens, fov_deg);
    const std::string run = folder.Path("run" + std::to_string(k));
    const RunSummary summary = TrackSequenceAt(sequence, run, {});
    ASSERT_EQ(summary.status, RunStatus::kCompleted) << summary.note;
    EXPECT_EQ(summary.frames_tracked, 60);
    const Evaluation evaluation = EvaluateRun(run, sequence, ErrorScale::kPerFrame);
    EXPECT_GT(evaluation.survival.mean_points, kMinMeanPoints);
    EXPECT_LT(evaluation.surface->plain.estimate.mean_rmse_mm,
              kFisheyeShareOfNull * evaluation.surface->plain.null.mean_rmse_mm);
    rmses_mm[k] = evaluation.surface->plain.estimate.mean_rmse_mm;
  }
  EXPECT_LT(rmses_mm[1], kAsWell * rmses_mm[0]);
}

}  // namespace
}  // namespace pliant
