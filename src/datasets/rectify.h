// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Raw stereo pairs made rectified ones: one pinhole camera, the right image taken at +baseline on the left one's x
// axis, so that a point has one row in both.
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/datasets/pair_layout.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/io/camera_file.h"

namespace pliant {

// Where in a raw image every pixel of the rectified one lies.
struct ImageWarp {
  cv::Size raw;
  cv::Mat x;  // CV_32FC1
  cv::Mat y;

  // Bilinear; black where the raw image has nothing.
  cv::Mat Apply(const cv::Mat& image) const;
  // Nearest, for masks and depths: no value is invented; 0 where the raw image has nothing.
  cv::Mat ApplyNearest(const cv::Mat& image) const;
  // 255 where the raw image has a pixel, 0 elsewhere.
  cv::Mat Inside() const;
};

struct RectifiedPair {
  Camera camera;  // PINHOLE, of both
  double baseline_mm = 0;
  ImageWarp left;
  ImageWarp right;
  Eigen::Matrix3d rectified_from_left;  // a turn of the left camera about its center
};

// OpenCV's rectification (Bouguet's), zero disparity at infinity. Raw images whose pixels are not square, such as those
// of an interlaced video, become as high as they are to be. `raw` is the size of one eye's image. Fails with
// kInvalidArgument where the calibration is none of a pair side by side.
Result<RectifiedPair> RectifyPair(const StereoCalibration& calibration, cv::Size raw);

// The layout in which a calibration's left camera looks out of the middle of an image, as all do; by the size that the
// calibration says, where it says one. Fails with kMismatch where no layout does.
Result<PairLayout> LayoutOf(const StereoCalibration& calibration, cv::Size image);
cv::Size EyeSize(PairLayout layout, cv::Size image);
// A view into `image`.
cv::Mat LeftEye(PairLayout layout, const cv::Mat& image);
cv::Mat RightEye(PairLayout layout, const cv::Mat& image);

}  // namespace pliant
