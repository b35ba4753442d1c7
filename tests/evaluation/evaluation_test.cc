// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/evaluation.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pliant/base/random.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

constexpr double kFps = 25;

Camera TestCamera() {
  constexpr std::array<double, 4> kParams = {60, 60, 31.5, 23.5};
  return *Camera::Create(CameraModelId::kPinhole, 64, 48, kParams);
}

// Truth without images: a wavy wall that moves, seen from a camera that moves.
class TruthSequence final : public Sequence {
 public:
  enum class Truth { kAll, kDepthOnly, kPosesOnly, kNone };
  explicit TruthSequence(int count, Truth truth = Truth::kAll) : count_(count), truth_(truth) {}

  const Camera& camera() const override { return camera_; }
  int size() const override { return count_; }
  Result<std::optional<SequenceFrame>> Next() override { return std::optional<SequenceFrame>(); }
  Result<std::optional<cv::Mat>> Depth(int frame_idx) const override {
    if (frame_idx >= count_ || truth_ == Truth::kPosesOnly || truth_ == Truth::kNone) return std::optional<cv::Mat>();
    cv::Mat_<float> depth(48, 64);
    for (int y = 0; y < depth.rows; ++y)
      for (int x = 0; x < depth.cols; ++x)
        depth(y, x) = static_cast<float>(50 + 5 * std::sin(0.1 * x + frame_idx) + 0.1 * y);
    return std::optional<cv::Mat>(depth);
  }
  std::optional<Rigid3> WorldFromCamera(int frame_idx) const override {
    if (frame_idx >= count_ || truth_ == Truth::kDepthOnly || truth_ == Truth::kNone) return std::nullopt;
    return Pose(frame_idx);
  }
  std::optional<double> TimestampS(int frame_idx) const override {
    if (frame_idx < 0 || frame_idx >= count_) return std::nullopt;
    return frame_idx / kFps;
  }
  static Rigid3 Pose(int frame_idx) {
    return {RotationExp({0.02 * frame_idx, 0.1 * std::sin(frame_idx), 0}),
            Eigen::Vector3d(frame_idx, 0.3 * frame_idx * frame_idx, std::cos(frame_idx))};
  }

 private:
  Camera camera_ = TestCamera();
  int count_;
  Truth truth_;
};

// A run on TruthSequence: frame 0 is not tracked, the others are. Map units are mm / scale; noise in mm.
EvaluationInput MakeRun(int count, double scale, double noise_mm) {
  const TruthSequence truth(count);
  const Random seed(17);
  EvaluationInput run;
  run.name = "RUN";
  for (int idx = 0; idx < count; ++idx) {
    EvaluationFrame& frame = run.frames.emplace_back();
    frame.frame_idx = idx;
    frame.timestamp_s = idx / kFps;
    if (idx == 0) continue;
    Random random = seed.Child(std::to_string(idx));
    const auto noise = [&random, noise_mm] {
      return Eigen::Vector3d(random.Normal(noise_mm), random.Normal(noise_mm), random.Normal(noise_mm));
    };
    std::vector<Eigen::Vector2d> pixels;
    for (int i = 0; i < 40; ++i) pixels.emplace_back(random.Uniform(0, 63), random.Uniform(0, 47));
    const std::vector<Eigen::Vector3d> any(pixels.size(), Eigen::Vector3d::UnitZ());
    const SurfaceFrame surface = PairWithSurface(idx, any, pixels, truth.camera(), **truth.Depth(idx), 10);
    const Rigid3 pose(TruthSequence::Pose(idx).rotation, (TruthSequence::Pose(idx).translation + noise()) / scale);
    frame.cam_from_world = pose.Inverse();
    for (int i = 0; i < 40; ++i)
      frame.observations.push_back({PointId{i}, pixels[static_cast<std::size_t>(i)],
                                    pose * ((surface.pairs[static_cast<std::size_t>(i)].truth + noise()) / scale), 1});
  }
  return run;
}

