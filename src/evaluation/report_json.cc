// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <optional>

#include <nlohmann/json.hpp>

#include "pliant/evaluation/report.h"

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const LeftOutCounts& counts) {
  return {{"depth_step", counts.depth_step}, {"no_depth", counts.no_depth},   {"outside_image", counts.outside_image},
          {"no_ray", counts.no_ray},         {"uncertain", counts.uncertain}, {"not_finite", counts.not_finite}};
}

Json ToJson(const PointSummary& s) {
  return {{"mean_rmse_mm", s.mean_rmse_mm},
          {"pooled_rmse_mm", s.pooled_rmse_mm},
          {"pooled_median_mm", s.pooled_median_mm},
          {"mean_median_mm", s.mean_median_mm},
          {"median_relative_depth", s.median_relative_depth},
          {"left_out_share", s.left_out_share},
          {"min_scale", s.min_scale},
          {"max_scale", s.max_scale},
          {"within", s.within},
          {"average_within", s.average_within}};
}

Json ToJson(const PointFigures& f) {
  return {{"scale", f.scale},
          {"points", f.points},
          {"rmse_mm", f.rmse_mm},
          {"median_mm", f.median_mm},
          {"median_relative_depth", f.median_relative_depth}};
}

Json ToJson(const PointFrameError& frame) {
  return {{"frame", frame.frame_idx}, {"estimate", ToJson(frame.estimate)}, {"null", ToJson(frame.null)}};
}

Json ToJson(const PointError& e) {
  Json protocols = Json::object();
  for (const ProtocolError& protocol : e.protocols) {
    Json frames = Json::array();
    for (const PointFrameError& frame : protocol.frames) frames.push_back(ToJson(frame));
    protocols[std::string(EnumName(protocol.protocol))] = {
        {"estimate", ToJson(protocol.estimate)}, {"null", ToJson(protocol.null)}, {"frames", frames}};
  }
  Json frames = Json::array();
  for (std::size_t i = 0; i < e.plain.frames.size(); ++i) {
    const PointFrameError& frame = e.plain.frames[i];
    frames.push_back({{"frame", frame.frame_idx},
                      {"points", frame.estimate.points},
                      {"estimate", ToJson(frame.estimate)},
                      {"null", ToJson(frame.null)},
                      {"left_out", ToJson(e.frame_left_out[i])}});
  }
  return {{"scale", EnumName(e.scale)},
          {"points", e.points},
          {"frames_without_pair", e.frames_without_pair},
          {"left_out", ToJson(e.left_out)},
          {"truth_sigma_mm", e.truth_sigma_mm},
          {"estimate", ToJson(e.plain.estimate)},
          {"null", ToJson(e.plain.null)},
          {"protocols", protocols},
          {"frames", frames}};
}

Json ToJson(const UncertaintyError& e) {
  Json bins = Json::array();
  for (const UncertaintyBin& bin : e.bins)
    bins.push_back({{"points", bin.points}, {"sigma_mm", bin.sigma_mm}, {"rmse_mm", bin.rmse_mm}});
  return {
      {"points", e.points},
      {"points_without", e.points_without},
      {"within_1_sigma", e.within_1_sigma},
      {"within_2_sigma", e.within_2_sigma},
      {"nees", e.nees},
      {"median_ratio", e.median_ratio},
      {"median_relative_sigma", e.median_sigma},
      {"bins", bins},
      {"sparsification", {{"area", e.area}, {"oracle_area", e.oracle_area}, {"curve", e.curve}, {"oracle", e.oracle}}}};
}

Json ToJson(const DepthFigures& f) {
  return {{"abs_rel", f.abs_rel},         {"sq_rel_mm", f.sq_rel_mm},      {"rmse_mm", f.rmse_mm},
          {"rmse_log", f.rmse_log},       {"below_1.25", f.below[0]},      {"below_1.25_2", f.below[1]},
          {"below_1.25_3", f.below[2]},   {"within_1_mm", f.within_mm[0]}, {"within_2_mm", f.within_mm[1]},
          {"within_5_mm", f.within_mm[2]}};
}

