// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/output_folder.h"

#include <filesystem>
#include <system_error>

#include "pliant/base/text.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/io/run_writer.h"

namespace pliant::cli {
namespace {

namespace fs = std::filesystem;

bool HoldsSequence(const fs::path& folder) {
  std::error_code error;
  const fs::path images = folder / native::kImageFolder;
  return fs::is_directory(images, error) && !fs::is_empty(images, error) && !error;
}

bool HoldsSurface(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / "surface.json", error);
}

struct Kind {
  const char* name;
  bool (*is_there)(const fs::path& folder);
};

Kind KindOf(OutputFolder::Content content) {
  switch (content) {
    case OutputFolder::Content::kSequence:
      return {"sequence", HoldsSequence};
    case OutputFolder::Content::kSurface:
      return {"surface", HoldsSurface};
    case OutputFolder::Content::kRun:
      break;
  }
  return {"run", HoldsRun};
}

}  // namespace

void OutputFolder::AddTo(CommandLine* line, std::string why, Need need) {
  line->Add("output_path", &path, "DIR", std::move(why), need);
  line->AddFlag("overwrite", &overwrite, "replace what such a command left there before");
}

std::optional<int> OutputFolder::Check(const CommandLine& line, const std::string& folder, Content content) const {
  if (content == Content::kSequence && HoldsRun(folder))
    return line.UsageError(Quoted(folder) + " holds a run; give another --output_path");
  const Kind kind = KindOf(content);
  if (overwrite || !kind.is_there(folder)) return std::nullopt;
  return line.UsageError(Quoted(folder) + " holds a " + kind.name +
                         " already; give another --output_path, or --overwrite to replace it");
}

}  // namespace pliant::cli
