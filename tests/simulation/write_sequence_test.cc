// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/simulation/write_sequence.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include "pliant/simulation/open_simulation.h"
#include "simulation/small_scene.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using simulation_test::SmallScene;

constexpr double kDepthStep_mm = 0.01;     // 16 bits over a scene of some 200 mm
constexpr double kFloatDepth_mm = 2e-5;    // the rounding of a float of 200
constexpr double kQuaternionShare = 2e-3;  // of the step of six decimals; twice the half step of nine
constexpr double kTumHalfStep = 0.501e-6;  // of times and positions with six decimals; quaternions have nine

class WriteSequenceTest : public testing::Test {
 protected:
  WriteSequenceTest()
      : folder_(fs::temp_directory_path() / ("pliant_simulation_" + std::to_string(getpid()) + "_" +
                                             testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~WriteSequenceTest() override { fs::remove_all(folder_); }

  fs::path folder_;
};

std::vector<std::vector<double>> Numbers(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    rows.emplace_back(std::istream_iterator<double>(words), std::istream_iterator<double>());
  }
  return rows;
}

std::string Bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

int CountFiles(const fs::path& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST_F(WriteSequenceTest, LeavesTheNativeLayout) {
  const SimulationOptions options = SmallScene(TrajectoryKind::kInsert, 3);
  int calls = -1;  // the first call says that the scene stands
  const Status status = WriteSequence(options, folder_ / "seq", [&](int done, int total) {
    EXPECT_EQ(done, ++calls);
    EXPECT_EQ(total, 3);
    return SimulationContinue::kYes;
  });
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(calls, 3);

  const YAML::Node camera = YAML::LoadFile((folder_ / "seq/camera.yaml").string());
  EXPECT_EQ(camera["model"].as<std::string>(), "PINHOLE");
  EXPECT_EQ(camera["width"].as<int>(), 160);
  EXPECT_EQ(camera["height"].as<int>(), 120);
  EXPECT_EQ(camera["unit"].as<std::string>(), "mm");
  EXPECT_EQ(camera["fps"].as<double>(), 30.0);
  const auto params = camera["params"].as<std::vector<double>>();
  ASSERT_EQ(params.size(), 4U);
  EXPECT_NEAR(params[0], simulation_test::Pinhole160().focal, kLengthRoundOff_mm);
  EXPECT_EQ(params[2], 79.5);

  const auto poses = Numbers(folder_ / "seq/groundtruth.txt");
  const auto times = Numbers(folder_ / "seq/times.txt");
  ASSERT_EQ(poses.size(), 3U);
  ASSERT_EQ(times.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(poses[i].size(), 8U);
    EXPECT_NEAR(poses[i][0], times[i][0], kTumHalfStep);
    EXPECT_DOUBLE_EQ(times[i][0], static_cast<double>(i) / 30.0);
    const std::string name = "00000" + std::to_string(i) + ".png";
    EXPECT_EQ(cv::imread((folder_ / "seq/images" / name).string(), cv::IMREAD_UNCHANGED).type(), CV_8UC3);
    EXPECT_EQ(cv::imread((folder_ / "seq/depth" / name).string(), cv::IMREAD_UNCHANGED).type(), CV_16UC1);
  }
}

TEST_F(WriteSequenceTest, DepthAndPosesOnDiskAreTheSimulatorsToHalfAStep) {
  const SimulationOptions options = SmallScene(TrajectoryKind::kSway, 3);
  ASSERT_TRUE(WriteSequence(options, folder_).ok());
  Result<Simulator> simulator = Simulator::Create(options);
  ASSERT_TRUE(simulator.ok());
  const double scale = YAML::LoadFile((folder_ / "camera.yaml").string())["depth_scale"].as<double>();
  EXPECT_LT(scale, kDepthStep_mm);
  const cv::Mat steps = cv::imread((folder_ / "depth/000002.png").string(), cv::IMREAD_UNCHANGED);
  const cv::Mat depth = simulator->Render(2).depth;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      ASSERT_NEAR(steps.at<std::uint16_t>(y, x) * scale, depth.at<float>(y, x), 0.5 * scale + kFloatDepth_mm);
    }
  }
  const auto pose = Numbers(folder_ / "groundtruth.txt")[2];
  const Rigid3 truth = simulator->WorldFromCamera(2);
  EXPECT_LT((Eigen::Vector3d(pose[1], pose[2], pose[3]) - truth.translation).norm(), 2 * kTumHalfStep);
  EXPECT_LT((Eigen::Vector4d(pose[4], pose[5], pose[6], pose[7]) - truth.rotation.coeffs()).norm(),
            kQuaternionShare * kTumHalfStep);
}

