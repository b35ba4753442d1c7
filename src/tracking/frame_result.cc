// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/frame_result.h"

#include <utility>

#include "pliant/base/statistics.h"
#include "pliant/image/coverage.h"

namespace pliant {
namespace {

double MedianError(const FollowedPoints& points) {
  std::vector<double> errors;
  for (const FramePoint& point : points.solved) errors.push_back(point.reprojection_error_px);
  return Median(std::move(errors));
}

}  // namespace

void AddSolved(const SolvedFrame& solved, FrameResult* result) {
  result->losses.Add(solved.points.losses);
  result->costs = solved.solution.costs;
  result->median_reprojection_error_px = MedianError(solved.points);
}

void AddCoverage(const PreparedFrame& frame, const Candidates& candidates, FrameReport* report) {
  std::vector<Eigen::Vector2d> pixels;
  for (const PointObservation& seen : report->observations) pixels.push_back(seen.pixel);
  report->coverage = CoverageOf(frame.mask.valid(), pixels);
  const std::vector<Eigen::Vector2d> followed = candidates.FollowedPixels();
  pixels.insert(pixels.end(), followed.begin(), followed.end());
  report->followed_coverage = CoverageOf(frame.mask.valid(), pixels);
}

TrackingState ReportedState(TrackingState state, const Submap& submap) {
  return state == TrackingState::kTracking && submap.provisional ? TrackingState::kProvisional : state;
}

void AddSolution(const Submap& submap, const FrameResult& result, FrameReport* report) {
  report->cam_from_world = submap.last_cam_from_world;
  report->observations = submap.Observations();
  report->optimized = static_cast<int>(report->observations.size());
  report->costs = result.costs;
  report->new_points = result.update.new_points;
  report->added = static_cast<int>(report->new_points.size());
  report->refined_points = result.update.refined_points;
  report->prior = result.update.prior;
  report->median_reprojection_error_px =
      result.update.median_reprojection_error_px.value_or(result.median_reprojection_error_px);
}

FrameReport MakeReport(const PreparedFrame& frame, TrackingState state, const Submap& submap, const FrameResult& result,
                       const StageTimes& times) {
  FrameReport report;
  report.frame_idx = frame.frame_idx;
  report.name = frame.name;
  report.timestamp_s = frame.timestamp_s;
  report.state = ReportedState(state, submap);
  report.note = result.note;
  report.submap = submap.idx;
  report.tracked = result.tracked + static_cast<int>(result.update.new_points.size());
  report.losses = result.losses.by_reason();
  report.lost = result.losses.total();
  report.stage_ms = times.ByName();
  report.costs = result.costs;
  if (state != TrackingState::kTracking || (result.first_map && !result.has_caught_up)) return report;
  AddSolution(submap, result, &report);
  AddCoverage(frame, submap.candidates, &report);
  return report;
}

void AddLosses(const LossCounts& losses, FrameReport* report) {
  LossCounts all;
  for (const auto& [reason, count] : report->losses) all.Add(reason, count);
  all.Add(losses);
  report->losses = all.by_reason();
  report->lost = all.total();
}

void AddLastAttempt(const BootstrapStep& step, const StageTimes& times, FrameReport* report) {
  AddLosses(step.losses, report);
  report->note = step.note;
  const auto added = times.ByName();
  for (std::size_t k = 0; k < added.size(); ++k) report->stage_ms[k].second += added[k].second;
}

void MarkAmbiguous(const std::string& reason, int since_frame_idx, std::vector<FrameReport>* reports) {
  if (reason.empty()) return;
  for (FrameReport& report : *reports) {
    if (report.state != TrackingState::kInitializing || report.frame_idx < since_frame_idx) continue;
    report.state = TrackingState::kAmbiguous;
    report.note = reason;
  }
}

}  // namespace pliant
