// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/command_line.h"

#include <algorithm>
#include <iostream>
#include <set>
#include <sstream>
#include <utility>

#include <CLI/CLI.hpp>

#include "cli/messages.h"
#include "pliant/base/text.h"
#include "pliant/io/options_file.h"

namespace pliant::cli {
namespace {

constexpr std::size_t kManualWidth = 100;

// `text` broken into lines of the manual's width, each behind `indent` spaces.
std::string Wrap(std::string_view text, std::size_t indent) {
  std::istringstream words{std::string(text)};
  std::string wrapped;
  std::size_t column = 0;
  for (std::string word; words >> word;) {
    if (column == 0 || column + 1 + word.size() > kManualWidth) {
      wrapped += (column == 0 ? "" : "\n") + std::string(indent, ' ') + word;
      column = indent + word.size();
    } else {
      wrapped += " " + word;
      column += 1 + word.size();
    }
  }
  return wrapped + "\n";
}

// CLI11's sentences speak of its own types and counts.
std::string ArgumentError(const CLI::ParseError& error) {
  std::string text = error.what();
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) == nullptr) return text;
  const std::string name = text.substr(0, text.find(':'));
  return name + (text.find("missing") != std::string::npos ? " needs a value" : " is given more than once; leave one");
}

std::string NameOf(std::string_view program, std::string_view command) {
  return std::string(program) + (command.empty() ? "" : " ") + std::string(command);
}

// How it is called: "pliant track".
std::string NameOf(const Manual& manual) { return NameOf(manual.program, manual.command); }

// The usual short names.
std::string ShortFlagOf(const std::string& name) {
  if (name == "output_path") return "-o";
  return name == "help" ? "-h" : "";
}

// With `--Group.option VALUE` as one word: CLI11 knows no options, and would take their values for arguments without a
// name.
std::vector<std::string> WithOptionsJoined(std::span<const std::string> args) {
  std::vector<std::string> joined;
  for (std::size_t i = 0; i < args.size(); ++i) {
    joined.push_back(args[i]);
    const bool is_option = args[i].starts_with("--") && args[i].find('.') != std::string::npos;
    const bool has_value = args[i].find('=') != std::string::npos;
    if (is_option && !has_value && i + 1 < args.size() && !args[i + 1].starts_with("--"))
      joined.back() += "=" + args[++i];
  }
  return joined;
}

bool AsksForJson(std::span<const std::string> args) {
  for (std::size_t i = 0; i < args.size(); ++i)
    if (args[i] == "--log_format=json" || (args[i] == "--log_format" && i + 1 < args.size() && args[i + 1] == "json"))
      return true;
  return false;
}

// As CLI11 takes them.
std::string FlagsOf(const std::string& name) {
  const std::string short_flag = ShortFlagOf(name);
  return short_flag + (short_flag.empty() ? "--" : ",--") + name;
}

// Paragraphs, separated by empty lines as they come.
std::string WrapParagraphs(std::string_view text, std::size_t indent) {
  std::string wrapped;
  while (!text.empty()) {
    const std::size_t end = text.find("\n\n");
    wrapped += (wrapped.empty() ? "" : "\n") + Wrap(text.substr(0, end), indent);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 2);
  }
  return wrapped;
}

}  // namespace

int RunVerb(std::string_view command, std::span<const Verb> verbs, std::span<const std::string> args) {
  const std::string name = args.empty() ? "" : args.front();
  for (const Verb& verb : verbs)
    if (name == verb.name) return verb.run(args.subspan(1));
  std::string usage;
  for (const Verb& verb : verbs)
    usage += (usage.empty() ? "usage: " : "       ") + ("pliant " + std::string(command)) + " " +
             std::string(verb.name) + " " + std::string(verb.arguments) + "\n";
  usage += "\nWith --help each of them prints its manual, with --help-all that with all options.\n";
  const bool asked = name == "--help" || name == "--help-all" || name == "-h" || name == "help";
  TheLogging() = {NameOf("pliant", command)};
  if (!asked) SayError(name.empty() ? "give one of its verbs" : "it has no verb " + Quoted(name));
  (asked ? std::cout : std::cerr) << usage;
  return asked ? kExitOk : kExitUsage;
}

