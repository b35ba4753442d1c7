// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/masks.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "pliant/image/pyramid.h"

namespace pliant {
namespace {

constexpr int kMedianScale = 8;        // the local median is taken on an image this much smaller ...
constexpr int kMedianWindow = 11;      // ... over this many of its pixels: about 88 px
constexpr int kBorderScale = 4;        // the field of view is found on an image this much smaller
constexpr double kMinViewArea = 0.02;  // share of the image; smaller bright regions are captions on the black

cv::Mat Disc(int radius) {
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * radius + 1, 2 * radius + 1));
}

// Whether max - min <= limit * max over the channels.
bool IsPale(const cv::Mat& image, int y, int x, double limit) {
  if (image.channels() == 1) return true;
  const auto& bgr = image.at<cv::Vec3b>(y, x);
  const auto [low, high] = std::minmax({bgr[0], bgr[1], bgr[2]});
  return 256 * (high - low) <= static_cast<int>(limit * 256) * high;
}

cv::Mat LocalMedian(const cv::Mat& gray) {
  cv::Mat small;
  const cv::Size size(std::max(1, gray.cols / kMedianScale), std::max(1, gray.rows / kMedianScale));
  cv::resize(gray, small, size, 0, 0, cv::INTER_AREA);
  cv::medianBlur(small, small, kMedianWindow);
  cv::Mat median;
  cv::resize(small, median, gray.size(), 0, 0, cv::INTER_LINEAR);
  return median;
}

// Corners of the bright pixels at the ends of each row, in pixels of the full image: their hull is the field of view.
std::vector<cv::Point> RowEnds(const cv::Mat& bright, cv::Size full) {
  std::vector<cv::Point> ends;
  const auto low = [](int i) { return i * kBorderScale; };
  const auto high = [](int i, int count, int size) { return i == count - 1 ? size - 1 : (i + 1) * kBorderScale - 1; };
  for (int y = 0; y < bright.rows; ++y) {
    const auto* row = bright.ptr<std::uint8_t>(y);
    const auto* end = row + bright.cols;
    const auto* first = std::find(row, end, 255);
    if (first == end) continue;
    const int left = static_cast<int>(first - row);
    int right = bright.cols - 1;
    while (row[right] == 0) --right;
    for (const int py : {low(y), high(y, bright.rows, full.height)}) {
      ends.emplace_back(low(left), py);
      ends.emplace_back(high(right, bright.cols, full.width), py);
    }
  }
  return ends;
}

cv::Mat HighlightMaskOf(const cv::Mat& image, const cv::Mat& gray, const MaskOptions& options) {
  cv::Mat mask = gray >= std::min(options.highlight_level, options.highlight_near_level);
  if (cv::countNonZero(mask) == 0) return mask;
  const cv::Mat median = LocalMedian(gray);
  const auto is_highlight = [&](int y, int x) {
    const int level = gray.at<std::uint8_t>(y, x);
    if (level >= options.highlight_level) return true;
    return level >= options.highlight_near_level &&
           std::max(0, level - median.at<std::uint8_t>(y, x)) >= options.highlight_contrast &&
           IsPale(image, y, x, options.highlight_saturation);
  };
  for (int y = 0; y < mask.rows; ++y) {
    auto* row = mask.ptr<std::uint8_t>(y);
    const auto* end = row + mask.cols;
    for (auto* at = std::find(row, row + mask.cols, 255); at != end; at = std::find(at + 1, row + mask.cols, 255))
      if (!is_highlight(y, static_cast<int>(at - row))) *at = 0;
  }
  if (options.highlight_dilation_px > 0) cv::dilate(mask, mask, Disc(options.highlight_dilation_px));
  return mask;
}

}  // namespace

void MaskOptions::List(OptionTable& table) {
  table.BeginGroup("Masks", "pixels that do not show the scene");
  table.AddChoice("highlights", &highlights, "find specular highlights: they move with the light, not with the tissue");
  table.Add("highlight_level", &highlight_level, "gray levels", "brighter pixels are highlights, whatever their color",
            1, 255);
  table.Add("highlight_near_level", &highlight_near_level, "gray levels",
            "brighter pixels are highlights if pale and brighter than their surroundings", 1, 255);
  table.Add("highlight_saturation", &highlight_saturation, "-", "color saturation below which a bright pixel is pale",
            0, 1);
  table.Add("highlight_contrast", &highlight_contrast, "gray levels",
            "how far a pale pixel must stand out from the local median", 0, 255);
  table.Add("highlight_dilation_px", &highlight_dilation_px, "px", "the halo of a highlight moves with it", 0, 50);
  table.AddChoice("border", &border, "find the dark surroundings of a round or octagonal field of view");
  table.Add("border_level", &border_level, "gray levels", "the surroundings are darker than this", 0, 255);
  table.Add("border_dilation_px", &border_dilation_px, "px", "the rim is blurred and does not move with the scene", 0,
            50);
}

