// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/video_sequence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "datasets/image_file.h"

namespace pliant {
namespace {

// Containers without an index estimate their number of frames from duration and rate.
constexpr double kCountSlack = 0.01;  // of the count, and at least one frame

std::string FrameName(int frame_idx) {
  char name[32];
  std::snprintf(name, sizeof name, "%06d.png", frame_idx);
  return name;
}

}  // namespace

Result<std::unique_ptr<VideoSequence>> VideoSequence::Open(const std::filesystem::path& file,
                                                           SourceCalibration calibration,
                                                           const std::filesystem::path& mask_path,
                                                           const FrameRange& range) {
  std::unique_ptr<VideoSequence> sequence(new VideoSequence(file, std::move(calibration), range));
  if (Status status = sequence->OpenCapture(); !status.ok()) return status;
  if (sequence->container_count_ > 0) {
    const Result<FrameRange> bounded = range.Within(sequence->container_count_, file);
    if (!bounded.ok()) return bounded.status();
  }
  sequence->next_idx_ = range.start;
  if (!mask_path.empty()) {
    std::vector<std::string> stems;
    for (int idx = 0; idx < std::max(sequence->container_count_, 1); ++idx)
      stems.push_back(std::filesystem::path(FrameName(idx)).stem().string());
    Result<CompanionImages> masks =
        CompanionImages::Open("mask", mask_path, stems, CompanionImages::Counts::kMayDiffer);
    if (!masks.ok()) return masks.status();
    sequence->masks_ = *std::move(masks);
  }
  return sequence;
}

Status VideoSequence::OpenCapture() {
  try {
    capture_.open(file_.string(), cv::CAP_FFMPEG);
  } catch (const cv::Exception&) {
    capture_.release();
  }
  if (!capture_.isOpened())
    return {ErrorCode::kUnreadable, "cannot open " + file_.string() +
                                        " as a video: it is damaged, cut off before its index, or not a video; convert "
                                        "it to a folder of images, or copy it anew"};
  const double count = capture_.get(cv::CAP_PROP_FRAME_COUNT);
  container_count_ = count > 0 && count < 1e9 ? static_cast<int>(std::lround(count)) : 0;
  fps_ = capture_.get(cv::CAP_PROP_FPS);
  if (!(std::isfinite(fps_) && fps_ > 0)) fps_ = calibration_.fps;

  const int width = static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH));
  const int height = static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT));
  const Camera& camera = calibration_.camera;
  if (width != camera.width() || height != camera.height())
    return {ErrorCode::kMismatch, "the calibration " + calibration_.path.string() + " is for images of " +
                                      SizeText(camera.width(), camera.height()) + ", but the video " + file_.string() +
                                      " is " + SizeText(width, height) + "; give the calibration of this video"};
  return Status::Ok();
}

int VideoSequence::size() const {
  FrameRange range = range_;
  if (container_count_ > 0) range.end = range.end == -1 ? container_count_ : std::min(range.end, container_count_);
  return range.Count();
}

std::optional<double> VideoSequence::TimestampS(int frame_idx) const {
  if (frame_idx < 0 || (container_count_ > 0 && frame_idx >= container_count_)) return std::nullopt;
  return frame_idx / fps_;
}

std::optional<std::string> VideoSequence::Name(int frame_idx) const {
  return TimestampS(frame_idx) ? std::optional(FrameName(frame_idx)) : std::nullopt;
}

Status VideoSequence::Truncated() const {
  return {ErrorCode::kUnreadable, "the video " + file_.string() + " breaks off: frame " + std::to_string(read_count_) +
                                      " of " + std::to_string(container_count_) +
                                      " cannot be decoded; copy it anew, or set end to " + std::to_string(read_count_)};
}

Result<std::optional<SequenceFrame>> VideoSequence::Next() {
  if (ended_ || (range_.end != -1 && next_idx_ >= range_.end)) return std::optional<SequenceFrame>();
  while (read_count_ <= next_idx_) {
    if (!capture_.grab()) {
      ended_ = true;
      const int slack = std::max(1, static_cast<int>(kCountSlack * container_count_));
      if (container_count_ - read_count_ > slack) return Truncated();
      return std::optional<SequenceFrame>();
    }
    ++read_count_;
  }
  return Decode();
}

// The frame that was grabbed last, number next_idx_.
Result<std::optional<SequenceFrame>> VideoSequence::Decode() {
  SequenceFrame frame;
  frame.frame_idx = std::exchange(next_idx_, next_idx_ + range_.stride);
  frame.name = FrameName(frame.frame_idx);
  frame.timestamp_s = frame.frame_idx / fps_;
  cv::Mat decoded;
  if (!capture_.retrieve(decoded) || decoded.empty() || decoded.depth() != CV_8U)
    return Status(ErrorCode::kUnreadable, "frame " + std::to_string(frame.frame_idx) + " of the video " +
                                              file_.string() + " cannot be decoded; copy it anew");
  const Camera& camera = calibration_.camera;
  if (decoded.cols != camera.width() || decoded.rows != camera.height())
    return Status(ErrorCode::kMismatch, "frame " + std::to_string(frame.frame_idx) + " of the video " + file_.string() +
                                            " is " + SizeText(decoded) + ", but the frames before are " +
                                            SizeText(camera.width(), camera.height()) +
                                            "; the size may not change within a sequence");
  frame.image = decoded.clone();  // the decoder reuses its own memory
  if (masks_) {
    Result<cv::Mat> mask = ReadFrameMask(*masks_, frame.frame_idx, frame.name, camera.width(), camera.height());
    if (!mask.ok()) return mask.status();
    frame.mask = *std::move(mask);
  }
  return std::optional<SequenceFrame>(std::move(frame));
}

}  // namespace pliant
