// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Plain statistics of a list of numbers. Of an empty list each is 0.
#pragma once

#include <span>
#include <vector>

namespace pliant {

// The middle value; the mean of the two middle ones of an even count.
double Median(std::vector<double> values);
// The same without a copy; their order is lost.
double MedianInPlace(std::span<double> values);
// The value below which `share` (0 to 1) of them lie, between the two nearest ones by their distance (NumPy's default).
double Quantile(std::vector<double> values, double share);
double Mean(const std::vector<double>& values);
// How far the mean may be off: the values' standard deviation by the square root of their number. Of one value 0.
double StandardError(const std::vector<double>& values);
// The median of |value - median|.
double MedianDeviation(std::vector<double> values);
// By this a median of absolute errors becomes the standard deviation of a normal distribution.
inline constexpr double kMedianToSigma = 1.4826;
// Spearman's: -1 where `b` falls as `a` grows to 1 where it grows, 0 where one of them does not vary. Both are as long.
double RankCorrelation(const std::vector<double>& a, const std::vector<double>& b);
// Root of the mean square.
double Rms(const std::vector<double>& values);

}  // namespace pliant
