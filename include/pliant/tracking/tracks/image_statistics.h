// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What images are like for a point tracker, in numbers that can be compared between recordings and with a simulation:
// how much they are noisy, how many corners they have, how long these last and how exactly they are followed.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/tracking/prepared_frame.h"
#include "pliant/tracking/tracker_options.h"

namespace pliant {

struct ImageStatistics {
  int frames = 0;             // that were measured
  double noise_levels = 0;    // ImageNoise in the median of the frames, gray levels of 255
  double corners = 0;         // of a frame that can be tracked at all, in the mean of the runs
  double alive_after_1 = 0;   // share of them that are tracked into the next frame, 0 to 1
  double alive_after_9 = 0;   // through all of the next nine frames
  double track_noise_px = 0;  // TrackNoise of all runs
};

// The frames of a run: corners are detected in the first one and tracked through the others.
inline constexpr int kStatisticsRunFrames = 10;

// Standard deviation of the noise of an image, gray levels: 1.4826 times the median of |L| / 6, where L is the image
// filtered by (1 -2 1, -2 4 -2, 1 -2 1), to which edges and shading give nothing and white noise six times its
// deviation. Noise that is correlated between pixels counts less. Rounding to gray levels alone gives about 0.3. Over
// the pixels whose 3 x 3 neighborhood is valid and neither black (below 2) nor white (above 253). `gray` is CV_8UC1,
// `valid` as of a SupportMask, or empty. 0 where fewer than 100 pixels are left.
// Source: Immerkaer, Fast Noise Variance Estimation, CVIU 1996, with the median in place of the mean.
double ImageNoise(const cv::Mat& gray, const cv::Mat& valid);

// How far tracks deviate from their neighbors' motion between three frames, one value a coordinate, px: the second
// difference in time of a track, p(k+1) - 2 p(k) + p(k-1), minus the median of that of the 12 nearest tracks (at time
// k) that were seen in all three. tracks[i][k] is the pixel of track i in frame k of the run, as far as it was found.
// Frames in which fewer than 13 tracks have one give nothing.
std::vector<double> TrackResiduals(std::span<const std::vector<Eigen::Vector2d>> tracks);

// Standard deviation of one coordinate of a track, px, from such residuals: 1.4826 times the median of their absolute
// values, divided by the deviation that noise of 1 px, independent from frame to frame and track to track, gives them:
// sqrt(6 (1 + 0.117)), 6 from the second difference and 0.117 from the median of 12 others. Smooth motion adds nothing
// where neighbors share it. 0 where there are no residuals.
double TrackNoise(std::vector<double> residuals_px);

// What one run shows; several are summarized together.
struct RunMeasurement {
  std::vector<double> noise_levels = {};  // one a frame
  int corners = 0;
  int alive_after_1 = 0;
  int alive_after_9 = 0;
  std::vector<double> track_residuals_px = {};
};

// Of frames that follow each other, kStatisticsRunFrames of them or more (later ones are not tracked into; of a shorter
// run nothing is alive after the frames that it lacks). `options`: corners, masks and point tracker count.
RunMeasurement MeasureRun(std::span<const PreparedFrame> frames, const TrackerOptions& options, int threads);
ImageStatistics Summarize(std::span<const RunMeasurement> runs);

// Of frames that follow each other, cut into runs; frames after the last whole run are left out. All 0 for fewer than
// kStatisticsRunFrames frames. The result does not depend on `threads`.
ImageStatistics MeasureImageStatistics(std::span<const PreparedFrame> frames, const TrackerOptions& options,
                                       int threads);

}  // namespace pliant
