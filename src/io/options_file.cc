// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/options_file.h"

#include <utility>
#include <vector>

#include "io/yaml.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

Status SetGroup(const std::string& path, const std::string& group, const YAML::Node& options, OptionTable& table) {
  const auto invalid = [&](const YAML::Node& where, const std::string& what) {
    return Status(ErrorCode::kInvalidArgument, PathAndLine(path, where) + ": " + what);
  };
  if (Status status = CheckUniqueKeys(path, options); !status.ok()) return status;
  for (const auto& entry : options) {
    const std::string name = group + "." + KeyText(entry.first);
    std::string value;
    if (entry.second.IsScalar()) {
      value = entry.second.Scalar();
    } else if (!entry.second.IsNull()) {
      return invalid(entry.first, "the option " + name + " takes one value, not a list or a group");
    }
    if (Status status = table.Set(name, value); !status.ok()) return invalid(entry.first, status.message());
  }
  return Status::Ok();
}

}  // namespace

Status LoadOptionsFile(const std::string& path, OptionTable& table) {
  const auto text = ReadFile(path);
  if (!text.ok()) return text.status();
  const auto root = ParseYamlMap(path, *text);
  if (!root.ok()) return root.status();

  std::vector<std::string> before;
  for (const OptionField& field : table.fields()) before.push_back(field.get());
  Status status;
  for (const auto& group : *root) {
    if (group.second.IsMap()) {
      status = SetGroup(path, KeyText(group.first), group.second, table);
    } else if (!group.second.IsNull()) {
      status = {ErrorCode::kInvalidArgument, PathAndLine(path, group.first) + ": " + Quoted(KeyText(group.first)) +
                                                 " has no group; write options as `Group:` and, indented below it, "
                                                 "`option: value`"};
    }
    if (!status.ok()) break;
  }
  if (!status.ok()) {
    // Every value was printed by its own field, which reads it back.
    for (std::size_t i = 0; i < before.size(); ++i) static_cast<void>(table.fields()[i].set(before[i]));
  }
  return status;
}

}  // namespace pliant
