// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/scene/serialize.h"

namespace pliant {

void Serialize(StateArchive& archive, PointId& id) { archive.Members<1>(id); }
void Serialize(StateArchive& archive, Rigid3& b_from_a) { archive.Members<2>(b_from_a); }
void Serialize(StateArchive& archive, Sim3& b_from_a) { archive.Members<3>(b_from_a); }
void Serialize(StateArchive& archive, Landmark& landmark) { archive.Members<12>(landmark); }
void Serialize(StateArchive& archive, Map& map) { archive.Members<1>(map); }
void Serialize(StateArchive& archive, CostTerm& cost) { archive.Members<2>(cost); }
void Serialize(StateArchive& archive, PointObservation& observation) { archive.Members<5>(observation); }
void Serialize(StateArchive& archive, NewPoint& point) { archive.Members<3>(point); }
void Serialize(StateArchive& archive, RefinedPoint& point) { archive.Members<2>(point); }
void Serialize(StateArchive& archive, FirstMapEvidence& evidence) { archive.Members<11>(evidence); }
void Serialize(StateArchive& archive, FirstMapFrames& frames) { archive.Members<3>(frames); }
void Serialize(StateArchive& archive, SubmapMerge& merge) { archive.Members<3>(merge); }
void Serialize(StateArchive& archive, FramePrior& prior) { archive.Members<3>(prior); }
void Serialize(StateArchive& archive, FrameReport& report) {
  auto& [frame_idx, name, timestamp_s, state, note, submap, merge, cam_from_world, pose_covariance, observations,
         new_points, refined_points, first_map, tracked, optimized, lost, added, losses, costs,
         median_reprojection_error_px, coverage, followed_coverage, prior, stage_ms, latency_ms] = report;
  archive(frame_idx, name, timestamp_s, state, note, submap, merge, cam_from_world, pose_covariance, observations);
  archive(new_points, refined_points, first_map, tracked, optimized, lost, added, losses, costs);
  archive(median_reprojection_error_px, coverage, followed_coverage, prior, stage_ms, latency_ms);
}

}  // namespace pliant
