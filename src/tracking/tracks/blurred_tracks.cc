// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/tracks/blurred_tracks.h"

#include <algorithm>
#include <array>
#include <cassert>

#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

// How blurred an image may be, and how much smaller it then is.
struct Blur {
  double sigma_px;
  int shrink;
};
constexpr std::array kBlurs = {Blur{2, 2}, Blur{3, 2}, Blur{4, 4}, Blur{6, 4}};

// Pixel (0, 0) is the center of the first one in both.
Eigen::Vector2d Shrunk(const Eigen::Vector2d& pixel, int shrink) {
  return (pixel + Eigen::Vector2d::Constant(0.5)) / shrink - Eigen::Vector2d::Constant(0.5);
}
Eigen::Vector2d Enlarged(const Eigen::Vector2d& pixel, int shrink) {
  return shrink * (pixel + Eigen::Vector2d::Constant(0.5)) - Eigen::Vector2d::Constant(0.5);
}

cv::Size Shrunk(const cv::Size& size, int shrink) {
  const auto side = [&](int full) { return std::max(1, cvRound(full / static_cast<double>(shrink))); };
  return {side(size.width), side(size.height)};
}

ImagePyramid SmallPyramid(const cv::Mat& gray, int shrink, int levels) {
  cv::Mat small;
  cv::resize(gray, small, Shrunk(gray.size(), shrink), 0, 0, cv::INTER_AREA);
  return ImagePyramid(small, levels);
}

SupportMask SmallMask(const SupportMask& mask, int shrink) {
  if (mask.unrestricted()) return {};
  cv::Mat small;
  cv::resize(mask.valid(), small, Shrunk(mask.valid().size(), shrink), 0, 0, cv::INTER_NEAREST);
  return SupportMask(small);
}

}  // namespace

int CountTracked(std::span<const PointTrack> tracks) {
  return static_cast<int>(
      std::ranges::count(tracks, PatchFailure::kNone, [](const PointTrack& track) { return track.failure; }));
}

std::vector<PointTrack> TrackIntoBlur(const PreparedFrame& sharp, const PreparedFrame& blurred,
                                      std::span<const Eigen::Vector2d> pixels,
                                      std::span<const PointPrediction> predictions, const PointTrackerOptions& options,
                                      int threads) {
  assert(pixels.size() == predictions.size());
  PointTrackerOptions once = options;  // there is no earlier image to compare with
  once.patch_policy = PatchPolicy::kPeriodic;
  once.refresh_period = 1000000;
  std::vector<PointTrack> best;
  for (const Blur& blur : kBlurs) {
    cv::Mat as_blurred;
    cv::GaussianBlur(sharp.gray, as_blurred, cv::Size(), blur.sigma_px, blur.sigma_px, cv::BORDER_REPLICATE);
    const ImagePyramid before = SmallPyramid(as_blurred, blur.shrink, options.lucas_kanade.levels);
    const ImagePyramid now = SmallPyramid(blurred.gray, blur.shrink, options.lucas_kanade.levels);
    const SupportMask before_mask = SmallMask(sharp.mask, blur.shrink);
    const SupportMask now_mask = SmallMask(blurred.mask, blur.shrink);
    PointTracker tracker(once);
    std::vector<PointPrediction> small(predictions.begin(), predictions.end());
    for (std::size_t k = 0; k < small.size(); ++k) {
      tracker.Add(small[k].id, Shrunk(pixels[k], blur.shrink), before, before_mask);
      small[k].pixel = Shrunk(small[k].pixel, blur.shrink);
    }
    std::vector<PointTrack> tracks = tracker.Track(before, before_mask, now, now_mask, small, threads);
    for (PointTrack& track : tracks) track.pixel = Enlarged(track.pixel, blur.shrink);
    if (best.empty() || CountTracked(tracks) > CountTracked(best)) best = std::move(tracks);
  }
  return best;
}

}  // namespace pliant