TEST_F(WriteSequenceTest, TheOptionsBesideASequenceGiveItBack) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 1);
  options.scene.seed = 7;
  options.deformation.amplitude_mm = 1.25;
  ASSERT_TRUE(WriteSequence(options, folder_ / "a").ok());
  SimulationOptions again;
  OptionTable table;
  again.List(table);
  for (const auto& group : YAML::LoadFile((folder_ / "a/simulation.yaml").string()))
    for (const auto& option : group.second)
      ASSERT_TRUE(table
                      .Set(group.first.as<std::string>() + "." + option.first.as<std::string>(),
                           option.second.as<std::string>())
                      .ok());
  ASSERT_TRUE(WriteSequence(again, folder_ / "b").ok());
  for (const char* name :
       {"images/000000.png", "depth/000000.png", "groundtruth.txt", "camera.yaml", "simulation.yaml"}) {
    EXPECT_FALSE(Bytes(folder_ / "a" / name).empty());
    EXPECT_EQ(Bytes(folder_ / "a" / name), Bytes(folder_ / "b" / name)) << name;
  }
}

// With everything that compresses and loses frames.
TEST_F(WriteSequenceTest, RecordsTheSameFilesOnAnyNumberOfThreads) {
  SimulationOptions options = MakeSimulationOptions(Realism::kEndoscope);
  const SimulationOptions small = SmallScene(TrajectoryKind::kInsert, 6);
  options.scene = small.scene;
  options.camera = small.camera;
  options.trajectory = small.trajectory;
  options.texture = small.texture;
  options.recording.lost_share = 0.3;
  options.camera.baseline_mm = 4;
  options.threads = 1;
  ASSERT_TRUE(WriteSequence(options, folder_ / "one").ok());
  options.threads = 4;
  ASSERT_TRUE(WriteSequence(options, folder_ / "four").ok());
  const int frames = CountFiles(folder_ / "one/images");
  ASSERT_EQ(CountFiles(folder_ / "four/images"), frames);
  for (int k = 0; k < frames; ++k)
    for (const char* kind : {"images", "right", "depth"}) {
      const std::string name = std::string(kind) + "/00000" + std::to_string(k) + ".png";
      EXPECT_EQ(Bytes(folder_ / "one" / name), Bytes(folder_ / "four" / name)) << name;
    }
  EXPECT_EQ(Bytes(folder_ / "one/times.txt"), Bytes(folder_ / "four/times.txt"));
}

