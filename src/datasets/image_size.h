// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The size of an image file's image without decoding it: OpenCV tells it only with the pixels.
#pragma once

#include <filesystem>
#include <optional>

#include <opencv2/core/types.hpp>

namespace pliant {

// As the head of a PNG, JPEG or BMP says it (EXIF is ignored); nothing for other files and such that cannot be read.
std::optional<cv::Size> ReadImageSize(const std::filesystem::path& path);

}  // namespace pliant
