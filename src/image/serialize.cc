// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/serialize.h"

#include "pliant/image/masks.h"
#include "pliant/image/pyramid.h"

namespace pliant {

void Serialize(StateArchive& archive, cv::Mat& image) {
  int rows = image.rows;
  int columns = image.cols;
  int type = image.type();
  archive(rows, columns, type);
  if (archive.reads()) {
    if (rows < 0 || columns < 0 || CV_MAT_DEPTH(type) > CV_64F || type != CV_MAT_TYPE(type)) archive.Fail();
    if (!archive.ok()) return;
    const auto row_size = static_cast<std::size_t>(columns) * static_cast<std::size_t>(CV_ELEM_SIZE(type));
    archive.CheckLeft(static_cast<std::size_t>(rows), row_size);
    if (!archive.ok()) return;
    image = rows > 0 && columns > 0 ? cv::Mat(rows, columns, type) : cv::Mat();
  }
  for (int y = 0; y < image.rows; ++y)
    archive.Bytes(image.ptr(y), static_cast<std::size_t>(image.cols) * image.elemSize());
}

void ImagePyramid::Serialize(StateArchive& archive) { archive(padded_); }

void SupportMask::Serialize(StateArchive& archive) { archive(valid_, integral_); }

}  // namespace pliant
