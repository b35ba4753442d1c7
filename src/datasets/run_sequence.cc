// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/run_sequence.h"

#include <system_error>

#include "pliant/io/run_summary.h"

namespace pliant {

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

}  // namespace pliant
