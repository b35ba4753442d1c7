// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/run_summary.h"

#include <filesystem>

#include <nlohmann/json.hpp>

#include "io/run_format.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant {

using Json = nlohmann::ordered_json;

Status WriteRunSummary(const std::string& path, const RunSummary& summary) {
  Json losses = Json::object();
  for (const auto& [reason, count] : summary.losses) losses[reason] = count;
  Json mean_ms = Json::object();
  for (const auto& [stage, ms] : summary.mean_ms) mean_ms[stage] = ms;
  Json first_map;
  if (summary.first_map)
    first_map = {{"reference_frame", summary.first_map->reference_frame_idx},
                 {"declared_frame", summary.first_map->declared_frame_idx}};
  const Json json = {
      {"program", kRunProgram},
      {"version", summary.description.program_version},
      {"command_line", summary.description.command_line},
      {"seed", summary.description.seed},
      {"input", summary.description.input},
      {"camera", summary.description.camera},
      {"oracles", summary.description.oracles},
      {"working_image",
       {{"scale", summary.description.image_scale}, {"smoothing_px", summary.description.image_smoothing_px}}},
      {"status", EnumName(summary.status)},
      {"note", summary.note},
      {"first_map", first_map},
      {"counts",
       {{"frames_read", summary.frames_read},
        {"frames_tracked", summary.frames_tracked},
        {"submaps", summary.submaps},
        {"points", summary.points},
        {"observations", summary.observations},
        {"losses", losses}}},
      {"timings",
       {{"total_s", summary.total_s}, {"frames_per_second", summary.frames_per_second}, {"mean_ms", mean_ms}}}};
  // Paths need not be UTF-8.
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  Status status = WriteFileAtomically(path, text);
  // How a run ended is written on a full disk too: the text fits into the file's first block.
  constexpr std::size_t kBlock = 4096;
  std::error_code error;
  if (status.ok() || !std::filesystem::exists(path, error) || text.size() > kBlock) return status;
  return OverwriteFile(path, text);
}

Result<RunSummary> ReadRunSummary(const std::string& path) {
  const auto text = ReadFile(path);
  if (!text.ok()) return text.status();
  try {
    const Json json = Json::parse(*text);
    if (json.at("program").get<std::string>() != kRunProgram)
      return Status(ErrorCode::kUnreadable, Quoted(path) + " was not written by Pliant");
    RunSummary summary;
    summary.description = {json.at("version").get<std::string>(),
                           json.at("command_line").get<std::vector<std::string>>(),
                           json.at("seed").get<std::uint64_t>(),
                           json.at("input").get<std::string>(),
                           json.value("camera", ""),
                           json.value("oracles", std::vector<std::string>())};
    if (const Json working = json.value("working_image", Json()); !working.is_null()) {
      summary.description.image_scale = working.at("scale").get<double>();
      summary.description.image_smoothing_px = working.at("smoothing_px").get<double>();
    }
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
    if (const Json first_map = json.value("first_map", Json()); !first_map.is_null())
      summary.first_map = {first_map.at("reference_frame").get<int>(), first_map.at("declared_frame").get<int>()};
    const Json& counts = json.at("counts");
    summary.frames_read = counts.at("frames_read").get<std::int64_t>();
    summary.frames_tracked = counts.at("frames_tracked").get<std::int64_t>();
    summary.submaps = counts.value("submaps", summary.frames_tracked > 0 ? 1 : 0);
    summary.points = counts.at("points").get<std::int64_t>();
    summary.observations = counts.at("observations").get<std::int64_t>();
    for (const auto& [reason, count] : counts.at("losses").items())
      summary.losses.emplace_back(PresentName(reason), count.get<std::int64_t>());
    const Json& timings = json.at("timings");
    summary.total_s = timings.at("total_s").get<double>();
    summary.frames_per_second = timings.at("frames_per_second").get<double>();
    for (const auto& [stage, ms] : timings.at("mean_ms").items())
      summary.mean_ms.emplace_back(PresentName(stage), ms.get<double>());
    return summary;
  } catch (const Json::exception& error) {
    return Status(ErrorCode::kUnreadable, Quoted(path) + " is not a run's run.json: " + error.what());
  }
}

}  // namespace pliant
