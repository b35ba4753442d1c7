// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where a depth is better not given.
#pragma once

#include <opencv2/core/mat.hpp>

namespace pliant {

// How far neighboring pixels' depths of one surface may be apart, relative: by its slant.
double LargestStepOfASurface(double focal_length_px);

// CV_8UC1, 255 where a window sees surfaces of different depth: within half a window of a step that neither slant nor
// noise (`sigmas`, relative) explains.
cv::Mat NearContours(const cv::Mat& inverse_distance, const cv::Mat& sigmas, double focal_length_px, int window_px);

// Takes small connected pieces out of a depth image: they are wrong more often than not.
void RemoveSpeckles(cv::Mat* depth);

// Values of another size, CV_32FC1, 0 where one of the pixels around has none (0).
cv::Mat Enlarged(const cv::Mat& values, cv::Size size);

}  // namespace pliant
