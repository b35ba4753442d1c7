// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/options.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "pliant/base/text.h"

namespace pliant {
namespace {

// A plain YAML scalar where it is safe, a double-quoted one elsewhere.
std::string YamlScalar(const std::string& text) {
  const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '.' || c == '-' || c == '+' || c == '/';
  });
  if (plain) return text;
  constexpr std::string_view kHexDigits = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::iscntrl(byte) != 0) {  // a line break would be read as a space
      quoted.append("\\x").append(1, kHexDigits[byte / 16]).append(1, kHexDigits[byte % 16]);
      continue;
    }
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

std::string FormatDouble(double value) {
  std::array<char, 64> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

bool ParseDouble(std::string_view text, double* value) {
  double parsed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), parsed);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  *value = parsed;
  return true;
}

bool ParseInt(std::string_view text, int* value) {
  int parsed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), parsed);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  *value = parsed;
  return true;
}

namespace {

char Lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substitute = diagonal + (Lower(a[i]) != Lower(b[j]) ? 1 : 0);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, substitute});
    }
  }
  return row.back();
}

// Edits from one to the other; less than one where `name` is how the other begins, or what it is within its group.
double DistanceTo(std::string_view name, std::string_view candidate) {
  constexpr std::size_t kShortestBeginning = 3;
  constexpr double kOfBeginning = 0.5;
  constexpr double kOfGroup = 0.25;
  const auto to = [&](std::string_view other) {
    const bool begins = name.size() >= kShortestBeginning && other.size() > name.size() &&
                        EditDistance(name, other.substr(0, name.size())) == 0;
    return begins ? kOfBeginning : static_cast<double>(EditDistance(name, other));
  };
  const std::size_t dot = candidate.rfind('.');
  const double whole = to(candidate);
  return dot == std::string_view::npos ? whole : std::min(whole, to(candidate.substr(dot + 1)) + kOfGroup);
}

struct Nearest {
  std::string name = {};
  double distance = std::numeric_limits<double>::infinity();
};

Nearest FindNearest(std::string_view name, const std::vector<std::string>& names) {
  Nearest nearest;
  for (const std::string& candidate : names)
    if (const double distance = DistanceTo(name, candidate); distance < nearest.distance)
      nearest = {candidate, distance};
  return nearest;
}

}  // namespace

std::string NearestName(std::string_view name, const std::vector<std::string>& names) {
  return FindNearest(name, names).name;
}

std::string SimilarName(std::string_view name, const std::vector<std::string>& names) {
  Nearest nearest = FindNearest(name, names);
  return 2 * nearest.distance < static_cast<double>(name.size()) ? std::move(nearest.name) : std::string();
}

void OptionTable::BeginGroup(std::string name, std::string why) {
  group_ = std::move(name);
  groups_.emplace_back(group_, std::move(why));
}

void OptionTable::AddField(OptionField field) {
  assert(!group_.empty());
  field.name = group_ + "." + field.name;
  assert(Find(field.name) == nullptr);
  fields_.push_back(std::move(field));
}

void OptionTable::Add(std::string name, bool* value, std::string unit, std::string why) {
  const std::string full_name = group_ + "." + name;
  AddField({std::move(name), std::move(unit), std::move(why), [value] { return *value ? "true" : "false"; },
            [value, full_name](std::string_view text) {
              if (text == "true" || text == "1" || text == "on" || text == "yes") {
                *value = true;
              } else if (text == "false" || text == "0" || text == "off" || text == "no") {
                *value = false;
              } else {
                return Status(ErrorCode::kInvalidArgument, full_name + " is " + Quoted(text) + "; give true or false");
              }
              return Status::Ok();
            }});
}

void OptionTable::Add(std::string name, int* value, std::string unit, std::string why, int low, int high) {
  const std::string full_name = group_ + "." + name;
  AddField({std::move(name), std::move(unit), std::move(why), [value] { return std::to_string(*value); },
            [value, full_name, low, high](std::string_view text) {
              int parsed = 0;
              if (!ParseInt(text, &parsed) || parsed < low || parsed > high)
                return Status(ErrorCode::kInvalidArgument, full_name + " is " + Quoted(text) +
                                                               "; give a whole number from " + std::to_string(low) +
                                                               " to " + std::to_string(high));
              *value = parsed;
              return Status::Ok();
            }});
}

void OptionTable::Add(std::string name, double* value, std::string unit, std::string why, double low, double high) {
  const std::string full_name = group_ + "." + name;
  const bool has_unit = !unit.empty() && unit != "-" && unit != "1";
  const std::string range = FormatDouble(low) + " to " + FormatDouble(high) + (has_unit ? " " + unit : "");
  AddField({std::move(name), std::move(unit), std::move(why), [value] { return FormatDouble(*value); },
            [value, full_name, range, low, high](std::string_view text) {
              double parsed = 0;
              if (!ParseDouble(text, &parsed) || !(parsed >= low && parsed <= high))
                return Status(ErrorCode::kInvalidArgument,
                              full_name + " is " + Quoted(text) + "; give a number from " + range);
              *value = parsed;
              return Status::Ok();
            }});
}

