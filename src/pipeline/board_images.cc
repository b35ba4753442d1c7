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

Result<std::unique_ptr<ImageStream>> OpenStream(const fs::path& path) {
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
Result<ImageStreams> OpenStreams(const CalibrateRequest& request) {
  ImageStreams streams;
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
Result<std::vector<cv::Mat>> ReadMoment(const CalibrateRequest& request, const ImageStreams& streams, int idx) {
  std::vector<cv::Mat> images;
  std::vector<int> counts;
  for (const std::unique_ptr<ImageStream>& stream : streams) {
    counts.push_back(idx);
    if (stream->count_is_exact() && idx == stream->count()) continue;
    auto image = stream->Read(idx);
    if (!image.ok()) return image.status();
    if (!*image) continue;
    images.push_back(**std::move(image));
    ++counts.back();
  }
  if (!images.empty() && images.size() < streams.size())
    return Unequal(request.image_path, counts.front(), request.right_path, counts.back());
  return images;
}

}  // namespace

Result<BoardImageReader> BoardImageReader::Open(const CalibrateRequest& request) {
  auto streams = OpenStreams(request);
  if (!streams.ok()) return streams.status();
  return BoardImageReader(request, *std::move(streams));
}

Result<std::optional<BoardImage>> BoardImageReader::Next() {
  auto moment = ReadMoment(request_, streams_, count_);
  const auto is_damaged = [&](const std::unique_ptr<ImageStream>& stream) { return stream->IsDamaged(count_); };
  for (; !moment.ok() && std::ranges::any_of(streams_, is_damaged); ++count_)
    moment = ReadMoment(request_, streams_, count_ + 1);
  if (!moment.ok()) return moment.status();
  if (moment->empty()) {
    if (count_ > 0) return std::optional<BoardImage>();
    return Status(ErrorCode::kUnreadable,
                  Quoted(request_.image_path.string()) + " has no image; give images of the board");
  }
  BoardImage image{streams_.front()->Name(count_), {}};
  for (std::size_t eye = 0; eye < moment->size(); ++eye) {
    const cv::Mat& pixels = (*moment)[eye];
    const ImageStream& stream = *streams_[eye];
    if (sizes_.size() <= eye) sizes_.push_back(pixels.size());
    if (pixels.size() != sizes_[eye])
      return Status(ErrorCode::kMismatch, stream.Title(count_) + " is " + SizeText(pixels) + " and " + stream.Title(0) +
                                              " is " + SizeText(sizes_[eye].width, sizes_[eye].height) +
                                              "; calibrate with images of one size");
    // Not a view into a pair's image: filters would look beyond its border.
    image.gray.push_back(ToGray(streams_.size() > 1 ? pixels.clone() : pixels));
    const double sharpness = Sharpness(image.gray.back(), {});
    image.sharpness = eye == 0 ? sharpness : std::min(image.sharpness, sharpness);
  }
  ++count_;
  return std::optional<BoardImage>(std::move(image));
}

}  // namespace pliant
