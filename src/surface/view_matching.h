// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How alike a reference image and another one are, at every pixel of the reference image, for a distance of the surface
// along the pixel's ray.
#pragma once

#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"

namespace pliant {

// An image as it is compared.
struct MatchingImage {
  cv::Mat intensity;  // CV_32FC1; pixels that are not valid have the mean of those around
  cv::Mat valid;      // CV_8UC1, 0 = not the surface
};

// Of an 8-bit image with 1 or 3 channels, reduced to `size`, and smoothed there.
MatchingImage MakeMatchingImage(const cv::Mat& image, const cv::Mat& valid, cv::Size size, double smoothing_px);

// The reference image with what its windows have.
struct ReferenceWindows {
  MatchingImage image;
  int window_px = 11;
  double noise_variance = 1;  // of the intensity
  cv::Mat mean;               // CV_32FC1
  cv::Mat variance;           // CV_32FC1
};
ReferenceWindows MakeReferenceWindows(const MatchingImage& image, int window_px, double noise_variance);

// (V3) Another image: with the inverse distance rho along its ray, a pixel's point is in the direction
// at_infinity + rho * by_inverse_distance of that image's camera.
struct MatchingView {
  MatchingImage image;
  cv::Mat at_infinity;          // CV_32FC3, of the reference image's size
  cv::Mat by_inverse_distance;  // CV_32FC3: what the camera moved, and the point
  cv::Vec3f of_camera;          // the camera's part of it
};

// Where the view sees the points, CV_32FC2, px; far outside of the image where it does not.
cv::Mat ProjectInto(const MatchingView& view, const Camera& camera, const cv::Mat& inverse_distance);

// (V4) The normalized cross-correlation of the windows, CV_32FC1, -1 to 1, small where they have little more than
// noise; kNotSeen where either image does not show the point.
inline constexpr float kDampingByNoise = 4.0F;  // variance that is added to that of a window, by that of the noise
inline constexpr float kNotSeen = -2.0F;
cv::Mat Correlation(const ReferenceWindows& reference, const MatchingView& view, const Camera& camera,
                    const cv::Mat& inverse_distance);

}  // namespace pliant
