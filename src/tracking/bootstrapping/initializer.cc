// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/bootstrapping/initializer.h"

namespace pliant {

std::vector<Eigen::Vector2d> PixelsOf(const std::vector<InitObservation>& observations) {
  std::vector<Eigen::Vector2d> pixels;
  for (const InitObservation& observation : observations) pixels.push_back(observation.pixel);
  return pixels;
}

std::string_view InitRejectionName(InitRejection reason) {
  switch (reason) {
    case InitRejection::kNoRay:
      return "no_ray";
    case InitRejection::kLostOnTheWay:
      return "lost_on_the_way";
    case InitRejection::kTooFewViews:
      return "too_few_views";
    case InitRejection::kEpipolar:
      return "epipolar_error";
    case InitRejection::kCheirality:
      return "cheirality";
    case InitRejection::kUncertainDepth:
      return "uncertain_depth";
    case InitRejection::kReprojection:
      return "map_reprojection_error";
  }
  return "?";
}

}  // namespace pliant