cv::Mat HighlightMask(const cv::Mat& image, const MaskOptions& options) {
  return HighlightMaskOf(image, ToGray(image), options);
}

cv::Mat DarkBorderMask(const cv::Mat& gray, const MaskOptions& options) {
  assert(gray.type() == CV_8UC1);
  cv::Mat small;
  const cv::Size small_size(std::max(1, gray.cols / kBorderScale), std::max(1, gray.rows / kBorderScale));
  cv::resize(gray, small, small_size, 0, 0, cv::INTER_AREA);
  cv::Mat bright = small >= options.border_level;
  cv::morphologyEx(bright, bright, cv::MORPH_OPEN, Disc(1));
  cv::Mat labels, stats, centroids;
  const int count = cv::connectedComponentsWithStats(bright, labels, stats, centroids, 8, CV_32S);
  cv::Mat view = cv::Mat::zeros(bright.size(), CV_8UC1);
  for (int i = 1; i < count; ++i)
    if (stats.at<int>(i, cv::CC_STAT_AREA) >= kMinViewArea * bright.rows * bright.cols) view.setTo(255, labels == i);

  // Fields of view are convex. What is dark inside their hull (a lumen, a shadow) belongs to the scene.
  cv::Mat mask(gray.size(), CV_8UC1, cv::Scalar(255));
  const std::vector<cv::Point> ends = RowEnds(view, gray.size());
  if (ends.empty()) return mask;
  std::vector<cv::Point> hull;
  cv::convexHull(ends, hull);
  cv::fillConvexPoly(mask, hull, cv::Scalar(0));
  if (options.border_dilation_px > 0 && cv::countNonZero(mask) > 0)
    cv::dilate(mask, mask, Disc(options.border_dilation_px));
  return mask;
}

cv::Mat ValidMask(const cv::Mat& image, const cv::Mat& given, const MaskOptions& options) {
  assert(given.empty() || (given.type() == CV_8UC1 && given.size() == image.size()));
  cv::Mat valid(image.size(), CV_8UC1, cv::Scalar(255));
  if (!given.empty()) valid.setTo(0, given == 0);
  if (options.highlights == Switch::kOff && options.border == Switch::kOff) return valid;
  const cv::Mat gray = ToGray(image);
  if (options.highlights == Switch::kOn) valid.setTo(0, HighlightMaskOf(image, gray, options));
  if (options.border == Switch::kOn) valid.setTo(0, DarkBorderMask(gray, options));
  return valid;
}

SupportMask::SupportMask(const cv::Mat& valid) : valid_(valid) {
  assert(valid.type() == CV_8UC1 && !valid.empty());
  cv::Mat ones;
  cv::threshold(valid, ones, 0, 1, cv::THRESH_BINARY);
  cv::integral(ones, integral_, CV_32S);
}

double SupportMask::Fraction(int x, int y, int radius) const {
  if (unrestricted()) return 1;
  const int left = std::clamp(x - radius, 0, valid_.cols);
  const int right = std::clamp(x + radius + 1, 0, valid_.cols);
  const int top = std::clamp(y - radius, 0, valid_.rows);
  const int bottom = std::clamp(y + radius + 1, 0, valid_.rows);
  const int sum = integral_.at<int>(bottom, right) - integral_.at<int>(top, right) - integral_.at<int>(bottom, left) +
                  integral_.at<int>(top, left);
  return static_cast<double>(sum) / ((2 * radius + 1) * (2 * radius + 1));
}

bool SupportMask::Valid(int x, int y) const {
  if (unrestricted()) return true;
  return x >= 0 && y >= 0 && x < valid_.cols && y < valid_.rows && valid_.at<std::uint8_t>(y, x) != 0;
}

cv::Mat ErodeMask(const cv::Mat& valid, int radius_px) {
  if (radius_px <= 0) return valid.clone();
  cv::Mat eroded;
  const cv::Size side(2 * radius_px + 1, 2 * radius_px + 1);
  cv::erode(valid, eroded, cv::getStructuringElement(cv::MORPH_RECT, side), cv::Point(-1, -1), 1, cv::BORDER_CONSTANT,
            cv::Scalar(0));
  return eroded;
}

}  // namespace pliant
