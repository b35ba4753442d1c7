// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A small rendered scene in memory: images, right images, depth and poses, any of which a test may spoil.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/datasets/sequence.h"
#include "pliant/simulation/simulator.h"

namespace pliant {

struct RenderedScene {
  Camera camera;
  double baseline_mm = 0;
  std::vector<SimulatedFrame> frames;
  std::vector<Rigid3> world_from_cam;
};

// Rendered once for all tests: a pair of cameras that sways and advances before a surface that deforms.
inline const RenderedScene& Rendered() {
  static const RenderedScene kScene = [] {
    SimulationOptions options;
    options.scene.kind = SceneKind::kLobes;
    options.camera.width = 320;
    options.camera.height = 240;
    options.camera.params = "230,230,159.5,119.5";
    options.camera.baseline_mm = 5;
    options.sensor.samples = 1;
    options.texture.texel_mm = 0.2;
    options.trajectory.kind = TrajectoryKind::kLoop;
    options.trajectory.frames = 20;
    options.deformation.amplitude_mm = 1;
    auto simulator = Simulator::Create(options);
    EXPECT_TRUE(simulator.ok()) << simulator.status().message();
    RenderedScene scene{simulator->camera(), options.camera.baseline_mm, {}, {}};
    for (int k = 0; k < options.trajectory.frames; ++k) {
      scene.frames.push_back(simulator->Render(k));
      scene.world_from_cam.push_back(simulator->WorldFromCamera(k));
    }
    return scene;
  }();
  return kScene;
}

class RenderedSequence final : public Sequence {
 public:
  const Camera& camera() const override { return Rendered().camera; }
  int size() const override { return static_cast<int>(Rendered().frames.size()); }
  Result<std::optional<SequenceFrame>> Next() override {
    if (next_ >= size()) return std::optional<SequenceFrame>();
    const cv::Mat& image = swapped ? Frame(next_).right : Frame(next_).image;
    SequenceFrame frame{.frame_idx = next_, .name = "", .timestamp_s = next_ / 30.0, .image = image, .mask = {}};
    ++next_;
    return std::optional<SequenceFrame>(std::move(frame));
  }
  std::optional<double> BaselineMm() const override {
    return mono ? std::nullopt : std::optional(Rendered().baseline_mm);
  }
  Result<std::optional<cv::Mat>> Right() override {
    if (mono) return std::optional<cv::Mat>();
    return std::optional<cv::Mat>(right(swapped ? Frame(next_ - 1).image : Frame(next_ - 1).right));
  }
  Result<std::optional<cv::Mat>> Depth(int idx) const override {
    return std::optional<cv::Mat>(cv::Mat(depth_unit * Frame(idx).depth));
  }
  std::optional<Rigid3> WorldFromCamera(int idx) const override {
    return pose(Rendered().world_from_cam[static_cast<std::size_t>(idx)]);
  }

  bool mono = true;
  bool swapped = false;
  double depth_unit = 1.0;
  std::function<Rigid3(const Rigid3&)> pose = [](const Rigid3& truth) { return truth; };
  std::function<cv::Mat(const cv::Mat&)> right = [](const cv::Mat& truth) { return truth; };

 private:
  static const SimulatedFrame& Frame(int idx) { return Rendered().frames[static_cast<std::size_t>(idx)]; }

  int next_ = 0;
};

}  // namespace pliant
