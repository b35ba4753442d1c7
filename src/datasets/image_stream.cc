// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/image_stream.h"

#include <algorithm>
#include <utility>

#include <opencv2/core.hpp>

#include "datasets/image_file.h"
#include "datasets/image_list.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

class FileStream final : public ImageStream {
 public:
  FileStream(fs::path folder, std::vector<fs::path> files) : folder_(std::move(folder)), files_(std::move(files)) {}

  const fs::path& path() const override { return folder_; }
  int count() const override { return static_cast<int>(files_.size()); }
  bool count_is_exact() const override { return true; }
  std::optional<double> fps() const override { return std::nullopt; }
  std::string Name(int idx) const override { return At(idx).filename().string(); }
  std::string Title(int idx) const override { return "the image " + At(idx).string(); }

  std::optional<cv::Size> SizeAt(int idx) const override {
    const Result<cv::Mat> image = ReadImage(At(idx));
    if (!image.ok()) return std::nullopt;
    return image->size();
  }

  Result<std::optional<cv::Size>> StoredSize(int idx) const override {
    if (idx >= count()) return std::optional<cv::Size>();
    const Result<cv::Size> size = SizeOfImageFile(At(idx));
    return size.ok() ? Result(std::optional(*size)) : size.status();
  }

  std::optional<int> Largest16BitValue(int idx) const override {
    if (idx >= count()) return std::nullopt;
    const Result<cv::Mat> image = ReadStoredImage(At(idx));
    if (!image.ok() || image->depth() != CV_16U) return std::nullopt;
    double largest = 0;
    for (int k = 0; k < std::min(image->channels(), 3); ++k) {  // without alpha
      cv::Mat channel;
      double of_channel = 0;
      cv::extractChannel(*image, channel, k);
      cv::minMaxLoc(channel, nullptr, &of_channel);
      largest = std::max(largest, of_channel);
    }
    return static_cast<int>(largest);
  }

  Result<std::optional<cv::Mat>> Read(int idx) override {
    if (idx >= count()) return std::optional<cv::Mat>();
    Result<cv::Mat> image = ReadImage(At(idx));
    if (!image.ok()) return image.status();
    return std::optional<cv::Mat>(*std::move(image));
  }

 private:
  const fs::path& At(int idx) const { return files_[static_cast<std::size_t>(idx)]; }

  fs::path folder_;
  std::vector<fs::path> files_;
};

}  // namespace

std::unique_ptr<ImageStream> StreamFiles(fs::path folder, std::vector<fs::path> files) {
  return std::make_unique<FileStream>(std::move(folder), std::move(files));
}

Result<std::unique_ptr<ImageStream>> StreamFolder(const fs::path& folder) {
  Result<std::vector<fs::path>> files = ListImages(folder);
  if (!files.ok()) return files.status();
  return StreamFiles(folder, *std::move(files));
}

}  // namespace pliant
