// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/run_options.h"

#include "io/yaml.h"
#include "pliant/base/files.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"

namespace pliant {

Result<std::vector<NamedText>> ReadRunOptions(const std::string& run_path) {
  std::vector<NamedText> options;
  const std::string path = run_path + "/config.yaml";
  if (!Exists(path)) return options;
  const auto text = ReadFile(path);
  if (!text.ok()) return text.status();
  const auto root = ParseYaml(path, *text);
  if (!root.ok()) return root.status();
  try {
    for (const auto& group : *root)
      for (const auto& option : group.second)
        options.push_back({group.first.Scalar(), option.first.Scalar(), option.second.Scalar()});
  } catch (const YAML::Exception& error) {
    return Status(ErrorCode::kUnreadable, path + " is not a run's: " + error.what());
  }
  return options;
}

bool AreMetric(const std::vector<NamedText>& options) {
  InitOptions init;
  OptionTable table;
  init.List(table);
  for (const NamedText& option : options)
    if (option.group == "Init")
      static_cast<void>(table.Set("Init." + option.name, option.value));  // of another version: is as it is by default
  return init.IsMetric();
}

}  // namespace pliant
