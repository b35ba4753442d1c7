// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/descriptors.h"

#include <cassert>

#include <opencv2/features2d.hpp>

namespace pliant {
namespace {

constexpr float kSize_px = 8;         // diameter of a keypoint; the histograms cover about five times as much
constexpr int kFirstOctave = 1 << 8;  // OpenCV's code for the image as it is, at the first level of blur

// The `count` nearest rows of `train` for every row of `query`.
std::vector<std::vector<cv::DMatch>> Nearest(const cv::Mat& query, const cv::Mat& train, int count) {
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_L2).knnMatch(query, train, matches, count);
  return matches;
}

}  // namespace

cv::Mat DescribePixels(const cv::Mat& gray, std::span<const Eigen::Vector2d> pixels) {
  assert(gray.type() == CV_8UC1);
  if (pixels.empty()) return cv::Mat(0, 128, CV_32FC1);
  std::vector<cv::KeyPoint> keypoints;
  for (const Eigen::Vector2d& pixel : pixels)
    keypoints.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), kSize_px, /*angle=*/0.0F,
                           /*response=*/0.0F, kFirstOctave);
  cv::Mat descriptors;
  cv::SIFT::create()->compute(gray, keypoints, descriptors);
  assert(descriptors.rows == static_cast<int>(pixels.size()));
  return descriptors;
}

std::vector<std::pair<int, int>> MatchDescriptors(const cv::Mat& a, const cv::Mat& b, double max_ratio) {
  std::vector<std::pair<int, int>> pairs;
  if (a.empty() || b.empty()) return pairs;
  const auto there = Nearest(a, b, 2);
  const auto back = Nearest(b, a, 1);
  for (const std::vector<cv::DMatch>& best : there) {
    if (best.empty() || back[static_cast<std::size_t>(best[0].trainIdx)][0].trainIdx != best[0].queryIdx) continue;
    if (best.size() == 2 && !(best[0].distance < max_ratio * best[1].distance)) continue;
    pairs.emplace_back(best[0].queryIdx, best[0].trainIdx);
  }
  return pairs;
}

}  // namespace pliant
