// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/output_folder.h"

#include <filesystem>
#include <system_error>

#include "pliant/base/text.h"
#include "pliant/datasets/native_layout.h"

namespace pliant::cli {
namespace {

namespace fs = std::filesystem;

// A run that failed before it had a pose is nothing to keep.
bool HoldsRun(const fs::path& folder) {
  std::error_code error;
  const auto size = fs::file_size(folder / "trajectory.txt", error);
  return !error && size > 0 && fs::exists(folder / "run.json", error);
}

bool HoldsSequence(const fs::path& folder) {
  std::error_code error;
  const fs::path images = folder / native::kImageFolder;
  return fs::is_directory(images, error) && !fs::is_empty(images, error) && !error;
}

}  // namespace

void OutputFolder::AddTo(CommandLine* line, std::string why, Need need) {
  line->Add("output_path", &path, "DIR", std::move(why), need);
  line->AddFlag("overwrite", &overwrite, "replace what such a command left there before");
}

std::optional<int> OutputFolder::Check(const CommandLine& line, const std::string& folder, Content content) const {
  const bool is_taken = content == Content::kRun ? HoldsRun(folder) : HoldsSequence(folder);
  if (overwrite || !is_taken) return std::nullopt;
  return line.UsageError(Quoted(folder) + " holds a " + (content == Content::kRun ? "run" : "sequence") +
                         " already; give another --output_path, or --overwrite to replace it");
}

}  // namespace pliant::cli
