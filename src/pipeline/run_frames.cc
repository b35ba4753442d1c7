// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/run_frames.h"

#include <filesystem>
#include <system_error>

#include "pliant/base/text.h"

namespace pliant {

Status CheckOutsideOfRun(const std::string& run_path, const std::string& output_path, std::string_view kind) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path run = fs::canonical(run_path, error);
  if (error) return Status::Ok();  // what is not there is not overwritten
  const fs::path output = fs::weakly_canonical(fs::absolute(output_path), error);
  if (error) return Status::Ok();  // whoever writes there says why that cannot be
  const fs::path from_run = output.lexically_relative(run);
  if (from_run.empty() || *from_run.begin() == "..") return Status::Ok();
  const std::string what = "the " + std::string(kind) + " run would ";
  return {ErrorCode::kInvalidArgument, what + (from_run == "." ? "overwrite the run " : "be written inside the run ") +
                                           Quoted(run_path) + "; give another --output_path"};
}

Result<std::vector<int>> FramesWithPose(const std::string& path, const Run& run) {
  std::vector<int> frames_idx;
  for (const RunPose& pose : run.poses) {
    if (!pose.frame_idx)
      return Status(ErrorCode::kMismatch, Quoted(path) +
                                              " has no frames.csv, so it is another program's; make it a run with "
                                              "pliant import --format result");
    frames_idx.push_back(*pose.frame_idx);
  }
  return frames_idx;
}

Status CheckOneSubmap(int one, int other, PointId id) {
  if (one == other) return Status::Ok();
  return {ErrorCode::kMismatch, "the point " + std::to_string(id.value) + " is in the submaps " + std::to_string(one) +
                                    " and " + std::to_string(other) +
                                    ": the run was killed after the two were merged; finish it first, with pliant "
                                    "track --resume"};
}

FrameReport ReportOf(const RunFrame& frame, const RunMap& known) {
  FrameReport report;
  report.frame_idx = frame.frame_idx;
  report.timestamp_s = frame.timestamp_s;
  report.state = frame.state;
  report.submap = frame.submap;
  report.tracked = frame.tracked;
  report.lost = frame.lost;
  if (const auto name = known.names.find(frame.frame_idx); name != known.names.end()) report.name = name->second;
  return report;
}

void CompleteReport(const Run& run, const Camera& camera, FrameReport* report) {
  report->optimized = static_cast<int>(report->observations.size());
  report->added = static_cast<int>(report->new_points.size());
  report->median_reprojection_error_px =
      MedianReprojectionErrorPx(camera, *report->cam_from_world, report->observations);
  for (const FirstMapFrames& map : run.summary->first_maps)
    if (map.declared_frame_idx == report->frame_idx) report->first_map = map;
}

}  // namespace pliant
