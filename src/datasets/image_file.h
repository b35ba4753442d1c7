// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Image files as the readers need them: whole or not at all. Decoders of PNG and JPEG fill the missing part of a
// truncated file with gray or black, so the file's own end marker is looked for first.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"

namespace pliant {

// "640x480".
std::string SizeText(int width, int height);
inline std::string SizeText(const cv::Mat& image) { return SizeText(image.cols, image.rows); }

// All of them refuse images of more than kMaxImageMegapixels (image/image_size.h), where the head tells the size before
// they are decoded.

// The size of an image. A file whose head tells it, and whose end looks like one (PNG, JPEG), is not decoded. Else
// fails as ReadImage does: what is cut off or no image is found without reading whole files.
Result<cv::Size> SizeOfImageFile(const std::filesystem::path& path);

// 8-bit with one (gray) or three (BGR) channels. 16-bit values are divided by 257, alpha is dropped, EXIF is ignored.
// Fails with kNotFound or kUnreadable.
Result<cv::Mat> ReadImage(const std::filesystem::path& path);
// The same of a file's content; `what` begins the sentence ("the image a.png").
Result<cv::Mat> DecodeImage(const std::vector<unsigned char>& bytes, const std::string& what);

// 8-bit, one channel, 0 or 255. A pixel counts when any color channel does: not 0, in a JPEG (whose zeros are not
// exact) at least 128.
Result<cv::Mat> ReadMaskImage(const std::filesystem::path& path);

// As the file has it: any depth, any number of channels (BGR); EXR too. Fails with kNotFound or kUnreadable.
Result<cv::Mat> ReadStoredImage(const std::filesystem::path& path);

// CV_32FC1, millimeters: value * depth_scale. Fails with kMismatch unless the file is 16-bit with one channel.
Result<cv::Mat> ReadDepthImage(const std::filesystem::path& path, double depth_scale);
// The same where the largest value, 65535, stands for all that is as far or farther: no depth there.
Result<cv::Mat> ReadClampedDepthImage(const std::filesystem::path& path, double depth_scale);

}  // namespace pliant
