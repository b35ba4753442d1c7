// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/corners.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <functional>

#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

constexpr double kSamePoint_px = 1;  // nearer ones are one point, whatever the options say

constexpr double kReferenceQuantile = 0.99;  // of the local maxima: a few highlights do not set the scale
// Smallest response of a corner, (gray levels / px)^2 of the mean tensor: below it is the noise of an 8-bit image.
constexpr double kNoiseFloor = 0.5;
// OpenCV's response is the mean tensor of gradients in units of half a gray level / 255 a pixel.
constexpr double kTensorScale = 255.0 * 255.0 / 4.0;

// Peak of the parabola through three equidistant samples, within half a pixel.
double ParabolaPeak(double left, double center, double right) {
  const double curvature = left - 2 * center + right;
  return curvature < 0 ? std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5) : 0;
}

// Rows of an image of which the response is computed at a time: its temporaries stay in the cache.
constexpr int kStripRows = 64;

// Adds the local maxima of the corner response in the rows [begin, end), without the image's first and last one.
void AddCandidates(const cv::Mat& gray, const cv::Mat& usable, int begin, int end, int block_size_px,
                   std::vector<Corner>* corners) {
  // A maximum is compared with its neighbors, whose windows of gradients reach beyond the strip.
  const int margin = block_size_px / 2 + 2;
  const int top = std::max(0, begin - margin);
  cv::Mat response, peaks;
  cv::cornerMinEigenVal(gray.rowRange(top, std::min(gray.rows, end + margin)), response, block_size_px, 3);
  cv::dilate(response, peaks, cv::Mat());
  for (int y = begin; y < end; ++y) {
    const auto* row = response.ptr<float>(y - top);
    const auto* above = response.ptr<float>(y - top - 1);
    const auto* below = response.ptr<float>(y - top + 1);
    const auto* peak = peaks.ptr<float>(y - top);
    const auto* use = usable.ptr<std::uint8_t>(y);
    for (int x = 1; x + 1 < gray.cols; ++x) {
      if (use[x] == 0 || row[x] < peak[x] || row[x] <= 0) continue;
      Corner corner;
      corner.pixel = {x + ParabolaPeak(row[x - 1], row[x], row[x + 1]), y + ParabolaPeak(above[x], row[x], below[x])};
      corner.score = row[x] * kTensorScale;
      corners->push_back(corner);
    }
  }
}

// Local maxima of the corner response on usable pixels, by row, then column.
std::vector<Corner> Candidates(const cv::Mat& gray, const cv::Mat& valid, const CornerOptions& options) {
  const cv::Mat usable = ErodeMask(valid, options.border_px);
  std::vector<Corner> corners;
  for (int begin = 1; begin + 1 < gray.rows; begin += kStripRows)
    AddCandidates(gray, usable, begin, std::min(begin + kStripRows, gray.rows - 1), options.block_size_px, &corners);
  return corners;
}

void DropWeak(double quality_level, std::vector<Corner>* corners) {
  if (corners->empty()) return;
  std::vector<double> scores;
  scores.reserve(corners->size());
  for (const Corner& corner : *corners) scores.push_back(corner.score);
  const auto rank = static_cast<std::ptrdiff_t>((1 - kReferenceQuantile) * static_cast<double>(scores.size()));
  std::nth_element(scores.begin(), scores.begin() + rank, scores.end(), std::greater<>());
  const double limit = std::max(quality_level * scores[static_cast<std::size_t>(rank)], kNoiseFloor);
  std::erase_if(*corners, [&](const Corner& c) { return c.score < limit; });
}

// Square cells, about one for every wanted corner, each with the points that lie in it.
class Cells {
 public:
  Cells(cv::Size size, double side)
      : side_(side), cols_(static_cast<int>(size.width / side) + 1), rows_(static_cast<int>(size.height / side) + 1) {
    taken_.resize(static_cast<std::size_t>(cols_) * static_cast<std::size_t>(rows_));
  }
  std::size_t Index(const Eigen::Vector2d& p) const {
    const int col = std::clamp(static_cast<int>(p.x() / side_), 0, cols_ - 1);
    const int row = std::clamp(static_cast<int>(p.y() / side_), 0, rows_ - 1);
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(col);
  }
  void Take(const Eigen::Vector2d& p) { taken_[Index(p)].push_back(p); }
  int count(std::size_t cell) const { return static_cast<int>(taken_[cell].size()); }
  bool Crowded(const Eigen::Vector2d& p, double distance) const {
    const int reach = static_cast<int>(std::ceil(distance / side_));
    const int col = static_cast<int>(p.x() / side_);
    const int row = static_cast<int>(p.y() / side_);
    for (int r = std::max(0, row - reach); r <= std::min(rows_ - 1, row + reach); ++r)
      for (int c = std::max(0, col - reach); c <= std::min(cols_ - 1, col + reach); ++c)
        for (const auto& other :
             taken_[static_cast<std::size_t>(r) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(c)])
          if ((other - p).squaredNorm() < distance * distance) return true;
    return false;
  }