TEST(Evaluate, IsZeroWithoutNoiseWhateverTheScale) {
  const auto evaluation = Evaluate(MakeRun(8, 3, 0), TruthSequence(8), {});
  ASSERT_TRUE(evaluation.ok()) << evaluation.status().message();
  ASSERT_TRUE(evaluation->surface && evaluation->trajectory);
  EXPECT_LT(evaluation->surface->estimate.mean_rmse_mm, 1e-9);
  EXPECT_NEAR(evaluation->surface->estimate.max_scale, 3, 1e-9);
  EXPECT_LT(evaluation->trajectory->ate_rmse_mm, 1e-9);
  EXPECT_EQ(evaluation->trajectory->poses, 7);
  EXPECT_EQ(evaluation->surface->frames.size(), 7U);
  EXPECT_EQ(evaluation->survival.frames_read, 8);
  EXPECT_EQ(evaluation->survival.frames_tracked, 7);
  EXPECT_EQ(evaluation->survival.median_track_length, 7);
  EXPECT_TRUE(evaluation->notes.empty());
}

TEST(Evaluate, TellsWhatIsMissingAndGoesOnWithTheRest) {
  const auto depth = Evaluate(MakeRun(8, 1, 1), TruthSequence(8, TruthSequence::Truth::kDepthOnly), {});
  ASSERT_TRUE(depth.ok());
  EXPECT_TRUE(depth->surface && !depth->trajectory);
  EXPECT_THAT(depth->notes, testing::ElementsAre(HasSubstr("no camera error")));
  const auto poses = Evaluate(MakeRun(8, 1, 1), TruthSequence(8, TruthSequence::Truth::kPosesOnly), {});
  ASSERT_TRUE(poses.ok());
  EXPECT_TRUE(!poses->surface && poses->trajectory);
  EXPECT_THAT(EvaluationTable(*poses), HasSubstr("no surface error"));
  const auto none = Evaluate(MakeRun(8, 1, 1), TruthSequence(8, TruthSequence::Truth::kNone), {});
  EXPECT_EQ(none.status().code(), ErrorCode::kNotFound);
}

TEST(Evaluate, RefusesRunsThatDoNotBelongToTheSequence) {
  const auto longer = Evaluate(MakeRun(9, 1, 1), TruthSequence(8), {});
  EXPECT_EQ(longer.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(longer.status().message(), HasSubstr("a frame 8"));
  EvaluationInput shifted = MakeRun(8, 1, 1);
  shifted.frames[5].timestamp_s += 0.04;
  const auto other = Evaluate(shifted, TruthSequence(8), {});
  EXPECT_EQ(other.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(other.status().message(), HasSubstr("frame 5 is at 0.240000 s"));
  const auto untracked = Evaluate(MakeRun(1, 1, 1), TruthSequence(8), {});
  EXPECT_EQ(untracked.status().code(), ErrorCode::kInsufficient);
}

TEST(EvaluationReport, TableJsonAndCsvSayTheSame) {
  const auto evaluation = Evaluate(MakeRun(8, 1, 1), TruthSequence(8), {});
  ASSERT_TRUE(evaluation.ok());
  char rmse[32];
  std::snprintf(rmse, sizeof rmse, "%.3f", evaluation->surface->estimate.mean_rmse_mm);
  EXPECT_THAT(EvaluationTable(*evaluation), HasSubstr(rmse));
  const auto json = nlohmann::json::parse(EvaluationJson(*evaluation));
  EXPECT_EQ(json["surface"]["estimate"]["mean_rmse_mm"], evaluation->surface->estimate.mean_rmse_mm);
  EXPECT_EQ(json["trajectory"]["ate_rmse_mm"], evaluation->trajectory->ate_rmse_mm);
  EXPECT_EQ(json["surface"]["frames"].size(), 7U);

  std::istringstream csv(EvaluationCsv(*evaluation));
  std::string line;
  std::getline(csv, line);
  const auto columns = std::count(line.begin(), line.end(), ',');
  int rows = 0;
  for (; std::getline(csv, line); ++rows) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns) << line;
    if (rows == 0) {
      EXPECT_EQ(line, "0,0,0,,,,,,,,");
    }
    if (rows == 1) {
      EXPECT_THAT(line, HasSubstr(FormatDouble(evaluation->surface->frames[0].estimate.rmse_mm)));
    }
  }
  EXPECT_EQ(rows, 8);
}

