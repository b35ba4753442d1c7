// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/stir_error.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "evaluation/format_text.h"
#include "pliant/base/files.h"
#include "pliant/evaluation/point_error.h"

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;
using Points = std::vector<Eigen::Vector3d>;

constexpr std::array<double, 5> kThresholds_px = {4, 8, 16, 32, 64};

// Of each point to the nearest of `labels`, which there are.
std::vector<double> NearestDistances(const Points& points, const Points& labels) {
  std::vector<double> distances;
  for (const Eigen::Vector3d& point : points) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& label : labels) nearest = std::min(nearest, (point - label).norm());
    distances.push_back(nearest);
  }
  return distances;
}

// The distances of a recording after the other.
class Scores {
 public:
  void Add(const std::vector<double>& distances) {
    if (distances.empty()) return;
    double sum = 0;
    for (const double distance : distances) sum += distance;
    sum_of_means_ += sum / static_cast<double>(distances.size());
    ++recordings_;
    distances_.insert(distances_.end(), distances.begin(), distances.end());
  }

  // There is a distance.
  StirAccuracy Accuracy(const std::array<double, 5>& thresholds) const {
    StirAccuracy accuracy;
    accuracy.points = static_cast<int>(distances_.size());
    for (std::size_t k = 0; k < thresholds.size(); ++k) {
      const auto within = std::ranges::count_if(distances_, [&](double d) { return d <= thresholds[k]; });
      accuracy.within[k] = static_cast<double>(within) / static_cast<double>(distances_.size());
      accuracy.average_within += accuracy.within[k] / static_cast<double>(thresholds.size());
    }
    accuracy.end_point_error = sum_of_means_ / recordings_;
    return accuracy;
  }

 private:
  std::vector<double> distances_;
  double sum_of_means_ = 0;
  int recordings_ = 0;
};

// The labelled points of a recording; fails where there are none.
Result<const Points*> LabelsOf(const StirPoints& labels, const std::string& recording, const char* when) {
  const auto found = labels.of_recording.find(recording);
  if (found != labels.of_recording.end() && !found->second.empty()) return &found->second;
  return Status(ErrorCode::kMismatch, "the recording " + recording +
                                          " has tracked points and no labelled ones at its " + when +
                                          "; its name has to be the same in all files");
}

// What is left out would not be scored, and points that are hard to track are left out first. In space there may be
// more tracked points: a label that one eye alone shows has a pixel and no position.
Status CheckIsComplete(const std::string& recording, std::size_t tracked, std::size_t labelled, int dimensions) {
  if (tracked == labelled || (dimensions == 3 && tracked > labelled)) return Status::Ok();
  return {ErrorCode::kMismatch, "the recording " + recording + " has " + std::to_string(tracked) +
                                    " tracked points and " + std::to_string(labelled) +
                                    " labelled ones at its start; give the end of each of them"};
}

std::string Row(const char* name, const StirAccuracy& accuracy) {
  std::string text = FormatText("  %-10s", name);
  for (const double within : accuracy.within) text += FormatText(" %7.1f", 100 * within);
  return text + FormatText(" %7.1f %15.2f\n", 100 * accuracy.average_within, accuracy.end_point_error);
}

Json ToJson(const StirAccuracy& accuracy) {
  return {{"points", accuracy.points},
          {"within", accuracy.within},
          {"average_within", accuracy.average_within},
          {"end_point_error", accuracy.end_point_error}};
}

}  // namespace

Result<StirError> ComputeStirError(const StirPoints& tracked, const StirPoints& start, const StirPoints& end) {
  if (tracked.dimensions != start.dimensions || tracked.dimensions != end.dimensions)
    return Status(ErrorCode::kMismatch, "the tracked points have " + std::to_string(tracked.dimensions) +
                                            " numbers, the labelled ones " + std::to_string(start.dimensions) +
                                            " at the start and " + std::to_string(end.dimensions) +
                                            " at the end; give all in pixels, or all in millimeters");
  StirError error;
  error.dimensions = tracked.dimensions;
  error.thresholds = tracked.dimensions == 2 ? kThresholds_px : kNearDistances_mm;
  Scores estimate;
  Scores null;
  for (const auto& [recording, points] : tracked.of_recording) {
    if (points.empty()) continue;
    const auto at_start = LabelsOf(start, recording, "start");
    if (!at_start.ok()) return at_start.status();
    const auto at_end = LabelsOf(end, recording, "end");
    if (!at_end.ok()) return at_end.status();
    if (Status status = CheckIsComplete(recording, points.size(), (*at_start)->size(), tracked.dimensions);
        !status.ok())
      return status;
    estimate.Add(NearestDistances(points, **at_end));
    null.Add(NearestDistances(**at_start, **at_end));
    ++error.recordings;
  }
  if (error.recordings == 0) return Status(ErrorCode::kInsufficient, "there are no tracked points to score");
  error.estimate = estimate.Accuracy(error.thresholds);
  error.null = null.Accuracy(error.thresholds);
  return error;
}

Result<StirError> EvaluateStir(const StirRequest& request) {
  const auto tracked = ReadStirPoints(request.tracked_path);
  if (!tracked.ok()) return tracked.status();
  const auto start = ReadStirPoints(request.start_path);
  if (!start.ok()) return start.status();
  const auto end = ReadStirPoints(request.end_path);
  if (!end.ok()) return end.status();
  return ComputeStirError(*tracked, *start, *end);
}

std::string StirTable(const StirError& error) {
  const char* unit = error.dimensions == 2 ? "px" : "mm";
  std::string text =
      FormatText("points at the end of %d recordings, %% within a distance, as the STIR challenge\n", error.recordings);
  text += FormatText("  %-10s", "");
  for (const double threshold : error.thresholds) text += FormatText(" %4.0f %s", threshold, unit);
  text += FormatText(" %7s %12s %s\n", "mean", "end point", unit);
  text += Row("estimate", error.estimate) + Row("null", error.null);
  return text + FormatText("  %d points, %d labelled at the start; null: nothing moves\n", error.estimate.points,
                           error.null.points);
}

std::string StirJson(const StirError& error) {
  const Json json = {{"unit", error.dimensions == 2 ? "px" : "mm"},
                     {"recordings", error.recordings},
                     {"thresholds", error.thresholds},
                     {"estimate", ToJson(error.estimate)},
                     {"null", ToJson(error.null)}};
  return json.dump(2) + "\n";
}

Status WriteStirError(const StirError& error, const std::string& folder) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code) return {ErrorCode::kUnwritable, "cannot make the folder " + folder + ": " + code.message()};
  return WriteFileAtomically((std::filesystem::path(folder) / "stir.json").string(), StirJson(error));
}

}  // namespace pliant
