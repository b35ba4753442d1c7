// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/find_overlay.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "pliant/base/statistics.h"
#include "pliant/image/serialize.h"

namespace pliant {
namespace {

constexpr std::size_t kMinSamples = 20;  // a pixel may stay the same in fewer by chance
constexpr double kDarkLevel = 32;        // gray levels on average: darker is the surroundings of the view
// Of a pixel's levels over time the 10 % and 90 % quantiles count, so that single images do not; between them a normal
// distribution has 2.56 standard deviations.
constexpr double kLowQuantile = 0.1;
constexpr double kHighQuantile = 0.9;
// A pixel that never changes does so by less than this part of what pixels change by in the median. An overlay keeps
// what the codec makes of its moving surroundings.
constexpr double kStillShare = 0.15;
constexpr double kMinChange = 1 / kStillShare;  // gray levels: with less, a still pixel would change by less than one
// A sharp edge has this many times the contrast that nine in ten pixels of the recording stay below.
constexpr double kSharpTimes = 1.5;
constexpr double kSharpQuantile = 0.9;
constexpr double kMinSize = 3e-4;       // of the grid's pixels: a few letters
constexpr double kMaxStillShare = 0.3;  // of the lit pixels: where more are still, the camera or the scene is
constexpr double kGap = 0.015;          // of the grid's width: what is as near belongs together

// How each pixel of the grid behaves over time.
struct PixelStatistics {
  cv::Mat_<float> change;    // between the quantiles, gray levels
  cv::Mat_<float> level;     // mean
  cv::Mat_<float> contrast;  // mean
  cv::Mat_<std::uint8_t> lit;
};

float Spread(std::vector<std::uint8_t>* levels) {
  const auto place = [&](double share) {
    return levels->begin() + std::lround(share * static_cast<double>(levels->size() - 1));
  };
  std::nth_element(levels->begin(), place(kLowQuantile), levels->end());
  const float low = *place(kLowQuantile);
  std::nth_element(levels->begin(), place(kHighQuantile), levels->end());
  return static_cast<float>(*place(kHighQuantile)) - low;
}

PixelStatistics Measure(const std::vector<GridSample>& samples) {
  const cv::Size size = samples.front().gray.size();
  PixelStatistics statistics{cv::Mat_<float>(size), cv::Mat_<float>(size), cv::Mat_<float>(size),
                             cv::Mat_<std::uint8_t>(size)};
  std::vector<std::uint8_t> levels(samples.size());
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      double sum = 0;
      double contrast = 0;
      bool valid = true;
      for (std::size_t k = 0; k < samples.size(); ++k) {
        levels[k] = samples[k].gray.at<std::uint8_t>(y, x);
        sum += levels[k];
        contrast += samples[k].contrast.at<std::uint8_t>(y, x);
        valid = valid && (samples[k].valid.empty() || samples[k].valid.at<std::uint8_t>(y, x) != 0);
      }
      const auto count = static_cast<double>(samples.size());
      statistics.level(y, x) = static_cast<float>(sum / count);
      statistics.contrast(y, x) = static_cast<float>(contrast / count);
      statistics.lit(y, x) = valid && sum / count > kDarkLevel ? 255 : 0;
      statistics.change(y, x) = Spread(&levels);
    }
  }
  return statistics;
}

std::vector<double> ValuesAt(const cv::Mat_<float>& values, const cv::Mat_<std::uint8_t>& where) {
  std::vector<double> found;
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x)
      if (where(y, x) != 0) found.push_back(values(y, x));
  return found;
}

// The contrast of single images, not of pixels over time: an overlay is little of that.
double SharpContrast(const std::vector<GridSample>& samples, const cv::Mat_<std::uint8_t>& lit) {
  std::vector<double> contrasts;
  const std::size_t every = (samples.size() + kMinSamples - 1) / kMinSamples;  // some are enough
  for (std::size_t k = 0; k < samples.size(); k += every) {
    const cv::Mat_<float> contrast = cv::Mat_<std::uint8_t>(samples[k].contrast);
    const std::vector<double> of_sample = ValuesAt(contrast, lit);
    contrasts.insert(contrasts.end(), of_sample.begin(), of_sample.end());
  }
  return kSharpTimes * Quantile(std::move(contrasts), kSharpQuantile);
}

