// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Interlaced images: the odd rows were exposed later than the even ones, so that whatever moves has a comb for an edge,
// and no point is where the image shows it.
#pragma once

#include <opencv2/core/mat.hpp>

namespace pliant {

// How much more neighboring rows alternate than neighboring columns do. With s the second difference over three
// neighbors: the square root of the ratio of the mean of max(0, -s s'), s' being the next one, along columns to that
// along rows; in the median of rows or columns. About 1 for other images (0.7 to 2 in real ones), and in those that
// stand still; larger where an interlaced image moves. Any depth and channels of cv::cvtColor's BGR or gray; 1 for
// images of fewer than 8 rows or columns.
double CombRatio(const cv::Mat& image);

// The image of the even rows: each odd one is the mean of its neighbors. Size and type stay; a copy.
cv::Mat WithoutOddRows(const cv::Mat& image);

}  // namespace pliant
