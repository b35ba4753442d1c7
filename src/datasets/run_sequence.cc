// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/run_sequence.h"

#include <system_error>
#include <utility>

#include "pliant/base/text.h"
#include "pliant/io/run_summary.h"

namespace pliant {
namespace {

// The camera and the images' names.
Result<RunMap> MapFromSequence(const SequenceRequest& request, const Run& run) {
  const auto sequence = OpenSequence(request);
  if (!sequence.ok()) return sequence.status();
  RunMap known;
  known.camera = (*sequence)->camera();
  for (const RunFrame& frame : run.frames)
    if (auto name = (*sequence)->Name(frame.frame_idx)) known.names.emplace(frame.frame_idx, *std::move(name));
  return known;
}

}  // namespace

SequenceRequest SequenceOfRun(const std::string& run_path, const std::filesystem::path& sequence_path,
                              const std::filesystem::path& camera_path) {
  SequenceRequest request{.image_path = sequence_path, .camera_path = camera_path};
  const auto summary = ReadRunSummary(run_path + "/run.json");
  if (!summary.ok()) return request;
  const std::filesystem::path input = summary->description.input;
  if (sequence_path.empty()) request.image_path = input;
  std::error_code error;
  const bool same = request.image_path == input || std::filesystem::equivalent(request.image_path, input, error);
  if (same) request.spare_camera_path = summary->description.camera;
  return request;
}

Result<RunMap> KnownMapOfRun(const std::string& run_path, const SequenceRequest& sequence, const Run& run) {
  if (HasRunMap(run_path)) return ReadRunMap(run_path, run);
  if (!sequence.image_path.empty()) {
    auto known = MapFromSequence(sequence, run);
    if (known.ok()) return known;
    return Status(known.status().code(), "the run has no sparse/ to take the camera and the images' names from, and " +
                                             known.status().message());
  }
  return Status(ErrorCode::kNotFound, Quoted(run_path) +
                                          " has no sparse/ to take the camera and the images' names "
                                          "from; name its sequence with --sequence");
}

}  // namespace pliant
