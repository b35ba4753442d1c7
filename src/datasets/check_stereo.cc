// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/check_stereo.h"

#include <cmath>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "pliant/base/statistics.h"
#include "pliant/image/descriptors.h"
#include "pliant/image/pyramid.h"

namespace pliant {
namespace {

constexpr int kCorners = 1000;
constexpr double kQuality = 0.01;
constexpr double kMinDistance_px = 8;
constexpr double kMaxRatio = 0.8;
constexpr int kWindow_px = 21;
// A match that moves farther when it is refined was none.
constexpr double kMaxRefinement_px = 4;
// Disparities below say nothing exact of depth.
constexpr double kMinDisparity_px = 2;

std::vector<cv::Point2f> CornersOf(const cv::Mat& gray) {
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(gray, corners, kCorners, kQuality, kMinDistance_px);
  return corners;
}

cv::Mat Described(const cv::Mat& gray, const std::vector<cv::Point2f>& corners) {
  std::vector<Eigen::Vector2d> pixels;
  for (const cv::Point2f& corner : corners) pixels.emplace_back(corner.x, corner.y);
  return DescribePixels(gray, pixels);
}

}  // namespace

void StereoChecker::Add(const cv::Mat& left, const cv::Mat& right, const cv::Mat& depth_mm, const Camera& camera,
                        double baseline_mm) {
  const cv::Mat grays[] = {ToGray(left), ToGray(right)};
  const std::vector<cv::Point2f> corners[] = {CornersOf(grays[0]), CornersOf(grays[1])};
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const auto& [a, b] :
       MatchDescriptors(Described(grays[0], corners[0]), Described(grays[1], corners[1]), kMaxRatio)) {
    from.push_back(corners[0][static_cast<std::size_t>(a)]);
    to.push_back(corners[1][static_cast<std::size_t>(b)]);
  }
  if (from.empty()) return;
  const std::vector<cv::Point2f> matched = to;
  std::vector<unsigned char> found;
  cv::calcOpticalFlowPyrLK(grays[0], grays[1], from, to, found, cv::noArray(), {kWindow_px, kWindow_px}, 0,
                           {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.01}, cv::OPTFLOW_USE_INITIAL_FLOW);
  for (std::size_t k = 0; k < from.size(); ++k) {
    if (found[k] == 0 || cv::norm(to[k] - matched[k]) > kMaxRefinement_px) continue;
    row_errors_px_.push_back(std::abs(to[k].y - from[k].y));
    const double disparity_px = from[k].x - to[k].x;
    if (disparity_px > 0) ++right_way_;
    if (depth_mm.empty() || std::abs(disparity_px) < kMinDisparity_px) continue;
    const float depth = depth_mm.at<float>(cv::Point(cvRound(from[k].x), cvRound(from[k].y)));
    if (depth > 0)
      depth_ratios_.push_back(depth * std::abs(disparity_px) / (camera.HorizontalFocalLengthPx() * baseline_mm));
  }
}

StereoCheck StereoChecker::Check() const {
  StereoCheck check;
  check.matches = static_cast<int>(count());
  check.median_row_error_px = Median(row_errors_px_);
  check.share_right_way = static_cast<double>(right_way_) / static_cast<double>(count());
  if (!depth_ratios_.empty()) check.depth_ratio = Median(depth_ratios_);
  return check;
}

}  // namespace pliant
