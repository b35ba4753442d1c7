// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/rectify.h"

#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "datasets/image_file.h"

namespace pliant {
namespace {

// A principal point farther from the middle than this share of the image is that of another image.
constexpr double kMaxOffCenter = 0.2;
// fx and fy that differ by less are those of square pixels.
constexpr double kSquare = 0.01;
// Pixels that are said to be this many times as high as wide are a mistake.
constexpr double kMaxStretch = 4.0;

using Eye = StereoCalibration::Eye;

cv::Matx33d MatrixOf(const Eye& eye) { return {eye.fx, 0, eye.cx, 0, eye.fy, eye.cy, 0, 0, 1}; }

// Rows `stretch` times as far apart; pixel (0, 0) is the center of the first pixel.
Eye Stretched(Eye eye, double stretch) {
  eye.fy *= stretch;
  eye.cy = stretch * (eye.cy + 0.5) - 0.5;
  return eye;
}

// From the raw image to the rectified one, of this size.
ImageWarp WarpOf(const Eye& stretched, const cv::Mat& turn, const cv::Mat& projection, cv::Size raw, cv::Size size) {
  ImageWarp warp{raw, {}, {}};
  cv::initUndistortRectifyMap(MatrixOf(stretched), stretched.distortion, turn, projection, size, CV_32FC1, warp.x,
                              warp.y);
  warp.y = (warp.y + 0.5) * raw.height / size.height - 0.5;
  return warp;
}

std::string Millimeters(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g mm", value);
  return text;
}

}  // namespace

cv::Mat ImageWarp::Apply(const cv::Mat& image) const {
  cv::Mat warped;
  cv::remap(image, warped, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar::all(0));
  return warped;
}

cv::Mat ImageWarp::ApplyNearest(const cv::Mat& image) const {
  cv::Mat warped;
  cv::remap(image, warped, x, y, cv::INTER_NEAREST, cv::BORDER_CONSTANT, cv::Scalar::all(0));
  return warped;
}

cv::Mat ImageWarp::Inside() const { return (x >= 0) & (x <= raw.width - 1) & (y >= 0) & (y <= raw.height - 1); }

Result<RectifiedPair> RectifyPair(const StereoCalibration& calibration, cv::Size raw) {
  const Eigen::Vector3d& t = calibration.right_from_left.translation;
  const auto invalid = [](const std::string& what) { return Status(ErrorCode::kInvalidArgument, what); };
  if (!(t.norm() > 0.0)) return invalid("the stereo calibration has no baseline: T is 0");
  if (t.x() > 0.0)
    return invalid(
        "the stereo calibration puts the right camera " + Millimeters(t.norm()) +
        " to the left of the left one: exchange the two cameras, or invert R and T (a point is at R x + T in "
        "the right camera)");
  if (std::abs(t.x()) < std::abs(t.y()))
    return invalid("the cameras of the stereo calibration are one above the other; only pairs side by side are read");
  for (const Eye* eye : {&calibration.left, &calibration.right})
    if (!(eye->fx > 0 && eye->fy > 0 && eye->fx / eye->fy > 1.0 / kMaxStretch && eye->fx / eye->fy < kMaxStretch))
      return invalid(
          "the stereo calibration has focal lengths that are not positive, or too different along rows and "
          "columns");
  if (raw.width < 1 || raw.height < 1) return invalid("the images to be rectified have no size");
  const double ratio = calibration.left.fx / calibration.left.fy;
  cv::Size size = raw;
  if (std::abs(ratio - 1.0) > kSquare) size.height = static_cast<int>(std::lround(raw.height * ratio));
  const double stretch = static_cast<double>(size.height) / raw.height;
  const Eye left = Stretched(calibration.left, stretch);
  const Eye right = Stretched(calibration.right, stretch);
  const Eigen::Matrix3d turn = calibration.right_from_left.rotation.toRotationMatrix();
  cv::Matx33d r;
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 3; ++col) r(row, col) = turn(row, col);
  cv::Mat left_turn, right_turn, left_projection, right_projection, unused;
  try {
    cv::stereoRectify(MatrixOf(left), left.distortion, MatrixOf(right), right.distortion, size, r,
                      cv::Vec3d(t.x(), t.y(), t.z()), left_turn, right_turn, left_projection, right_projection, unused,
                      cv::CALIB_ZERO_DISPARITY);
  } catch (const cv::Exception& error) {
    return invalid("the stereo calibration cannot be rectified: " + error.err);
  }
  const cv::Matx34d p = left_projection;
  auto camera = Camera::Create(CameraModelId::kPinhole, size.width, size.height,
                               std::vector<double>{p(0, 0), p(1, 1), p(0, 2), p(1, 2)});
  if (!camera.ok()) return camera.status();
  RectifiedPair pair{std::move(camera).value(), t.norm(), WarpOf(left, left_turn, left_projection, raw, size),
                     WarpOf(right, right_turn, right_projection, raw, size), Eigen::Matrix3d()};
  const cv::Matx33d rectified = left_turn;
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 3; ++col) pair.rectified_from_left(row, col) = rectified(row, col);
  return pair;
}

cv::Size EyeSize(PairLayout layout, cv::Size image) {
  if (layout == PairLayout::kLeftRight) image.width /= 2;
  if (layout == PairLayout::kTopBottom) image.height /= 2;
  return image;
}

Result<PairLayout> LayoutOf(const StereoCalibration& calibration, cv::Size image) {
  for (const PairLayout layout : {PairLayout::kApart, PairLayout::kLeftRight, PairLayout::kTopBottom}) {
    const cv::Size size = EyeSize(layout, image);
    if (calibration.image_size) {
      if (size == cv::Size(calibration.image_size->width, calibration.image_size->height)) return layout;
    } else if (std::abs(calibration.left.cx / size.width - 0.5) < kMaxOffCenter &&
               std::abs(calibration.left.cy / size.height - 0.5) < kMaxOffCenter) {
      return layout;
    }
  }
  return Status(ErrorCode::kMismatch,
                "the stereo calibration fits no image of " + SizeText(image.width, image.height) +
                    ", neither whole nor its left or upper half; give the calibration of these images");
}

cv::Mat LeftEye(PairLayout layout, const cv::Mat& image) {
  return image(cv::Rect(cv::Point(0, 0), EyeSize(layout, image.size())));
}

cv::Mat RightEye(PairLayout layout, const cv::Mat& image) {
  const cv::Size size = EyeSize(layout, image.size());
  const cv::Point corner(layout == PairLayout::kLeftRight ? size.width : 0,
                         layout == PairLayout::kTopBottom ? size.height : 0);
  return image(cv::Rect(corner, size));
}

}  // namespace pliant
