// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/image_folder.h"

#include <cassert>
#include <utility>

#include "datasets/image_file.h"

namespace pliant {

Result<std::unique_ptr<ImageFolder>> ImageFolder::Open(const std::filesystem::path& folder,
                                                       SourceCalibration calibration,
                                                       const std::filesystem::path& mask_path,
                                                       const FrameRange& range) {
  Result<std::vector<std::filesystem::path>> files = ListImages(folder);
  if (!files.ok()) return files.status();
  const Result<FrameRange> bounded = range.Within(static_cast<int>(files->size()), folder);
  if (!bounded.ok()) return bounded.status();
  std::unique_ptr<ImageFolder> sequence(new ImageFolder(std::move(calibration), *std::move(files), *bounded));
  if (Status status = sequence->CheckFirstImage(); !status.ok()) return status;

  if (!mask_path.empty()) {
    Result<CompanionImages> masks =
        CompanionImages::Open("mask", mask_path, sequence->Stems(), CompanionImages::Counts::kMustAgree);
    if (!masks.ok()) return masks.status();
    for (int idx = bounded->start; idx < bounded->end; idx += bounded->stride) {
      const auto found = masks->Require(idx, sequence->files_[static_cast<std::size_t>(idx)].filename().string());
      if (!found.ok()) return found.status();
    }
    sequence->masks_ = *std::move(masks);
  }
  return sequence;
}

// A calibration of other images is the commonest mistake: it is told before anything runs. A first image that cannot
// be decoded is Next's to report.
Status ImageFolder::CheckFirstImage() const {
  const std::filesystem::path& file = files_[static_cast<std::size_t>(range_.start)];
  const Result<cv::Mat> image = ReadImage(file);
  const Camera& camera = calibration_.camera;
  if (!image.ok() || (image->cols == camera.width() && image->rows == camera.height())) return Status::Ok();
  return {ErrorCode::kMismatch, "the calibration " + calibration_.path.string() + " is for images of " +
                                    SizeText(camera.width(), camera.height()) + ", but " + file.string() + " is " +
                                    SizeText(*image) + "; give the calibration of these images"};
}

std::vector<std::string> ImageFolder::Stems() const {
  std::vector<std::string> stems;
  stems.reserve(files_.size());
  for (const std::filesystem::path& file : files_) stems.push_back(file.stem().string());
  return stems;
}

void ImageFolder::SetTimestamps(std::vector<double> timestamps_s) {
  assert(timestamps_s.size() == files_.size());
  timestamps_s_ = std::move(timestamps_s);
}

std::optional<double> ImageFolder::TimestampS(int frame_idx) const {
  if (frame_idx < 0 || frame_idx >= source_count()) return std::nullopt;
  return timestamps_s_.empty() ? frame_idx / calibration_.fps : timestamps_s_[static_cast<std::size_t>(frame_idx)];
}

std::optional<std::string> ImageFolder::Name(int frame_idx) const {
  if (frame_idx < 0 || frame_idx >= source_count()) return std::nullopt;
  return files_[static_cast<std::size_t>(frame_idx)].filename().string();
}

Result<std::optional<SequenceFrame>> ImageFolder::Next() {
  if (next_idx_ >= range_.end) return std::optional<SequenceFrame>();
  Result<SequenceFrame> frame = ReadFrame(next_idx_);
  next_idx_ += range_.stride;  // also after a failure: the frame after it can still be read
  if (!frame.ok()) return frame.status();
  return std::optional<SequenceFrame>(*std::move(frame));
}

Result<SequenceFrame> ImageFolder::ReadFrame(int frame_idx) const {
  const std::filesystem::path& file = files_[static_cast<std::size_t>(frame_idx)];
  const Camera& camera = calibration_.camera;
  Result<cv::Mat> image = ReadImage(file);
  if (!image.ok()) return image.status();
  if (image->cols != camera.width() || image->rows != camera.height())
    return Status(ErrorCode::kMismatch, "the image " + file.string() + " is " + SizeText(*image) +
                                            ", but the calibration and the first image are " +
                                            SizeText(camera.width(), camera.height()) +
                                            "; the size may not change within a sequence");
  SequenceFrame frame;
  frame.frame_idx = frame_idx;
  frame.name = *Name(frame_idx);
  frame.timestamp_s = *TimestampS(frame_idx);
  frame.image = *std::move(image);
  if (masks_) {
    Result<cv::Mat> mask = ReadFrameMask(*masks_, frame_idx, frame.name, camera.width(), camera.height());
    if (!mask.ok()) return mask.status();
    frame.mask = *std::move(mask);
  }
  return frame;
}

}  // namespace pliant
