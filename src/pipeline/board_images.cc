// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/board_images.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "datasets/image_file.h"
#include "datasets/image_stream.h"
#include "datasets/pair_streams.h"
#include "pliant/base/text.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/image/pyramid.h"
#include "pliant/image/sharpness.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// The sharpest image of every stretch of a stream, of whatever length: stretches become longer as there are more.
class SharpestImages {
 public:
  // `expected`: images of the stream, where that is known; 0: not.
  SharpestImages(int max_images, int expected)
      : max_images_(static_cast<std::size_t>(max_images)),
        stretch_(std::max(1, (expected + max_images - 1) / max_images)) {}

  void Add(BoardImage image) {
    if (in_last_ == 0 || in_last_ == stretch_) {
      if (images_.size() == 2 * max_images_) Halve();
      images_.push_back(std::move(image));
      in_last_ = 1;
      return;
    }
    ++in_last_;
    if (image.sharpness > images_.back().sharpness) images_.back() = std::move(image);
  }

  // At most as many as were asked for.
  std::vector<BoardImage> Take() {
    if (images_.size() > max_images_) Halve();
    return std::move(images_);
  }

 private:
  void Halve() {
    std::vector<BoardImage> half;
    for (std::size_t i = 0; i < images_.size(); i += 2) {
      const bool second = i + 1 < images_.size() && images_[i + 1].sharpness > images_[i].sharpness;
      half.push_back(std::move(images_[second ? i + 1 : i]));
    }
    images_ = std::move(half);
    stretch_ *= 2;
    in_last_ = stretch_;
  }

  std::size_t max_images_;
  std::vector<BoardImage> images_;
  int stretch_;
  int in_last_ = 0;  // images that the last one stands for
};

using Stream = std::unique_ptr<ImageStream>;

Result<Stream> OpenStream(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    if (!fs::exists(path, error))
      return Status(ErrorCode::kNotFound, "there is nothing at " + Quoted(path.string()) +
                                              "; give a folder of images, or a video, of the board");
    return StreamVideo(path);
  }
  const fs::path images = path / native::kImageFolder;
  return StreamFolder(fs::is_directory(images, error) ? images : path);
}

Status Unequal(const fs::path& left, int left_count, const fs::path& right, int right_count) {
  return {ErrorCode::kMismatch, Quoted(left.string()) + " has " + std::to_string(left_count) + " images and " +
                                    Quoted(right.string()) + " has " + std::to_string(right_count) +
                                    "; pairs are images of the same moment, in the same order"};
}

// One stream, or two of a pair.
Result<std::vector<Stream>> OpenStreams(const CalibrateRequest& request) {
  std::vector<Stream> streams;
  auto first = OpenStream(request.image_path);
  if (!first.ok()) return first.status();
  if (request.pairs != PairLayout::kApart) {
    const auto size = (*first)->SizeAt(0);
    if (!size) return Status(ErrorCode::kUnreadable, Quoted(request.image_path.string()) + " has no image that opens");
    EyeStreams eyes = SplitEyes(*std::move(first), request.pairs, *size);
    streams.push_back(std::move(eyes.left));
    streams.push_back(std::move(eyes.right));
    return streams;
  }
  streams.push_back(*std::move(first));
  if (request.right_path.empty()) return streams;
  auto right = OpenStream(request.right_path);
  if (!right.ok()) return right.status();
  const ImageStream& left = *streams.front();
  if (left.count_is_exact() && (*right)->count_is_exact() && left.count() != (*right)->count())
    return Unequal(request.image_path, left.count(), request.right_path, (*right)->count());
  streams.push_back(*std::move(right));
  return streams;
}

// The images of one moment; empty at the end. Where one eye's end before the other's that is an error.
Result<std::vector<cv::Mat>> ReadMoment(const CalibrateRequest& request, const std::vector<Stream>& streams, int idx) {
  std::vector<cv::Mat> images;
  for (const Stream& stream : streams) {
    if (stream->count_is_exact() && idx == stream->count()) return std::vector<cv::Mat>();
    auto image = stream->Read(idx);
    if (!image.ok()) return image.status();
    if (*image) {
      images.push_back(**std::move(image));
    } else if (!images.empty()) {
      return Unequal(request.image_path, idx + 1, request.right_path, idx);
    } else {
      break;
    }
  }
  return images;
}

}  // namespace

Result<BoardImages> ReadBoardImages(const CalibrateRequest& request, int max_images,
                                    const CalibrateProgress& progress) {
  auto streams = OpenStreams(request);
  if (!streams.ok()) return streams.status();
  const ImageStream& first = *streams->front();
  SharpestImages sharpest(max_images, first.count());
  BoardImages read;
  read.fps = first.fps();
  std::vector<cv::Size> sizes(streams->size());
  while (true) {
    auto moment = ReadMoment(request, *streams, read.count);
    if (!moment.ok()) return moment.status();
    if (moment->empty()) break;
    BoardImage image{first.Name(read.count), {}};
    for (std::size_t eye = 0; eye < moment->size(); ++eye) {
      const cv::Mat& pixels = (*moment)[eye];
      const ImageStream& stream = *(*streams)[eye];
      if (read.count == 0) sizes[eye] = pixels.size();
      if (pixels.size() != sizes[eye])
        return Status(ErrorCode::kMismatch,
                      stream.Title(read.count) + " is " + SizeText(pixels) + " and " + stream.Title(0) + " is " +
                          SizeText(sizes[eye].width, sizes[eye].height) + "; calibrate with images of one size");
      // Not a view into a pair's image: filters would look beyond its border.
      image.gray.push_back(ToGray(streams->size() > 1 ? pixels.clone() : pixels));
      const double sharpness = Sharpness(image.gray.back(), {});
      image.sharpness = eye == 0 ? sharpness : std::min(image.sharpness, sharpness);
    }
    sharpest.Add(std::move(image));
    ++read.count;
    if (!progress(0, 0)) return Status(ErrorCode::kInterrupted, "the calibration was stopped");
  }
  read.images = sharpest.Take();
  if (read.images.empty())
    return Status(ErrorCode::kUnreadable,
                  Quoted(request.image_path.string()) + " has no image; give images of the board");
  return read;
}

}  // namespace pliant
