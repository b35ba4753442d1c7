// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/run_figures.h"

#include <algorithm>
#include <utility>

#include "pliant/base/text.h"
#include "pliant/io/run_trust.h"

namespace pliant {
namespace {

std::string Millimeters(double value) { return FormatNumber("%.3f mm", value); }
std::string PreciseShare(double share) { return Percent(share, 2); }

class Rows {
 public:
  void Begin(std::string group) { group_ = std::move(group); }
  void Add(std::string name, std::string value) { rows_.push_back({group_, std::move(name), std::move(value)}); }
  std::vector<NamedText> Take() { return std::move(rows_); }

 private:
  std::string group_;
  std::vector<NamedText> rows_;
};

void AddPointError(const std::string& title, const PointError& error, Rows* rows) {
  rows->Begin(title + ", scale " + std::string(EnumName(error.scale)));
  const PointSummary& estimate = error.plain.estimate;
  const PointSummary& null = error.plain.null;
  rows->Add("RMSE, mean over frames", Millimeters(estimate.mean_rmse_mm));
  rows->Add("RMSE of one constant depth", Millimeters(null.mean_rmse_mm));
  rows->Add("median, all points", Millimeters(estimate.pooled_median_mm));
  rows->Add("median of one constant depth", Millimeters(null.pooled_median_mm));
  rows->Add("relative depth, median", PreciseShare(estimate.median_relative_depth));
}

void AddEvaluation(const Evaluation& evaluation, Rows* rows) {
  const TrackSurvival& survival = evaluation.survival;
  rows->Begin("Tracks");
  rows->Add("points a frame", FormatNumber("%.1f", survival.mean_points));
  rows->Add("length, median", FormatNumber("%.1f frames", survival.median_track_length));
  rows->Add("first frame's points in the last",
            std::to_string(survival.last_alive_of_first) + " of " + std::to_string(survival.first_points));
  if (evaluation.reprojection) {
    rows->Add("reprojection error, median", FormatNumber("%.3f px", evaluation.reprojection->median_px));
    rows->Add("reprojection error, RMSE", FormatNumber("%.3f px", evaluation.reprojection->rmse_px));
  }
  if (evaluation.surface) AddPointError("Surface error", *evaluation.surface, rows);
  if (evaluation.material) {
    AddPointError("Material error", evaluation.material->error, rows);
    rows->Add("drift, median", FormatNumber("%.3f px", evaluation.material->drift.median_px));
  }
  if (evaluation.trajectory) {
    const TrajectoryError& camera = *evaluation.trajectory;
    rows->Begin("Camera, aligned by " + std::string(EnumName(camera.alignment)));
    rows->Add("ATE, RMSE", Millimeters(camera.ate_rmse_mm));
    rows->Add("true path", Millimeters(camera.true_path_length_mm));
    rows->Add("rotation, RMSE", FormatNumber("%.3f deg", camera.rotation_rmse_deg));
    if (camera.rpe_pairs > 0) rows->Add("RPE a frame, RMSE", Millimeters(camera.rpe_translation_rmse_mm));
  }
  if (evaluation.first_map) {
    rows->Begin("First map");
    rows->Add("frames waited", std::to_string(evaluation.first_map->frames_waited));
    rows->Add("relative depth, median", PreciseShare(evaluation.first_map->declared.estimate.median));
    rows->Add("relative depth of one constant depth", PreciseShare(evaluation.first_map->declared.null.median));
  }
}

}  // namespace

std::vector<NamedText> RunFigures(const ViewedRun& run, const std::optional<RunSummary>& summary,
                                  const std::optional<Evaluation>& evaluation) {
  Rows rows;
  rows.Begin("Run");
  const auto tracked = std::count_if(run.frames.begin(), run.frames.end(),
                                     [](const ViewedFrame& frame) { return frame.world_from_cam.has_value(); });
  rows.Add("frames tracked", std::to_string(tracked) + " of " + std::to_string(run.frames.size()));
  if (summary) {
    rows.Add("program", summary->description.program_version);
    rows.Add("images", summary->description.input);
    rows.Add("points", std::to_string(summary->points));
    rows.Add("observations", std::to_string(summary->observations));
    rows.Add("maps", std::to_string(summary->submaps));
    if (summary->frames_per_second > 0) rows.Add("frames a second", FormatNumber("%.1f", summary->frames_per_second));
    if (summary->latency) {
      const auto& [p50, p99, max] = *summary->latency;
      rows.Add("latency of a frame", FormatNumber("%.0f ms (median)", p50) + FormatNumber(", %.0f (99 %%)", p99) +
                                         FormatNumber(", %.0f (worst)", max));
    }
    if (summary->total_s > 0) rows.Add("wall time", FormatNumber("%.2f s", summary->total_s));
    const RunDescription& description = summary->description;
    if (!description.oracles.empty()) rows.Add("replaced by the truth", CommaSeparated(description.oracles));
    if (!description.extensions.empty()) rows.Add("given by a program", CommaSeparated(description.extensions));
    for (const auto& [reason, count] : summary->losses) rows.Add("given up: " + reason, std::to_string(count));
  }
  if (summary) {
    rows.Begin("How far to trust it");
    for (auto& [topic, sentence] : TrustIn(*summary)) rows.Add(topic, std::move(sentence));
  }
  if (evaluation) AddEvaluation(*evaluation, &rows);
  return rows.Take();
}

}  // namespace pliant
