// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Images written as PNG files, each whole or not at all.
#pragma once

#include <filesystem>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"

namespace pliant {

// 8- or 16-bit. Fails with kUnwritable.
Status WritePng(const std::filesystem::path& path, const cv::Mat& image);

// CV_32FC1 -> CV_16UC1 steps of `scale`, for a depth image; 0 where there is none or it is out of range.
cv::Mat QuantizeDepth(const cv::Mat& depth, double scale);

}  // namespace pliant
