// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Miniatures of other people's data sets, written from a rendered scene in their exact layout, units and handedness,
// and read back.
#pragma once

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "datasets/sequence_files.h"
#include "pliant/datasets/check_sequence.h"
#include "pliant/datasets/open_sequence.h"
#include "support/rendered_sequence.h"

namespace pliant::data_set_files {

inline constexpr double kTextNumber = 1e-6;   // calibrations are written with six decimals
inline constexpr double kTimestamp_s = 1e-4;  // data sets name times with four decimals and more
inline constexpr double kPose_mm = 1e-3;      // meters with six digits, in the coarsest of the sets
inline constexpr double kPose_rad = 1e-5;     // matrices and quaternions of the same
inline constexpr double kAtEdges = 0.02;      // of the pixels lie on edges of depth, where a resampled image differs

inline const SimulatedFrame& Frame(int k) { return Rendered().frames[static_cast<std::size_t>(k)]; }
inline const Rigid3& Pose(int k) { return Rendered().world_from_cam[static_cast<std::size_t>(k)]; }
inline int Frames() { return static_cast<int>(Rendered().frames.size()); }

inline std::string Numbered(const char* format, int k) {
  char text[64];
  std::snprintf(text, sizeof text, format, k);
  return text;
}

template <class... Values>
std::string Line(const char* separator, const Values&... values) {
  std::ostringstream line;
  line.precision(12);
  const char* between = "";
  ((line << between << values, between = separator), ...);
  line << "\n";
  return line.str();
}

// What Unity says of a pose: y turned round, of the world and of the camera.
inline Rigid3 InUnity(const Rigid3& pose) {
  const Eigen::Vector3d turn(1, -1, 1);
  return {Eigen::Matrix3d(turn.asDiagonal() * pose.RotationMatrix() * turn.asDiagonal()),
          turn.cwiseProduct(pose.translation)};
}

inline cv::Mat Steps(const cv::Mat& depth_mm, double step_mm) {
  cv::Mat steps;
  depth_mm.convertTo(steps, CV_16U, 1.0 / step_mm);  // saturates
  steps.setTo(0, steps == 65535);
  return steps;
}

struct Expected {
  std::string kind;
  bool poses = true;
  bool pairs = false;
  double depth_mm = -1;      // largest error but for edges; -1: there is no depth
  double gray_levels = 1.0;  // mean difference of the images
};

class DataSets : public SequenceFiles {
 protected:
  void SceneCamera(const std::string& name) const {
    const Camera& camera = Rendered().camera;
    std::string params;
    for (const double value : camera.params()) params += (params.empty() ? "" : ", ") + std::to_string(value);
    Text(name, "model: PINHOLE\nwidth: " + std::to_string(camera.width()) +
                   "\nheight: " + std::to_string(camera.height()) + "\nparams: [" + params + "]\nfps: 30\n");
  }

  void Stereo(const std::string& name, double baseline) const {
    const auto& p = Rendered().camera.params();
    std::ostringstream matrix;
    matrix << "[" << p[0] << ", 0, " << p[2] << ", 0, " << p[1] << ", " << p[3] << ", 0, 0, 1]";
    Text(name, "M1: " + matrix.str() + "\nD1: [0, 0, 0, 0]\nM2: " + matrix.str() +
                   "\nD2: [0, 0, 0, 0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [" + std::to_string(-baseline) +
                   ", 0, 0]\n");
  }

  // Left on top of right.
  void WriteStackedVideo(const std::string& name) const {
    std::filesystem::create_directories(Path(name).parent_path());
    cv::VideoWriter writer(Path(name).string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 30,
                           {Rendered().camera.width(), 2 * Rendered().camera.height()});
    ASSERT_TRUE(writer.isOpened());
    for (int k = 0; k < Frames(); ++k) {
      cv::Mat pair;
      cv::vconcat(Frame(k).image, Frame(k).right, pair);
      writer.write(pair);
    }
  }

  void ExpectTheScene(const std::filesystem::path& path, const Expected& expected) const {
    const auto kind = RecognizeDataSet(path);
    ASSERT_TRUE(kind.ok()) << kind.status().message();
    EXPECT_EQ(kind->name, expected.kind);
    auto opened = OpenSequence({.image_path = path});
    ASSERT_TRUE(opened.ok()) << opened.status().message();
    Sequence& sequence = **opened;
    EXPECT_THAT(sequence.Warnings(), testing::IsEmpty());
    EXPECT_EQ(sequence.size(), Frames());
    EXPECT_EQ(sequence.BaselineMm().has_value(), expected.pairs);
    if (expected.pairs) {
      EXPECT_NEAR(*sequence.BaselineMm(), Rendered().baseline_mm, kTextNumber);
    }
    for (int k = 0; k < Frames(); ++k) {
      const auto frame = sequence.Next();
      ASSERT_TRUE(frame.ok() && frame->has_value()) << frame.status().message();
      const cv::Rect inside(4, 4, sequence.camera().width() - 8, sequence.camera().height() - 8);
      EXPECT_LT(cv::norm((*frame)->image(inside), Frame(k).image(inside), cv::NORM_L1) / inside.area() / 3,
                expected.gray_levels);
      EXPECT_NEAR((*frame)->timestamp_s - *sequence.TimestampS(0), k / 30.0, kTimestamp_s);
      const auto depth = sequence.Depth(k);
      ASSERT_TRUE(depth.ok()) << depth.status().message();
      ASSERT_EQ(depth->has_value(), expected.depth_mm >= 0);
      if (depth->has_value()) {
        const cv::Mat has = **depth > 0;
        EXPECT_GT(cv::countNonZero(has), static_cast<int>(has.total()) / 4);
        cv::Mat difference;
        cv::absdiff(**depth, Frame(k).depth, difference);
        // Where a rectified pixel lies half a pixel off, so does the edge of what is in front.
        EXPECT_LT(cv::countNonZero(has & (difference > expected.depth_mm)), kAtEdges * cv::countNonZero(has));
      }
      const auto pose = sequence.WorldFromCamera(k);
      ASSERT_EQ(pose.has_value(), expected.poses);
      if (!pose) continue;
      const Rigid3 step = sequence.WorldFromCamera(0)->Inverse() * *pose;
      const Rigid3 error = step.Inverse() * (Pose(0).Inverse() * Pose(k));
      EXPECT_LT(error.translation.norm(), kPose_mm);
      EXPECT_LT(RotationAngle(error.rotation), kPose_rad);
    }
    auto again = OpenSequence({.image_path = path});
    ASSERT_TRUE(again.ok());
    const auto check = CheckSequence(**again);
    ASSERT_TRUE(check.ok()) << check.status().message();
    EXPECT_THAT(check->wrong, testing::IsEmpty());
    if (expected.poses && expected.depth_mm >= 0) {
      EXPECT_EQ(check->poses->right, true);
    }
  }
};

}  // namespace pliant::data_set_files
