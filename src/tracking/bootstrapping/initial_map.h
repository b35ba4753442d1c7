// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What every initializer from two sets of unit rays does before and after its own method: match the rays of the
// reference and the current frame, estimate the poses of the frames between them, scale the map and fill the outcome
// in.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/estimation/two_view/relative_pose.h"
#include "pliant/estimation/two_view/two_view_models.h"
#include "pliant/estimation/window/window_refinement.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"

namespace pliant {

// The points seen in the reference (cam0) and in the current frame (cam1), side by side, sorted by id.
struct MatchedRays {
  std::vector<PointId> ids;
  std::vector<Eigen::Vector3d> rays0;
  std::vector<Eigen::Vector3d> rays1;
  std::vector<InitRejectedPoint> rejected;  // the reference's other points
};
MatchedRays MatchRays(const Camera& camera, const InitFrame& reference, const InitFrame& current);

// The pair's motion by the method that the options name. Fails as EstimateRelativePose does, and with kDegenerate where
// the method finds no translation.
Result<RelativePose> EstimateMotion(const MatchedRays& matched, double focal_px, const MonocularInitOptions& options,
                                    Random random);

// A map in the making; world = the reference camera, any scale.
struct InitialMap {
  std::vector<PointId> ids;  // sorted
  std::vector<Eigen::Vector3d> positions;
  std::vector<double> depth_sigmas;
  std::vector<double> parallaxes_rad;
};

// The pair's points that agree with its motion (`inliers`, one a match), by the method that the options name; depth
// sigmas are predicted from parallax. The others are added to matched->rejected.
InitialMap TriangulateInliers(const Rigid3& cam1_from_cam0, const std::vector<char>& inliers, double focal_px,
                              const MonocularInitOptions& options, MatchedRays* matched);

// The rays of the map's points in one frame, as observations of view `view_idx`; points are numbered by their index in
// `ids`.
std::vector<WindowObservation> ObservationsOf(const Camera& camera, const InitFrame& frame,
                                              const std::vector<PointId>& ids, int view_idx);

// The pose of a frame against fixed points, from the pose of a frame near it: robust, first with a wide loss, because
// the frames between may lie tens of pixels apart. Fails with kInsufficient when the frame sees too few of the points.
Result<Rigid3> EstimateFramePose(const Camera& camera, const InitFrame& frame, const InitialMap& map,
                                 const Rigid3& near, const RefinementOptions& options);

// The same with the wide loss alone, in few iterations: against points whose depths are rough themselves.
Result<Rigid3> EstimateFramePoseRoughly(const Camera& camera, const InitFrame& frame, const InitialMap& map,
                                        const Rigid3& near);

// Poses of all frames. `known[k]` is frame k's pose if it has one; the first and the last must. A frame without one is
// starts from the pose of the next later one.
struct KnownPose {
  bool known = false;
  Rigid3 cam_from_world;
};
Result<std::vector<Rigid3>> EstimateFramePoses(const InitInput& input, const InitialMap& map,
                                               std::vector<KnownPose> known, const RefinementOptions& options);

// Fills in the frames of an outcome whose points are there and stand still: each at its one position in every frame in
// which it was seen. `cams_from_world`: one a frame of the input.
void FillRigidFrames(const InitInput& input, const std::vector<Rigid3>& cams_from_world, InitOutcome* outcome);

// The points of a reference whose depths are known: each on its pixel's ray at its z, in the order of the reference's
// observations; where there is no depth, or no ray, the point is rejected. Counts them.
void BackProjectDepths(const InitInput& input, const std::vector<std::optional<double>>& depths, InitOutcome* outcome);

// Fills an outcome in, whose points have known depths in mm, as a map of the reference alone: such a start never waits.
// No map where they are nearer than the files of a run can hold. `source`: what the depths come from.
void FillKnownMap(const InitInput& input, std::string_view source, InitOutcome* outcome);

// Map units to mm: by it the median depth (z in the reference camera) is nominal_depth_mm. Fails with kDegenerate when
// the median depth is not positive.
Result<double> NominalScale(const std::vector<Eigen::Vector3d>& positions, double nominal_depth_mm);

// Scales map and poses so that the median depth (z in the reference camera) is nominal_depth_mm, and fills the outcome
// in as a map. Fails with kDegenerate when the median depth is not positive.
Status FillRigidMap(const InitInput& input, const InitialMap& map, const std::vector<Rigid3>& cams_from_world,
                    std::vector<InitRejectedPoint> rejected, double nominal_depth_mm, InitOutcome* outcome);

// Why a reference is given up after so many frames: what the last attempt said, whose last clause, which says what to
// do, stays the last one.
std::string WithGivenUp(const std::string& reason, int frames);

}  // namespace pliant
