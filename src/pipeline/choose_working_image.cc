// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/choose_working_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "pipeline/working_frame.h"
#include "pliant/base/statistics.h"
#include "pliant/image/interlacing.h"
#include "pliant/tracking/tracks/trackability.h"

namespace pliant {
namespace {

constexpr int kRuns = 3;
constexpr int kRunFrames = 16;  // about what a first map takes at least
constexpr int kRunDistance = 60;
// Where so many of the source's own corners last, its images are fine as they are.
constexpr double kLastingShare = 2.0 / 3.0;
// A count below says nothing.
constexpr int kMinAlive = 20;
// Of the working image's longer side, except where it is the source: smaller ones hold too little, larger ones cost
// more time than they give.
constexpr int kMinSide_px = 320;
constexpr int kMaxSide_px = 1300;
// Of a larger source the working image has so many pixels: a map of each pixel's texture would fill the memory.
constexpr double kMaxPixels = 12e6;
// Of all images that are looked at. Those of more than a few megapixels are fewer.
constexpr double kMaxImageBytes = 400e6;
constexpr std::array kScales = {1.0, 0.75, 1.5, 0.5, 2.0, 1.0 / 3.0, 0.25};  // nearest to the source first
constexpr std::array kSmoothings_px = {0.0, 0.7, 1.0, 1.4};
// Of patches in images whose corners do not last: twice the pixels, so that noise moves a patch by 0.7 times as much.
constexpr double kNoisyPatchScale = 1.41;
// CombRatio of the images that move most, a quarter of all: 14 and more of an interlaced laparoscopy, at most 1.6 of
// six recordings that are not.
constexpr double kMinCombRatio = 3.0;
constexpr double kMovingMost = 0.75;
constexpr std::size_t kCombEvery = 4;  // images of a run
constexpr int kCombSide_px = 1024;
// With which sizes are compared. At the source's own noise all large sizes would lose.
constexpr double kSmoothingOfSizes_px = 0.7;

// One a run; fewer where `watch` is stopped.
std::vector<Trackability> Measure(const std::vector<ImageRun>& runs, const WorkingImage& working,
                                  const TrackOptions& options, const ImageWatch& watch) {
  std::vector<Trackability> measured;
  const TrackerOptions tracker = WorkingOptions(options.tracker, working);
  for (const ImageRun& run : runs) {
    if (watch.IsStopped()) break;
    std::vector<PreparedFrame> frames;
    for (const SequenceFrame& frame : run) frames.push_back(PrepareWorkingFrame(frame, working, tracker));
    measured.push_back(MeasureTrackability(frames, tracker, options.threads));
  }
  return measured;
}

int SumOf(std::span<const Trackability> runs, int Trackability::*count) {
  int sum = 0;
  for (const Trackability& run : runs) sum += run.*count;
  return sum;
}

// The middle of an image, which is as interlaced as all of it.
cv::Mat MiddleOf(const cv::Mat& image) {
  const cv::Size size(std::min(image.cols, kCombSide_px), std::min(image.rows, kCombSide_px));
  return image({(image.cols - size.width) / 2, (image.rows - size.height) / 2, size.width, size.height});
}

bool IsInterlaced(const std::vector<ImageRun>& runs, const ImageOptions& options) {
  if (options.interlaced != Interlacing::kMeasured) return options.interlaced == Interlacing::kOn;
  if (options.working == WorkingImageMode::kFixed) return false;
  std::vector<double> ratios;
  for (const ImageRun& run : runs)
    for (std::size_t k = 0; k < run.size(); k += kCombEvery) ratios.push_back(CombRatio(MiddleOf(run[k].image)));
  return !ratios.empty() && Quantile(std::move(ratios), kMovingMost) > kMinCombRatio;
}

// Of working images, some of which are asked for more than once.
class Measurements {
 public:
  // All have to outlive this.
  Measurements(const std::vector<ImageRun>& runs, const TrackOptions& options, const ImageWatch& watch)
      : runs_(runs), options_(options), watch_(watch) {}

  int Alive(const WorkingImage& working) { return SumOf(Of(working), &Trackability::alive); }
  // In px of the source.
  double Information(const WorkingImage& working) { return TrackInformation(Of(working), working.scale); }

 private:
  const std::vector<Trackability>& Of(const WorkingImage& working) {
    const auto known =
        std::ranges::find(measured_, working, &std::pair<WorkingImage, std::vector<Trackability>>::first);
    if (known != measured_.end()) return known->second;
    return measured_.emplace_back(working, Measure(runs_, working, options_, watch_)).second;
  }

