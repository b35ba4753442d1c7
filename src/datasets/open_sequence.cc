// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/open_sequence.h"

#include <string_view>
#include <utility>

#include "datasets/formats.h"
#include "datasets/image_list.h"
#include "pliant/base/text.h"

namespace pliant {

namespace {

constexpr std::string_view kVideoDevice = "/dev/video";

Result<const DataSetFormat*> FormatAt(const std::filesystem::path& path) {
  std::error_code error;
  if (path.empty() || !std::filesystem::exists(path, error))
    return Status(ErrorCode::kNotFound, "there is nothing at the image path '" + path.string() +
                                            "'; give a folder of images, a video or a sequence");
  // It is written into run.json.
  if (!IsUtf8(std::filesystem::absolute(path, error).string()))
    return Status(ErrorCode::kInvalidArgument,
                  "the image path '" + path.string() + "' is not UTF-8; rename it, or the folder that holds it");
  for (const DataSetFormat& format : DataSetFormats())
    if (format.is_at(path)) return &format;
  if (const std::string name = path.string(); name.starts_with(kVideoDevice))
    return Status(ErrorCode::kUnreadable, name + " is a camera; write device:" + name.substr(kVideoDevice.size()));
  return Status(ErrorCode::kUnreadable, path.string() +
                                            " is neither a folder nor a file; give a folder of images, "
                                            "a video or a sequence");
}

Result<std::unique_ptr<Sequence>> OpenWithCamera(const SequenceRequest& request) {
  const DataSetFormat* format = nullptr;
  if (!request.given) {
    const auto found = FormatAt(request.image_path);
    if (!found.ok()) return found.status();
    format = *found;
  }
  if (const Result<FrameRange> range = FrameRange::From(request); !range.ok()) return range.status();
  Result<DataSet> data_set = format == nullptr ? OpenGivenImages(request) : format->open(request);
  if (!data_set.ok()) return data_set.status();
  return ReadDataSet(*std::move(data_set), request);
}

}  // namespace

SequenceRequest SequenceRequest::Whole() const {
  SequenceRequest whole = *this;
  whole.start = 0;
  whole.end = -1;
  whole.stride = 1;
  return whole;
}

Result<std::unique_ptr<Sequence>> OpenSequence(const SequenceRequest& request) {
  auto sequence = OpenWithCamera(request);
  if (sequence.ok() || !request.camera_path.empty() || request.spare_camera_path.empty()) return sequence;
  SequenceRequest with_spare = request;
  with_spare.camera_path = request.spare_camera_path;
  auto other = OpenWithCamera(with_spare);
  return other.ok() ? std::move(other) : std::move(sequence);
}

Result<DataSetKind> RecognizeDataSet(const std::filesystem::path& path) {
  const auto format = FormatAt(path);
  if (!format.ok()) return format.status();
  return DataSetKind{(*format)->name, (*format)->what};
}

}  // namespace pliant
