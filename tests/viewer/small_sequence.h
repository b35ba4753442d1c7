// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The images of support/small_run.h's run, and its truth: a plane before cameras in a world of its own.
#pragma once

#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pliant/datasets/native_writer.h"
#include "pliant/geometry/sim3.h"
#include "support/small_run.h"

namespace pliant {

inline constexpr int kSequenceFrames = 19;
inline constexpr double kPlaneDepth_mm = 101;
// mm and truth from the run's world.
inline const Sim3 kTruthFromRun = {
    2.0, Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY())), {5, 6, 7}};

enum class Truth { kNone, kDepthAndPoses };

// Brightness of frame k, beside that of frame 0.
inline double GainOf(int frame_idx) { return 1 - 0.02 * (frame_idx - 10); }

inline void WriteSmallSequence(const std::string& folder, Truth truth, int frames = kSequenceFrames) {
  auto writer = NativeWriter::Create(folder, {.camera = TestCamera(), .fps = 50});
  ASSERT_TRUE(writer.ok()) << writer.status().message();
  cv::Mat noise(480, 640, CV_8UC1);
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 60, 180);
  cv::GaussianBlur(noise, noise, {}, 2);
  for (int k = 0; k < frames; ++k) {
    NativeFrame frame{.timestamp_s = (k - 10) / 50.0};
    noise.convertTo(frame.image, CV_8U, GainOf(k), 5);
    if (truth == Truth::kDepthAndPoses) {
      frame.depth_mm = cv::Mat(480, 640, CV_32FC1, cv::Scalar(kPlaneDepth_mm));
      frame.world_from_cam = PoseInWorld(kTruthFromRun, PoseAt(0)).Inverse();
      if (k >= 10 && k < kSequenceFrames && k % 2 == 0)
        frame.world_from_cam = PoseInWorld(kTruthFromRun, PoseAt((k - 10) / 2)).Inverse();
    }
    ASSERT_TRUE(writer->Write(frame).ok());
  }
}

}  // namespace pliant