void OptionTable::Add(std::string name, std::string* value, std::string unit, std::string why) {
  AddField({std::move(name), std::move(unit), std::move(why), [value] { return *value; },
            [value](std::string_view text) {
              *value = text;
              return Status::Ok();
            }});
}

void OptionTable::AddChoice(std::string name, std::vector<std::string> names, std::string why,
                            std::function<std::string()> get, std::function<void(std::size_t)> set_index) {
  const std::string full_name = group_ + "." + name;
  std::string unit;
  for (const std::string& n : names) unit += (unit.empty() ? "" : " | ") + n;
  AddField({std::move(name), unit, std::move(why), std::move(get),
            [names = std::move(names), unit, full_name, set_index = std::move(set_index)](std::string_view text) {
              const auto it = std::find(names.begin(), names.end(), text);
              if (it == names.end())
                return Status(ErrorCode::kInvalidArgument, full_name + " is " + Quoted(text) + "; give one of " + unit);
              set_index(static_cast<std::size_t>(it - names.begin()));
              return Status::Ok();
            }});
}

void OptionTable::AddChoices(std::string name, std::vector<std::string> names, std::string why,
                             std::function<std::vector<std::string>()> get,
                             std::function<void(const std::vector<std::size_t>&)> set_indices) {
  const std::string full_name = group_ + "." + name;
  std::string unit;
  for (const std::string& n : names) unit += n + ", ";
  unit += "several with commas, or all";
  AddField({std::move(name), unit, std::move(why),
            [get = std::move(get)] {
              std::string text;
              for (const std::string& n : get()) text += (text.empty() ? "" : ",") + n;
              return text;
            },
            [names = std::move(names), unit, full_name, set_indices = std::move(set_indices)](std::string_view text) {
              std::vector<bool> chosen(names.size(), text == "all");
              for (const std::string_view part : Words(text)) {
                if (text == "all") break;
                const auto it = std::find(names.begin(), names.end(), part);
                if (it == names.end())
                  return Status(ErrorCode::kInvalidArgument, full_name + " is " + Quoted(text) + "; give " + unit);
                chosen[static_cast<std::size_t>(it - names.begin())] = true;
              }
              std::vector<std::size_t> indices;
              for (std::size_t i = 0; i < chosen.size(); ++i)
                if (chosen[i]) indices.push_back(i);
              set_indices(indices);
              return Status::Ok();
            }});
}

const OptionField* OptionTable::Find(std::string_view name) const {
  const auto it = std::find_if(fields_.begin(), fields_.end(), [&](const OptionField& f) { return f.name == name; });
  return it == fields_.end() ? nullptr : &*it;
}

std::string OptionTable::FullName(const std::string& name) const {
  return name.find('.') == std::string::npos ? group_ + "." + name : name;
}

void OptionTable::Renamed(const std::string& old_name, const std::string& name) {
  renamed_.emplace_back(FullName(old_name), FullName(name));
}

void OptionTable::RenamedValue(const std::string& name, const std::string& old_value, std::string value) {
  renamed_values_.emplace_back(FullName(name) + "=" + old_value, std::move(value));
}

void OptionTable::RenamedGroup(std::string old_group, std::string group) {
  renamed_groups_.emplace_back(std::move(old_group), std::move(group));
}

std::string OptionTable::RenamedSentence(std::string_view name) const {
  const std::string old_name(name);
  std::string present = old_name;
  for (const auto& [old_group, group] : renamed_groups_)
    if (name.starts_with(old_group + ".")) present = group + old_name.substr(old_group.size());
  for (const auto& [old_option, option] : renamed_)
    if (old_option == old_name || old_option == present) present = option;
  return present == old_name || Find(present) == nullptr ? std::string() : old_name + " is now called " + present;
}

Status OptionTable::Set(std::string_view name, std::string_view value) {
  const OptionField* field = Find(name);
  if (field == nullptr) {
    if (std::string sentence = RenamedSentence(name); !sentence.empty())
      return {ErrorCode::kInvalidArgument, std::move(sentence)};
    std::vector<std::string> names;
    for (const OptionField& f : fields_) names.push_back(f.name);
    return {ErrorCode::kInvalidArgument,
            "there is no option " + Quoted(name) + "; did you mean " + Quoted(NearestName(name, names)) + "?"};
  }
  for (const std::string_view part : Words(value))
    for (const auto& [old_value, present] : renamed_values_)
      if (old_value == field->name + "=" + std::string(part))
        return {ErrorCode::kInvalidArgument,
                "the value " + Quoted(part) + " of " + field->name + " is now called " + Quoted(present)};
  return field->set(value);
}

std::string OptionTable::ToYaml() const {
  std::string yaml;
  for (const auto& [group, why] : groups_) {
    if (!yaml.empty()) yaml += '\n';
    yaml.append(group).append(":  # ").append(why).append("\n");
    for (const OptionField& field : fields_) {
      if (!field.name.starts_with(group + ".")) continue;
      const std::string line = "  " + field.name.substr(group.size() + 1) + ": " + YamlScalar(field.get());
      yaml += line + std::string(line.size() < 34 ? 34 - line.size() : 1, ' ') + "# [" + field.unit + "] " + field.why +
              "\n";
    }
  }
  return yaml;
}

}  // namespace pliant
