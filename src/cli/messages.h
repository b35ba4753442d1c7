// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a command says while it works: results and notes on standard output, errors, warnings and progress on standard
// error. Every command has --log_level, which leaves out what is less than an error or a warning, and --log_format,
// which makes every line a JSON object with "event" (error, warning, note, progress, result) and "command". In text,
// control characters of what they quote are replaced (Printable).
#pragma once

#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include "pliant/base/options.h"

namespace pliant::cli {

enum class LogLevel { kError, kWarning, kInfo };
enum class LogFormat { kText, kJson };

// The command that speaks, and what of it is wanted.
struct Logging {
  std::string command = "pliant";  // "pliant track"
  LogLevel level = LogLevel::kInfo;
  LogFormat format = LogFormat::kText;
};
// There is one in a program, which its CommandLine sets.
Logging& TheLogging();

// One sentence behind the name of the command: "pliant track: sentence". Of more than 400 characters the middle is left
// out, between words; its last clauses, behind "; ", are kept.
void SayError(std::string_view sentence);
void SayWarning(std::string_view sentence);
// What is to be known of a result, or happens on the way to it: "note: sentence".
void SayNote(std::string_view sentence);
// What was found: a line, or several with line ends between them.
void SayResult(std::string_view text);

// A line with '?' for each control character of UTF-8 in it, line breaks and tabs too: names in files of others must
// not reach a terminal as commands, nor as lines of their own.
std::string Printable(std::string_view line);

// As printf writes them.
template <class... Values>
std::string Formatted(const char* format, Values... values) {
  std::array<char, 256> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

// {"event":"name","command":"pliant track",members}; `members` is JSON, without its braces.
std::string EventLine(std::string_view event, std::string_view members);
// `text` as a string of JSON, with its quotation marks.
std::string JsonString(std::string_view text);

}  // namespace pliant::cli

namespace pliant {

template <>
struct EnumNames<cli::LogLevel> {
  static constexpr std::array kNames = {std::pair{cli::LogLevel::kError, std::string_view("error")},
                                        std::pair{cli::LogLevel::kWarning, std::string_view("warning")},
                                        std::pair{cli::LogLevel::kInfo, std::string_view("info")}};
};
template <>
struct EnumNames<cli::LogFormat> {
  static constexpr std::array kNames = {std::pair{cli::LogFormat::kText, std::string_view("text")},
                                        std::pair{cli::LogFormat::kJson, std::string_view("json")}};
};

}  // namespace pliant
