// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far the estimated points lie from the material points that they started on. A track's material point is the one
// that the true surface has at the pixel of its first observation, in its first tracked frame; from there on its true
// path is known, wherever the track goes. Surface error and material error tell shape from drift:
//   s X - P  =  (s X - S(u)) + (S(u) - P)       estimate - material point  =  shape  +  drift
// X is the estimate, P the material point's true position, S(u) the true surface at the tracked pixel u, all in the
// camera's frame of the moment. Drift is given in millimeters, |S(u) - P| (the straight line between two places of the
// surface; where S(u) has no truth, at a depth step, there is none), and in pixels, |u - project(P)|. A track that
// starts on a depth step belongs to no one material point and is left out.
//
// Tracks that split: a track that starts where the material point of another one is seen at that moment, after that one
// has ended, goes on with it under a new name. A rigid reconstruction of a scene that moves lives on such splits.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/ids.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/evaluation/material_truth.h"
#include "pliant/evaluation/point_error.h"
#include "pliant/image/depth_lookup.h"

namespace pliant {

// A point observed in one frame.
struct TrackedPoint {
  PointId id;
  Eigen::Vector2d pixel;                           // where it was measured
  Eigen::Vector3d point_in_cam;                    // the estimate, in the run's camera of this frame, map units
  DepthAtPixel surface = {DepthLookup::kNoDepth};  // the true surface at the pixel
};

// Distances between where points were tracked and where their material is. The first frame of a track counts, with 0.
struct DriftFigures {
  int points_px = 0;  // whose material point projects
  double rmse_px = 0;
  double median_px = 0;
  double p95_px = 0;           // 95 % of them are not larger
  double still_median_px = 0;  // the null: points that stay at their first pixel
  int points_mm = 0;           // with true surface at the tracked pixel
  double rmse_mm = 0;
  double median_mm = 0;
  double p95_mm = 0;
};

struct MaterialFrameDrift {
  int frame_idx = 0;
  DriftFigures drift;
  int occluded = 0;       // points tracked although something lies before their material point
  int outside_image = 0;  // points tracked although their material point has left the image
};

struct MaterialError {
  PointError error;
  DriftFigures drift;                      // over all observations
  std::vector<MaterialFrameDrift> frames;  // as error.plain.frames
  int tracks = 0;                          // with a material point
  int occluded = 0;                        // observations, as in the frames
  int outside_image = 0;
  int tracks_occluded = 0;  // tracks with at least one such observation
  int tracks_outside_image = 0;
  int continuing_tracks = 0;  // that go on with another one: the tracks minus these is the number of places followed
};

// Collects a run's frames, which come in order, and computes. `truth` and `camera` must outlive it.
class MaterialErrorCollector {
 public:
  MaterialErrorCollector(MaterialTruth& truth, const Camera& camera) : truth_(truth), camera_(camera) {}

  // `points` sorted by id, in the unit of that submap. Where the surface is not known there is no drift in millimeters,
  // and a track that starts on a depth step is not recognized. Fails as the truth does.
  Status AddFrame(int frame_idx, int submap, std::span<const TrackedPoint> points);

  // Fails with kInsufficient when no observation has a material point.
  Result<MaterialError> Compute(const PointErrorOptions& options) const;

 private:
  enum class Start { kOk, kOutsideImage, kDepthStep, kNothing };
  struct Track {
    Start start = Start::kOk;
    MaterialId material;
    Eigen::Vector2d first_pixel;
    int first_frame_idx = 0;
    int last_frame_idx = 0;
  };
  struct Drift {  // distances of one frame, or of many
    std::vector<double> px;
    std::vector<double> mm;
    std::vector<double> still_px;

    void Append(const Drift& other);
    DriftFigures Figures() const;
  };
  struct Frame {
    PairedFrame paired;
    Drift drift;
    std::set<PointId> occluded;
    std::set<PointId> outside_image;
  };

  Status StartTracks(int frame_idx, std::span<const TrackedPoint> points);
  Result<int> CountContinuingTracks() const;
  void AddPoint(const TrackedPoint& point, const Track& track, const MaterialState& state,
                const std::optional<Eigen::Vector3d>& ray, Frame* frame) const;

  MaterialTruth& truth_;
  const Camera& camera_;
  std::map<PointId, Track> tracks_;
  std::vector<Frame> frames_;
};

}  // namespace pliant
