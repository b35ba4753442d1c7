// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The oracle switches on small simulated sequences, against the true positions of the material points.
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include <gmock/gmock.h>

#include "pliant/io/run_summary.h"
#include "pliant/pipeline/track.h"
#include "pliant/simulation/simulator.h"
#include "pliant/simulation/write_sequence.h"
#include "simulation/small_scene.h"
#include "support/test_folder.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

// Everything true and the scene rigid: what is left is the rounding of barycentric weights and the solver's tolerance.
constexpr double kExactMm = 1e-3;
// Everything true and the scene deforming: motion along the rays of one frame is seen by nothing, the regularizers
// share it out. The points move by up to 1.3 mm in the sequence.
constexpr double kNearlyExactMm = 0.3;
constexpr double kAsGood = 1.02;  // "not worse": two per cent for the points that one run has and the other has not

constexpr int kFrames = 24;

SimulationOptions Scene(double amplitude_mm) {
  SimulationOptions options = simulation_test::SmallScene(TrajectoryKind::kSway, kFrames);
  options.camera.width = 320;
  options.camera.height = 240;
  options.deformation.amplitude_mm = amplitude_mm;
  options.trajectory.sway_period_s = 2.0;
  return options;
}

// Compares every reported point with the material point at the pixel where it was first reported, in the camera frame,
// with the best scale a frame.
class MaterialError final : public TrackObserver {
 public:
  explicit MaterialError(const SimulationOptions& options) : simulator_(Simulator::Create(options).value()) {}

  void OnStart(int) override {}
  void OnFrame(const FrameReport& report) override {
    if (!report.cam_from_world) return;
    const Rigid3 cam_from_scene = simulator_.WorldFromCamera(report.frame_idx).Inverse();
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> estimate_and_truth;
    double dot = 0;
    double square = 0;
    for (const PointObservation& observation : report.observations) {
      if (!first_.contains(observation.id)) {
        const std::vector<Eigen::Vector2d> pixel = {observation.pixel};
        const auto hit = simulator_.HitsAt(report.frame_idx, pixel).front();
        if (!hit) continue;
        first_[observation.id] = hit->point;
      }
      const Eigen::Vector3d truth = cam_from_scene * simulator_.Position(first_.at(observation.id), report.frame_idx);
      const Eigen::Vector3d estimate = *report.cam_from_world * observation.position;
      estimate_and_truth.emplace_back(estimate, truth);
      dot += estimate.dot(truth);
      square += estimate.squaredNorm();
    }
    double sum = 0;
    for (const auto& [estimate, truth] : estimate_and_truth) sum += (dot / square * estimate - truth).squaredNorm();
    rmse_sum_mm_ += std::sqrt(sum / static_cast<double>(estimate_and_truth.size()));
    ++frames;
  }

  double MeanRmse() const { return rmse_sum_mm_ / frames; }
  int frames = 0;

 private:
  Simulator simulator_;
  std::map<PointId, MaterialPoint> first_;
  double rmse_sum_mm_ = 0;
};

struct Outcome {
  double rmse_mm = 0;
  int frames = 0;
  RunSummary summary;
};

class Oracles : public testing::Test {
 protected:
  void Render(double amplitude_mm) {
    scene_ = Scene(amplitude_mm);
    const Status written = WriteSequence(scene_, folder_.Path("sequence"));
    ASSERT_TRUE(written.ok()) << written.message();
  }

  Outcome Track(const OracleOptions& oracle, InitMethod start = InitMethod::kGated) const {
    RunRequest request;
    request.input.image_path = folder_.Path("sequence");
    request.output_path = folder_.Path("run");
    TrackOptions options;
    options.tracker.oracle = oracle;
    options.tracker.init.method = start;
    MaterialError error(scene_);
    const std::array<TrackObserver*, 1> observers = {&error};
    const auto summary = RunTrack(request, options, observers);
    EXPECT_TRUE(summary.ok()) << summary.status().message();
    return {error.MeanRmse(), error.frames, summary.ok() ? *summary : RunSummary{}};
  }

  TestFolder folder_;
  SimulationOptions scene_;
};

OracleOptions All() { return {Switch::kOn, Switch::kOn, Switch::kOn}; }

TEST_F(Oracles, WithAllOfThemARigidSceneIsExactFromTheFirstFrame) {
  Render(0.0);
  for (const InitMethod start : {InitMethod::kGated, InitMethod::kDepth}) {
    const Outcome outcome = Track(All(), start);
    EXPECT_EQ(outcome.frames, kFrames);
    EXPECT_LT(outcome.rmse_mm, kExactMm);
  }
}

