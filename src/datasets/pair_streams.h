// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Streams made of streams: one eye of images that hold both, and images that are warped as they are read.
#pragma once

#include <memory>

#include "datasets/image_stream.h"
#include "datasets/rectify.h"

namespace pliant {

struct EyeStreams {
  std::unique_ptr<ImageStream> left;
  std::unique_ptr<ImageStream> right;
};

// The halves of a stream whose images all are of this size (kMismatch where one is not). An image is read once for both
// eyes; the right one is asked for after the left one, or not at all.
EyeStreams SplitEyes(std::unique_ptr<ImageStream> pairs, PairLayout layout, cv::Size image);

// The images of a stream, all of the warp's raw size (kMismatch), warped.
std::unique_ptr<ImageStream> Warped(std::unique_ptr<ImageStream> images, ImageWarp warp);

}  // namespace pliant
