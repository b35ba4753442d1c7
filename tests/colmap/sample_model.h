// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A small valid model with everything in it that the formats can hold.
#pragma once

#include <cmath>

#include "pliant/colmap/model.h"

namespace pliant::colmap {

// Two cameras; image 1 and 4 see points 7 and 9, keypoint 1 of image 4 sees none, image 2 has no keypoints.
inline Model SampleModel() {
  Model model;
  model.cameras = {{1, 1, 640, 480, {525.5, 525.25, 320, 240}},
                   {3, 5, 320, 240, {160, 161, 160.5, 120.1, 0.1, 0, 0, 1e-4}}};
  const double half = std::sqrt(0.5);
  model.images = {
      {1, {{1, 0, 0, 0}, {0, 0, 1. / 3}}, 1, "a/000001.png", {{10.25, 20.5, 7}, {100, 200.125, 9}}},
      {4, {{half, 0, half, 0}, {-1e-7, 0.1, 2}}, 3, "000004.png", {{33, 44, 9}, {0.5, 0.5, kNoPoint3D}, {55, 66, 7}}},
      {2, {{0.5, 0.5, 0.5, 0.5}, {0, 0, 0}}, 1, "000002.png", {}}};
  model.points3D = {{9, {0.1, 0.2, 3}, {255, 0, 128}, 0.5, {{1, 1}, {4, 0}}},
                    {7, {-1, 2, 1e3}, {1, 2, 3}, -1, {{1, 0}, {4, 2}}}};
  return model;
}

inline Model SampleModelWithRigs() {
  Model model = SampleModel();
  model.rigs = {{1,
                 Sensor{SensorType::kCamera, 1},
                 {{{SensorType::kCamera, 3}, Pose{{1, 0, 0, 0}, {0.1, 0, 0}}}, {{SensorType::kImu, 1}, std::nullopt}}}};
  model.frames = {
      {1, 1, {{1, 0, 0, 0}, {0, 0, 1. / 3}}, {{{SensorType::kCamera, 1}, 1}, {{SensorType::kCamera, 3}, 4}}},
      {2, 1, {{0.5, 0.5, 0.5, 0.5}, {0, 0, 0}}, {{{SensorType::kCamera, 1}, 2}}}};
  return model;
}

}  // namespace pliant::colmap