CommandLine::CommandLine(Manual manual) : manual_(std::move(manual)) { TheLogging() = {NameOf(manual_)}; }

void CommandLine::AddArgument(Argument argument) { arguments_.push_back(std::move(argument)); }

void CommandLine::Add(std::string name, std::string* value, const std::string& placeholder, std::string why, Need need,
                      Positional positional) {
  AddArgument({std::move(name), placeholder, std::move(why), placeholder, *value, need, [value](std::string_view text) {
                 *value = text;
                 return !text.empty();
               }});
  arguments_.back().positional = positional;
}

void CommandLine::Add(std::string name, int* value, std::string why, int low, int high) {
  AddArgument({std::move(name), "N", std::move(why),
               "a whole number from " + std::to_string(low) + " to " + std::to_string(high), std::to_string(*value),
               Need::kOptional, [value, low, high](std::string_view text) {
                 return ParseInt(text, value) && *value >= low && *value <= high;
               }});
}

void CommandLine::Add(std::string name, std::vector<std::string>* values, const std::string& placeholder,
                      std::string why, Need need, Positional positional) {
  AddArgument({std::move(name), placeholder, std::move(why), placeholder, "", need, [values](std::string_view text) {
                 values->emplace_back(text);
                 return !text.empty();
               }});
  arguments_.back().times = Times::kSeveral;
  arguments_.back().positional = positional;
}

void CommandLine::AddFlag(std::string name, bool* value, std::string why) {
  AddArgument({std::move(name), "", std::move(why), "", "", Need::kOptional, [value](std::string_view) {
                 *value = true;
                 return true;
               }});
}

void CommandLine::AddChoice(std::string name, std::string* value, const std::vector<std::string_view>& names,
                            std::string why) {
  AddChoice(std::move(name), *value, names, std::move(why), [value](std::string_view text) { *value = text; });
}

void CommandLine::AddChoice(std::string name, std::string_view value, const std::vector<std::string_view>& names,
                            std::string why, std::function<void(std::string_view)> set) {
  std::string accepted;
  for (const std::string_view known : names) accepted += (accepted.empty() ? "" : "|") + std::string(known);
  AddArgument(
      {std::move(name), accepted, std::move(why), "one of " + accepted, std::string(value), Need::kOptional,
       [set = std::move(set), known = std::set<std::string>(names.begin(), names.end())](std::string_view text) {
         if (!known.contains(std::string(text))) return false;
         set(text);
         return true;
       }});
}

void CommandLine::AddAlias(std::string name, std::string option, const std::string& placeholder, std::string why) {
  AddArgument({std::move(name), placeholder, std::move(why), placeholder, "", Need::kOptional,
               [this, option = std::move(option)](std::string_view text) {
                 extras_.push_back("--" + option + "=" + std::string(text));
                 return true;
               }});
}

Status CommandLine::ReadArguments(std::span<const std::string> args) {
  CLI::App app;
  app.allow_extras();
  app.set_help_flag();  // the manual is ours
  for (Argument& argument : arguments_) {
    const std::string names =
        (argument.positional == Positional::kYes ? argument.name + "," : std::string()) + FlagsOf(argument.name);
    if (argument.placeholder.empty()) {
      app.add_flag_callback(FlagsOf(argument.name), [&argument] { argument.given = {""}; });
    } else if (argument.times == Times::kSeveral) {
      app.add_option_function<std::vector<std::string>>(
             names, [&argument](const std::vector<std::string>& values) { argument.given = values; })
          ->allow_extra_args(argument.positional == Positional::kYes);  // else one value each time it is given
    } else {
      app.add_option_function<std::string>(names, [&argument](const std::string& value) { argument.given = {value}; });
    }
  }
  try {
    const std::vector<std::string> joined = WithOptionsJoined(args);
    app.parse(std::vector<std::string>(joined.rbegin(), joined.rend()));  // CLI11 takes them from the back
  } catch (const CLI::ParseError& error) {
    return {ErrorCode::kInvalidArgument, ArgumentError(error)};
  }
  extras_ = app.remaining();
  for (const Argument& argument : arguments_) {
    for (const std::string& value : argument.given) {
      if (argument.set(value)) continue;
      return {ErrorCode::kInvalidArgument,
              "--" + argument.name + " is " + Quoted(value) + "; give " + argument.accepts};
    }
  }
  return Status::Ok();
}

