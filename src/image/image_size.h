// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The size of an image file's image without decoding it, which OpenCV tells only with the pixels, and the largest one
// that is decoded: a file of a few kB can claim an image that fills the memory.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <opencv2/core/types.hpp>

#include "pliant/base/status.h"

namespace pliant {

constexpr double kMaxImageMegapixels = 50;

// As the head of a PNG, JPEG, BMP, TIFF, EXR, WebP, JPEG 2000, PNM, PAM, PFM, Radiance or Sun raster file says it (EXIF
// is ignored); nothing for other files and such that cannot be read.
std::optional<cv::Size> ReadImageSize(const std::filesystem::path& path);
// The same of a file's content.
std::optional<cv::Size> ImageSizeOf(std::span<const unsigned char> file);

// kUnreadable where `size` has no pixels or more than are decoded. `what` begins the sentence ("the image a.png").
Status CheckPixels(const cv::Size& size, const std::string& what);

}  // namespace pliant
