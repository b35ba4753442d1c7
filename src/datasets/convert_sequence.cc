// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/convert_sequence.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include "pliant/datasets/native_layout.h"
#include "pliant/datasets/native_writer.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// Depth is written in the finest step of 1, 2, 5, 10, ... in which so many times the largest depth of frames from all
// over the sequence fits.
constexpr double kDepthHeadroom = 2.0;
constexpr int kDepthsLookedAt = 50;

// Of `count` frames, every `stride`-th from the first one on.
double DepthScaleFor(const Sequence& sequence, int first_frame_idx, int stride, int count) {
  double largest_mm = 0;
  for (int k = 0; k < kDepthsLookedAt; ++k) {
    const int frame_idx = first_frame_idx + stride * ((count - 1) * k / (kDepthsLookedAt - 1));
    const auto depth_mm = sequence.Depth(frame_idx);
    if (!depth_mm.ok() || !depth_mm->has_value()) continue;
    double largest_of_frame_mm = 0;
    cv::minMaxLoc(**depth_mm, nullptr, &largest_of_frame_mm);
    if (std::isfinite(largest_of_frame_mm)) largest_mm = std::max(largest_mm, largest_of_frame_mm);
  }
  if (!(largest_mm > 0)) return 1.0;
  const double least = kDepthHeadroom * largest_mm / native::kMaxDepthSteps;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double step : {1.0, 2.0, 5.0})
    if (least <= step * power) return step * power;
  return 10.0 * power;
}

// The frame that Next gave, with all that belongs to it.
Result<NativeFrame> Gather(Sequence& sequence, SequenceFrame frame) {
  NativeFrame gathered{
      .timestamp_s = frame.timestamp_s, .image = std::move(frame.image), .mask = std::move(frame.mask)};
  auto right = sequence.Right();
  if (!right.ok()) return right.status();
  gathered.right = std::move(*right).value_or(cv::Mat());
  auto depth_mm = sequence.Depth(frame.frame_idx);
  if (!depth_mm.ok()) return depth_mm.status();
  gathered.depth_mm = std::move(*depth_mm).value_or(cv::Mat());
  gathered.world_from_cam = sequence.WorldFromCamera(frame.frame_idx);
  return gathered;
}

Result<NativeWriter> MakeWriter(const Sequence& sequence, int first_frame_idx, int stride, const fs::path& folder) {
  CameraFile camera{.camera = sequence.camera()};
  camera.baseline_mm = sequence.BaselineMm();
  camera.photometric = sequence.Photometric();
  camera.depth_scale = DepthScaleFor(sequence, first_frame_idx, stride, std::max(1, sequence.size()));
  return NativeWriter::Create(folder, camera);
}

}  // namespace

Result<ConvertSummary> ConvertSequence(Sequence& sequence, const fs::path& folder, const ConvertProgress& progress,
                                       int stride) {
  std::error_code error;
  if (fs::exists(folder, error) && !(fs::is_directory(folder, error) && fs::is_empty(folder, error)))
    return Status(ErrorCode::kInvalidArgument,
                  folder.string() + " is there and is not an empty folder; give a new one");
  ConvertSummary summary;
  std::optional<NativeWriter> writer;
  for (;;) {
    auto next = sequence.Next();
    if (!next.ok()) return next.status();
    if (!next->has_value()) break;
    const int frame_idx = (*next)->frame_idx;
    auto frame = Gather(sequence, **std::move(next));
    if (!frame.ok()) return frame.status();
    if (!writer) {
      auto made = MakeWriter(sequence, frame_idx, stride, folder);
      if (!made.ok()) return made.status();
      writer = *std::move(made);
    }
    if (Status status = writer->Write(*frame); !status.ok()) return status;
    summary.clipped_depths += writer->OutOfRange(frame->depth_mm);
    ++summary.frames;
    summary.poses += frame->world_from_cam ? 1 : 0;
    summary.right += frame->right.empty() ? 0 : 1;
    summary.masks += frame->mask.empty() ? 0 : 1;
    summary.depths += frame->depth_mm.empty() ? 0 : 1;
    if (progress && !progress(summary.frames))
      return Status(ErrorCode::kInterrupted,
                    "stopped after " + std::to_string(summary.frames) + " frames; they are in " + folder.string());
  }
  return summary;
}

}  // namespace pliant