 private:
  double side_;
  int cols_, rows_;
  std::vector<std::vector<Eigen::Vector2d>> taken_;
};

}  // namespace

void CornerOptions::List(OptionTable& table) {
  table.BeginGroup("Corners", "points worth following");
  table.Add("max_corners", &max_corners, "-", "more points cost time in every frame", 1, 100000);
  table.Add("quality_level", &quality_level, "-", "share of the strong corners' response below which is noise", 0, 1);
  table.Add("min_distance_px", &min_distance_px, "px", "closer corners say the same thing twice", 0, 1000);
  table.Add("border_px", &border_px, "px", "distance to the image's edge and to masked pixels: a patch must fit", 1,
            200);
  table.Add("block_size_px", &block_size_px, "px", "window of the structure tensor", 3, 31);
  table.AddChoice("contour_filter", &contour_filter,
                  "keep corners off occluding contours: what is seen there slides over the surface");
  table.Add("contour_threshold", &contour_threshold, "-", "contour measure above which a corner is dropped", 0, 1);
  table.Add("contour_radius_px", &contour_radius_px, "px", "how far to each side brightness is compared", 2, 200);
}

// Rounds: in round k every cell that holds k points takes its strongest candidate left, strong cells first, until
// enough are taken. So each part of the image gets its share before any part gets more.
std::vector<std::size_t> SpreadPoints(std::span<const Eigen::Vector2d> pixels, const cv::Mat& valid,
                                      std::span<const Eigen::Vector2d> existing, const CornerOptions& options,
                                      const std::function<bool(std::size_t)>& accepts) {
  const double area = std::max(1, cv::countNonZero(valid));
  const double wanted = options.max_corners + static_cast<double>(existing.size());
  Cells cells(valid.size(), std::max({std::sqrt(area / wanted), options.min_distance_px, 1.0}));
  for (const Eigen::Vector2d& p : existing) cells.Take(p);
  std::vector<std::size_t> chosen;
  std::vector<char> done(pixels.size(), 0);
  std::size_t left = pixels.size();
  const auto limit = static_cast<std::size_t>(options.max_corners);
  for (int round = 0; left > 0 && chosen.size() < limit; ++round) {
    for (std::size_t i = 0; i < pixels.size() && chosen.size() < limit; ++i) {
      if (done[i] != 0 || cells.count(cells.Index(pixels[i])) > round) continue;
      done[i] = 1;
      --left;
      if (cells.Crowded(pixels[i], std::max(options.min_distance_px, kSamePoint_px))) continue;
      if (accepts && !accepts(i)) continue;
      cells.Take(pixels[i]);
      chosen.push_back(i);
    }
  }
  return chosen;
}

std::vector<Corner> DetectCorners(const cv::Mat& gray, const cv::Mat& valid, std::span<const Eigen::Vector2d> existing,
                                  const CornerOptions& options) {
  assert(gray.type() == CV_8UC1 && !gray.empty());
  assert(valid.empty() || (valid.type() == CV_8UC1 && valid.size() == gray.size()));
  const cv::Mat usable = valid.empty() ? cv::Mat(gray.size(), CV_8UC1, cv::Scalar(255)) : valid;
  std::vector<Corner> candidates = Candidates(gray, usable, options);
  DropWeak(options.quality_level, &candidates);
  std::ranges::stable_sort(candidates, std::greater<>(), &Corner::score);  // ties stay by row, then column
  std::vector<Eigen::Vector2d> pixels;
  for (const Corner& candidate : candidates) pixels.push_back(candidate.pixel);
  const ContourMeasure contours(gray, options.contour_radius_px);
  const auto is_off_contours = [&](std::size_t i) {
    candidates[i].contour = contours.At(candidates[i].pixel);
    return options.contour_filter == Switch::kOff || candidates[i].contour <= options.contour_threshold;
  };
  std::vector<Corner> corners;
  for (const std::size_t i : SpreadPoints(pixels, usable, existing, options, is_off_contours))
    corners.push_back(candidates[i]);
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return a.pixel.y() != b.pixel.y() ? a.pixel.y() < b.pixel.y() : a.pixel.x() < b.pixel.x();
  });
  return corners;
}

}  // namespace pliant
