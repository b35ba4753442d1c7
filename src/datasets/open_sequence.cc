// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/open_sequence.h"

#include <utility>

#include "datasets/formats.h"
#include "datasets/image_list.h"

namespace pliant {

namespace {

Result<const DataSetFormat*> FormatAt(const std::filesystem::path& path) {
  std::error_code error;
  if (path.empty() || !std::filesystem::exists(path, error))
    return Status(ErrorCode::kNotFound, "there is nothing at the image path '" + path.string() +
                                            "'; give a folder of images, a video or a sequence");
  for (const DataSetFormat& format : DataSetFormats())
    if (format.is_at(path)) return &format;
  return Status(ErrorCode::kUnreadable, path.string() +
                                            " is neither a folder nor a file; give a folder of images, "
                                            "a video or a sequence");
}

}  // namespace

Result<std::unique_ptr<Sequence>> OpenSequence(const SequenceRequest& request) {
  const auto format = FormatAt(request.image_path);
  if (!format.ok()) return format.status();
  if (const Result<FrameRange> range = FrameRange::From(request); !range.ok()) return range.status();
  Result<DataSet> data_set = (*format)->open(request);
  if (!data_set.ok()) return data_set.status();
  return ReadDataSet(*std::move(data_set), request);
}

Result<DataSetKind> RecognizeDataSet(const std::filesystem::path& path) {
  const auto format = FormatAt(path);
  if (!format.ok()) return format.status();
  return DataSetKind{(*format)->name, (*format)->what};
}

}  // namespace pliant
