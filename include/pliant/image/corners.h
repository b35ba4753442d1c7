// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points worth following: Shi-Tomasi corners (Shi and Tomasi, CVPR 1994), refined to sub-pixel, spread evenly over the
// usable image, without those that lie on occluding contours. The same input gives the same corners in the same order.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/base/options.h"
#include "pliant/image/masks.h"

namespace pliant {

struct CornerOptions {
  int max_corners = 500;
  double quality_level = 0.003;  // share of the strongest corner response (its 99 % quantile) below which is noise
  double min_distance_px = 8;    // between two corners, and to points that exist already
  int border_px = 12;            // to the image's edge and to masked pixels: half a patch and a little
  int block_size_px = 7;         // window of the structure tensor
  Switch contour_filter = Switch::kOn;
  double contour_threshold = 0.35;  // ContourMeasure above which a corner counts as lying on an occluding contour
  int contour_radius_px = 24;       // how far to each side the surroundings are compared

  void List(OptionTable& table);  // group "Corners"
};

struct Corner {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double score = 0;    // smaller eigenvalue of the mean gradient tensor, (gray levels / px)^2 (eq. P11)
  double contour = 0;  // ContourMeasure::At the corner
};

// At most `options.max_corners` corners of a CV_8UC1 image. `valid`: CV_8UC1 of the same size, 0 = not usable; or
// empty. `existing`: points to stay away from (for adding to those already followed); they count towards evenness, not
// towards max_corners. Sorted by row, then column.
std::vector<Corner> DetectCorners(const cv::Mat& gray, const cv::Mat& valid, std::span<const Eigen::Vector2d> existing,
                                  const CornerOptions& options);

// Of points in order of preference, those that are taken: at most `options.max_corners`, options.min_distance_px apart
// and from those that exist, spread so that each part of the usable image gets its share before any gets more. Places
// in `pixels`, in the order taken. `valid` is not empty; it and `existing` as in DetectCorners. A point that would be
// taken and is not accepted (asked by its place, at most once) is passed over; empty: all are.
std::vector<std::size_t> SpreadPoints(std::span<const Eigen::Vector2d> pixels, const cv::Mat& valid,
                                      std::span<const Eigen::Vector2d> existing, const CornerOptions& options,
                                      const std::function<bool(std::size_t)>& accepts = {});

// How much the surroundings of a pixel look like an occluding contour in a CV_8UC1 image: with the light at the camera
// a near surface is bright and a far one dark, so a contour is a step between two sides that are each far more alike
// within themselves than to each other, at a scale coarser than texture. Sides are compared up to `radius_px` (2 or
// more) away, in logarithms of brightness (docs/method.md, eq. P12).
class ContourMeasure {
 public:
  ContourMeasure(const cv::Mat& gray, int radius_px);
  // 0 to 1; outside the image as at its nearest pixel.
  double At(const Eigen::Vector2d& pixel) const;

 private:
  struct Moments {
    double mean = 0, mean_square = 0;
  };
  // Of the logarithms in a square window around a pixel.
  Moments Around(const Eigen::Vector2d& pixel) const;

  cv::Mat gray_;
  int step_px_;
};

}  // namespace pliant