// Null: there was nothing to measure.
Json OrNull(const std::optional<DepthFigures>& figures) { return figures ? ToJson(*figures) : Json(); }

Json OrNull(const std::optional<VertexFigures>& figures) {
  if (!figures) return {};
  Json json = ToJson(figures->depth);
  const auto& within = figures->within_sigma;
  json["within_1_sigma"] = within ? Json((*within)[0]) : Json();
  json["within_2_sigma"] = within ? Json((*within)[1]) : Json();
  return json;
}

Json ToJson(const DenseError& e) {
  Json json = {{"scale", EnumName(e.scale)},
               {"frames_compared", e.frames},
               {"frames_without_depth", e.frames_without_depth},
               {"known_share", e.known_share},
               {"complete_1_mm", e.complete_mm[0]},
               {"complete_2_mm", e.complete_mm[1]},
               {"complete_5_mm", e.complete_mm[2]},
               {"within_1_sigma", e.within_1_sigma},
               {"within_2_sigma", e.within_2_sigma},
               {"estimate", ToJson(e.estimate)},
               {"certain_half", ToJson(e.certain_half)},
               {"interpolation", OrNull(e.interpolation)},
               {"filled", OrNull(e.filled)},
               {"filled_share", e.filled_share},
               {"mesh", OrNull(e.mesh)},
               {"mesh_alone", OrNull(e.mesh_alone)},
               {"mesh_vertices", e.mesh_vertices},
               {"mesh_alone_share", e.mesh_alone_share ? Json(*e.mesh_alone_share) : Json()},
               {"null", ToJson(e.null)}};
  if (e.textured) json["textured"] = {{"share", e.textured->share}, {"known_share", e.textured->known_share}};
  return json;
}

Json ToJson(const DriftFigures& d) {
  return {{"points_px", d.points_px},
          {"rmse_px", d.rmse_px},
          {"median_px", d.median_px},
          {"p95_px", d.p95_px},
          {"still_median_px", d.still_median_px},
          {"points_mm", d.points_mm},
          {"rmse_mm", d.rmse_mm},
          {"median_mm", d.median_mm},
          {"p95_mm", d.p95_mm}};
}

Json ToJson(const MaterialError& e) {
  Json json = ToJson(e.error);
  json["drift"] = ToJson(e.drift);
  json["tracks"] = e.tracks;
  json["continuing_tracks"] = e.continuing_tracks;
  json["occluded"] = e.occluded;
  json["tracks_occluded"] = e.tracks_occluded;
  json["outside_image"] = e.outside_image;
  json["tracks_outside_image"] = e.tracks_outside_image;
  for (std::size_t i = 0; i < e.frames.size(); ++i) {
    json["frames"][i]["drift"] = ToJson(e.frames[i].drift);
    json["frames"][i]["occluded"] = e.frames[i].occluded;
    json["frames"][i]["outside_image"] = e.frames[i].outside_image;
  }
  return json;
}

