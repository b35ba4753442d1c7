// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdarg>
#include <cstdio>
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "pliant/evaluation/evaluation.h"

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;

// printf into a string: a table line never exceeds the buffer, except for a run's name, which is appended apart.
[[gnu::format(printf, 1, 2)]] std::string Line(const char* format, ...) {
  char text[256];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

std::string SurfaceTable(const SurfaceError& e) {
  const auto row = [](const char* name, double estimate, double null) {
    return Line("  %-26s %10.3f %10.3f\n", name, estimate, null);
  };
  std::string text =
      Line("surface error, mm (scale %s)   estimate       null\n", std::string(EnumName(e.protocol)).c_str());
  text += row("RMSE, mean over frames", e.estimate.mean_rmse_mm, e.null.mean_rmse_mm);
  text += row("RMSE, all points", e.estimate.pooled_rmse_mm, e.null.pooled_rmse_mm);
  text += row("median, all points", e.estimate.pooled_median_mm, e.null.pooled_median_mm);
  text += row("median, mean over frames", e.estimate.mean_median_mm, e.null.mean_median_mm);
  text += row("relative depth, median, %", 100 * e.estimate.median_relative_depth, 100 * e.null.median_relative_depth);
  text += Line("  scale %.4f to %.4f; %d points in %zu frames\n", e.estimate.min_scale, e.estimate.max_scale, e.points,
               e.frames.size());
  text += Line("  left out: %d on a depth step, %d without depth, %d outside, %d without a ray, %d not a number\n",
               e.left_out.depth_step, e.left_out.no_depth, e.left_out.outside_image, e.left_out.no_ray,
               e.left_out.not_finite);
  return text;
}

std::string TrajectoryTable(const TrajectoryError& e) {
  std::string text = Line("camera error (%s, %d poses)\n", std::string(EnumName(e.alignment)).c_str(), e.poses);
  text += Line("  ATE RMSE %.4f mm, median %.4f, largest %.4f, over a path of %.2f mm\n", e.ate_rmse_mm,
               e.ate_median_mm, e.ate_max_mm, e.true_path_length_mm);
  text += Line("  rotation RMSE %.4f deg\n", e.rotation_rmse_deg);
  if (e.rpe_pairs > 0)
    text += Line("  RPE over %d frame(s): %.4f mm, %.4f deg\n", e.rpe_delta, e.rpe_translation_rmse_mm,
                 e.rpe_rotation_rmse_deg);
  return text;
}

std::string SurvivalTable(const TrackSurvival& s) {
  std::string text = "tracks\n";
  text += Line("  frames tracked %d of %d\n", s.frames_tracked, s.frames_read);
  text += Line("  points: first frame %d, last %d, mean %.1f\n", s.first_points, s.last_points, s.mean_points);
  text += Line("  of the first frame's points %d live in the last\n", s.last_alive_of_first);
  text += Line("  %d tracks, median length %.1f frames\n", s.tracks, s.median_track_length);
  return text;
}

Json ToJson(const LeftOutCounts& counts) {
  return {{"depth_step", counts.depth_step},
          {"no_depth", counts.no_depth},
          {"outside_image", counts.outside_image},
          {"no_ray", counts.no_ray},
          {"not_finite", counts.not_finite}};
}

Json ToJson(const SurfaceSummary& s) {
  return {{"mean_rmse_mm", s.mean_rmse_mm},
          {"pooled_rmse_mm", s.pooled_rmse_mm},
          {"pooled_median_mm", s.pooled_median_mm},
          {"mean_median_mm", s.mean_median_mm},
          {"median_relative_depth", s.median_relative_depth},
          {"min_scale", s.min_scale},
          {"max_scale", s.max_scale}};
}

Json ToJson(const SurfaceFigures& f) {
  return {{"scale", f.scale},
          {"rmse_mm", f.rmse_mm},
          {"median_mm", f.median_mm},
          {"median_relative_depth", f.median_relative_depth}};
}

Json ToJson(const SurfaceError& e) {
  Json frames = Json::array();
  for (const SurfaceFrameError& frame : e.frames)
    frames.push_back({{"frame", frame.frame_idx},
                      {"points", frame.points},
                      {"estimate", ToJson(frame.estimate)},
                      {"null", ToJson(frame.null)},
                      {"left_out", ToJson(frame.left_out)}});
  return {{"scale", EnumName(e.protocol)},
          {"points", e.points},
          {"frames_without_pair", e.frames_without_pair},
          {"left_out", ToJson(e.left_out)},
          {"estimate", ToJson(e.estimate)},
          {"null", ToJson(e.null)},
          {"frames", frames}};
}

Json ToJson(const TrajectoryError& e) {
  Json frames = Json::array();
  for (std::size_t i = 0; i < e.ate_mm.size(); ++i)
    frames.push_back({{"frame", e.frame_idx[i]}, {"ate_mm", e.ate_mm[i]}});
  return {{"alignment", EnumName(e.alignment)},
          {"poses", e.poses},
          {"ate_rmse_mm", e.ate_rmse_mm},
          {"ate_median_mm", e.ate_median_mm},
          {"ate_max_mm", e.ate_max_mm},
          {"rotation_rmse_deg", e.rotation_rmse_deg},
          {"rpe_delta", e.rpe_delta},
          {"rpe_pairs", e.rpe_pairs},
          {"rpe_translation_rmse_mm", e.rpe_translation_rmse_mm},
          {"rpe_rotation_rmse_deg", e.rpe_rotation_rmse_deg},
          {"true_path_length_mm", e.true_path_length_mm},
          {"path_length_mm", e.path_length_mm},
          {"scale", e.truth_from_run.scale},
          {"frames", frames}};
}

Json ToJson(const TrackSurvival& s) {
  Json frames = Json::array();
  for (const TrackSurvival::Frame& frame : s.frames)
    frames.push_back({{"frame", frame.frame_idx},
                      {"tracked", frame.tracked},
                      {"points", frame.points},
                      {"alive_of_first", frame.alive_of_first}});
  return {{"frames_read", s.frames_read},
          {"frames_tracked", s.frames_tracked},
          {"first_points", s.first_points},
          {"last_points", s.last_points},
          {"mean_points", s.mean_points},
          {"last_alive_of_first", s.last_alive_of_first},
          {"tracks", s.tracks},
          {"median_track_length", s.median_track_length},
          {"frames", frames}};
}

std::string SurfaceCells(const SurfaceFrameError* e) {
  if (e == nullptr) return ",,,,,,,";
  return "," + std::to_string(e->points) + "," + std::to_string(e->left_out.Total()) + "," +
         FormatDouble(e->estimate.scale) + "," + FormatDouble(e->estimate.rmse_mm) + "," +
         FormatDouble(e->estimate.median_mm) + "," + FormatDouble(e->null.rmse_mm) + "," +
         FormatDouble(e->null.median_mm);
}

}  // namespace