TEST(Evaluate, TakesFrameReportsAsTheyAre) {
  EvaluationInput run = MakeRun(8, 1, 1);
  const auto expected = Evaluate(run, TruthSequence(8), {});
  for (EvaluationFrame& frame : run.frames) {
    FrameReport report;
    report.frame_idx = frame.frame_idx;
    report.timestamp_s = frame.timestamp_s;
    report.cam_from_world = frame.cam_from_world;
    report.observations = frame.observations;
    frame = FrameFromReport(report);
  }
  const auto evaluation = Evaluate(run, TruthSequence(8), {});
  ASSERT_TRUE(expected.ok() && evaluation.ok());
  EXPECT_EQ(EvaluationCsv(*evaluation), EvaluationCsv(*expected));
}

TEST(EvaluationReport, JsonTakesARunWhoseNameIsNotUtf8) {
  EvaluationInput run = MakeRun(8, 1, 1);
  run.name = "run_\xff";
  const auto evaluation = Evaluate(run, TruthSequence(8), {});
  ASSERT_TRUE(evaluation.ok());
  EXPECT_THAT(nlohmann::json::parse(EvaluationJson(*evaluation))["run"].get<std::string>(), StartsWith("run_"));
}

TEST(EvaluationOptions, AreSetByName) {
  EvaluationOptions options;
  OptionTable table;
  options.List(table);
  EXPECT_TRUE(table.Set("SurfaceError.scale", "none").ok());
  EXPECT_TRUE(table.Set("TrajectoryError.alignment", "se3").ok());
  EXPECT_EQ(options.surface.scale, SurfaceScale::kNone);
  EXPECT_EQ(options.trajectory.alignment, TrajectoryAlignment::kSe3);
  EXPECT_FALSE(table.Set("SurfaceError.scale", "median").ok());
}

class EvaluationOnDisk : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::temp_directory_path() /
            (std::string("pliant_evaluation_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(root_);
    fs::create_directories(root_ / "run");
  }
  void TearDown() override { fs::remove_all(root_); }

  // What any program may write: trajectory.txt and observations.csv, with all digits.
  void WriteRun(const EvaluationInput& run) const {
    std::ofstream trajectory(root_ / "run" / "trajectory.txt");
    std::ofstream observations(root_ / "run" / "observations.csv");
    observations << "frame,point_id,u_px,v_px,x,y,z,ssim\n";
    for (const EvaluationFrame& frame : run.frames) {
      if (!frame.cam_from_world) continue;
      trajectory << TumLine(frame.timestamp_s, frame.cam_from_world->Inverse());
      for (const PointObservation& o : frame.observations)
        observations << frame.frame_idx << "," << o.id.value << "," << FormatDouble(o.pixel.x()) << ","
                     << FormatDouble(o.pixel.y()) << "," << FormatDouble(o.position.x()) << ","
                     << FormatDouble(o.position.y()) << "," << FormatDouble(o.position.z()) << ",1\n";
    }
  }
  static std::string TumLine(double time_s, const Rigid3& pose) {
    std::string line = FormatDouble(time_s);
    for (const double value : pose.translation) line += " " + FormatDouble(value);
    for (const double value : pose.rotation.coeffs()) line += " " + FormatDouble(value);
    return line + "\n";
  }
  // NumPy's own format, version 1: a magic, the header's length, the header padded to 64 bytes, the data.
  static void WriteNpy(const fs::path& path, const cv::Mat& depth_mm) {
    static_assert(std::endian::native == std::endian::little);
    std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(depth_mm.rows) + ", " +
                         std::to_string(depth_mm.cols) + "), }";
    header.resize((10 + header.size() + 1 + 63) / 64 * 64 - 10 - 1, ' ');
    header += '\n';
    std::ofstream file(path, std::ios::binary);
    file << "\x93NUMPY" << '\x01' << '\0' << static_cast<char>(header.size() & 0xFF)
         << static_cast<char>(header.size() >> 8) << header;
    file.write(reinterpret_cast<const char*>(depth_mm.data),
               static_cast<std::streamsize>(depth_mm.total() * depth_mm.elemSize()));
  }

  fs::path root_;
};

