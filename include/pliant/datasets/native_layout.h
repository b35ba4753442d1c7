// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the files of a native sequence are called (docs/formats.md).
#pragma once

#include <cstdio>
#include <string>

namespace pliant::native {

inline constexpr const char* kCameraFile = "camera.yaml";
inline constexpr const char* kPosesFile = "groundtruth.txt";
inline constexpr const char* kTimesFile = "times.txt";
inline constexpr const char* kSfmPointsFile = "sfm_points.csv";
inline constexpr const char* kImageFolder = "images";
inline constexpr const char* kRightFolder = "right";
inline constexpr const char* kDepthFolder = "depth";
inline constexpr const char* kMaskFolder = "masks";

inline constexpr double kMaxDepthSteps = 65535.0;  // of a 16-bit depth image; 0 is none

inline std::string FrameFileName(int frame_idx) {
  char name[32];
  std::snprintf(name, sizeof(name), "%06d.png", frame_idx);
  return name;
}

}  // namespace pliant::native
