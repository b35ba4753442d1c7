// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracks/image_statistics.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "pliant/base/statistics.h"
#include "pliant/image/masks.h"
#include "tracking/tracks/followed_corners.h"

namespace pliant {
namespace {

using Track = std::vector<Eigen::Vector2d>;

constexpr int kMinPixels = 100;
constexpr int kTrackNeighbors = 12;
constexpr double kVarianceOfMedian = 0.117;  // of 12 standard normal values

// The median of whole numbers that are real ones rounded: between its neighbors by how many lie on either side.
double MedianOfCounts(std::span<const int> counts, int total) {
  double below = 0;
  for (std::size_t value = 0; value < counts.size(); ++value) {
    if (below + counts[value] < 0.5 * total) {
      below += counts[value];
      continue;
    }
    const double share = (0.5 * total - below) / counts[value];
    // Absolute values: those that were rounded to 0 come from 0 to a half.
    return value == 0 ? 0.5 * share : static_cast<double>(value) - 0.5 + share;
  }
  return 0;
}

// Where a track is at the middle one of three frames, and its second difference there.
struct Bend {
  Eigen::Vector2d pixel;
  Eigen::Vector2d second_difference;
};

Eigen::Vector2d MedianOfNeighbors(std::span<const Bend> bends, std::size_t of) {
  std::vector<std::pair<double, std::size_t>> nearest;
  for (std::size_t i = 0; i < bends.size(); ++i)
    if (i != of) nearest.emplace_back((bends[i].pixel - bends[of].pixel).squaredNorm(), i);
  std::ranges::nth_element(nearest, nearest.begin() + kTrackNeighbors - 1);
  std::array<std::vector<double>, 2> differences;
  for (int k = 0; k < kTrackNeighbors; ++k)
    for (int axis = 0; axis < 2; ++axis) differences[axis].push_back(bends[nearest[k].second].second_difference[axis]);
  return {Median(differences[0]), Median(differences[1])};
}

int CountAlive(std::span<const Track> tracks, std::size_t after) {
  return static_cast<int>(std::ranges::count_if(tracks, [&](const Track& track) { return track.size() > after; }));
}

}  // namespace

double ImageNoise(const cv::Mat& gray, const cv::Mat& valid) {
  assert(gray.type() == CV_8UC1);
  constexpr int kBlack = 2;
  constexpr int kWhite = 253;
  cv::Mat usable;
  cv::inRange(gray, kBlack, kWhite, usable);
  if (!valid.empty()) usable &= valid;
  usable = ErodeMask(usable, 1);
  const cv::Mat kernel = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::Mat filtered;
  cv::filter2D(gray, filtered, CV_16S, kernel);
  std::vector<int> counts(8 * 255 + 1, 0);
  int total = 0;
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      if (usable.at<std::uint8_t>(y, x) == 0) continue;
      ++counts[static_cast<std::size_t>(std::abs(filtered.at<std::int16_t>(y, x)))];
      ++total;
    }
  }
  return total < kMinPixels ? 0.0 : kMedianToSigma * MedianOfCounts(counts, total) / 6.0;
}

std::vector<double> TrackResiduals(std::span<const Track> tracks) {
  std::size_t frames = 0;
  for (const Track& track : tracks) frames = std::max(frames, track.size());
  std::vector<double> residuals;
  for (std::size_t k = 1; k + 1 < frames; ++k) {
    std::vector<Bend> bends;
    for (const Track& track : tracks)
      if (track.size() > k + 1) bends.push_back({track[k], track[k + 1] - 2 * track[k] + track[k - 1]});
    if (bends.size() <= kTrackNeighbors) continue;
    for (std::size_t i = 0; i < bends.size(); ++i) {
      const Eigen::Vector2d residual = bends[i].second_difference - MedianOfNeighbors(bends, i);
      residuals.insert(residuals.end(), {residual.x(), residual.y()});
    }
  }
  return residuals;
}

double TrackNoise(std::vector<double> residuals_px) {
  for (double& residual : residuals_px) residual = std::abs(residual);
  return kMedianToSigma * Median(std::move(residuals_px)) / std::sqrt(6.0 * (1.0 + kVarianceOfMedian));
}

RunMeasurement MeasureRun(std::span<const PreparedFrame> frames, const TrackerOptions& options, int threads) {
  RunMeasurement run;
  for (const PreparedFrame& frame : frames) run.noise_levels.push_back(ImageNoise(frame.gray, frame.mask.valid()));
  const std::size_t length = std::min(frames.size(), static_cast<std::size_t>(kStatisticsRunFrames));
  const std::vector<Track> tracks = FollowCorners(frames.first(length), options, threads);
  run.corners = static_cast<int>(tracks.size());
  run.alive_after_1 = CountAlive(tracks, 1);
  run.alive_after_9 = CountAlive(tracks, kStatisticsRunFrames - 1);
  run.track_residuals_px = TrackResiduals(tracks);
  return run;
}

ImageStatistics Summarize(std::span<const RunMeasurement> runs) {
  ImageStatistics all;
  if (runs.empty()) return all;
  std::vector<double> noise_levels;
  std::vector<double> residuals_px;
  for (const RunMeasurement& run : runs) {
    noise_levels.insert(noise_levels.end(), run.noise_levels.begin(), run.noise_levels.end());
    residuals_px.insert(residuals_px.end(), run.track_residuals_px.begin(), run.track_residuals_px.end());
    all.corners += run.corners;
    all.alive_after_1 += run.alive_after_1;
    all.alive_after_9 += run.alive_after_9;
  }
  all.frames = static_cast<int>(noise_levels.size());
  all.noise_levels = Median(std::move(noise_levels));
  all.track_noise_px = TrackNoise(std::move(residuals_px));
  if (all.corners > 0) {
    all.alive_after_1 /= all.corners;
    all.alive_after_9 /= all.corners;
  }
  all.corners /= static_cast<double>(runs.size());
  return all;
}

ImageStatistics MeasureImageStatistics(std::span<const PreparedFrame> frames, const TrackerOptions& options,
                                       int threads) {
  constexpr std::size_t kLength = kStatisticsRunFrames;
  std::vector<RunMeasurement> runs;
  for (std::size_t first = 0; first + kLength <= frames.size(); first += kLength)
    runs.push_back(MeasureRun(frames.subspan(first, kLength), options, threads));
  return Summarize(runs);
}

}  // namespace pliant
