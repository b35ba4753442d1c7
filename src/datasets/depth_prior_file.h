// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Depth images of other programs, as these write them (docs/your_own_video.md).
#pragma once

#include <filesystem>
#include <string_view>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"

namespace pliant {

// CV_32FC1, values as they are in the file: PNG or TIFF of one channel with 8 or 16 bits or floats, EXR, or an array of
// NumPy, (height, width) with any axes of length 1 before or behind. Of any size, with the sides of `width` x `height`
// (those of the images) to one another. Fails with kNotFound, kUnreadable, and kMismatch (colors, other sides).
Result<cv::Mat> ReadDepthPrior(const std::filesystem::path& path, int width, int height);

// Why a depth prior tells no two points apart: "no positive number" or "one value everywhere"; empty where it does.
std::string_view WhySaysNothing(const cv::Mat& prior);

}  // namespace pliant
