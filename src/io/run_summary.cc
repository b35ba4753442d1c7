// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/run_summary.h"

#include <filesystem>

#include <nlohmann/json.hpp>

#include "io/run_format.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/io/run_trust.h"

namespace pliant {

using Json = nlohmann::ordered_json;

namespace {

Json FirstMapJson(const FirstMapFrames& map) {
  const FirstMapEvidence& evidence = map.evidence;
  return {{"reference_frame", map.reference_frame_idx},
          {"declared_frame", map.declared_frame_idx},
          {"provisional", evidence.provisional},
          {"model", evidence.deforming ? "deforming" : "rigid"},
          {"points", evidence.points},
          {"parallax_deg", evidence.median_parallax_deg},
          {"error_px", evidence.median_error_px},
          {"depth_sigma", evidence.depth_sigma},
          {"depth_spread", evidence.depth_spread},
          {"still_camera_error_ratio", evidence.still_camera_error_ratio},
          {"focal_length_factor", evidence.focal_length_factor},
          {"moves_by_depth", evidence.moves_by_depth},
          {"uses_prior", evidence.uses_prior}};
}

FirstMapFrames ReadFirstMap(const Json& json) {
  return {json.at("reference_frame").get<int>(),
          json.at("declared_frame").get<int>(),
          {.provisional = json.value("provisional", false),
           .deforming = json.value("model", "rigid") == "deforming",
           .points = json.value("points", 0),
           .median_parallax_deg = json.value("parallax_deg", 0.0),
           .median_error_px = json.value("error_px", 0.0),
           .depth_sigma = json.value("depth_sigma", 0.0),
           .depth_spread = json.value("depth_spread", 0.0),
           .still_camera_error_ratio = json.value("still_camera_error_ratio", 0.0),
           .focal_length_factor = json.value("focal_length_factor", 1.0),
           .moves_by_depth = json.value("moves_by_depth", false),
           .uses_prior = json.value("uses_prior", false)}};
}

Json RefinementJson(const RunDescription& description) {
  if (!description.refinement) return {};
  Json models = Json::array();
  for (const RefinedModel model : description.refinement->models) models.push_back(EnumName(model));
  return {{"models", models},
          {"depth_sigma", description.refinement->depth_sigma},
          {"estimated_camera", description.refinement->has_estimated_camera},
          {"focal_length_kept", description.refinement->focal_length_kept}};
}

RunRefinement ReadRefinement(const Json& json) {
  RunRefinement refinement;
  for (const Json& name : json.at("models")) {
    RefinedModel of_submap = RefinedModel::kUnchanged;
    for (const auto& [model, model_name] : EnumNames<RefinedModel>::kNames)
      if (name.get<std::string>() == model_name) of_submap = model;
    refinement.models.push_back(of_submap);
  }
  refinement.depth_sigma = json.at("depth_sigma").get<double>();
  refinement.has_estimated_camera = json.at("estimated_camera").get<bool>();
  refinement.focal_length_kept = json.value("focal_length_kept", "");
  return refinement;
}

RunDescription ReadDescription(const Json& json) {
  RunDescription description = {json.at("version").get<std::string>(),
                                json.at("command_line").get<std::vector<std::string>>(),
                                json.at("seed").get<std::uint64_t>(),
                                json.at("input").get<std::string>(),
                                json.value("camera", ""),
                                json.value("mask", ""),
                                json.value("oracles", std::vector<std::string>())};
  description.refined_from = json.value("refined_from", "");
  if (const Json refinement = json.value("refinement", Json()); !refinement.is_null())
    description.refinement = ReadRefinement(refinement);
  description.joined_from = json.value("joined_from", std::vector<std::string>());
  if (const Json metric = json.value("metric", Json()); !metric.is_null()) description.metric = metric.get<bool>();
  description.tracks = json.value("tracks", "");
  description.depth_prior = json.value("depth_prior", "");
  description.extensions = json.value("extensions", std::vector<std::string>());
  description.warnings = json.value("warnings", std::vector<std::string>());
  if (const Json range = json.value("frames", Json()); !range.is_null())
    description.range = {range.at("start").get<int>(), range.at("end").get<int>(), range.at("stride").get<int>()};
  if (const Json working = json.value("working_image", Json()); !working.is_null()) {
    description.image_scale = working.at("scale").get<double>();
    description.image_smoothing_px = working.at("smoothing_px").get<double>();
    description.patch_size = working.value("patch_size", 0);
    description.image_noise_levels = working.value("noise_levels", 0.0);
    description.track_noise_px = working.value("track_noise_px", 0.0);
    description.alive_after_9 = working.value("alive_after_9", 0.0);
    description.interlaced = working.value("interlaced", false);
  }
  return description;
}

Json LatencyJson(const RunSummary& summary) {
  if (!summary.latency) return {};
  return {{"p50", summary.latency->p50}, {"p99", summary.latency->p99}, {"max", summary.latency->max}};
}

Json StreamJson(const RunSummary& summary) {
  if (!summary.stream) return {};
  const StreamCounts& stream = *summary.stream;
  return {{"received", stream.received},
          {"skipped", stream.skipped},
          {"damaged", stream.damaged},
          {"fps", stream.fps},
          {"measured", stream.measured}};
}

Json MediansJson(const RunSummary& summary) {
  return {{"reprojection_error_px", summary.median_reprojection_error_px},
          {"coverage", summary.median_coverage},
          {"followed_coverage", summary.median_followed_coverage}};
}

Json PriorJson(const PriorCounts& prior) {
  if (prior.compared == 0 && prior.reestimated_maps == 0) return {};
  return {{"compared", prior.compared},
          {"agree", prior.agree},
          {"fall", prior.fall},
          {"by_brightness", prior.by_brightness},
          {"reestimated_maps", prior.reestimated_maps}};
}

PriorCounts ReadPrior(const Json& json) {
  return {json.at("compared").get<std::int64_t>(), json.at("agree").get<std::int64_t>(),
          json.at("fall").get<std::int64_t>(), json.at("by_brightness").get<std::int64_t>(),
          json.at("reestimated_maps").get<std::int64_t>()};
}

Json CountsJson(const RunSummary& summary) {
  Json losses = Json::object();
  for (const auto& [reason, count] : summary.losses) losses[reason] = count;
  Json states = Json::object();
  for (const auto& [state, count] : summary.states) states[EnumName(state)] = count;
  return {{"frames_read", summary.frames_read},
          {"frames_tracked", summary.frames_tracked},
          {"states", states},
          {"submaps", summary.submaps},
          {"points", summary.points},
          {"observations", summary.observations},
          {"losses", losses},
          {"depth_prior", PriorJson(summary.prior)}};
}

}  // namespace

Status WriteRunSummary(const std::string& path, const RunSummary& summary) {
  Json mean_ms = Json::object();
  for (const auto& [stage, ms] : summary.mean_ms) mean_ms[stage] = ms;
  Json first_maps = Json::array();
  for (const FirstMapFrames& map : summary.first_maps) first_maps.push_back(FirstMapJson(map));
  Json trust = Json::object();
  for (const auto& [topic, sentence] : TrustIn(summary)) trust[topic] = sentence;
  Json json = {{"program", kRunProgram},
               {"version", summary.description.program_version},
               {"command_line", summary.description.command_line},
               {"seed", summary.description.seed},
               {"input", summary.description.input},
               {"camera", summary.description.camera},
               {"mask", summary.description.mask},
               {"frames",
                {{"start", summary.description.range.start},
                 {"end", summary.description.range.end},
                 {"stride", summary.description.range.stride}}},
               {"refined_from", summary.description.refined_from},
               {"refinement", RefinementJson(summary.description)},
               {"joined_from", summary.description.joined_from},
               {"metric", summary.description.metric ? Json(*summary.description.metric) : Json()},
               {"tracks", summary.description.tracks},
               {"depth_prior", summary.description.depth_prior},
               {"oracles", summary.description.oracles},
               {"extensions", summary.description.extensions},
               {"working_image",
                {{"scale", summary.description.image_scale},
                 {"smoothing_px", summary.description.image_smoothing_px},
                 {"patch_size", summary.description.patch_size},
                 {"noise_levels", summary.description.image_noise_levels},
                 {"track_noise_px", summary.description.track_noise_px},
                 {"alive_after_9", summary.description.alive_after_9},
                 {"interlaced", summary.description.interlaced}}},
               {"status", EnumName(summary.status)},
               {"note", summary.note},
               {"warnings", summary.description.warnings},
               {"trust", trust},
               {"first_map", first_maps.empty() ? Json() : first_maps.front()},
               {"first_maps", first_maps},
               {"stream", StreamJson(summary)},
               {"medians", MediansJson(summary)},
               {"counts", CountsJson(summary)},
               {"timings",
                {{"total_s", summary.total_s},
                 {"frames_per_second", summary.frames_per_second},
                 {"mean_ms", mean_ms},
                 {"latency_ms", LatencyJson(summary)}}}};
  // Paths need not be UTF-8.
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  Status status = WriteFileAtomically(path, text);
  std::error_code error;
  if (status.ok() || !std::filesystem::exists(path, error)) return status;
  // How a run ended is written on a full disk too: what matters most fits into the file's first block.
  constexpr std::size_t kBlock = 4096;
  json.erase("trust");
  json["first_maps"].clear();
  const std::string shorter = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  if (shorter.size() <= kBlock) static_cast<void>(OverwriteFile(path, shorter));
  return status;
}

Result<RunSummary> ReadRunSummary(const std::string& path) {
  const auto text = ReadFile(path);
  if (!text.ok()) return text.status();
  try {
    const Json json = Json::parse(*text);
    if (json.at("program").get<std::string>() != kRunProgram)
      return Status(ErrorCode::kUnreadable, Quoted(path) + " was not written by Pliant");
    RunSummary summary;
    summary.description = ReadDescription(json);
    const std::string status = json.at("status").get<std::string>();
    bool known = false;
    for (const auto& [value, name] : EnumNames<RunStatus>::kNames) {
      if (name != status) continue;
      summary.status = value;
      known = true;
    }
    if (!known) return Status(ErrorCode::kUnreadable, Quoted(path) + " has an unknown status " + Quoted(status));
    summary.note = json.at("note").get<std::string>();
    // Runs of before this was written are read all the same.
    for (const Json& map : json.value("first_maps", Json::array())) summary.first_maps.push_back(ReadFirstMap(map));
    if (const Json map = json.value("first_map", Json()); summary.first_maps.empty() && !map.is_null())
      summary.first_maps.push_back(ReadFirstMap(map));
    if (const Json stream = json.value("stream", Json()); !stream.is_null())
      summary.stream = {stream.at("received").get<std::int64_t>(), stream.at("skipped").get<std::int64_t>(),
                        stream.value("damaged", std::int64_t{0}), stream.value("fps", 0.0),
                        stream.value("measured", false)};
    if (const Json medians = json.value("medians", Json()); !medians.is_null()) {
      summary.median_reprojection_error_px = medians.at("reprojection_error_px").get<double>();
      summary.median_coverage = medians.at("coverage").get<double>();
      summary.median_followed_coverage = medians.value("followed_coverage", 0.0);
    }
    const Json& counts = json.at("counts");
    summary.frames_read = counts.at("frames_read").get<std::int64_t>();
    summary.frames_tracked = counts.at("frames_tracked").get<std::int64_t>();
    for (const auto& [state, name] : EnumNames<TrackingState>::kNames)
      if (const auto found = counts.find("states"); found != counts.end() && found->contains(name))
        summary.states.emplace_back(state, found->at(name).get<std::int64_t>());
    summary.submaps = counts.value("submaps", summary.frames_tracked > 0 ? 1 : 0);
    summary.points = counts.at("points").get<std::int64_t>();
    summary.observations = counts.at("observations").get<std::int64_t>();
    for (const auto& [reason, count] : counts.at("losses").items())
      summary.losses.emplace_back(PresentName(reason), count.get<std::int64_t>());
    if (const Json prior = counts.value("depth_prior", Json()); !prior.is_null()) summary.prior = ReadPrior(prior);
    const Json& timings = json.at("timings");
    summary.total_s = timings.at("total_s").get<double>();
    summary.frames_per_second = timings.at("frames_per_second").get<double>();
    for (const auto& [stage, ms] : timings.at("mean_ms").items())
      summary.mean_ms.emplace_back(PresentName(stage), ms.get<double>());
    if (const Json latency = timings.value("latency_ms", Json()); !latency.is_null())
      summary.latency = {latency.at("p50").get<double>(), latency.at("p99").get<double>(),
                         latency.at("max").get<double>()};
    return summary;
  } catch (const Json::exception&) {
    return Status(
        ErrorCode::kUnreadable,
        Quoted(path) + " is not a run's run.json: an entry is missing, or of another kind; make the run again");
  }
}

}  // namespace pliant
