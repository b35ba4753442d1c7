// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/depth_prior_file.h"

#include <limits>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include "datasets/depth_array.h"
#include "datasets/image_file.h"
#include "pliant/datasets/frame_checks.h"

namespace pliant {
namespace {

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
  const Status size = CheckDepthPriorSize(values->size(), {width, height}, "the depth prior " + path.string());
  return size.ok() ? std::move(values) : Result<cv::Mat>(size);
}

std::string_view WhySaysNothing(const cv::Mat& prior) {
  const cv::Mat known = (prior > 0.0F) & (prior < std::numeric_limits<float>::infinity());
  if (cv::countNonZero(known) == 0) return "no positive number";
  double low = 0;
  double high = 0;
  cv::minMaxLoc(prior, &low, &high, nullptr, nullptr, known);
  return low < high ? "" : "one value everywhere";
}

}  // namespace pliant