  const std::vector<ImageRun>& runs_;
  const TrackOptions& options_;
  const ImageWatch& watch_;
  std::vector<std::pair<WorkingImage, std::vector<Trackability>>> measured_;
};

// Small, so that a codec's noise averages out.
cv::Mat ThumbnailOf(const cv::Mat& image) {
  constexpr int kSide_px = 64;
  cv::Mat gray = image;
  if (image.channels() == 3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  cv::Mat small;
  cv::resize(gray, small, {kSide_px, kSide_px}, 0, 0, cv::INTER_AREA);
  return small;
}

// How many images there are before the first one that shows a view; 0 where the first ones do, or none does.
int CountLeadIn(const SequenceRequest& request, const ImageWatch& watch) {
  constexpr int kShortest = 15;
  constexpr int kLongest = 900;
  constexpr double kDark = 12.0;   // gray levels: the brightest of a black image with noise
  constexpr double kStill = 0.25;  // gray levels in the mean, from an image to the next
  constexpr int kAmong = 8;        // images, of which
  constexpr std::size_t kFew = 3;  // differ from the one before: others may be repeated, and a card may appear
  if (request.IsLive()) return 0;
  auto sequence = OpenSequence(request);
  if (!sequence.ok()) return 0;
  cv::Mat before;
  std::vector<int> changes;
  for (int k = 0; k < kLongest && !watch.IsStopped(); ++k) {
    const auto next = (*sequence)->Next();
    if (!next.ok() || !next->has_value()) return 0;
    if (k == 0 && watch.on_first) watch.on_first(**next);
    const cv::Mat now = ThumbnailOf((*next)->image);
    double brightest = 0;
    cv::minMaxLoc(now, nullptr, &brightest);
    if (brightest > kDark && !before.empty() &&
        cv::norm(now, before, cv::NORM_L1) > kStill * static_cast<double>(now.total()))
      changes.push_back(k);
    before = now;
    std::erase_if(changes, [&](int change) { return change <= k - kAmong; });
    if (changes.size() < kFew) continue;
    return changes.front() <= kShortest ? 0 : changes.front();
  }
  return 0;
}

// The first in which as many corners last as in the best, to the accuracy of a count; the first of all where none
// tells.
WorkingImage FirstAsGoodAsTheBest(const std::vector<WorkingImage>& candidates, Measurements* measurements) {
  std::vector<int> alive;
  for (const WorkingImage& candidate : candidates) alive.push_back(measurements->Alive(candidate));
  const int best = *std::ranges::max_element(alive);
  if (best < kMinAlive) return candidates.front();
  const auto chosen = std::ranges::find_if(alive, [&](int count) { return count >= best - std::sqrt(best); });
  return candidates[static_cast<std::size_t>(chosen - alive.begin())];
}

}  // namespace

std::vector<ImageRun> ReadFirstRuns(const SequenceRequest& of_all, const ImageWatch& watch) {
  SequenceRequest request = of_all;
  request.start += CountLeadIn(of_all, watch) * request.stride;
  auto sequence = OpenSequence(request);
  if (!sequence.ok()) return {};
  std::vector<ImageRun> runs(kRuns);
  // Images that have yet to come would be waited for.
  const int last_run = request.IsLive() ? 0 : kRuns - 1;
  double bytes = 0;
  double bytes_of_one = 0;
  for (int k = 0; k < last_run * kRunDistance + kRunFrames; ++k) {
    if (bytes + bytes_of_one > kMaxImageBytes) break;
    auto next = (*sequence)->Next();
    if (!next.ok() || !next->has_value()) break;
    if (watch.IsStopped()) return {};
    if (k == 0 && request.IsLive() && watch.on_first) watch.on_first(**next);
    if (k % kRunDistance >= kRunFrames) continue;
    bytes_of_one = static_cast<double>((*next)->image.total() * (*next)->image.elemSize());
    bytes += bytes_of_one;
    runs[static_cast<std::size_t>(k / kRunDistance)].push_back(**std::move(next));
  }
  return runs;
}

WorkingImage ChooseWorkingImage(const std::vector<ImageRun>& runs, const TrackOptions& options,
                                const ImageWatch& watch) {
  const bool follows_in_source = options.FollowsInSource();
  const WorkingImage as_read{.interlaced = !follows_in_source && IsInterlaced(runs, options.image)};
  WorkingImage fixed = as_read;
  fixed.scale = options.image.scale;
  fixed.smoothing_px = options.image.smoothing_px;
  if (options.image.working != WorkingImageMode::kMeasured || follows_in_source) return fixed;
  if (runs.empty() || runs.front().empty()) return as_read;
  const auto pixels = static_cast<double>(runs.front().front().image.total());
  if (pixels > kMaxPixels) return {.scale = std::sqrt(kMaxPixels / pixels), .interlaced = as_read.interlaced};
  if (runs.front().size() < 2) return as_read;
  const std::vector<Trackability> measured = Measure(runs, as_read, options, watch);
  const int corners = SumOf(measured, &Trackability::corners);
  if (corners >= kMinAlive && SumOf(measured, &Trackability::alive) >= kLastingShare * corners) return as_read;
  const cv::Size source = runs.front().front().image.size();
  std::vector<WorkingImage> sizes;
  for (const double scale : kScales) {
    const double side = scale * std::max(source.width, source.height);
    if (scale == 1 || (side >= kMinSide_px && side <= kMaxSide_px))
      sizes.push_back({scale, kSmoothingOfSizes_px, kNoisyPatchScale, as_read.interlaced});
  }
  Measurements measurements(runs, options, watch);
  const WorkingImage size = FirstAsGoodAsTheBest(sizes, &measurements);
  std::vector<WorkingImage> smoothings;
  for (const double smoothing_px : kSmoothings_px)
    smoothings.push_back({size.scale, smoothing_px, kNoisyPatchScale, as_read.interlaced});
  const WorkingImage chosen = FirstAsGoodAsTheBest(smoothings, &measurements);
  WorkingImage small_patches = chosen;
  small_patches.patch_scale = 1;
  // Pixels that are neither smoothed nor interpolated hold as much each as the source's: it is not noise that loses
  // the corners, and a larger patch crosses more folds.
  if (chosen.scale <= 1 && chosen.smoothing_px == 0) return small_patches;
  return measurements.Information(small_patches) >= measurements.Information(chosen) ? small_patches : chosen;
}

}  // namespace pliant
