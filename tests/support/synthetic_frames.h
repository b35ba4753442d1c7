// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A synthetic scene as a tracker would hand it to an initializer.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pliant/camera/camera.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "support/synthetic_scene.h"

namespace pliant::test {

// The pinhole of RaysOf.
inline Camera SceneCamera(const SceneOptions& options) {
  const std::array params = {options.focal_px, 0.5 * (options.width - 1), 0.5 * (options.height - 1)};
  return Camera::Create(CameraModelId::kSimplePinhole, options.width, options.height, params).value();
}

// Frames numbered from `first_idx`; a point's id is its index in the scene. One that leaves the image, or comes to lie
// behind the camera, is lost from then on.
inline std::vector<InitFrame> FramesOf(const Scene& scene, const SceneOptions& options, int first_idx) {
  const Camera camera = SceneCamera(options);
  std::vector<char> alive(scene.points.size(), 1);
  std::vector<InitFrame> frames;
  for (std::size_t k = 0; k < scene.pixels.size(); ++k) {
    InitFrame& frame = frames.emplace_back();
    frame.frame_idx = first_idx + static_cast<int>(k);
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      if (!camera.Contains(scene.pixels[k][i])) alive[i] = 0;
      if (alive[i] == 0) continue;
      frame.observations.push_back({.id = PointId{static_cast<std::int64_t>(i)},
                                    .pixel = scene.pixels[k][i],
                                    .brightness = scene.brightness[k][i]});
    }
  }
  return frames;
}

}  // namespace pliant::test
