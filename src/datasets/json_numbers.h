// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Vectors and matrices in the JSON files of data sets.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

namespace pliant {

// The numbers of a list, or of a list of lists, rows first, that `object` has under this key. None where it has no such
// list; what is no number is passed over.
inline std::vector<double> NumbersAt(const nlohmann::json& object, const char* key) {
  std::vector<double> numbers;
  const auto add = [&](const nlohmann::json& value) {
    if (value.is_number()) numbers.push_back(value.get<double>());
  };
  if (!object.is_object() || !object.contains(key) || !object[key].is_array()) return numbers;
  for (const nlohmann::json& part : object[key]) {
    add(part);
    if (part.is_array())
      for (const nlohmann::json& value : part) add(value);
  }
  return numbers;
}

}  // namespace pliant