Json ToJson(const TrajectoryError& e) {
  Json frames = Json::array();
  for (std::size_t i = 0; i < e.ate_mm.size(); ++i)
    frames.push_back({{"frame", e.frame_idx[i]}, {"ate_mm", e.ate_mm[i]}});
  return {{"alignment", EnumName(e.alignment)},
          {"poses", e.poses},
          {"submaps", e.submaps},
          {"ate_rmse_mm", e.ate_rmse_mm},
          {"ate_mean_mm", e.ate_mean_mm},
          {"ate_median_mm", e.ate_median_mm},
          {"ate_std_mm", e.ate_std_mm},
          {"ate_min_mm", e.ate_min_mm},
          {"ate_max_mm", e.ate_max_mm},
          {"rotation_rmse_deg", e.rotation_rmse_deg},
          {"rpe_delta", e.rpe_delta},
          {"rpe_pairs", e.rpe_pairs},
          {"rpe_translation_rmse_mm", e.rpe_translation_rmse_mm},
          {"rpe_translation_mean_mm", e.rpe_translation_mean_mm},
          {"rpe_rotation_rmse_deg", e.rpe_rotation_rmse_deg},
          {"rpe_rotation_mean_deg", e.rpe_rotation_mean_deg},
          {"true_path_length_mm", e.true_path_length_mm},
          {"true_path_extent_mm", e.true_path_extent_mm},
          {"true_path_width_mm", e.true_path_width_mm},
          {"path_length_mm", e.path_length_mm},
          {"scale", e.truth_from_run.scale},
          {"frames", frames}};
}

Json ToJson(const RelativeDepthFigures& f) {
  return {{"scale", f.scale},
          {"median_relative_depth", f.median},
          {"rmse_relative_depth", f.rmse},
          {"p90_relative_depth", f.p90}};
}

Json ToJson(const FirstMapDepth& d) {
  return {{"frame", d.frame_idx},
          {"points", d.points},
          {"estimate", ToJson(d.estimate)},
          {"null", ToJson(d.null)},
          {"left_out", ToJson(d.left_out)}};
}

Json ToJson(const FirstMapMotion& m) {
  return {{"rotation_error_deg", m.rotation_error_deg},
          {"true_rotation_deg", m.true_rotation_deg},
          {"direction_error_deg", m.direction_error_deg ? Json(*m.direction_error_deg) : Json()},
          {"true_translation_mm", m.true_translation_mm}};
}

Json ToJson(const FirstMapError& e) {
  return {{"reference_frame", e.frames.reference_frame_idx},
          {"declared_frame", e.frames.declared_frame_idx},
          {"frames_waited", e.frames_waited},
          {"frames_before", e.frames_before},
          {"declared", ToJson(e.declared)},
          {"reference", e.reference ? ToJson(*e.reference) : Json()},
          {"motion", e.motion ? ToJson(*e.motion) : Json()},
          {"initializer_ms", {{"total", e.initialize_total_ms}, {"largest", e.initialize_largest_ms}}}};
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
          {"alive_share_25", s.alive_shares[0]},
          {"alive_share_50", s.alive_shares[1]},
          {"alive_share_75", s.alive_shares[2]},
          {"alive_share_100", s.alive_shares[3]},
          {"tracks", s.tracks},
          {"median_track_length", s.median_track_length},
          {"mean_track_length", s.mean_track_length},
          {"submaps", s.submaps},
          {"interruptions", s.interruptions},
          {"interruptions_survived", s.interruptions_survived},
          {"returned_points", s.returned_points},
          {"frames", frames}};
}

Json SharesJson(const TrackScores& s) {
  Json json;
  for (std::size_t k = 0; k < s.within.size(); ++k) {
    const std::string distance = std::to_string(static_cast<int>(TrackScores::kDistances_px[k]));
    json["within_" + distance] = s.within[k];
    json["jaccard_" + distance] = s.jaccard[k];
  }
  json.update({{"average_within", s.average_within}, {"average_jaccard", s.average_jaccard}});
  return json;
}

Json ToJson(const TrackScores& s) {
  Json json = {{"tracks", s.tracks}, {"without_truth", s.without_truth}, {"points", s.points}, {"visible", s.visible}};
  json.update(SharesJson(s));
  json["occlusion_accuracy"] = s.occlusion_accuracy;
  return json;
}

Json ToJson(const TrackError& e) {
  Json json = ToJson(static_cast<const TrackScores&>(e));
  json.update({{"survival", e.survival}, {"median_px", e.median_px}});
  return json;
}

