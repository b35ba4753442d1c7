// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How well points are tracked in space, by the measures of TAPVid-3D (Koppula et al., TAPVid-3D: A Benchmark for
// Tracking Any Point in 3D, NeurIPS Datasets and Benchmarks 2024; github.com/google-deepmind/tapnet,
// tapnet/tapvid3d/evaluation/metrics.py and evaluate_model.py): the scores of track_scores.h, of which the mean within
// is its APD and the mean Jaccard its 3D-AJ. X is the estimate in the run's camera of the frame, P the truth in the
// true one. Their distance in pixels is what it spans at the depth of the truth in an image whose smaller side has 256
// pixels:
//   |s X - P| f / P_z      f = sqrt(fx fy) 256 / min(width, height), of the true camera
//   s = median |P| / median |X|, one for all frames and submaps, over the points that are seen and truly visible
// A track's material point is the one that its first pixel shows. Its first frame counts, unlike in the images, where
// the pixel is given: the depth is not. TAPVid-3D counts the frames before it too, in which a run cannot have seen the
// point. A truly visible point without an estimate, since its track has ended or the frame was not tracked, is missed.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/evaluation/material_truth.h"
#include "pliant/evaluation/protocol.h"
#include "pliant/evaluation/track_scores.h"

namespace pliant {

struct TrackPoint3d {
  int frame_idx = 0;                                       // the sequence's own number
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();         // where it was seen
  Eigen::Vector3d point_in_cam = Eigen::Vector3d::Zero();  // the estimate, in the run's camera of this frame, map units
};

struct Track3d {
  std::vector<TrackPoint3d> points;  // at least one; ascending frames, each once
};

struct TrackError3d : TrackScores {
  double scale = 1;       // s
  double median_mm = 0;   // |s X - P| of the seen points that are truly visible
  TrackScores null = {};  // the same points, all at one constant depth, at its own s
};

// `frames` ascend: those in which the tracks could have been followed. `scale`: kNone for a run that claims
// millimeters, s = 1; the others s as above. Fails as the truth does, and with kInsufficient where no track has a
// material point that is truly visible.
Result<TrackError3d> ComputeTrackError3d(std::span<const Track3d> tracks, std::span<const int> frames,
                                         const Camera& camera, MaterialTruth& truth, ErrorScale scale);

}  // namespace pliant