TEST_F(Oracles, WithAllOfThemADeformingSceneIsNearlyExact) {
  Render(2.5);
  const Outcome outcome = Track(All());
  EXPECT_EQ(outcome.frames, kFrames);
  EXPECT_LT(outcome.rmse_mm, kNearlyExactMm);
}

TEST_F(Oracles, EachAloneIsNotWorseThanNone) {
  Render(2.5);
  const Outcome none = Track({});
  for (const OracleOptions& oracle : {OracleOptions{.first_map = Switch::kOn}, OracleOptions{.tracks = Switch::kOn},
                                      OracleOptions{.poses = Switch::kOn}}) {
    const Outcome outcome = Track(oracle);
    EXPECT_GE(outcome.frames, none.frames) << oracle.Names().front();
    EXPECT_LE(outcome.rmse_mm, kAsGood * none.rmse_mm) << oracle.Names().front();
  }
}

class RotationError final : public TrackObserver {
 public:
  explicit RotationError(const SimulationOptions& options) : simulator_(Simulator::Create(options).value()) {}
  void OnStart(int) override {}
  void OnFrame(const FrameReport& report) override {
    if (!report.cam_from_world) return;
    const Rigid3 truth = simulator_.WorldFromCamera(report.frame_idx).Inverse() * simulator_.WorldFromCamera(0);
    largest_rad = std::max(largest_rad, report.cam_from_world->rotation.angularDistance(truth.rotation));
    ++frames;
  }
  void OnHeld(const FrameReport&) override { ++held; }
  double largest_rad = 0;
  int frames = 0;
  int held = 0;

 private:
  Simulator simulator_;
};

TEST_F(Oracles, ThePosesAreTrueInTheFramesThatWaitedForTheMapToo) {
  constexpr int kReference = 1;  // the frame that is held in any case
  Render(0.0);
  RunRequest request;
  request.input.image_path = folder_.Path("sequence");
  request.output_path = folder_.Path("run");
  TrackOptions options;
  options.tracker.oracle.poses = Switch::kOn;
  RotationError error(scene_);
  ASSERT_TRUE(RunTrack(request, options, std::array<TrackObserver*, 1>{&error}).ok());
  EXPECT_GT(error.held, kReference);
  EXPECT_EQ(error.frames, kFrames);
  EXPECT_LT(error.largest_rad, kAngleRoundOff_rad);
}

TEST_F(Oracles, WithAllOfThemPointsAreLostOnlyWhenOccludedOrOutsideTheImage) {
  Render(0.0);
  const auto losses = Track(All()).summary.losses;
  ASSERT_FALSE(losses.empty());
  for (const auto& [reason, count] : losses) EXPECT_THAT(reason, testing::AnyOf("occluded", "out_of_image")) << count;
}

TEST_F(Oracles, ThoseUsedAreInRunJsonAndConfigYaml) {
  Render(0.0);
  Track({.tracks = Switch::kOn, .poses = Switch::kOn});
  const auto summary = ReadRunSummary(folder_.Path("run/run.json"));
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_THAT(summary->description.oracles, testing::ElementsAre("tracks", "poses"));
  EXPECT_THAT(folder_.Read("run/config.yaml"), testing::HasSubstr("poses: on"));
}

TEST_F(Oracles, WithoutTheSimulationOrWithAnotherCameraAreRefusedInOneSentence) {
  Render(0.0);
  TrackOptions options;
  options.tracker.oracle.poses = Switch::kOn;
  RunRequest request;
  request.input.image_path = folder_.Path("sequence");
  request.output_path = folder_.Path("run");
  request.input.camera_path = folder_.Write(
      "other.yaml", "model: PINHOLE\nwidth: 320\nheight: 240\nparams: [300, 300, 159.5, 119.5]\nfps: 30\n");
  EXPECT_THAT(RunTrack(request, options, {}).status().message(), testing::HasSubstr("the camera is not the one"));
  request.input.camera_path.clear();
  options.image = {.working = WorkingImageMode::kFixed, .scale = 0.5};
  EXPECT_THAT(RunTrack(request, options, {}).status().message(), testing::HasSubstr("leave Image.scale at 1"));
  options.image = {};
  std::filesystem::remove(folder_.Path("sequence/simulation.yaml"));
  EXPECT_THAT(RunTrack(request, options, {}).status().message(), testing::HasSubstr("has no simulation.yaml"));
}

}  // namespace
}  // namespace pliant
