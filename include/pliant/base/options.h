// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Options by name. Every algorithm has a struct of options whose fields are listed once, in
//   void MyOptions::List(OptionTable& table) { table.Add("levels", &levels, "-", "pyramid levels", 1, 8); }
// and that one list serves the configuration file, the command line, the printed manual and the validation.
// A field's full name is "Group.option". A table holds pointers into the structs: it must not outlive them.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/status.h"

namespace pliant {

// One option. `get` prints the present value so that `set` reads the same value back.
struct OptionField {
  std::string name;  // "Group.option"
  std::string unit;  // "px", "mm" ..., "-", "1" or empty where there is none; for a choice its names, "a | b"
  std::string why;   // one line
  std::function<std::string()> get;
  std::function<Status(std::string_view)> set;  // refuses what cannot be read or is out of range
};

// The names of an enum's values; specialise it beside the enum:
//   template <> struct EnumNames<Policy> {
//     static constexpr std::array kNames = {std::pair{Policy::kPeriodic, std::string_view("periodic")}, ...}; };
template <class Enum>
struct EnumNames;

template <class Enum>
std::string_view EnumName(Enum value) {
  for (const auto& [candidate, name] : EnumNames<Enum>::kNames)
    if (candidate == value) return name;
  return "?";
}

// A choice that has no other names.
enum class Switch { kOff, kOn };
template <>
struct EnumNames<Switch> {
  static constexpr std::array kNames = {std::pair{Switch::kOff, std::string_view("off")},
                                        std::pair{Switch::kOn, std::string_view("on")}};
};

class OptionTable {
 public:
  // The fields added from here on belong to this group; `why` describes it in one line.
  void BeginGroup(std::string name, std::string why);

  // Ranges are inclusive. Not-a-number is always refused.
  void Add(std::string name, bool* value, std::string unit, std::string why);
  void Add(std::string name, int* value, std::string unit, std::string why, int low, int high);
  void Add(std::string name, double* value, std::string unit, std::string why, double low, double high);
  void Add(std::string name, std::string* value, std::string unit, std::string why);

  // One of the named values of an enum (EnumNames).
  template <class Enum>
  void AddChoice(std::string name, Enum* value, std::string why) {
    std::vector<std::string> names;
    for (const auto& entry : EnumNames<Enum>::kNames) names.emplace_back(entry.second);
    AddChoice(
        std::move(name), std::move(names), std::move(why), [value] { return std::string(EnumName(*value)); },
        [value](std::size_t index) { *value = EnumNames<Enum>::kNames[index].first; });
  }

  // Any number of them: "one,another", "all" for every one, empty for none. They are kept in the enum's order, each
  // once.
  template <class Enum>
  void AddChoices(std::string name, std::vector<Enum>* values, std::string why) {
    std::vector<std::string> names;
    for (const auto& entry : EnumNames<Enum>::kNames) names.emplace_back(entry.second);
    AddChoices(
        std::move(name), std::move(names), std::move(why),
        [values] {
          std::vector<std::string> present;
          for (const Enum value : *values) present.emplace_back(EnumName(value));
          return present;
        },
        [values](const std::vector<std::size_t>& indices) {
          values->clear();
          for (const std::size_t index : indices) values->push_back(EnumNames<Enum>::kNames[index].first);
        });
  }

  // Earlier names, of an option of the present group (or "Group.option" of another one), of a value of a choice of the
  // present group, and of a whole group. They are listed nowhere; who still gives one is told the name of today.
  void Renamed(const std::string& old_name, const std::string& name);
  void RenamedValue(const std::string& name, const std::string& old_value, std::string value);
  void RenamedGroup(std::string old_group, std::string group);

  const std::vector<OptionField>& fields() const { return fields_; }
  const std::vector<std::pair<std::string, std::string>>& groups() const { return groups_; }  // name, why
  const OptionField* Find(std::string_view name) const;

  // "Growth.old is now called Growth.new" where `name` is an earlier name; else empty.
  std::string RenamedSentence(std::string_view name) const;

  // Sets one option from text. An earlier name is an error that says the name of today; an unknown one, an error that
  // names its nearest neighbor; a bad value, an error that names the option, its range and its unit. Nothing is changed
  // on error.
  Status Set(std::string_view name, std::string_view value);

  // The table as YAML with every option's unit and reason as a comment; LoadOptionsFile (io) reads it back.
  std::string ToYaml() const;

 private:
  void AddChoice(std::string name, std::vector<std::string> names, std::string why, std::function<std::string()> get,
                 std::function<void(std::size_t)> set_index);
  void AddChoices(std::string name, std::vector<std::string> names, std::string why,
                  std::function<std::vector<std::string>()> get,
                  std::function<void(const std::vector<std::size_t>&)> set_indices);
  void AddField(OptionField field);
  std::string FullName(const std::string& name) const;

  std::string group_;
  std::vector<std::pair<std::string, std::string>> groups_;
  std::vector<OptionField> fields_;
  std::vector<std::pair<std::string, std::string>> renamed_;         // full names: old, new
  std::vector<std::pair<std::string, std::string>> renamed_groups_;  // old, new
  std::vector<std::pair<std::string, std::string>> renamed_values_;  // "Group.option=old", new
};

// The entry of `names` nearest to `name` (Levenshtein distance, upper and lower case alike, and of "Group.name" the
// name by itself; one that begins with `name` is nearer than any with an edit); empty if `names` is empty.
std::string NearestName(std::string_view name, const std::vector<std::string>& names);
// The same, or nothing where half of its letters would have to be others.
std::string SimilarName(std::string_view name, const std::vector<std::string>& names);

// Prints a double so that it reads back to the same value, in as few digits as possible.
std::string FormatDouble(double value);
// Reads the whole of `text` as a number; false if it is not one.
bool ParseDouble(std::string_view text, double* value);
bool ParseInt(std::string_view text, int* value);

}  // namespace pliant
