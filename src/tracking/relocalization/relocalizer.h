// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The way back after the view was lost (docs/method.md, eq. R3): where the camera may be, and which of these guesses
// the image confirms.
#pragma once

#include <vector>

#include "tracking/frame/frame_tracker.h"

namespace pliant {

class Relocalizer {
 public:
  // `frame_tracker` must outlive this.
  Relocalizer(const Camera& camera, const TrackerOptions& options, TrackAbilities abilities,
              const FrameTracker* frame_tracker)
      : camera_(camera), options_(options), abilities_(abilities), frame_tracker_(frame_tracker) {}

  // The submap's points in this image, and the camera's pose; none where the submap is not found. The attempt is the
  // track source's present one.
  FollowedPoints Relocalize(const PreparedFrame& frame, Submap* submap);

  // To be called with every frame that was tracked: where the camera was.
  void RememberPose(int step, Submap* submap) const;
  // To be called with every sharp frame that was tracked: how the points look, every now and then.
  void RememberView(const PreparedFrame& frame, Submap* submap) const;
  // To be called when the view is lost: how the points looked last, unless that was in blur.
  void RememberLastView(Submap* submap) const;

 private:
  std::vector<Rigid3> GuessPoses(int step, const Submap& submap) const;
  FollowedPoints FollowFrom(const PreparedFrame& frame, const Rigid3& guess, Submap* submap) const;
  bool IsConfirmed(const FollowedPoints& followed) const;
  const DescribedImage& Described(const PreparedFrame& frame);

  Camera camera_;
  TrackerOptions options_;
  TrackAbilities abilities_;
  const FrameTracker* frame_tracker_;
  int described_frame_idx_ = -1;
  DescribedImage described_;  // that frame: several submaps are searched in one
};

}  // namespace pliant
