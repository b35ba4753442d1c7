// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The points that were followed into one frame, on their way from their pixels to the solved frame.
#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Core>

#include "pliant/estimation/frame/frame_problem.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/tracks/point_tracker.h"
#include "tracking/tracks/loss_counts.h"

namespace pliant {

// Element k of each list belongs to the same landmark.
struct FollowedPoints {
  std::vector<PointId> ids;                     // ascending
  std::vector<Eigen::Vector3d> positions;       // X_i^{t-1}
  std::vector<Eigen::Vector3d> rest_positions;  // undeformed
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> ssim;
  std::vector<FramePoint> solved;  // of the joint problem, once there is a solution

  Rigid3 cam_from_world;          // predicted, or where relocalization found the camera
  std::vector<PointId> unseen;    // landmarks that were not found in this image, ascending
  std::vector<PointId> searched;  // lost points that the image should show
  std::ptrdiff_t expected = 0;    // landmarks and searched lost points that the image should show
  LossCounts losses;              // points given up so far, by reason
  bool in_blur = false;           // the image is blurred; the patches stay those of the last sharp one
  std::size_t unconfirmed =
      0;  // points that were found where none of the camera's poses is confirmed; then none is here

  std::size_t size() const { return positions.size(); }

  void Add(const Landmark& landmark, const PointTrack& track) {
    const auto at = std::lower_bound(ids.begin(), ids.end(), landmark.id) - ids.begin();
    ids.insert(ids.begin() + at, landmark.id);
    positions.insert(positions.begin() + at, landmark.position);
    rest_positions.insert(rest_positions.begin() + at, landmark.rest_position);
    pixels.insert(pixels.begin() + at, track.pixel);
    ssim.insert(ssim.begin() + at, track.ssim);
  }

  // Keeps the elements whose flag is set.
  void Keep(const std::vector<char>& keep) {
    const auto filter = [&](auto& values) {
      if (values.empty()) return;  // not filled in yet
      std::size_t kept = 0;
      for (std::size_t k = 0; k < keep.size(); ++k)
        if (keep[k] != 0) values[kept++] = values[k];
      values.resize(kept);
    };
    filter(ids);
    filter(positions);
    filter(rest_positions);
    filter(pixels);
    filter(ssim);
    filter(solved);
  }
};

}  // namespace pliant
