// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the commands' command lines have in common. A command has arguments of its own (--image_path PATH) and options
// (--Group.option VALUE or --Group.option=VALUE) that an OptionTable lists. The order of a command:
//   CommandLine line(kManual);  line.Add(...);            its own arguments
//   if (auto exit = line.Parse(args)) return *exit;        reads them; the options' flags are kept for later
//   TrackOptions options = MakeTrackOptions(preset);       what the arguments choose as defaults
//   OptionTable table;  options.List(table);
//   if (auto exit = line.Resolve(table)) return *exit;     --config FILE, then the flags; --help, --print_config
// Every command gets --config, --print_config, --help, --help-all and what messages.h needs from here. Manuals go to
// standard output.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/options.h"
#include "pliant/base/status.h"

namespace pliant::cli {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;  // the command was understood, but could not be carried out
inline constexpr int kExitUsage = 2;   // the command line or an option file is wrong

struct Manual {
  std::string_view command;  // "track"; empty for a program that does one thing
  std::string_view summary;  // one line, no full stop
  std::string_view text;     // what it does, what it reads, what it leaves; paragraphs separated by an empty line
  std::vector<std::string_view> examples;
  // The options that --help describes, where there are many; --help-all describes all of them. Empty: all.
  std::vector<std::string_view> main_options = {};
  std::string_view program = "pliant";
};

enum class Need { kRequired, kOptional };

// Whether an argument may also be given without its name. Each command has at most one: what it is about.
enum class Positional { kNo, kYes };

// A command of commands: pliant model check.
struct Verb {
  std::string_view name;
  std::string_view arguments;  // for the usage: "DIR"
  int (*run)(std::span<const std::string> args);
};

// The verb that the first of `args` names, with the others; else the usage, as an error unless --help asked for it.
int RunVerb(std::string_view command, std::span<const Verb> verbs, std::span<const std::string> args);

class CommandLine {
 public:
  explicit CommandLine(Manual manual);

  // An argument `--name VALUE`. The value at the time of the call is its default in the manual.
  void Add(std::string name, std::string* value, const std::string& placeholder, std::string why, Need need,
           Positional positional = Positional::kNo);
  void Add(std::string name, int* value, std::string why, int low, int high);
  // An argument that may be given several times; the values in the order given.
  void Add(std::string name, std::vector<std::string>* values, const std::string& placeholder, std::string why,
           Need need, Positional positional = Positional::kNo);
  // An argument without a value.
  void AddFlag(std::string name, bool* value, std::string why);
  // One of the given names.
  void AddChoice(std::string name, std::string* value, const std::vector<std::string_view>& names, std::string why);
  // One of the named values of an enum (EnumNames).
  template <class Enum>
  void AddChoice(std::string name, Enum* value, std::string why) {
    std::vector<std::string_view> names;
    for (const auto& entry : EnumNames<Enum>::kNames) names.push_back(entry.second);
    AddChoice(std::move(name), EnumName(*value), names, std::move(why), [value](std::string_view text) {
      for (const auto& [candidate, candidate_name] : EnumNames<Enum>::kNames)
        if (candidate_name == text) *value = candidate;
    });
  }

  // An argument that had another name: whoever gives that one is told.
  void Renamed(std::string former, std::string name) { former_names_[std::move(former)] = std::move(name); }

  // A short name of an option: as if `--Group.option VALUE` were given last.
  void AddAlias(std::string name, std::string option, const std::string& placeholder, std::string why);

  // Reads the command's own arguments. An exit code when the command line is wrong (the sentence has been said).
  std::optional<int> Parse(std::span<const std::string> args);

  // Sets the options: the file of --config first, then the flags. Then --help or --print_config is answered, else a
  // missing required argument is an error. An exit code when the command is to end here.
  std::optional<int> Resolve(OptionTable& options);

  // The command as it was given, for what it leaves: "pliant", its name, `args`.
  std::vector<std::string> Words(std::span<const std::string> args) const;

  // For errors in the values of arguments that the command itself finds: says it and gives kExitUsage.
  int UsageError(std::string_view sentence) const;

  // For what could not be carried out: says it and gives kExitFailed.
  int Failure(std::string_view sentence) const;
  // The same of what the library says: what it takes for a wrong argument is wrong usage (kExitUsage).
  int Failure(const Status& status) const;

  enum class Detail { kMain, kAll };
  // The manual of `--help`, or of `--help-all`.
  std::string ManualText(const OptionTable& options, Detail detail) const;

 private:
  // `set` gets one of the names; `value` is the one that it has at first.
  void AddChoice(std::string name, std::string_view value, const std::vector<std::string_view>& names, std::string why,
                 std::function<void(std::string_view)> set);
  enum class Times { kOnce, kSeveral };
  struct Argument {
    std::string name;
    std::string placeholder;  // empty: a flag
    std::string why;
    std::string accepts;  // "a whole number from 0 to 9"
    std::string default_text;
    Need need = Need::kOptional;
    std::function<bool(std::string_view)> set;  // false: a value that it does not accept
    std::vector<std::string> given = {};        // what the command line gave: values, or one entry for a flag
    Times times = Times::kOnce;
    Positional positional = Positional::kNo;
  };

  bool IsShown(const OptionField& field, Detail detail) const;
  std::string OptionsText(const OptionTable& options, Detail detail) const;
  void AddArgument(Argument argument);
  Status ReadArguments(std::span<const std::string> args);
  Status ApplyFlags(OptionTable& options) const;
  std::string Hint(std::string_view flag, const OptionTable& options) const;

  Manual manual_;
  std::vector<Argument> arguments_;
  std::map<std::string, std::string> former_names_;
  std::vector<std::string> extras_;  // the options' flags and their values: what CLI11 did not know, and aliases
  std::string config_path_;
  bool print_config_ = false;
  bool quiet_ = false;
  bool help_ = false;
  bool help_all_ = false;
};

}  // namespace pliant::cli
