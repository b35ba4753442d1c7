// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/given_images.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>

#include "datasets/formats.h"
#include "pliant/datasets/frame_checks.h"
#include "pliant/io/camera_file.h"

namespace pliant {
namespace {

class GivenStream final : public ImageStream {
 public:
  explicit GivenStream(std::shared_ptr<ImageSource> images) : images_(std::move(images)) {}

  const std::filesystem::path& path() const override { return path_; }
  int count() const override { return images_->count(); }
  bool count_is_exact() const override { return images_->count() > 0; }
  std::optional<double> fps() const override { return std::nullopt; }
  std::string Name(int idx) const override {
    std::array<char, 32> name;
    std::snprintf(name.data(), name.size(), "%06d.png", idx);
    return name.data();
  }
  std::string Title(int idx) const override { return "image " + std::to_string(idx); }
  std::optional<cv::Size> SizeAt(int idx) const override {
    const auto image = images_->Read(idx);
    return image.ok() && image->has_value() ? std::optional((*image)->size()) : std::nullopt;
  }
  Result<std::optional<cv::Mat>> Read(int idx) override { return images_->Read(idx); }
  std::optional<double> TimestampS(int idx) const override { return images_->TimestampS(idx); }

 private:
  std::filesystem::path path_ = "the list of images";
  std::shared_ptr<ImageSource> images_;
};

}  // namespace

Result<DataSet> OpenGivenImages(const SequenceRequest& request) {
  const GivenImages& given = *request.given;
  if (const std::size_t times = given.timestamps_s.size();
      times > 0 && static_cast<int>(times) != given.images->count())
    return Status(ErrorCode::kMismatch,
                  "there are " + std::to_string(times) + " timestamps for " +
                      (given.images->count() > 0 ? std::to_string(given.images->count()) : "an unknown number of") +
                      " images; each image needs one");
  if (Status status = CheckFrameTimes(given.timestamps_s, "the timestamps are"); !status.ok()) return status;
  if (Status status = CheckFps(given.fps); !status.ok()) return status;
  DataSet data_set{.calibration = {given.camera, "that was given"},
                   .images = std::make_unique<GivenStream>(given.images),
                   .mask_path = request.mask_path,
                   .timestamps_s = given.timestamps_s};
  data_set.calibration.fps = given.fps;
  data_set.calibration.photometric = given.photometric;
  data_set.warnings = given.warnings;
  return data_set;
}

}  // namespace pliant
