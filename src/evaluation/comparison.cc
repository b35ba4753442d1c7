// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <utility>
#include <vector>

#include "evaluation/format_text.h"
#include "pliant/evaluation/report.h"

namespace pliant {
namespace {

using Cells = std::vector<std::pair<std::string, std::string>>;  // column, value

void AddPoints(const PointError& error, const std::string& prefix, Cells* cells) {
  const auto add = [&](const std::string& name, double value) { cells->emplace_back(name, FormatDouble(value)); };
  add(prefix + "mean_rmse_mm", error.plain.estimate.mean_rmse_mm);
  add(prefix + "null_mean_rmse_mm", error.plain.null.mean_rmse_mm);
  add(prefix + "pooled_median_mm", error.plain.estimate.pooled_median_mm);
  add(prefix + "null_pooled_median_mm", error.plain.null.pooled_median_mm);
  for (const ProtocolError& protocol : error.protocols) {
    if (protocol.protocol == ErrorProtocol::kPaper) continue;
    const std::string name = prefix + std::string(EnumName(protocol.protocol)) + "_";
    add(name + "mean_rmse_mm", protocol.estimate.mean_rmse_mm);
    add(name + "null_mean_rmse_mm", protocol.null.mean_rmse_mm);
    add(name + "left_out_share", protocol.estimate.left_out_share);
    add(name + "null_left_out_share", protocol.null.left_out_share);
  }
}

// A path as a cell of a CSV file.
std::string Quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

// What a comparison with the first run adds, where no truth is known.
void AddOtherRun(const RunConsistency& other, Cells* cells) {
  cells->emplace_back("other_run", Quoted(other.other_run));
  if (other.depths) {
    cells->emplace_back("other_median_relative_depth", FormatDouble(other.depths->difference));
    cells->emplace_back("other_null_median_relative_depth", FormatDouble(other.depths->null));
  }
  if (!other.path) return;
  cells->emplace_back("other_poses", std::to_string(other.path->poses));
  cells->emplace_back("other_ate_share", FormatDouble(other.path->AteShare()));
  cells->emplace_back("other_rpe_translation_share", FormatDouble(other.path->RpeShare()));
  cells->emplace_back("other_rpe_rotation_rmse_deg", FormatDouble(other.path->rpe_rotation_rmse_deg));
}

Cells CellsOf(const Evaluation& e) {
  Cells cells = {{"run", Quoted(e.run)},
                 {"sequence", Quoted(e.sequence)},
                 {"frames_read", std::to_string(e.survival.frames_read)},
                 {"frames_tracked", std::to_string(e.survival.frames_tracked)},
                 {"first_points", std::to_string(e.survival.first_points)},
                 {"mean_points", FormatDouble(e.survival.mean_points)},
                 {"alive_share_25", FormatDouble(e.survival.alive_shares[0])},
                 {"alive_share_50", FormatDouble(e.survival.alive_shares[1])},
                 {"alive_share_75", FormatDouble(e.survival.alive_shares[2])},
                 {"alive_share_100", FormatDouble(e.survival.alive_shares[3])},
                 {"tracks", std::to_string(e.survival.tracks)},
                 {"mean_track_length", FormatDouble(e.survival.mean_track_length)},
                 {"submaps", std::to_string(e.survival.submaps)},
                 {"interruptions", std::to_string(e.survival.interruptions)},
                 {"interruptions_survived", std::to_string(e.survival.interruptions_survived)},
                 {"returned_points", std::to_string(e.survival.returned_points)}};
  if (e.material) cells.emplace_back("continuing_tracks", std::to_string(e.material->continuing_tracks));
  if (e.reprojection) {
    cells.emplace_back("reprojection_median_px", FormatDouble(e.reprojection->median_px));
    cells.emplace_back("reprojection_rmse_px", FormatDouble(e.reprojection->rmse_px));
  }
  if (e.run_seconds) cells.emplace_back("run_seconds", FormatDouble(*e.run_seconds));
  if (e.surface) AddPoints(*e.surface, "surface_", &cells);
  if (e.material) {
    AddPoints(e.material->error, "material_", &cells);
    cells.emplace_back("drift_median_px", FormatDouble(e.material->drift.median_px));
    cells.emplace_back("drift_rmse_px", FormatDouble(e.material->drift.rmse_px));
    cells.emplace_back("drift_median_mm", FormatDouble(e.material->drift.median_mm));
    cells.emplace_back("drift_rmse_mm", FormatDouble(e.material->drift.rmse_mm));
  }
  if (e.trajectory) {
    cells.emplace_back("ate_rmse_mm", FormatDouble(e.trajectory->ate_rmse_mm));
    cells.emplace_back("rpe_translation_rmse_mm", FormatDouble(e.trajectory->rpe_translation_rmse_mm));
    cells.emplace_back("rpe_rotation_rmse_deg", FormatDouble(e.trajectory->rpe_rotation_rmse_deg));
  }
  if (e.first_map) {
    cells.emplace_back("first_map_frames_waited", std::to_string(e.first_map->frames_waited));
    cells.emplace_back("first_map_median_relative_depth", FormatDouble(e.first_map->declared.estimate.median));
    cells.emplace_back("first_map_null_median_relative_depth", FormatDouble(e.first_map->declared.null.median));
    cells.emplace_back("first_map_rmse_relative_depth", FormatDouble(e.first_map->declared.estimate.rmse));
  }
  if (!e.consistency.empty()) AddOtherRun(e.consistency.front(), &cells);
  return cells;
}

const ProtocolError* FindProtocol(const PointError& error, ErrorProtocol protocol) {
  const auto it = std::find_if(error.protocols.begin(), error.protocols.end(),
                               [&](const ProtocolError& p) { return p.protocol == protocol; });
  return it == error.protocols.end() ? nullptr : &*it;
}

// "estimate (null)" of the mean RMSE, or a dash.
std::string PointCell(const ProtocolError* error) {
  if (error == nullptr) return "-";
  return FormatText("%.2f (%.2f)", error->estimate.mean_rmse_mm, error->null.mean_rmse_mm);
}

using Rows = std::vector<std::vector<std::string>>;

// Columns as wide as their widest cell; the first is flush left.
std::string Print(const Rows& rows) {
  std::string text;
  for (const std::vector<std::string>& row : rows) {
    for (std::size_t column = 0; column < row.size(); ++column) {
      std::size_t width = 0;
      for (const std::vector<std::string>& other : rows) width = std::max(width, other[column].size());
      const std::string blanks(width - row[column].size(), ' ');
      text += column == 0 ? row[column] + blanks : "  " + blanks + row[column];
    }
    text += "\n";
  }
  return text;
}

Rows ProtocolRows(std::span<const Evaluation> evaluations, ErrorProtocol protocol) {
  const std::string name(EnumName(protocol));
  Rows rows = {{name + ", RMSE mm (null)", "surface", "left out %", "material", "left out %"}};
  for (const Evaluation& e : evaluations) {
    const ProtocolError* surface = e.surface ? FindProtocol(*e.surface, protocol) : nullptr;
    const ProtocolError* material = e.material ? FindProtocol(e.material->error, protocol) : nullptr;
    const auto share = [](const ProtocolError* p) {
      return p == nullptr ? std::string("-") : FormatText("%.1f", 100 * p->estimate.left_out_share);
    };
    rows.push_back({e.run, PointCell(surface), share(surface), PointCell(material), share(material)});
  }
  return rows;
}

// What there is to look at before any error: how much was reconstructed, of how many pieces, in what time.
Rows ReconstructionRows(std::span<const Evaluation> evaluations) {
  Rows rows = {
      {"run", "frames", "points a frame", "tracks", "mean length", "continue another", "reprojection px", "seconds"}};
  for (const Evaluation& e : evaluations) {
    const TrackSurvival& s = e.survival;
    rows.push_back({e.run, FormatText("%d/%d", s.frames_tracked, s.frames_read), FormatText("%.0f", s.mean_points),
                    std::to_string(s.tracks), FormatText("%.1f", s.mean_track_length),
                    e.material ? std::to_string(e.material->continuing_tracks) : "-",
                    e.reprojection ? FormatText("%.2f", e.reprojection->median_px) : "-",
                    e.run_seconds ? FormatText("%.1f", *e.run_seconds) : "-"});
  }
  return rows;
}

Rows TruthRows(std::span<const Evaluation> evaluations) {
  Rows rows = {{"run", "alive at 50, 100 %", "surface RMSE mm (null)", "material RMSE mm (null)", "drift px",
                "drift mm", "ATE mm", "first map % (null)"}};
  for (const Evaluation& e : evaluations) {
    const TrackSurvival& s = e.survival;
    rows.push_back(
        {e.run, FormatText("%.0f, %.0f", 100 * s.alive_shares[1], 100 * s.alive_shares[3]),
         PointCell(e.surface ? &e.surface->plain : nullptr), PointCell(e.material ? &e.material->error.plain : nullptr),
         e.material ? FormatText("%.2f", e.material->drift.median_px) : "-",
         e.material && e.material->drift.points_mm > 0 ? FormatText("%.3f", e.material->drift.median_mm) : "-",
         e.trajectory ? FormatText("%.3f", e.trajectory->ate_rmse_mm) : "-",
         e.first_map ? FormatText("%.2f (%.2f)", 100 * e.first_map->declared.estimate.median,
                                  100 * e.first_map->declared.null.median)
                     : "-"});
  }
  return rows;
}

// Of the runs that were compared with another one; none of those that were not.
Rows ConsistencyRows(std::span<const Evaluation> evaluations) {
  Rows rows;
  for (const Evaluation& e : evaluations) {
    if (e.consistency.empty()) continue;
    const RunConsistency& other = e.consistency.front();
    if (rows.empty())
      rows.push_back(
          {"against " + other.other_run, "depth % (null)", "poses", "ATE % of the path", "RPE % of a step", "RPE deg"});
    const bool has_path = other.path.has_value();
    rows.push_back(
        {e.run,
         other.depths ? FormatText("%.2f (%.2f)", 100 * other.depths->difference, 100 * other.depths->null) : "-",
         has_path ? std::to_string(other.path->poses) : "-",
         has_path ? FormatText("%.2f", 100 * other.path->AteShare()) : "-",
         has_path ? FormatText("%.1f", 100 * other.path->RpeShare()) : "-",
         has_path ? FormatText("%.3f", other.path->rpe_rotation_rmse_deg) : "-"});
  }
  return rows;
}

}  // namespace

std::string ComparisonTable(std::span<const Evaluation> evaluations) {
  bool has_protocol[EnumNames<ErrorProtocol>::kNames.size()] = {};
  for (const Evaluation& e : evaluations) {
    if (!e.surface && !e.material) continue;
    for (const ProtocolError& protocol : e.surface ? e.surface->protocols : e.material->error.protocols)
      has_protocol[static_cast<std::size_t>(protocol.protocol)] = true;
  }
  const Rows consistency = ConsistencyRows(evaluations);
  std::string text =
      Print(ReconstructionRows(evaluations)) + "\n" + Print(consistency.empty() ? TruthRows(evaluations) : consistency);
  for (const auto& [protocol, name] : EnumNames<ErrorProtocol>::kNames)
    if (protocol != ErrorProtocol::kPaper && has_protocol[static_cast<std::size_t>(protocol)])
      text += "\n" + Print(ProtocolRows(evaluations, protocol));
  for (const Evaluation& e : evaluations)
    for (const std::string& note : e.notes) text += "note, " + e.run + ": " + note + "\n";
  return text;
}

std::string ComparisonCsv(std::span<const Evaluation> evaluations) {
  std::vector<std::string> columns;
  std::vector<Cells> rows;
  for (const Evaluation& evaluation : evaluations) {
    rows.push_back(CellsOf(evaluation));
    for (const auto& cell : rows.back())
      if (std::find(columns.begin(), columns.end(), cell.first) == columns.end()) columns.push_back(cell.first);
  }
  std::string text;
  for (const std::string& column : columns) text += (text.empty() ? "" : ",") + column;
  text += "\n";
  for (const Cells& cells : rows) {
    std::string line;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto it =
          std::find_if(cells.begin(), cells.end(), [&](const auto& cell) { return cell.first == columns[i]; });
      line += (i == 0 ? "" : ",") + (it == cells.end() ? std::string() : it->second);
    }
    text += line + "\n";
  }
  return text;
}

}  // namespace pliant