TEST_F(EvaluationOnDisk, ReadsARunFolder) {
  const EvaluationInput run = MakeRun(8, 1, 1);
  WriteRun(run);
  const auto read = ReadEvaluationInput((root_ / "run").string());
  ASSERT_TRUE(read.ok()) << read.status().message();
  ASSERT_EQ(read->frames.size(), 7U);  // without frames.csv only tracked frames are known
  const auto direct = Evaluate(run, TruthSequence(8), {});
  const auto from_disk = Evaluate(*read, TruthSequence(8), {});
  ASSERT_TRUE(direct.ok() && from_disk.ok());
  EXPECT_NEAR(from_disk->surface->estimate.mean_rmse_mm, direct->surface->estimate.mean_rmse_mm, 1e-9);
  EXPECT_EQ(ReadEvaluationInput((root_ / "nothing").string()).status().code(), ErrorCode::kNotFound);
}

TEST_F(EvaluationOnDisk, AgreesWithAnIndependentNumPyScript) {
  std::string python;
  for (const char* candidate : {"python3", "/usr/bin/python3"})
    if (std::system((std::string(candidate) + " -c 'import numpy' >/dev/null 2>&1").c_str()) == 0) python = candidate;
  if (python.empty()) GTEST_SKIP() << "needs python3 with numpy (python3-numpy)";

  constexpr int kFrames = 6;
  const EvaluationInput run = MakeRun(kFrames, 2, 1.5);
  WriteRun(run);
  fs::create_directories(root_ / "depth");
  std::ofstream truth(root_ / "groundtruth.txt");
  const TruthSequence sequence(kFrames);
  for (int idx = 1; idx < kFrames; ++idx) {
    WriteNpy(root_ / "depth" / (std::string("00000") + std::to_string(idx) + ".npy"), **sequence.Depth(idx));
    truth << TumLine(idx / kFps, TruthSequence::Pose(idx));
  }
  truth.close();
  const std::string out = (root_ / "out.txt").string();
  const std::string command = python + " '" PLIANT_TEST_SOURCE_DIR "/reference_evaluation.py' '" +
                              (root_ / "run").string() + "' '" + (root_ / "depth").string() + "' '" +
                              (root_ / "groundtruth.txt").string() + "' 60 60 31.5 23.5 > '" + out + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  double rmse = 0;
  double median = 0;
  double ate = 0;
  ASSERT_TRUE(std::ifstream(out) >> rmse >> median >> ate);

  EvaluationOptions options;
  options.surface.max_depth_step = 10;  // the script refuses nothing
  const auto read = ReadEvaluationInput((root_ / "run").string());
  ASSERT_TRUE(read.ok()) << read.status().message();
  const auto evaluation = Evaluate(*read, sequence, options);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status().message();
  constexpr double kAgreement = 1e-6;  // mm
  EXPECT_NEAR(evaluation->surface->estimate.mean_rmse_mm, rmse, kAgreement);
  EXPECT_NEAR(evaluation->surface->estimate.pooled_median_mm, median, kAgreement);
  EXPECT_NEAR(evaluation->trajectory->ate_rmse_mm, ate, kAgreement);
  EXPECT_GT(rmse, 1.0);
  EXPECT_GT(ate, 0.5);
}

}  // namespace
}  // namespace pliant