TEST_F(WriteSequenceTest, LostFramesLeaveGapsAndTheOthersTheirTimesPosesAndDepth) {
  SimulationOptions options = SmallScene(TrajectoryKind::kInsert, 12);
  ASSERT_TRUE(WriteSequence(options, folder_ / "whole").ok());
  options.recording.lost_share = 0.4;
  options.recording.repeated_share = 0;
  ASSERT_TRUE(WriteSequence(options, folder_ / "gaps").ok());
  const auto times = Numbers(folder_ / "gaps/times.txt");
  const auto poses = Numbers(folder_ / "gaps/groundtruth.txt");
  const auto all_poses = Numbers(folder_ / "whole/groundtruth.txt");
  ASSERT_LT(times.size(), 12U);
  ASSERT_EQ(poses.size(), times.size());
  ASSERT_EQ(CountFiles(folder_ / "gaps/images"), std::ssize(times));
  const auto name = [](const std::string& folder, std::size_t k) {
    return folder + (k < 10 ? "/00000" : "/0000") + std::to_string(k) + ".png";
  };
  for (std::size_t k = 0; k < times.size(); ++k) {
    const auto frame = static_cast<std::size_t>(std::lround(times[k][0] * 30));
    EXPECT_EQ(poses[k], all_poses[frame]);
    for (const char* kind : {"/images", "/depth"})
      EXPECT_EQ(Bytes(folder_ / name(std::string("gaps") + kind, k)),
                Bytes(folder_ / name(std::string("whole") + kind, frame)));
  }
  EXPECT_TRUE(OpenSimulation(folder_ / "gaps").ok());
}

TEST_F(WriteSequenceTest, AShorterSequenceReplacesALongerOne) {
  ASSERT_TRUE(WriteSequence(SmallScene(TrajectoryKind::kHold, 3), folder_).ok());
  ASSERT_TRUE(WriteSequence(SmallScene(TrajectoryKind::kHold, 1), folder_).ok());
  EXPECT_EQ(CountFiles(folder_ / "images"), 1);
  EXPECT_EQ(CountFiles(folder_ / "depth"), 1);
  EXPECT_EQ(Numbers(folder_ / "groundtruth.txt").size(), 1U);
}

TEST_F(WriteSequenceTest, LeavesASequenceAloneThatWasNotSimulated) {
  fs::create_directories(folder_ / "images");
  std::ofstream(folder_ / "images/filmed.png") << "of a patient";
  const Status status = WriteSequence(SmallScene(TrajectoryKind::kHold, 1), folder_);
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(status.message(), testing::HasSubstr("images"));
  EXPECT_EQ(CountFiles(folder_), 1);
  EXPECT_EQ(Bytes(folder_ / "images/filmed.png"), "of a patient");
}

TEST_F(WriteSequenceTest, LeavesAFolderAloneThatAnotherOneWritesInto) {
  Status second = Status::Ok();
  const Status first = WriteSequence(SmallScene(TrajectoryKind::kHold, 3), folder_, [&](int done, int) {
    if (done == 2) second = WriteSequence(SmallScene(TrajectoryKind::kHold, 1), folder_);
    return SimulationContinue::kYes;
  });
  EXPECT_TRUE(first.ok()) << first.message();
  EXPECT_EQ(second.code(), ErrorCode::kUnwritable);
  EXPECT_THAT(second.message(), testing::HasSubstr("is writing into"));
  EXPECT_EQ(CountFiles(folder_ / "images"), 3);
}

TEST_F(WriteSequenceTest, StopsOnRequestAndKeepsWhatWasRendered) {
  const Status status = WriteSequence(SmallScene(TrajectoryKind::kHold, 5), folder_, [](int done, int) {
    return done == 2 ? SimulationContinue::kStop : SimulationContinue::kYes;
  });
  EXPECT_EQ(status.code(), ErrorCode::kInterrupted);
  EXPECT_EQ(CountFiles(folder_ / "images"), 2);
  EXPECT_EQ(Numbers(folder_ / "groundtruth.txt").size(), 2U);
}

TEST_F(WriteSequenceTest, NamesTheFolderThatItCannotWrite) {
  std::ofstream(folder_ / "file") << "in the way";
  const Status status = WriteSequence(SmallScene(TrajectoryKind::kHold, 1), folder_ / "file/seq");
  EXPECT_EQ(status.code(), ErrorCode::kUnwritable);
  EXPECT_THAT(status.message(), testing::HasSubstr("file/seq"));
}

}  // namespace
}  // namespace pliant
