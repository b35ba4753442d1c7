// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Depth as an array of NumPy (.npy): (height, width), with any axes of length 1 before or behind.
#pragma once

#include <filesystem>
#include <string>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"

namespace pliant {

// CV_32FC1, values as they are, of any type. `what` names it in the sentence of a failure ("a depth prior"). Fails with
// kNotFound, kUnreadable (as ParseNpy), and kMismatch for another shape.
Result<cv::Mat> ReadDepthArray(const std::filesystem::path& path, const std::string& what);

// Of a sequence: CV_32FC1, mm along the optical axis; 0 where the number is not above 0, or none. Fails also with
// kMismatch for numbers that are not float32 or float64: whole numbers would need a scale.
Result<cv::Mat> ReadDepthMap(const std::filesystem::path& path);

}  // namespace pliant
