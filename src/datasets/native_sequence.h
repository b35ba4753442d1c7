// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The native sequence: camera.yaml, images/ and what may stand beside them (docs/formats.md).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/image_folder.h"
#include "pliant/datasets/sequence.h"

namespace pliant {

class NativeSequence final : public Sequence {
 public:
  // Whether `folder` is laid out as one.
  static bool IsAt(const std::filesystem::path& folder);
  // `mask_path` empty: the folder's own masks/, if any. groundtruth.txt and times.txt have one line an image
  // (kMismatch); a line that cannot be read is named by its number (kUnreadable).
  static Result<std::unique_ptr<NativeSequence>> Open(const std::filesystem::path& folder,
                                                      const SourceCalibration& calibration,
                                                      const std::filesystem::path& mask_path, const FrameRange& range);

  const Camera& camera() const override { return images_->camera(); }
  int size() const override { return images_->size(); }
  Result<std::optional<SequenceFrame>> Next() override { return images_->Next(); }
  Result<std::optional<cv::Mat>> Depth(int frame_idx) const override;
  std::optional<Rigid3> WorldFromCamera(int frame_idx) const override;
  std::optional<double> TimestampS(int frame_idx) const override { return images_->TimestampS(frame_idx); }
  std::optional<std::string> Name(int frame_idx) const override { return images_->Name(frame_idx); }

 private:
  NativeSequence(std::unique_ptr<ImageFolder> images, double depth_scale)
      : images_(std::move(images)), stems_(images_->Stems()), depth_scale_(depth_scale) {}

  std::unique_ptr<ImageFolder> images_;
  std::vector<std::string> stems_;
  double depth_scale_;
  std::optional<CompanionImages> depth_;
  std::vector<Rigid3> world_from_cam_;  // empty: no groundtruth.txt
};

}  // namespace pliant
