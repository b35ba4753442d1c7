// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where point tracks come from: our Lucas-Kanade tracker (patch_tracks.h), another program (given_tracks.h), the truth
// of a simulated scene (oracle_tracks.h), or another source of one's own. One source serves all submaps of a run; it
// gives every point an id that no other point of the run has. Pixels: (0, 0) is the center of the first pixel.
//
// A source follows in attempts: Track begins one, Find adds to it, and Keep makes what the attempt found the points'
// own. What is not kept is forgotten when the next attempt begins, so that a result that is not used leaves no trace.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/ids.h"
#include "pliant/image/corners.h"
#include "pliant/tracking/prepared_frame.h"
#include "pliant/tracking/tracks/point_tracker.h"

namespace pliant {

class StateArchive;

// What a source can do besides following the points of the reference image.
struct TrackAbilities {
  bool adds_points = true;      // Add and AddNew work in any image, not only in the reference
  bool finds_points = true;     // Find
  bool tracks_blurred = true;   // TrackIntoBlur
  bool sees_appearance = true;  // its points can be recognized by their looks (relocalization)
  bool adds_always = false;  // asked for new points in every frame, not every few: it is the source that chooses them
};

struct NewTrack {
  PointId id;
  Eigen::Vector2d pixel;
};

class TrackSource {
 public:
  virtual ~TrackSource() = default;
  virtual TrackAbilities abilities() const = 0;

  // Starts to follow points of the source's own choice: at most `corners.max_corners`, spread over the usable image,
  // away from those that exist. Sorted by id. Here: the image's corners; a source that knows its points offers those.
  virtual std::vector<NewTrack> AddNew(const PreparedFrame& frame, std::span<const Eigen::Vector2d> existing,
                                       const CornerOptions& corners);
  // Starts to follow the point that is seen at `pixel`; nothing when it cannot be followed.
  virtual std::optional<PointId> Add(const Eigen::Vector2d& pixel, const PreparedFrame& frame) = 0;
  // The same for a point that has an id already, which is not in use here. False: it cannot be followed.
  virtual bool Resume(PointId id, const Eigen::Vector2d& pixel, const PreparedFrame& frame) = 0;
  // The id that the next new point gets, at least; and to leave those below `next` to others.
  virtual PointId next_id() const = 0;
  virtual void SkipIds(PointId next) = 0;
  // Forgets a point; no effect when it is not known.
  virtual void Remove(PointId id) = 0;

  // Begins an attempt: the predicted points from `previous`, the image in which they were last kept, into `current`.
  // One result a prediction, in their order.
  virtual std::vector<PointTrack> Track(const PreparedFrame& previous, const PreparedFrame& current,
                                        std::span<const PointPrediction> predictions) = 0;
  // Searches points that were not seen in the latest image around their predicted pixels; part of the attempt. None is
  // found by a source without this ability.
  virtual std::vector<PointTrack> Find(const PreparedFrame& current, std::span<const PointPrediction> predictions) = 0;
  // The attempt's results of these points are right.
  virtual void Keep(std::span<const PointId> ids) = 0;

  // Points of the sharp image `previous` in a blurred one. No part of an attempt, and never kept: the points stay where
  // the sharp image has them.
  virtual std::vector<PointTrack> TrackIntoBlur(const PreparedFrame& previous, const PreparedFrame& blurred,
                                                std::span<const PointPrediction> predictions) const = 0;

  // Whether Serialize writes all that the source keeps, so that a run can be resumed.
  virtual bool IsSerializable() const { return false; }
  // Between two attempts. What is read was written by a source that was made alike.
  virtual void Serialize(StateArchive& /*archive*/) {}
};

}  // namespace pliant
