// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <utility>

#include "exchange/imported.h"
#include "pliant/base/text.h"
#include "pliant/datasets/match_poses.h"
#include "pliant/evaluation/run_input.h"
#include "pliant/io/trajectory.h"

namespace pliant {
namespace {

Result<Imported> FromKitti(const std::string& path, const Sequence& sequence) {
  const auto poses = ReadKittiPoses(path);
  if (!poses.ok()) return poses.status();
  // A system that leaves lost frames out does not say which ones: all lines behind them would belong to other frames.
  if (poses->size() != static_cast<std::size_t>(sequence.size()))
    return Status(ErrorCode::kMismatch,
                  Quoted(path) + " has " + std::to_string(poses->size()) +
                      " poses, a line a frame, and the sequence has " + std::to_string(sequence.size()) +
                      " frames; give a camera path with times (--format tum), which says the frame of each pose");
  Imported imported;
  for (std::size_t i = 0; i < poses->size(); ++i)
    imported.frames.emplace(static_cast<int>(i), ImportedFrame{(*poses)[i].Inverse(), {}});
  return imported;
}

}  // namespace

Result<Imported> ReadTrajectory(const std::string& path, ImportFormat format, const Sequence& sequence,
                                const ImportOptions& options) {
  if (format == ImportFormat::kKitti) return FromKitti(path, sequence);
  const auto poses = format == ImportFormat::kEuroc ? ReadEurocTrajectory(path) : ReadTumTrajectory(path);
  if (!poses.ok()) return poses.status();
  const auto matched = MatchPoses(*poses, sequence, options.max_time_difference_s, Quoted(path));
  if (!matched.ok()) return matched.status();
  Imported imported;
  for (const auto& [frame_idx, world_from_cam] : matched->world_from_cam)
    imported.frames.emplace(frame_idx, ImportedFrame{world_from_cam.Inverse(), {}});
  imported.notes = matched->notes;
  return imported;
}

Result<Imported> ReadResult(const std::string& folder, const Sequence& sequence, const ImportOptions& options) {
  MatchingOptions matching;
  matching.max_time_difference_s = options.max_time_difference_s;
  auto input = ReadEvaluationInput(folder, sequence, matching);
  if (!input.ok()) return input.status();
  Imported imported;
  imported.camera = std::move(input->camera);
  imported.notes = std::move(input->notes);
  for (EvaluationFrame& frame : input->frames)
    if (frame.cam_from_world)
      imported.frames.emplace(frame.frame_idx, ImportedFrame{*frame.cam_from_world, std::move(frame.observations)});
  return imported;
}

}  // namespace pliant
