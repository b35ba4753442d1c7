// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/depth_prior_file.h"

#include <cmath>
#include <string>

#include "datasets/depth_array.h"
#include "datasets/image_file.h"

namespace pliant {
namespace {

constexpr double kMaxStretch = 0.02;  // of the sides' ratio: sizes are rounded to multiples of a network's patches

Result<cv::Mat> ReadValues(const std::filesystem::path& path) {
  if (path.extension() == ".npy") return ReadDepthArray(path, "a depth prior");
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
