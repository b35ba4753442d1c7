// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/depth_array.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "io/npy.h"
#include "pliant/base/files.h"

namespace pliant {
namespace {

enum class Numbers { kAny, kFloats };

Result<cv::Mat> Read(const std::filesystem::path& path, const std::string& what, Numbers numbers) {
  const auto bytes = ReadFile(path.string());
  if (!bytes.ok()) return bytes.status();
  const auto array = ParseNpy(path.string(), *bytes);
  if (!array.ok()) return array.status();
  if (numbers == Numbers::kFloats && array->kind != NpyArray::Kind::kFloat)
    return Status(ErrorCode::kMismatch, path.string() + " has numbers of the type " + array->type + "; " + what +
                                            " is an array of float32 or float64, in millimeters");
  std::vector<std::size_t> sides;
  std::ranges::copy_if(array->shape, std::back_inserter(sides), [](std::size_t length) { return length != 1; });
  if (sides.size() != 2 || sides[0] == 0 || sides[1] == 0)
    return Status(ErrorCode::kMismatch, path.string() + " has the shape " + ShapeText(array->shape) + "; " + what +
                                            " is an array of (height, width), one file an image");
  cv::Mat values(static_cast<int>(sides[0]), static_cast<int>(sides[1]), CV_32FC1);
  for (std::size_t i = 0; i < array->size(); ++i) values.ptr<float>()[i] = static_cast<float>(array->At(i));
  return values;
}

}  // namespace

Result<cv::Mat> ReadDepthArray(const std::filesystem::path& path, const std::string& what) {
  return Read(path, what, Numbers::kAny);
}

Result<cv::Mat> ReadDepthMap(const std::filesystem::path& path) {
  Result<cv::Mat> depth_mm = Read(path, "a depth map", Numbers::kFloats);
  if (!depth_mm.ok()) return depth_mm;
  for (float& depth : cv::Mat_<float>(*depth_mm))
    if (!std::isfinite(depth) || depth < 0.0F) depth = 0.0F;
  return depth_mm;
}

}  // namespace pliant