std::optional<int> CommandLine::Parse(std::span<const std::string> args) {
  Logging& logging = TheLogging();
  if (AsksForJson(args)) logging.format = LogFormat::kJson;  // also where the command line is wrong
  Add("config", &config_path_, "FILE", "YAML file of options, as --print_config prints it; flags win over it",
      Need::kOptional);
  AddFlag("print_config", &print_config_, "print every option as resolved, with unit and reason, and end");
  AddFlag("quiet", &quiet_, "say nothing but errors: --log_level error");
  AddChoice("log_level", &logging.level, "the least that is said; results and progress are info");
  AddChoice("log_format", &logging.format, "of every line that is said; json: an object a line, for programs");
  AddFlag("help", &help_, "print the manual and end");
  AddFlag("help-all", &help_all_, "print the manual with every option and end");
  const Status status = ReadArguments(args);
  if (quiet_) logging.level = LogLevel::kError;
  if (status.ok() || help_ || help_all_) return std::nullopt;
  return UsageError(status.message());
}

std::string CommandLine::Hint(std::string_view flag, const OptionTable& options) const {
  std::vector<std::string> names;
  for (const Argument& argument : arguments_) names.push_back(argument.name);
  for (const OptionField& field : options.fields()) names.push_back(field.name);
  const std::string similar = SimilarName(flag, names);
  return similar.empty() ? "; " + NameOf(manual_) + " --help-all lists them" : "; did you mean --" + similar + "?";
}

Status CommandLine::ApplyFlags(OptionTable& options) const {
  std::set<std::string> given;
  for (std::size_t i = 0; i < extras_.size(); ++i) {
    const std::string& token = extras_[i];
    if (!token.starts_with("--") || token.size() == 2) {
      return {ErrorCode::kInvalidArgument, "does not know what to do with " + Quoted(token) +
                                               "; arguments are --name value, see " + NameOf(manual_) + " --help"};
    }
    const std::size_t equals = token.find('=');
    const std::string name = token.substr(2, equals == std::string::npos ? equals : equals - 2);
    if (options.Find(name) == nullptr) {
      if (std::string sentence = options.RenamedSentence(name); !sentence.empty())
        return {ErrorCode::kInvalidArgument, std::move(sentence)};
      if (const auto renamed = former_names_.find(name); renamed != former_names_.end())
        return {ErrorCode::kInvalidArgument, "--" + name + " is now called --" + renamed->second};
      return {ErrorCode::kInvalidArgument, "there is no option --" + name + Hint(name, options)};
    }
    if (!given.insert(name).second)
      return {ErrorCode::kInvalidArgument, "--" + name + " is given more than once; leave one"};
    std::string value;
    if (equals != std::string::npos) {
      value = token.substr(equals + 1);
    } else if (i + 1 < extras_.size() && !extras_[i + 1].starts_with("--")) {
      value = extras_[++i];
    } else {
      return {ErrorCode::kInvalidArgument, "--" + name + " needs a value"};
    }
    if (Status status = options.Set(name, value); !status.ok()) return status;
  }
  return Status::Ok();
}

std::optional<int> CommandLine::Resolve(OptionTable& options) {
  if (help_ || help_all_) {
    std::cout << ManualText(options, help_all_ ? Detail::kAll : Detail::kMain) << std::flush;
    return kExitOk;
  }
  if (!config_path_.empty()) {
    if (const Status status = LoadOptionsFile(config_path_, options); !status.ok()) return UsageError(status.message());
  }
  if (const Status status = ApplyFlags(options); !status.ok()) return UsageError(status.message());
  if (print_config_) {
    std::cout << options.ToYaml() << std::flush;
    return kExitOk;
  }
  for (const Argument& argument : arguments_) {
    if (argument.need == Need::kRequired && argument.given.empty())
      return UsageError("--" + argument.name + " " + argument.placeholder + " is missing; see " + NameOf(manual_) +
                        " --help");
  }
  return std::nullopt;
}

