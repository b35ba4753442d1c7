// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The points of reference images: chosen in the reference, and followed from image to image while there is no map.
#pragma once

#include <span>
#include <vector>

#include "pliant/camera/camera.h"
#include "pliant/image/brightness.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/prepared_frame.h"
#include "pliant/tracking/tracker_options.h"
#include "pliant/tracking/tracks/track_source.h"
#include "tracking/bootstrapping/reference.h"
#include "tracking/tracks/loss_counts.h"

namespace pliant {

class ReferenceTracks {
 public:
  // `tracks` and `initializer` must outlive this. `options` are copied.
  ReferenceTracks(const Camera& camera, const TrackerOptions& options, TrackSource* tracks,
                  const Initializer* initializer)
      : camera_(camera), options_(options), tracks_(tracks), initializer_(initializer) {}

  // This image as a reference: its corners, or its points of known depth, however few.
  Reference Take(const PreparedFrame& frame);
  // Whether references can overlap: the points of one are no others'.
  bool CanOverlap() const;
  // The next frame of both, of which the second may be none; `previous` is the last one they were followed into. Lost
  // points are counted of the first.
  void Follow(const PreparedFrame& previous, const PreparedFrame& frame, Reference* first, Reference* second,
              LossCounts* losses);
  // Its points are forgotten. There is none then.
  void Drop(Reference* reference);

 private:
  std::vector<PointPrediction> PredictPixels(const Reference& reference, int frame_idx) const;
  InitFrame FollowedFrame(const PreparedFrame& frame, std::span<const PointTrack> followed, std::size_t frames_before,
                          LossCounts* losses);
  void AddCorners(const PreparedFrame& frame, const LocalBrightness& brightness, int max_corners, InitFrame* points);
  void AddKnownPoints(const PreparedFrame& frame, const LocalBrightness& brightness, Reference* reference);

  Camera camera_;
  TrackerOptions options_;
  TrackSource* tracks_;
  const Initializer* initializer_;
};

}  // namespace pliant