Json ToJson(const TrackError3d& e) {
  Json json = ToJson(static_cast<const TrackScores&>(e));
  json.update({{"median_mm", e.median_mm}, {"scale", e.scale}, {"null", SharesJson(e.null)}});
  return json;
}

Json ToJson(const ReprojectionError& e) {
  return {{"points", e.points}, {"median_px", e.median_px}, {"rmse_px", e.rmse_px}};
}

Json ToJson(const RelativeDepthError& e) {
  Json frames = Json::array();
  for (const RelativeDepthFrame& frame : e.frames)
    frames.push_back({{"frame", frame.frame_idx},
                      {"points", frame.points},
                      {"estimate", {{"median_relative_depth", frame.difference}}},
                      {"null", {{"median_relative_depth", frame.null}}}});
  return {{"frames_compared", e.frames.size()},
          {"points", e.points},
          {"estimate", {{"median_relative_depth", e.difference}}},
          {"null", {{"median_relative_depth", e.null}}},
          {"frames", frames}};
}

// Lengths would be in units of the other run's map: shares say more.
Json PathJson(const std::optional<TrajectoryError>& path) {
  if (!path) return {};
  return {{"poses", path->poses},
          {"submaps", path->submaps},
          {"ate_share", path->AteShare()},
          {"rpe_translation_share", path->RpeShare()},
          {"rpe_rotation_rmse_deg", path->rpe_rotation_rmse_deg}};
}

Json ToJson(const std::vector<RunConsistency>& consistency) {
  Json runs = Json::array();
  for (const RunConsistency& other : consistency) {
    Json run = {{"other_run", other.other_run}, {"frames_compared", 0}, {"points", 0}};
    if (other.depths) run.update(ToJson(*other.depths));
    run["camera_path"] = PathJson(other.path);
    runs.push_back(std::move(run));
  }
  return runs;
}

Json ToJson(const Evaluation& evaluation) {
  return {{"run", evaluation.run},
          {"sequence", evaluation.sequence},
          {"surface", evaluation.surface ? ToJson(*evaluation.surface) : Json()},
          {"uncertainty", evaluation.uncertainty ? ToJson(*evaluation.uncertainty) : Json()},
          {"material", evaluation.material ? ToJson(*evaluation.material) : Json()},
          {"trajectory", evaluation.trajectory ? ToJson(*evaluation.trajectory) : Json()},
          {"first_map", evaluation.first_map ? ToJson(*evaluation.first_map) : Json()},
          {"tracks", evaluation.tracks ? ToJson(*evaluation.tracks) : Json()},
          {"tracks_3d", evaluation.tracks_3d ? ToJson(*evaluation.tracks_3d) : Json()},
          {"reprojection", evaluation.reprojection ? ToJson(*evaluation.reprojection) : Json()},
          {"sfm", evaluation.sfm ? ToJson(*evaluation.sfm) : Json()},
          {"dense", evaluation.dense ? ToJson(*evaluation.dense) : Json()},
          {"consistency", ToJson(evaluation.consistency)},
          {"survival", ToJson(evaluation.survival)},
          {"run_seconds", evaluation.run_seconds ? Json(*evaluation.run_seconds) : Json()},
          {"notes", evaluation.notes}};
}

// Takes every key `frames` out, at any depth.
void EraseFrames(Json* json) {
  if (json->is_object()) json->erase("frames");
  if (json->is_structured())
    for (Json& child : *json) EraseFrames(&child);
}

std::string PrintJson(const Json& json) {
  // Paths need not be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string EvaluationJson(const Evaluation& evaluation) { return PrintJson(ToJson(evaluation)); }

std::string ComparisonJson(std::span<const Evaluation> evaluations) {
  Json runs = Json::array();
  for (const Evaluation& evaluation : evaluations) {
    runs.push_back(ToJson(evaluation));
    EraseFrames(&runs.back());
  }
  return PrintJson({{"runs", runs}});
}

}  // namespace pliant
