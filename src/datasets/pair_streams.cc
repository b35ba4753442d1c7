// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/pair_streams.h"

#include <utility>

#include "datasets/image_file.h"

namespace pliant {
namespace {

Status CheckRawSize(const ImageStream& stream, int idx, const cv::Mat& image, cv::Size expected) {
  if (image.size() == expected) return Status::Ok();
  return {ErrorCode::kMismatch, stream.Title(idx) + " is " + SizeText(image) + ", but the calibration and the first " +
                                    "image are " + SizeText(expected.width, expected.height) +
                                    "; the size may not change within a sequence"};
}

// What is read of another stream is changed; all else is said by that one.
class DerivedStream : public ImageStream {
 public:
  explicit DerivedStream(std::shared_ptr<ImageStream> source) : source_(std::move(source)) {}

  const std::filesystem::path& path() const override { return source_->path(); }
  int count() const override { return source_->count(); }
  bool count_is_exact() const override { return source_->count_is_exact(); }
  std::optional<double> fps() const override { return source_->fps(); }
  std::string Name(int idx) const override { return source_->Name(idx); }
  std::string Title(int idx) const override { return source_->Title(idx); }
  Result<std::optional<cv::Size>> StoredSize(int idx) const override { return source_->StoredSize(idx); }
  std::optional<int> Largest16BitValue(int idx) const override { return source_->Largest16BitValue(idx); }
  bool IsDamaged(int idx) const override { return source_->IsDamaged(idx); }
  std::optional<double> RecordedS() const override { return source_->RecordedS(); }

 protected:
  ImageStream& source() const { return *source_; }

 private:
  std::shared_ptr<ImageStream> source_;
};

// Keeps the last image, for the other eye.
class PairStream final : public DerivedStream {
 public:
  PairStream(std::shared_ptr<ImageStream> source, cv::Size image) : DerivedStream(std::move(source)), size_(image) {}

  std::optional<cv::Size> SizeAt(int idx) const override { return source().SizeAt(idx); }

  Result<std::optional<cv::Mat>> Read(int idx) override {
    if (idx == last_idx_) return std::optional<cv::Mat>(last_);
    Result<std::optional<cv::Mat>> image = source().Read(idx);
    if (!image.ok() || !image->has_value()) return image;
    if (Status status = CheckRawSize(source(), idx, **image, size_); !status.ok()) return status;
    last_ = **image;
    last_idx_ = idx;
    return image;
  }

 private:
  cv::Size size_;
  int last_idx_ = -1;
  cv::Mat last_;
};

class EyeStream final : public DerivedStream {
 public:
  using Eye = cv::Mat (*)(PairLayout layout, const cv::Mat& image);

  EyeStream(std::shared_ptr<ImageStream> pairs, PairLayout layout, Eye eye)
      : DerivedStream(std::move(pairs)), layout_(layout), eye_(eye) {}

  std::optional<cv::Size> SizeAt(int idx) const override {
    const std::optional<cv::Size> size = source().SizeAt(idx);
    return size ? std::optional(EyeSize(layout_, *size)) : std::nullopt;
  }

  Result<std::optional<cv::Mat>> Read(int idx) override {
    Result<std::optional<cv::Mat>> pair = source().Read(idx);
    if (!pair.ok() || !pair->has_value()) return pair;
    return std::optional<cv::Mat>(eye_(layout_, **pair).clone());
  }

 private:
  PairLayout layout_;
  Eye eye_;
};

class WarpedStream final : public DerivedStream {
 public:
  WarpedStream(std::shared_ptr<ImageStream> images, ImageWarp warp)
      : DerivedStream(std::move(images)), warp_(std::move(warp)) {}

  std::optional<cv::Size> SizeAt(int idx) const override {
    const std::optional<cv::Size> size = source().SizeAt(idx);
    return size == warp_.raw ? std::optional(warp_.x.size()) : size;
  }

  Result<std::optional<cv::Mat>> Read(int idx) override {
    Result<std::optional<cv::Mat>> image = source().Read(idx);
    if (!image.ok() || !image->has_value()) return image;
    if (Status status = CheckRawSize(source(), idx, **image, warp_.raw); !status.ok()) return status;
    return std::optional<cv::Mat>(warp_.Apply(**image));
  }

 private:
  ImageWarp warp_;
};

}  // namespace

EyeStreams SplitEyes(std::unique_ptr<ImageStream> pairs, PairLayout layout, cv::Size image) {
  const auto source = std::make_shared<PairStream>(std::move(pairs), image);
  return {std::make_unique<EyeStream>(source, layout, LeftEye), std::make_unique<EyeStream>(source, layout, RightEye)};
}

std::unique_ptr<ImageStream> Warped(std::unique_ptr<ImageStream> images, ImageWarp warp) {
  return std::make_unique<WarpedStream>(std::move(images), std::move(warp));
}

}  // namespace pliant
