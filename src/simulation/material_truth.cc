// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/simulation/material_truth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> kColumns = {"frame", "u_px", "v_px"};

std::vector<std::string_view> Cells(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

std::string PixelText(const FramePixel& start) {
  return "(" + FormatDouble(start.pixel.x()) + ", " + FormatDouble(start.pixel.y()) + ")";
}

Status CheckStarts(const Simulator& simulator, std::span<const FramePixel> starts) {
  const Camera& camera = simulator.camera();
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::string point = "point " + std::to_string(i + 1);
    if (starts[i].frame_idx < 0 || starts[i].frame_idx >= simulator.frame_count())
      return {ErrorCode::kInvalidArgument, point + " is in frame " + std::to_string(starts[i].frame_idx) +
                                               ", and the sequence has the frames 0 to " +
                                               std::to_string(simulator.frame_count() - 1)};
    if (!camera.Contains(starts[i].pixel, -0.5))  // the outermost pixels reach half a pixel beyond their centers
      return {ErrorCode::kInvalidArgument, point + " is at " + PixelText(starts[i]) + ", outside the image of " +
                                               std::to_string(camera.width()) + " x " +
                                               std::to_string(camera.height()) + " pixels"};
  }
  return Status::Ok();
}

std::string_view Name(Visibility visibility) {
  switch (visibility) {
    case Visibility::kVisible:
      return "visible";
    case Visibility::kOccluded:
      return "occluded";
    case Visibility::kOutsideImage:
      return "outside";
  }
  return "?";
}

void AppendRow(std::string* out, std::size_t point, std::size_t frame, const MaterialObservation& seen) {
  const auto cell = [](double value) { return std::isfinite(value) ? FormatDouble(value) : std::string(); };
  *out += std::to_string(point) + ',' + std::to_string(frame) + ',' + cell(seen.pixel.x()) + ',' + cell(seen.pixel.y());
  for (const double value : seen.point_in_world) *out += ',' + cell(value);
  *out += ',' + cell(seen.depth_mm) + ',' + std::string(Name(seen.visibility)) + '\n';
}

}  // namespace

std::vector<FramePixel> PixelGrid(const Camera& camera, int frame_idx, int step_px) {
  std::vector<FramePixel> starts;
  for (int y = step_px / 2; y < camera.height(); y += step_px)
    for (int x = step_px / 2; x < camera.width(); x += step_px) starts.push_back({frame_idx, {x, y}});
  return starts;
}

Result<std::vector<FramePixel>> ReadFramePixels(const fs::path& path) {
  auto reader = LineReader::Open(path.string());
  if (!reader.ok()) return reader.status();
  std::string_view line;
  if (!reader->Next(&line)) {
    if (Status status = reader->End(); !status.ok()) return status;
    return {ErrorCode::kUnreadable, PathAndLine(path.string(), 1) + ": the file is empty; give frame,u_px,v_px"};
  }
  const std::vector<std::string_view> header = Cells(line);
  std::array<std::size_t, kColumns.size()> column_idx{};
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const auto found = std::ranges::find(header, kColumns[i]);
    if (found == header.end())
      return reader->Error("the header has no column " + std::string(kColumns[i]) + "; it must name frame,u_px,v_px");
    column_idx[i] = static_cast<std::size_t>(found - header.begin());
  }
  const std::size_t columns = header.size();
  std::vector<FramePixel> starts;
  while (reader->Next(&line)) {
    const std::vector<std::string_view> cells = Cells(line);
    if (cells.size() == 1 && cells[0].empty()) continue;
    if (cells.size() != columns)
      return reader->Error("the header has " + std::to_string(columns) + " columns, this line has " +
                           std::to_string(cells.size()));
    FramePixel start;
    if (!ParseInt(cells[column_idx[0]], &start.frame_idx) || !ParseDouble(cells[column_idx[1]], &start.pixel.x()) ||
        !ParseDouble(cells[column_idx[2]], &start.pixel.y()))
      return reader->Error("frame is a whole number, u_px and v_px are numbers");
    starts.push_back(start);
  }
  if (Status status = reader->End(); !status.ok()) return status;
  return starts;
}

Result<std::vector<MaterialPath>> FollowMaterial(Simulator& simulator, std::span<const FramePixel> starts,
                                                 const SimulationProgress& progress) {
  if (Status status = CheckStarts(simulator, starts); !status.ok()) return status;
  std::vector<MaterialPath> paths(starts.size());
  std::map<int, std::vector<std::size_t>> starts_of_frame;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    paths[i].start = starts[i];
    starts_of_frame[starts[i].frame_idx].push_back(i);
  }
  for (const auto& [frame_idx, indices] : starts_of_frame) {
    std::vector<Eigen::Vector2d> pixels;
    for (const std::size_t i : indices) pixels.push_back(starts[i].pixel);
    const auto hits = simulator.HitsAt(frame_idx, pixels);
    for (std::size_t k = 0; k < indices.size(); ++k)
      if (hits[k]) paths[indices[k]].point = hits[k]->point;
  }
  std::vector<MaterialPoint> points;
  for (const MaterialPath& path : paths)
    if (path.point) points.push_back(*path.point);
  for (int frame_idx = 0; frame_idx < simulator.frame_count(); ++frame_idx) {
    const std::vector<MaterialObservation> seen = simulator.Observe(frame_idx, points);
    std::size_t next = 0;
    for (MaterialPath& path : paths)
      if (path.point) path.observations.push_back(seen[next++]);
    if (progress && progress(frame_idx + 1, simulator.frame_count()) == SimulationContinue::kStop)
      return {ErrorCode::kInterrupted, "stopped after " + std::to_string(frame_idx + 1) + " of " +
                                           std::to_string(simulator.frame_count()) + " frames; nothing was written"};
  }
  return paths;
}

Status WriteMaterialPaths(const fs::path& path, std::span<const MaterialPath> paths) {
  FileGroup group;
  auto file = group.Create(path.string());
  if (!file.ok()) return file.status();
  std::string rows = "point,frame,u_px,v_px,x,y,z,depth_mm,visibility\n";
  for (std::size_t i = 0; i < paths.size(); ++i) {
    for (std::size_t k = 0; k < paths[i].observations.size(); ++k) AppendRow(&rows, i, k, paths[i].observations[k]);
    if (Status status = file->AppendWhenLarge(&rows); !status.ok()) return status;
  }
  if (Status status = file->Append(rows); !status.ok()) return status;
  if (Status status = file->Close(); !status.ok()) return status;
  return group.Commit();
}

}  // namespace pliant
