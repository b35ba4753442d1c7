// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A folder of images, read in natural order; timestamps are frame number / fps.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/image_list.h"
#include "datasets/source_calibration.h"
#include "pliant/datasets/sequence.h"

namespace pliant {

class ImageFolder final : public Sequence {
 public:
  // `mask_path` empty: no masks. Errors as OpenSequence.
  static Result<std::unique_ptr<ImageFolder>> Open(const std::filesystem::path& folder, SourceCalibration calibration,
                                                   const std::filesystem::path& mask_path, const FrameRange& range);

  const Camera& camera() const override { return calibration_.camera; }
  int size() const override { return range_.Count(); }
  Result<std::optional<SequenceFrame>> Next() override;
  Result<std::optional<cv::Mat>> Depth(int /*frame_idx*/) const override { return std::optional<cv::Mat>(); }
  std::optional<Rigid3> WorldFromCamera(int /*frame_idx*/) const override { return std::nullopt; }
  std::optional<double> TimestampS(int frame_idx) const override;
  std::optional<std::string> Name(int frame_idx) const override;

  // Of the whole folder, whatever the range.
  int source_count() const { return static_cast<int>(files_.size()); }
  std::vector<std::string> Stems() const;
  // Replaces number / fps; one time an image.
  void SetTimestamps(std::vector<double> timestamps_s);

 private:
  ImageFolder(SourceCalibration calibration, std::vector<std::filesystem::path> files, const FrameRange& range)
      : calibration_(std::move(calibration)), files_(std::move(files)), range_(range), next_idx_(range.start) {}

  Status CheckFirstImage() const;
  Result<SequenceFrame> ReadFrame(int frame_idx) const;

  SourceCalibration calibration_;
  std::vector<std::filesystem::path> files_;
  FrameRange range_;
  int next_idx_;
  std::optional<CompanionImages> masks_;
  std::vector<double> timestamps_s_;  // empty: number / fps
};

}  // namespace pliant
