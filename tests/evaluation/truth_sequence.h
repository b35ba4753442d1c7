// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A wavy wall that moves, seen by a camera that moves: truth without images, and runs on it.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/pair_with_depth.h"
#include "pliant/base/random.h"
#include "pliant/evaluation/evaluation.h"
#include "pliant/evaluation/material_truth.h"
#include "pliant/evaluation/surface_error.h"

namespace pliant {

inline constexpr double kFps = 25;
inline const Result<MaterialTruth*> kNoMaterial = Status(ErrorCode::kNotFound, "there is no simulation.yaml");

inline Camera TestCamera() {
  constexpr std::array<double, 4> kParams = {60, 60, 31.5, 23.5};
  return *Camera::Create(CameraModelId::kPinhole, 64, 48, kParams);
}

class TruthSequence final : public Sequence {
 public:
  enum class Truth { kAll, kDepthOnly, kPosesOnly, kNone };
  explicit TruthSequence(int count, Truth truth = Truth::kAll, Camera camera = TestCamera())
      : camera_(std::move(camera)), count_(count), truth_(truth) {}

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
  Camera camera_;
  int count_;
  Truth truth_;
};

// Material of the wall: a point is a pixel of its first frame, and moves in the image by (0.5, 0.25) px a frame; so
// truth and depth are one surface.
class WallMaterial final : public MaterialTruth {
 public:
  explicit WallMaterial(const TruthSequence& sequence) : sequence_(sequence) {}

  static Eigen::Vector2d PixelIn(int frame_idx, int first_frame_idx, const Eigen::Vector2d& first) {
    return first + (frame_idx - first_frame_idx) * Eigen::Vector2d(0.5, 0.25);
  }
  Eigen::Vector3d PointIn(int frame_idx, const Eigen::Vector2d& pixel) const {
    const std::vector<Eigen::Vector3d> any = {Eigen::Vector3d::UnitZ()};
    const PairedFrame pair =
        PairWithDepth(frame_idx, any, std::vector{pixel}, sequence_.camera(), **sequence_.Depth(frame_idx), 10);
    return pair.pairs.empty() ? Eigen::Vector3d(1, 1, 50) : pair.pairs[0].truth;  // outside: somewhere
  }

  Result<std::vector<std::optional<MaterialId>>> PointsAt(int frame_idx,
                                                          std::span<const Eigen::Vector2d> pixels) override {
    std::vector<std::optional<MaterialId>> ids;
    for (const Eigen::Vector2d& pixel : pixels) {
      ids.emplace_back(MaterialId{static_cast<std::int64_t>(starts_.size())});
      starts_.emplace_back(frame_idx, pixel);
    }
    return ids;
  }
  Result<std::vector<std::optional<MaterialState>>> Observe(int frame_idx,
                                                            std::span<const MaterialId> points) override {
    std::vector<std::optional<MaterialState>> states;
    for (const MaterialId id : points) {
      const auto& [first_frame_idx, first] = starts_[static_cast<std::size_t>(id.value)];
      const Eigen::Vector2d pixel = PixelIn(frame_idx, first_frame_idx, first);
      const auto visibility =
          sequence_.camera().Contains(pixel) ? MaterialVisibility::kVisible : MaterialVisibility::kOutsideImage;
      states.emplace_back(MaterialState{PointIn(frame_idx, pixel), pixel, visibility});
    }
    return states;
  }

 private:
  const TruthSequence& sequence_;
  std::vector<std::pair<int, Eigen::Vector2d>> starts_;
};

// The first map of MakeRun's runs, which are longer than this.
inline constexpr FirstMapFrames kFirstMap = {1, 4};

// A run on TruthSequence: frame 0 is not tracked, the others are. Map units are mm / scale; noise in mm. Every point is
// at another pixel of the wall in every frame, as if it slid. The initializer takes one millisecond a frame more than
// in the frame before, from one in frame 0 on.
inline EvaluationInput MakeRun(int count, double scale, double noise_mm) {
  const TruthSequence truth(count);
  const Random seed(17);
  EvaluationInput run;
  run.name = "RUN";
  for (int idx = 0; idx < count; ++idx) {
    EvaluationFrame& frame = run.frames.emplace_back();
    frame.frame_idx = idx;
    frame.timestamp_s = idx / kFps;
    frame.initialize_ms = idx <= kFirstMap.declared_frame_idx ? idx + 1 : 0;
    if (idx == 0) continue;
    if (idx <= kFirstMap.declared_frame_idx) frame.first_map = kFirstMap;
    Random random = seed.Child(std::to_string(idx));
    const auto noise = [&random, noise_mm] {
      return Eigen::Vector3d(random.Normal(noise_mm), random.Normal(noise_mm), random.Normal(noise_mm));
    };
    std::vector<Eigen::Vector2d> pixels;
    for (int i = 0; i < 40; ++i) pixels.emplace_back(random.Uniform(0, 63), random.Uniform(0, 47));
    const std::vector<Eigen::Vector3d> any(pixels.size(), Eigen::Vector3d::UnitZ());
    const PairedFrame surface = PairWithDepth(idx, any, pixels, truth.camera(), **truth.Depth(idx), 10);
    const Rigid3 pose(TruthSequence::Pose(idx).rotation, (TruthSequence::Pose(idx).translation + noise()) / scale);
    frame.cam_from_world = pose.Inverse();
    for (int i = 0; i < 40; ++i)
      frame.observations.push_back({PointId{i}, pixels[static_cast<std::size_t>(i)],
                                    pose * ((surface.pairs[static_cast<std::size_t>(i)].truth + noise()) / scale), 1});
  }
  return run;
}

}  // namespace pliant
