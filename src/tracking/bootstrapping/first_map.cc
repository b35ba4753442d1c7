// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/first_map.h"

#include <algorithm>
#include <cassert>
#include <set>
#include <utility>

namespace pliant {
namespace {

FirstMapEvidence EvidenceOf(const InitOutcome& outcome) {
  const InitMeasurements& measured = outcome.measured;
  return {.provisional = outcome.provisional,
          .deforming = outcome.deforming,
          .points = static_cast<int>(outcome.points.size()),
          .median_parallax_deg = measured.median_parallax_deg,
          .median_error_px = measured.median_error_px,
          .depth_sigma = measured.median_depth_sigma * measured.sigma_factor,
          .depth_spread = measured.depth_spread,
          .still_camera_error_ratio = measured.still_camera_error_ratio,
          .focal_length_factor = measured.focal_length_factor,
          .moves_by_depth = outcome.moves_by_depth,
          .uses_prior = outcome.uses_prior};
}

void ReportFrame(const Camera& camera, const InitFrame& frame, const InitFrameState& state, const InitOutcome& outcome,
                 FrameReport* report) {
  for (const InitPosition& point : state.positions) {
    const InitObservation& seen = *FindById(frame.observations, point.id);
    const double log_sigma = FindById(outcome.points, point.id)->LogDistanceSigma();
    report->observations.push_back(
        {point.id, seen.pixel, point.position, seen.ssim, log_sigma * (state.cam_from_world * point.position).norm()});
  }
  report->state = outcome.provisional ? TrackingState::kProvisional : TrackingState::kTracking;
  report->cam_from_world = state.cam_from_world;
  report->optimized = static_cast<int>(state.positions.size());
  report->median_reprojection_error_px = MedianReprojectionErrorPx(camera, state.cam_from_world, report->observations);
}

}  // namespace

std::vector<FrameReport> CompletedReports(const Camera& camera, const FirstMap& first,
                                          std::vector<FrameReport> reports) {
  const auto& [frames, outcome] = first;
  assert(outcome.frames.size() == frames.size());
  std::set<PointId> known;
  for (FrameReport& report : reports) {
    if (report.frame_idx < frames.front().frame_idx) continue;
    const auto frame = std::ranges::find(frames, report.frame_idx, &InitFrame::frame_idx);
    if (frame == frames.end()) {
      report.state = TrackingState::kLost;
      continue;
    }
    report.first_map = FirstMapFrames{frames.front().frame_idx, frames.back().frame_idx, EvidenceOf(outcome)};
    const InitFrameState& state = outcome.frames[static_cast<std::size_t>(frame - frames.begin())];
    ReportFrame(camera, *frame, state, outcome, &report);
    if (&report != &reports.back())
      report.note = "the pose came with the first map, which was made in frame " + reports.back().name;
    // A point is new in the first frame that shows it.
    for (const InitPosition& seen : state.positions) {
      if (!known.insert(seen.id).second) continue;
      const InitPoint& point = *FindById(outcome.points, seen.id);
      report.new_points.push_back({point.id, point.position, FindById(frame->observations, point.id)->rgb});
    }
    report.added = static_cast<int>(report.new_points.size());
  }
  return reports;
}

Map MakeFirstMap(const FirstMap& first) {
  const auto& [frames, outcome] = first;
  assert(!frames.empty() && outcome.frames.size() == frames.size());
  const std::size_t last = frames.size() - 1;
  const std::size_t before = last == 0 ? 0 : last - 1;
  Map map;
  for (const InitPoint& point : outcome.points) {
    const InitPosition* now = FindById(outcome.frames[last].positions, point.id);
    if (now == nullptr) continue;
    const InitPosition* then = FindById(outcome.frames[before].positions, point.id);
    Landmark landmark{.id = point.id, .rest_position = point.position, .position = now->position};
    if (then != nullptr) landmark.last_motion = now->position - then->position;
    landmark.pixel = FindById(frames[last].observations, point.id)->pixel;
    landmark.log_distance_sigma = point.LogDistanceSigma();
    landmark.determined_at = now->position;
    map.landmarks.push_back(landmark);
  }
  return map;
}

}  // namespace pliant
