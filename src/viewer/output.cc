// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/output.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "pliant/base/text.h"

namespace pliant {
namespace {

struct OutputKind {
  std::string_view name;
  std::vector<std::string_view> endings;
};

OutputKind KindOf(ViewOutput output) {
  switch (output) {
    case ViewOutput::kFigure:
      return {"a figure", {".png", ".svg", ".pdf"}};
    case ViewOutput::kFilm:
      return {"a film", {".mp4"}};
    case ViewOutput::kPage:
      break;
  }
  return {"a report", {".html", ".htm"}};
}

}  // namespace

Status CheckEnding(ViewOutput output, const std::string& path, std::string_view argument) {
  const OutputKind kind = KindOf(output);
  const std::string ending = std::filesystem::path(path).extension().string();
  if (std::ranges::find(kind.endings, ending) != kind.endings.end()) return Status::Ok();
  std::string endings;
  for (const std::string_view known : kind.endings) endings += (endings.empty() ? "" : " or ") + std::string(known);
  return {ErrorCode::kInvalidArgument,
          std::string(argument) + " is " + Quoted(path) + "; " + std::string(kind.name) + " ends with " + endings};
}

}  // namespace pliant
