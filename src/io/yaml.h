// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What Pliant's own YAML files share: a root that is a map, no key twice, errors with file and line.
#pragma once

#include <string>

#include <yaml-cpp/yaml.h>

#include "pliant/base/status.h"

namespace pliant {

// Parses text that came from `path`, of at most 1 MB: the parser takes minutes for a hundred times as much. Fails with
// kUnreadable.
Result<YAML::Node> ParseYaml(const std::string& path, const std::string& text);
// The same, of a map whose keys are there once.
Result<YAML::Node> ParseYamlMap(const std::string& path, const std::string& text);
// Refuses a key that a map has twice (YAML forbids it; the parser does not).
Status CheckUniqueKeys(const std::string& path, const YAML::Node& map);

// `path:line`.
std::string PathAndLine(const std::string& path, const YAML::Node& node);
std::string KeyText(const YAML::Node& key);

}  // namespace pliant
