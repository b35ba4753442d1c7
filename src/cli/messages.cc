// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/messages.h"

#include <iostream>

#include <nlohmann/json.hpp>

#include "pliant/base/text.h"

namespace pliant::cli {
namespace {

constexpr std::size_t kLongestSentence = 400;
constexpr std::size_t kKeptEnd = 120;  // of a longer one: what to do stands there

bool IsInsideOfCharacter(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }  // of UTF-8

// The middle of a sentence that quotes too much of an input is left out.
std::string Shortened(std::string_view sentence) {
  if (sentence.size() <= kLongestSentence) return std::string(sentence);
  std::size_t end = sentence.size() - kKeptEnd;
  while (end < sentence.size() && IsInsideOfCharacter(sentence[end])) ++end;
  std::size_t begin = kLongestSentence - kKeptEnd - 5;  // the dots and the blanks around them
  while (begin > 0 && IsInsideOfCharacter(sentence[begin])) --begin;
  return std::string(sentence.substr(0, begin)) + " ... " + std::string(sentence.substr(end));
}

bool IsJson() { return TheLogging().format == LogFormat::kJson; }

std::string TextEvent(std::string_view event, std::string_view text) {
  return EventLine(event, "\"text\":" + JsonString(text));
}

void SayLine(std::string_view event, std::string_view kind, std::string_view sentence) {
  std::cerr << (IsJson() ? TextEvent(event, Shortened(sentence))
                         : Shortened(TheLogging().command + ": " + std::string(kind) + std::string(sentence)) + "\n")
            << std::flush;
}

}  // namespace

Logging& TheLogging() {
  static Logging logging;
  return logging;
}

std::string JsonString(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string EventLine(std::string_view event, std::string_view members) {
  return "{\"event\":" + JsonString(event) + ",\"command\":" + JsonString(TheLogging().command) +
         (members.empty() ? "" : ",") + std::string(members) + "}\n";
}

void SayError(std::string_view sentence) { SayLine("error", "", sentence); }

void SayWarning(std::string_view sentence) {
  if (TheLogging().level < LogLevel::kWarning) return;
  SayLine("warning", "warning: ", sentence);
}

void SayNote(std::string_view sentence) {
  if (TheLogging().level < LogLevel::kInfo) return;
  std::cout << (IsJson() ? TextEvent("note", sentence) : "note: " + std::string(sentence) + "\n") << std::flush;
}

void SayResult(std::string_view text) {
  if (TheLogging().level < LogLevel::kInfo) return;
  while (text.ends_with('\n')) text.remove_suffix(1);
  for (const std::string_view line : Split(text, '\n'))
    std::cout << (IsJson() ? TextEvent("result", line) : std::string(line) + "\n");
  std::cout << std::flush;
}

}  // namespace pliant::cli
