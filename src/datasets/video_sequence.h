// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A video file through OpenCV's FFmpeg back end. Frames go forward only: what `start` and `stride` pass over is
// decoded and dropped, since seeking is not exact in most containers.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/videoio.hpp>

#include "datasets/image_list.h"
#include "datasets/source_calibration.h"
#include "pliant/datasets/sequence.h"

namespace pliant {

class VideoSequence final : public Sequence {
 public:
  // Errors as OpenSequence. Masks are named NNNNNN after the frame's number, or belong by their order.
  static Result<std::unique_ptr<VideoSequence>> Open(const std::filesystem::path& file, SourceCalibration calibration,
                                                     const std::filesystem::path& mask_path, const FrameRange& range);

  const Camera& camera() const override { return calibration_.camera; }
  int size() const override;
  // Where the container promises more frames than can be decoded, fails once with kUnreadable and ends. Containers
  // that only estimate their length are allowed to be off by 1 %, at least one frame.
  Result<std::optional<SequenceFrame>> Next() override;
  Result<std::optional<cv::Mat>> Depth(int /*frame_idx*/) const override { return std::optional<cv::Mat>(); }
  std::optional<Rigid3> WorldFromCamera(int /*frame_idx*/) const override { return std::nullopt; }
  std::optional<double> TimestampS(int frame_idx) const override;
  std::optional<std::string> Name(int frame_idx) const override;

 private:
  VideoSequence(std::filesystem::path file, SourceCalibration calibration, const FrameRange& range)
      : file_(std::move(file)), calibration_(std::move(calibration)), range_(range) {}

  Status OpenCapture();
  Status Truncated() const;
  Result<std::optional<SequenceFrame>> Decode();

  std::filesystem::path file_;
  SourceCalibration calibration_;
  FrameRange range_;
  cv::VideoCapture capture_;
  std::optional<CompanionImages> masks_;
  int container_count_ = 0;  // frames as the container says; 0: it does not
  double fps_ = 0;
  int read_count_ = 0;  // frames taken from the decoder
  int next_idx_ = 0;    // the frame that Next shall give
  bool ended_ = false;
};

}  // namespace pliant
