// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <map>
#include <utility>
#include <vector>

#include "pliant/evaluation/report.h"

namespace pliant {
namespace {

// A table that is filled cell by cell: rows are frames, columns come in the order of their first mention.
class FrameTable {
 public:
  explicit FrameTable(const TrackSurvival& survival) {
    for (const TrackSurvival::Frame& frame : survival.frames) rows_[frame.frame_idx] = {};
  }
  // The columns of which the next Set calls speak, in every row.
  void AddColumns(const std::vector<std::string>& names) {
    first_ = header_.size();
    header_.insert(header_.end(), names.begin(), names.end());
    for (auto& row : rows_) row.second.resize(header_.size());
  }
  void Set(int frame_idx, const std::vector<std::string>& cells) {
    const auto row = rows_.find(frame_idx);
    if (row == rows_.end()) return;
    for (std::size_t i = 0; i < cells.size(); ++i) row->second[first_ + i] = cells[i];
  }
  std::string Print() const {
    std::string text = "frame";
    for (const std::string& name : header_) text += "," + name;
    text += "\n";
    for (const auto& [frame_idx, cells] : rows_) {
      text += std::to_string(frame_idx);
      for (const std::string& cell : cells) text += "," + cell;
      text += "\n";
    }
    return text;
  }

 private:
  std::vector<std::string> header_;
  std::map<int, std::vector<std::string>> rows_;
  std::size_t first_ = 0;
};

void AddPoints(const PointError* error, const std::string& prefix, FrameTable* table) {
  table->AddColumns({prefix + "compared", prefix + "left_out", prefix + "scale", prefix + "rmse_mm",
                     prefix + "median_mm", prefix + "null_rmse_mm", prefix + "null_median_mm"});
  if (error == nullptr) return;
  for (std::size_t i = 0; i < error->plain.frames.size(); ++i) {
    const PointFrameError& frame = error->plain.frames[i];
    table->Set(frame.frame_idx, {std::to_string(frame.estimate.points),
                                 std::to_string(error->frame_left_out[i].Total()), FormatDouble(frame.estimate.scale),
                                 FormatDouble(frame.estimate.rmse_mm), FormatDouble(frame.estimate.median_mm),
                                 FormatDouble(frame.null.rmse_mm), FormatDouble(frame.null.median_mm)});
  }
}

void AddProtocols(const PointError& error, const std::string& prefix, FrameTable* table) {
  for (const ProtocolError& protocol : error.protocols) {
    if (protocol.protocol == ErrorProtocol::kPaper) continue;
    const std::string name = prefix + std::string(EnumName(protocol.protocol)) + "_";
    table->AddColumns({name + "compared", name + "rmse_mm", name + "null_rmse_mm"});
    for (const PointFrameError& frame : protocol.frames)
      table->Set(frame.frame_idx, {std::to_string(frame.estimate.points), FormatDouble(frame.estimate.rmse_mm),
                                   FormatDouble(frame.null.rmse_mm)});
  }
}

void AddDrift(const MaterialError* error, FrameTable* table) {
  table->AddColumns(
      {"drift_median_px", "drift_rmse_px", "drift_median_mm", "drift_rmse_mm", "occluded", "outside_image"});
  if (error == nullptr) return;
  for (const MaterialFrameDrift& frame : error->frames)
    table->Set(frame.frame_idx, {FormatDouble(frame.drift.median_px), FormatDouble(frame.drift.rmse_px),
                                 frame.drift.points_mm > 0 ? FormatDouble(frame.drift.median_mm) : "",
                                 frame.drift.points_mm > 0 ? FormatDouble(frame.drift.rmse_mm) : "",
                                 std::to_string(frame.occluded), std::to_string(frame.outside_image)});
}

}  // namespace

std::string EvaluationCsv(const Evaluation& evaluation) {
  FrameTable table(evaluation.survival);
  table.AddColumns({"tracked", "points", "alive_of_first"});
  for (const TrackSurvival::Frame& frame : evaluation.survival.frames)
    table.Set(frame.frame_idx,
              {frame.tracked ? "1" : "0", std::to_string(frame.points), std::to_string(frame.alive_of_first)});
  AddPoints(evaluation.surface ? &*evaluation.surface : nullptr, "", &table);
  table.AddColumns({"ate_mm"});
  if (evaluation.trajectory)
    for (std::size_t i = 0; i < evaluation.trajectory->ate_mm.size(); ++i)
      table.Set(evaluation.trajectory->frame_idx[i], {FormatDouble(evaluation.trajectory->ate_mm[i])});
  const MaterialError* material = evaluation.material ? &*evaluation.material : nullptr;
  AddPoints(material != nullptr ? &material->error : nullptr, "material_", &table);
  AddDrift(material, &table);
  if (evaluation.surface) AddProtocols(*evaluation.surface, "", &table);
  if (material != nullptr) AddProtocols(material->error, "material_", &table);
  return table.Print();
}

}  // namespace pliant
