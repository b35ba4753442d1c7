// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/depth_prior_file.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "datasets/image_file.h"
#include "io/npy.h"
#include "pliant/base/files.h"

namespace pliant {
namespace {

constexpr double kMaxStretch = 0.02;  // of the sides' ratio: sizes are rounded to multiples of a network's patches

Result<cv::Mat> ReadArray(const std::filesystem::path& path) {
  const auto bytes = ReadFile(path.string());
  if (!bytes.ok()) return bytes.status();
  const auto array = ParseNpy(path.string(), *bytes);
  if (!array.ok()) return array.status();
  std::vector<std::size_t> sides;
  std::ranges::copy_if(array->shape, std::back_inserter(sides), [](std::size_t length) { return length != 1; });
  if (sides.size() != 2)
    return Status(ErrorCode::kMismatch, path.string() + " has the shape " + ShapeText(array->shape) +
                                            "; a depth prior is an array of (height, width), one file an image");
  cv::Mat values(static_cast<int>(sides[0]), static_cast<int>(sides[1]), CV_32FC1);
  for (std::size_t i = 0; i < array->size(); ++i) values.ptr<float>()[i] = static_cast<float>(array->At(i));
  return values;
}

Result<cv::Mat> ReadValues(const std::filesystem::path& path) {
  if (path.extension() == ".npy") return ReadArray(path);
  const auto stored = ReadStoredImage(path);
  if (!stored.ok()) return stored.status();
  if (stored->channels() != 1)
    return Status(ErrorCode::kMismatch, "the depth prior " + path.string() + " has " +
                                            std::to_string(stored->channels()) +
                                            " channels: a picture in colors is no depth; write one channel of 16 bits "
                                            "or of floats");
  cv::Mat values;
  stored->convertTo(values, CV_32F);
  return values;
}

}  // namespace

Result<cv::Mat> ReadDepthPrior(const std::filesystem::path& path, int width, int height) {
  Result<cv::Mat> values = ReadValues(path);
  if (!values.ok()) return values;
  const double stretch = static_cast<double>(values->cols) * height / (static_cast<double>(values->rows) * width);
  if (std::abs(stretch - 1.0) > kMaxStretch)
    return Status(ErrorCode::kMismatch, "the depth prior " + path.string() + " is " + SizeText(*values) +
                                            ", but the images are " + SizeText(width, height) +
                                            "; resize it to the sides of the images");
  return values;
}

}  // namespace pliant
