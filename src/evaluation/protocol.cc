// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/protocol.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

double LeastSquaresScale(std::span<const PointPair> pairs) {
  double across = 0;
  double squared = 0;
  for (const PointPair& pair : pairs) {
    across += pair.estimate.dot(pair.truth);
    squared += pair.estimate.squaredNorm();
  }
  return squared > 0 ? across / squared : 1.0;
}

double MedianDepthRatio(std::span<const PointPair> pairs) {
  std::vector<double> ratios;
  for (const PointPair& pair : pairs)
    if (pair.estimate.z() > 0) ratios.push_back(pair.truth.z() / pair.estimate.z());
  return ratios.empty() ? 1.0 : Median(std::move(ratios));
}

// |s x - y|^2 of one pair as a parabola in s: least + curvature (s - vertex)^2.
struct Parabola {
  double vertex = 0;
  double least = 0;
  double curvature = 0;
};

// The middle of the scales at which at least `needed` parabolas lie at or below `level`; nothing: there are none.
// Among several such stretches the first one that is covered most.
bool CoveredScale(std::span<const Parabola> parabolas, double level, int needed,
                  std::vector<std::pair<double, int>>* ends, double* scale) {
  ends->clear();
  for (const Parabola& p : parabolas) {
    if (p.least > level) continue;
    const double half = std::sqrt((level - p.least) / p.curvature);
    ends->emplace_back(p.vertex - half, -1);  // sorted before an end at the same value
    ends->emplace_back(p.vertex + half, 1);
  }
  std::sort(ends->begin(), ends->end());
  int covered = 0;
  int most = needed - 1;
  for (std::size_t i = 0; i < ends->size(); ++i) {
    covered -= (*ends)[i].second;
    if (covered <= most) continue;
    most = covered;
    *scale = ((*ends)[i].first + (*ends)[i + 1].first) / 2;
  }
  return most >= needed;
}

// The exact least median of squares in one unknown, by bisection on the median's value: which scales keep the median
// below a level is a matter of intervals that overlap. The median of n is the value number n / 2 + 1.
double LeastMedianScale(std::span<const PointPair> pairs) {
  std::vector<Parabola> parabolas;
  std::vector<double> at_start;
  const double start = LeastSquaresScale(pairs);
  for (const PointPair& pair : pairs) {
    const double curvature = pair.estimate.squaredNorm();
    if (!(curvature > 0)) continue;
    const double vertex = pair.estimate.dot(pair.truth) / curvature;
    parabolas.push_back({vertex, (vertex * pair.estimate - pair.truth).squaredNorm(), curvature});
    at_start.push_back((start * pair.estimate - pair.truth).squaredNorm());
  }
  if (parabolas.empty()) return 1.0;
  const auto middle = static_cast<std::ptrdiff_t>(at_start.size() / 2);
  std::nth_element(at_start.begin(), at_start.begin() + middle, at_start.end());

  double high = at_start[static_cast<std::size_t>(middle)];
  double low = 0;
  double best = start;
  std::vector<std::pair<double, int>> ends;
  const int needed = static_cast<int>(middle) + 1;
  constexpr int kMaxSteps = 200;  // reached only where the least median is zero
  for (int step = 0; step < kMaxSteps && high - low > std::numeric_limits<double>::epsilon() * high; ++step) {
    const double level = low + (high - low) / 2;
    if (CoveredScale(parabolas, level, needed, &ends, &best))
      high = level;
    else
      low = level;
  }
  return best;
}

// The largest error that still counts.
double Threshold(std::vector<double> errors, ErrorProtocol protocol, const ProtocolOptions& options) {
  constexpr double kRounding_mm = 1e-9;  // errors below are none, whatever their spread
  const std::size_t n = errors.size();
  if (protocol == ErrorProtocol::kDepthTrimmed) {
    // Points that tie with the last one that counts, count too.
    const auto kept = n - static_cast<std::size_t>(options.trim_share * static_cast<double>(n));
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(kept - 1), errors.end());
    return errors[kept - 1];
  }
  if (protocol == ErrorProtocol::kPaper || n < 2) return std::numeric_limits<double>::infinity();
  const auto middle = static_cast<std::ptrdiff_t>(n / 2);
  std::nth_element(errors.begin(), errors.begin() + middle, errors.end());
  const double sigma = kMedianToSigma * (1 + 5 / static_cast<double>(n - 1)) * errors[static_cast<std::size_t>(middle)];
  return std::max(options.inlier_sigmas * sigma, kRounding_mm);
}

}  // namespace

void ProtocolOptions::List(OptionTable& table) {
  table.Add("trim_share", &trim_share, "-", "depth_trimmed: share of each frame's points, the worst, left out", 0.0,
            0.5);
  table.Add("inlier_sigmas", &inlier_sigmas, "sigma", "lmeds: points further than this many robust sigmas are left out",
            0.1, 1e6);
}

double ProtocolScale(std::span<const PointPair> pairs, ErrorProtocol protocol) {
  switch (protocol) {
    case ErrorProtocol::kPaper:
      break;
    case ErrorProtocol::kDepthTrimmed:
      return MedianDepthRatio(pairs);
    case ErrorProtocol::kLmeds:
      return LeastMedianScale(pairs);
  }
  return LeastSquaresScale(pairs);
}

ProtocolErrors ApplyProtocol(std::span<const PointPair> pairs, double scale, ErrorProtocol protocol,
                             const ProtocolOptions& options) {
  ProtocolErrors result;
  if (pairs.empty()) return result;
  std::vector<double> errors;
  for (const PointPair& pair : pairs) {
    const double along_axis = std::abs(scale * pair.estimate.z() - pair.truth.z());
    errors.push_back(protocol == ErrorProtocol::kDepthTrimmed ? along_axis
                                                              : (scale * pair.estimate - pair.truth).norm());
  }
  const double threshold = Threshold(errors, protocol, options);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (errors[i] > threshold) {
      ++result.left_out;
      continue;
    }
    result.errors_mm.push_back(errors[i]);
    result.relative_depths.push_back(std::abs(scale * pairs[i].estimate.z() - pairs[i].truth.z()) /
                                     std::abs(pairs[i].truth.z()));
  }
  return result;
}

}  // namespace pliant