// The largest group of pixels, if it is large enough.
std::optional<cv::Rect> LargestGroup(const cv::Mat_<std::uint8_t>& pixels) {
  const int reach = std::max(1, static_cast<int>(kGap * pixels.cols));
  cv::Mat joined;
  cv::dilate(pixels, joined, cv::Mat::ones(2 * reach + 1, 2 * reach + 1, CV_8U));
  cv::Mat labels;
  const int groups = cv::connectedComponents(joined, labels);
  std::vector<std::vector<cv::Point>> members(static_cast<std::size_t>(groups));
  for (int y = 0; y < pixels.rows; ++y)
    for (int x = 0; x < pixels.cols; ++x)
      if (pixels(y, x) != 0) members[static_cast<std::size_t>(labels.at<int>(y, x))].emplace_back(x, y);
  const auto largest = std::max_element(members.begin(), members.end(),
                                        [](const auto& a, const auto& b) { return a.size() < b.size(); });
  if (static_cast<double>(largest->size()) < kMinSize * static_cast<double>(pixels.total())) return std::nullopt;
  return cv::boundingRect(*largest);
}

}  // namespace

cv::Mat GridOf(const cv::Mat& image, int step) {
  cv::Mat grid((image.rows + step - 1) / step, (image.cols + step - 1) / step, image.type());
  for (int y = 0; y < grid.rows; ++y) {
    const std::uint8_t* from = image.ptr<std::uint8_t>(y * step);
    std::uint8_t* to = grid.ptr<std::uint8_t>(y);
    for (int x = 0; x < grid.cols; ++x) to[x] = from[x * step];
  }
  return grid;
}

GridSample SampleGrid(const cv::Mat& gray, const cv::Mat& mask, int step) {
  const cv::Mat around = cv::Mat::ones(3, 3, CV_8U);
  cv::Mat low;
  cv::Mat high;
  cv::erode(gray, low, around);
  cv::dilate(gray, high, around);
  return {GridOf(gray, step), GridOf(high - low, step), mask.empty() ? cv::Mat() : GridOf(mask, step)};
}

OverlaySearch FindOverlay(const std::vector<GridSample>& samples, int step) {
  if (samples.size() < kMinSamples) return {};
  const PixelStatistics statistics = Measure(samples);
  const std::vector<double> changes = ValuesAt(statistics.change, statistics.lit);
  if (changes.empty()) return {};
  const double change = Median(changes);
  if (change < kMinChange) return {};
  const auto still =
      std::count_if(changes.begin(), changes.end(), [&](double of_pixel) { return of_pixel < kStillShare * change; });
  if (static_cast<double>(still) > kMaxStillShare * static_cast<double>(changes.size())) return {};
  const double sharp = SharpContrast(samples, statistics.lit);
  // By its own level too: the rim of the view changes little because it is half as bright, or less.
  const cv::Mat_<float> relative = statistics.change / statistics.level;
  const double relative_change = Median(ValuesAt(relative, statistics.lit));
  cv::Mat_<std::uint8_t> found(statistics.lit.size(), 0);
  for (int y = 0; y < found.rows; ++y)
    for (int x = 0; x < found.cols; ++x)
      if (statistics.lit(y, x) != 0 && statistics.change(y, x) < kStillShare * change &&
          relative(y, x) < kStillShare * relative_change && statistics.contrast(y, x) > sharp)
        found(y, x) = 255;
  const auto group = LargestGroup(found);
  if (!group) return {true, std::nullopt};
  return {true, PixelRectangle{group->x * step, group->y * step, group->width * step, group->height * step}};
}

void Serialize(StateArchive& archive, GridSample& sample) { archive.Members<3>(sample); }

}  // namespace pliant