std::vector<std::string> CommandLine::Words(std::span<const std::string> args) const {
  std::vector<std::string> words = {std::string(manual_.program), std::string(manual_.command)};
  words.insert(words.end(), args.begin(), args.end());
  return words;
}

int CommandLine::UsageError(std::string_view sentence) const {
  SayError(sentence);
  return kExitUsage;
}

int CommandLine::Failure(std::string_view sentence) const {
  SayError(sentence);
  return kExitFailed;
}

int CommandLine::Failure(const Status& status) const {
  return status.code() == ErrorCode::kInvalidArgument ? UsageError(status.message()) : Failure(status.message());
}

bool CommandLine::IsShown(const OptionField& field, Detail detail) const {
  const auto& shown = manual_.main_options;
  return detail == Detail::kAll || shown.empty() || std::find(shown.begin(), shown.end(), field.name) != shown.end();
}

std::string CommandLine::OptionsText(const OptionTable& options, Detail detail) const {
  if (options.fields().empty()) return "";
  const bool is_part = detail == Detail::kMain && !manual_.main_options.empty();
  std::string text =
      "\nOPTIONS\n" + Wrap(std::string("Given as --Group.option VALUE or --Group.option=VALUE, or in the "
                                       "file of --config. Each is shown with its default and its unit "
                                       "or choices.") +
                               (is_part ? " These are the most used ones; --help-all shows all " +
                                              std::to_string(options.fields().size()) + "."
                                        : ""),
                           2);
  for (const auto& [group, why] : options.groups()) {
    std::string fields;
    for (const OptionField& field : options.fields()) {
      if (!field.name.starts_with(group + ".") || !IsShown(field, detail)) continue;
      const std::string value = field.get();
      fields += "    --" + field.name + " " + (value.empty() ? "\"\"" : value) + "  [" + field.unit + "]\n" +
                Wrap(field.why, 8);
    }
    if (!fields.empty()) text += "\n" + Wrap(group + ": " + why, 2) + fields;
  }
  return text;
}

std::string CommandLine::ManualText(const OptionTable& options, Detail detail) const {
  const std::string program = NameOf(manual_);
  std::string usage = program;
  std::string arguments;
  for (const Argument& argument : arguments_) {
    std::string flag = "--" + argument.name + (argument.placeholder.empty() ? "" : " ") + argument.placeholder;
    if (argument.positional == Positional::kYes) flag = "[--" + argument.name + "] " + argument.placeholder;
    if (argument.need == Need::kRequired) usage += " " + flag;
    if (const std::string short_flag = ShortFlagOf(argument.name); !short_flag.empty()) flag = short_flag + ", " + flag;
    if (argument.times == Times::kSeveral)
      flag += argument.positional == Positional::kYes ? " ..." : " [--" + argument.name + " ...]";
    std::string why = argument.why;
    if (argument.need == Need::kRequired) why += " (required)";
    if (!argument.default_text.empty()) why += " (default: " + argument.default_text + ")";
    arguments += "  " + flag + "\n" + Wrap(why, 8);
  }
  std::string text = program + " - " + std::string(manual_.summary) + "\n\nUSAGE\n" +
                     Wrap(usage + " [ARGUMENTS] [--Group.option VALUE ...]", 2) + "\nDESCRIPTION\n" +
                     WrapParagraphs(manual_.text, 2) + "\nARGUMENTS\n" + arguments;
  text += OptionsText(options, detail);
  text +=
      "\nEXIT CODES\n  0  done\n  1  the run failed or was interrupted; the reason is on standard error\n"
      "  2  the command line or the file of --config is wrong\n\nEXAMPLES\n";
  for (const std::string_view example : manual_.examples) text += "  " + std::string(example) + "\n";
  return text;
}

}  // namespace pliant::cli
