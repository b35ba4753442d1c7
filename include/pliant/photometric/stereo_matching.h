// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where pixels of the left image of a rectified pair are in the right one, along their row (docs/method.md, eq. B1 to
// B4), to a part of a pixel.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/image/depth_lookup.h"
#include "pliant/image/masks.h"
#include "pliant/image/pyramid.h"
#include "pliant/photometric/patch.h"

namespace pliant {

enum class StereoMatcher {
  kPhotometric,  // correlation along the row, then the tracker's own alignment with gain, bias and shading
  kSgbm,         // OpenCV's semi-global matching (Hirschmueller, PAMI 2008) of the whole image, read at the corners
};
template <>
struct EnumNames<StereoMatcher> {
  static constexpr std::array kNames = {std::pair{StereoMatcher::kPhotometric, std::string_view("photometric")},
                                        std::pair{StereoMatcher::kSgbm, std::string_view("sgbm")}};
};

struct StereoMatchingOptions {
  StereoMatcher matcher = StereoMatcher::kPhotometric;
  double min_disparity_px = 1;
  double max_disparity_share = 0.25;  // of the image's width
  double max_row_px = 1;              // difference of the rows
  double max_left_right_px = 0.5;     // followed back, it returns so near
  double min_correlation = 0.7;       // at the best position along the row
  double max_ambiguity = 0.8;         // 1 - correlation of the best position by that of the second best

  void List(OptionTable& table);  // appended to the present group, named stereo_...
};

// What pairs must be for a disparity to be a depth: rectified, of a PINHOLE camera, with a baseline above 0. Fails with
// kMismatch; the sentence begins with `what`, which needs them.
Status CheckPairs(const std::string& what, const Camera& camera, std::optional<double> baseline_mm);

struct RowMatch {
  double disparity_px = 0;   // x_left - x_right
  double row_px = 0;         // y_left - y_right, which a rectified pair has at 0; sgbm: 0
  double left_right_px = 0;  // followed back it returned so near; sgbm: 0

  bool operator==(const RowMatch&) const = default;
};

// Of each pixel of the left image; nothing where no match is certain. Images are of one size, rectified. The same input
// gives the same answer on any number of threads.
std::vector<std::optional<RowMatch>> MatchAlongRows(const ImagePyramid& left, const SupportMask& left_mask,
                                                    const ImagePyramid& right, const SupportMask& right_mask,
                                                    std::span<const Eigen::Vector2d> pixels,
                                                    const StereoMatchingOptions& options,
                                                    const LucasKanadeOptions& lucas_kanade, int threads);

// The same as depths of a whole image, matched as tracked points are by default. `left`, `right`: 8-bit, 1 or 3 (BGR)
// channels; `left_mask`: CV_8UC1, 0 = ignore, or empty. kNoDepth without a certain match. The standard deviation of a
// disparity is that of the rows of the matches, which ought to agree, and what the match followed back is off, together
// (docs/method.md, eq. B6).
std::vector<DepthAtPixel> DepthsOfPair(const Camera& camera, double baseline_mm, const cv::Mat& left,
                                       const cv::Mat& left_mask, const cv::Mat& right,
                                       std::span<const Eigen::Vector2d> pixels, int threads);

}  // namespace pliant
