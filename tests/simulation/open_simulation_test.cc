// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/simulation/open_simulation.h"

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "pliant/simulation/write_sequence.h"
#include "simulation/small_scene.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using simulation_test::SmallScene;
using testing::HasSubstr;

class OpenSimulationTest : public testing::Test {
 protected:
  OpenSimulationTest()
      : folder_(fs::temp_directory_path() / ("pliant_open_" + std::to_string(getpid()) + "_" +
                                             testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~OpenSimulationTest() override { fs::remove_all(folder_); }

  // Replaces text in a file of the sequence.
  void Edit(const char* name, const std::string& from, const std::string& to) const {
    std::stringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    std::string edited = text.str();
    const std::size_t position = edited.find(from);
    ASSERT_NE(position, std::string::npos) << name << " has no " << from;
    std::ofstream(folder_ / name) << edited.replace(position, from.size(), to);
  }

  fs::path folder_;
};

TEST_F(OpenSimulationTest, AnswersAsTheSimulatorThatMadeTheSequence) {
  SimulationOptions options = SmallScene(TrajectoryKind::kSway, 3);
  options.deformation.amplitude_mm = 2.0;
  options.scene.seed = 5;
  ASSERT_TRUE(WriteSequence(options, folder_).ok());
  Result<Simulator> opened = OpenSimulation(folder_);
  ASSERT_TRUE(opened.ok()) << opened.status().message();
  Result<Simulator> made = Simulator::Create(options);
  const std::vector<Eigen::Vector2d> pixels = {{20, 30}, {100.5, 60.25}};
  const auto there = opened->HitsAt(2, pixels);
  const auto here = made->HitsAt(2, pixels);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    ASSERT_TRUE(there[i] && here[i]);
    EXPECT_EQ(there[i]->point_in_world, here[i]->point_in_world);
    EXPECT_EQ(there[i]->point.triangle_idx, here[i]->point.triangle_idx);
  }
}

TEST_F(OpenSimulationTest, OpensASequenceThatWasInterrupted) {
  const Status stopped = WriteSequence(SmallScene(TrajectoryKind::kHold, 5), folder_, [](int done, int) {
    return done == 2 ? SimulationContinue::kStop : SimulationContinue::kYes;
  });
  ASSERT_EQ(stopped.code(), ErrorCode::kInterrupted);
  const Result<Simulator> opened = OpenSimulation(folder_);
  EXPECT_TRUE(opened.ok()) << opened.status().message();
}

TEST_F(OpenSimulationTest, SaysThatASequenceWasNotSimulated) {
  EXPECT_EQ(OpenSimulation(folder_).status().code(), ErrorCode::kNotFound);
  EXPECT_THAT(OpenSimulation(folder_).status().message(), HasSubstr("has no simulation.yaml"));
  EXPECT_EQ(OpenSimulation(folder_ / "nowhere").status().code(), ErrorCode::kNotFound);
}

TEST_F(OpenSimulationTest, NamesTheLineOfAFileThatIsNotOfASimulation) {
  std::ofstream(folder_ / "simulation.yaml") << "Tracker:\n  points: 500\n";
  const Status status = OpenSimulation(folder_).status();
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("simulation.yaml:2"));
  std::ofstream(folder_ / "simulation.yaml") << "{ damaged";
  EXPECT_EQ(OpenSimulation(folder_).status().code(), ErrorCode::kUnreadable);
}

TEST_F(OpenSimulationTest, RefusesOptionsOfAnotherSequence) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 1);
  options.trajectory.tremor_mm = 0;  // so that only the walls tell the seeds apart
  options.trajectory.tremor_deg = 0;
  options.scene.bend_deg_per_cm = 0;
  ASSERT_TRUE(WriteSequence(options, folder_).ok());
  ASSERT_TRUE(OpenSimulation(folder_).ok());
  const auto expect_mismatch = [&](const char* sentence) {
    const Status status = OpenSimulation(folder_).status();
    EXPECT_EQ(status.code(), ErrorCode::kMismatch);
    EXPECT_THAT(status.message(), HasSubstr(sentence));
  };
  Edit("simulation.yaml", "seed: 1", "seed: 2");
  expect_mismatch("the depth of frame 0");
  Edit("simulation.yaml", "seed: 2", "seed: 1");
  Edit("simulation.yaml", "start_mm: 25", "start_mm: 26");
  expect_mismatch("the pose of frame 0");
  Edit("simulation.yaml", "start_mm: 26", "start_mm: 25");
  Edit("simulation.yaml", "fov_deg: 70", "fov_deg: 71");
  expect_mismatch("camera.yaml");
}

}  // namespace
}  // namespace pliant
