// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/surface_truth.h"

#include <algorithm>
#include <utility>

#include "pliant/photometric/stereo_matching.h"

namespace pliant {
namespace {

class OfDepthImages final : public SurfaceTruth {
 public:
  OfDepthImages(const Sequence& sequence, double max_depth_step)
      : sequence_(sequence), max_depth_step_(max_depth_step) {}

  Result<std::optional<std::vector<DepthAtPixel>>> At(int frame_idx, std::span<const Eigen::Vector2d> pixels) override {
    const Result<std::optional<cv::Mat>> depth_mm = sequence_.Depth(frame_idx);
    if (!depth_mm.ok()) return depth_mm.status();
    if (!depth_mm->has_value()) return std::optional<std::vector<DepthAtPixel>>();
    std::vector<DepthAtPixel> depths;
    for (const Eigen::Vector2d& pixel : pixels) depths.push_back(LookUpDepth(**depth_mm, pixel, max_depth_step_));
    return std::optional(std::move(depths));
  }

  bool IsOfPairs() const override { return false; }

 private:
  const Sequence& sequence_;
  double max_depth_step_;
};

class OfPairs final : public SurfaceTruth {
 public:
  OfPairs(std::unique_ptr<Sequence> sequence, int threads) : sequence_(std::move(sequence)), threads_(threads) {}

  Result<std::optional<std::vector<DepthAtPixel>>> At(int frame_idx, std::span<const Eigen::Vector2d> pixels) override {
    std::optional<std::vector<DepthAtPixel>> depths;
    auto left = ReadTo(frame_idx);
    if (!left.ok()) return left.status();
    if (!left->has_value()) return depths;
    const auto right = sequence_->Right();
    if (!right.ok()) return right.status();
    if (right->has_value())
      depths = DepthsOfPair(sequence_->camera(), *sequence_->BaselineMm(), (*left)->image, (*left)->mask, **right,
                            pixels, threads_);
    return depths;
  }

  bool IsOfPairs() const override { return true; }

 private:
  // Nothing where the sequence does not have the frame, or it lies behind.
  Result<std::optional<SequenceFrame>> ReadTo(int frame_idx) {
    while (last_idx_ < frame_idx) {
      auto frame = sequence_->Next();
      if (!frame.ok()) return frame.status();
      if (!frame->has_value()) break;
      last_idx_ = (*frame)->frame_idx;
      if (last_idx_ == frame_idx) return frame;
    }
    return std::optional<SequenceFrame>();
  }

  std::unique_ptr<Sequence> sequence_;
  int threads_;
  int last_idx_ = -1;
};

bool HasDepth(const EvaluationInput& run, const Sequence& sequence) {
  return std::any_of(run.frames.begin(), run.frames.end(), [&](const EvaluationFrame& frame) {
    const auto depth = sequence.Depth(frame.frame_idx);
    return !depth.ok() || depth->has_value();  // what is wrong with it is told when it is used
  });
}

}  // namespace

std::unique_ptr<SurfaceTruth> SurfaceTruthFromDepthImages(const Sequence& sequence, double max_depth_step) {
  return std::make_unique<OfDepthImages>(sequence, max_depth_step);
}

std::unique_ptr<SurfaceTruth> PairTruth(std::unique_ptr<Sequence> sequence, int threads) {
  return std::make_unique<OfPairs>(std::move(sequence), threads);
}

Result<std::unique_ptr<SurfaceTruth>> OpenSurfaceTruth(SurfaceSource source, const EvaluationInput& run,
                                                       const Sequence& sequence, const SequenceRequest& request,
                                                       double max_depth_step) {
  constexpr int kThreads = 2;
  const Status pairs =
      CheckPairs("the true surface from " + request.image_path.string(), sequence.camera(), sequence.BaselineMm());
  if (source == SurfaceSource::kPairs && !pairs.ok()) return pairs;
  if (source == SurfaceSource::kDepth || !pairs.ok() || (source == SurfaceSource::kAny && HasDepth(run, sequence)))
    return SurfaceTruthFromDepthImages(sequence, max_depth_step);
  SequenceRequest of_run = request;
  if (!run.frames.empty()) of_run.start = run.frames.front().frame_idx;
  auto opened = OpenSequence(of_run);
  if (!opened.ok()) return opened.status();
  return PairTruth(*std::move(opened), kThreads);
}

}  // namespace pliant
