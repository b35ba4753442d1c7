// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/yaml.h"

#include <cstddef>
#include <set>

#include "pliant/base/text.h"

namespace pliant {

std::string PathAndLine(const std::string& path, const YAML::Node& node) {
  return PathAndLine(path, node.Mark().line + 1);
}

std::string KeyText(const YAML::Node& key) { return key.IsScalar() ? key.Scalar() : "?"; }

Result<YAML::Node> ParseYaml(const std::string& path, const std::string& text) {
  constexpr std::size_t kMaxBytes = 1'000'000;
  if (text.size() > kMaxBytes)
    return Status(ErrorCode::kUnreadable,
                  Quoted(path) + " has more than 1 MB, which no calibration and no options have");
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    return Status(ErrorCode::kUnreadable, PathAndLine(path, error.mark.line + 1) + ": this is not YAML: " + error.msg);
  }
}

Result<YAML::Node> ParseYamlMap(const std::string& path, const std::string& text) {
  auto root = ParseYaml(path, text);
  if (!root.ok()) return root.status();
  if (!root->IsMap() && !root->IsNull())
    return Status(ErrorCode::kUnreadable, PathAndLine(path, 1) + ": expected lines `name: value`");
  if (const Status status = CheckUniqueKeys(path, *root); !status.ok()) return status;
  return root;
}

Status CheckUniqueKeys(const std::string& path, const YAML::Node& map) {
  std::set<std::string> keys;
  for (const auto& entry : map)
    if (!keys.insert(KeyText(entry.first)).second)
      return {ErrorCode::kInvalidArgument,
              PathAndLine(path, entry.first) + ": " + Quoted(KeyText(entry.first)) + " is given twice; leave one"};
  return Status::Ok();
}

}  // namespace pliant
