// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/window_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr std::size_t kMinCommonPoints = 12;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Log distances of a solution's points from one of its views, in the order of `ids`; NaN where it has no such point.
std::vector<double> LogDistances(const SolvedWindow& window, std::size_t view, const std::vector<PointId>& ids) {
  const DeformingWindow& solved = window.solution.window;
  std::vector<double> distances;
  for (const PointId id : ids) {
    const int point = IndexOf(id, window.ids);
    distances.push_back(
        point < 0 ? kUnknown
                  : std::log((solved.cams_from_world[view] * solved.Position(point, static_cast<int>(view))).norm()));
  }
  return distances;
}

std::vector<double> Finite(const std::vector<double>& values) {
  std::vector<double> finite;
  std::ranges::copy_if(values, std::back_inserter(finite), [](double value) { return std::isfinite(value); });
  return finite;
}

// |x - y| after one scale; NaN where a point lacks. Empty where too few are in both.
std::vector<double> Differences(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < x.size(); ++i) differences.push_back(x[i] - y[i]);
  std::vector<double> known = Finite(differences);
  if (known.size() < kMinCommonPoints) return {};
  const double scale = Median(std::move(known));
  for (double& difference : differences) difference = std::abs(difference - scale);
  return differences;
}

// Of the log depths of `ids`, all of which the window has.
double MedianSigma(const SolvedWindow& window, const std::vector<PointId>& ids) {
  std::vector<double> sigmas;
  for (const PointId id : ids)
    sigmas.push_back(window.solution.LogDepthSigma(static_cast<std::size_t>(IndexOf(id, window.ids))));
  return Median(std::move(sigmas));
}

// The input's frames from `begin` to `end`, which is not one of them.
std::vector<InitFrame> FramesOf(const InitInput& input, std::size_t begin, std::size_t end) {
  const auto frame = [&](std::size_t k) { return input.frames.begin() + static_cast<std::ptrdiff_t>(k); };
  return {frame(begin), frame(end)};
}

// The input with `frames`, which have to outlive what is returned, in place of its own.
InitInput WithFrames(const InitInput& input, const std::vector<InitFrame>& frames) {
  return {input.camera, frames, {}, input.moment, input.threads, {}, input.photometric};
}

}  // namespace

std::vector<double> SigmasOfHalves(const InitInput& input, const SolvedWindow& rigid, const WindowInitOptions& options,
                                   double nominal_depth_mm) {
  std::vector<double> none(rigid.ids.size(), std::numeric_limits<double>::infinity());
  const std::size_t middle_view = rigid.views.size() / 2;
  const std::size_t middle = rigid.views[middle_view];
  const std::vector<InitFrame> later_frames = FramesOf(input, middle, rigid.views.back() + 1);
  const auto earlier = SolveAsRigid(input, middle + 1, options, nominal_depth_mm);
  const auto later = SolveAsRigid(WithFrames(input, later_frames), later_frames.size(), options, nominal_depth_mm);
  if (!earlier.ok() || !later.ok()) return none;
  const std::array<std::vector<double>, 3> distances{
      LogDistances(rigid, middle_view, rigid.ids),
      LogDistances(*earlier, earlier->views.size() - 1, rigid.ids),
      LogDistances(*later, 0, rigid.ids),
  };
  std::vector<double> sigmas(rigid.ids.size(), 0.0);
  for (const auto& [a, b] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
    const std::vector<double> differences =
        Differences(distances[static_cast<std::size_t>(a)], distances[static_cast<std::size_t>(b)]);
    if (differences.empty()) return none;
    for (std::size_t i = 0; i < sigmas.size(); ++i)
      if (std::isfinite(differences[i])) sigmas[i] = std::max(sigmas[i], differences[i] / std::sqrt(2.0));
  }
  std::vector<double> known;
  std::ranges::copy_if(sigmas, std::back_inserter(known), [](double sigma) { return sigma > 0.0; });
  std::ranges::replace(sigmas, 0.0, Median(std::move(known)));
  return sigmas;
}

double SigmaFactorOfLaterPart(const InitInput& input, const SolvedWindow& window, const std::vector<PointId>& ids,
                              const WindowInitOptions& options, double nominal_depth_mm) {
  const std::size_t end = window.views.back() + 1;
  const std::vector<InitFrame> frames = FramesOf(input, end / 3, end);
  const auto part =
      SolveWindow(WithFrames(input, frames), frames.size(), WindowScene::kDeforming, options, nominal_depth_mm);
  if (!part.ok()) return 1.0;
  std::vector<PointId> common;
  std::ranges::copy_if(ids, std::back_inserter(common),
                       [&](PointId id) { return IndexOf(id, window.ids) >= 0 && IndexOf(id, part->ids) >= 0; });
  const std::vector<double> differences = Differences(LogDistances(window, window.views.size() - 1, common),
                                                      LogDistances(*part, part->views.size() - 1, common));
  if (differences.empty()) return 1.0;
  const double sigma = std::hypot(MedianSigma(window, common), MedianSigma(*part, common));
  return std::max(1.0, kMedianToSigma * Median(differences) / sigma);
}

}  // namespace pliant
