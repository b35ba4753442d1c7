// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Depth images written as OpenEXR files, each whole or not at all.
#pragma once

#include <filesystem>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"

namespace pliant {

// CV_32FC1, as one channel "Y" of 32-bit floats, which OpenCV and ffmpeg read, compressed without loss. Fails with
// kUnwritable.
Status WriteDepthExr(const std::filesystem::path& path, const cv::Mat& depth);

}  // namespace pliant