std::string EvaluationTable(const Evaluation& evaluation) {
  std::string text = "run " + evaluation.run + "\n";
  if (evaluation.surface) text += SurfaceTable(*evaluation.surface);
  if (evaluation.trajectory) text += TrajectoryTable(*evaluation.trajectory);
  text += SurvivalTable(evaluation.survival);
  for (const std::string& note : evaluation.notes) text += "note: " + note + "\n";
  return text;
}

std::string EvaluationJson(const Evaluation& evaluation) {
  Json json;
  json["run"] = evaluation.run;
  json["surface"] = evaluation.surface ? ToJson(*evaluation.surface) : Json();
  json["trajectory"] = evaluation.trajectory ? ToJson(*evaluation.trajectory) : Json();
  json["survival"] = ToJson(evaluation.survival);
  json["notes"] = evaluation.notes;
  // Paths need not be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string EvaluationCsv(const Evaluation& evaluation) {
  std::map<int, const SurfaceFrameError*> surface_of_frame;
  std::map<int, double> ate_of_frame;
  if (evaluation.surface)
    for (const SurfaceFrameError& frame : evaluation.surface->frames) surface_of_frame[frame.frame_idx] = &frame;
  if (evaluation.trajectory)
    for (std::size_t i = 0; i < evaluation.trajectory->ate_mm.size(); ++i)
      ate_of_frame[evaluation.trajectory->frame_idx[i]] = evaluation.trajectory->ate_mm[i];

  std::string text =
      "frame,tracked,alive_of_first,compared,left_out,scale,rmse_mm,median_mm,null_rmse_mm,null_median_mm,ate_mm\n";
  for (const TrackSurvival::Frame& frame : evaluation.survival.frames) {
    text += std::to_string(frame.frame_idx) + "," + std::to_string(frame.points) + "," +
            std::to_string(frame.alive_of_first);
    const auto surface = surface_of_frame.find(frame.frame_idx);
    text += SurfaceCells(surface == surface_of_frame.end() ? nullptr : surface->second);
    const auto ate = ate_of_frame.find(frame.frame_idx);
    text += "," + (ate == ate_of_frame.end() ? std::string() : FormatDouble(ate->second)) + "\n";
  }
  return text;
}

}  // namespace pliant
