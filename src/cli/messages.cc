// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/messages.h"

#include <iostream>

#include <nlohmann/json.hpp>

#include "pliant/base/text.h"

namespace pliant::cli {
namespace {

constexpr std::size_t kLongestSentence = 400;
constexpr std::size_t kLongestEnd = 310;  // of a longer one, in whole clauses: what to do stands there
constexpr std::size_t kKeptEnd = 120;     // where its last clause is longer than that
constexpr std::string_view kDots = " ... ";

bool IsInsideOfCharacter(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }  // of UTF-8

// Where the end begins that is kept of a long sentence: at a clause, else at a word, else in a long quotation.
std::size_t KeptFrom(std::string_view sentence) {
  if (const std::size_t clause = sentence.find("; ", sentence.size() - kLongestEnd); clause != std::string_view::npos)
    return clause + 2;
  std::size_t begin = sentence.size() - kKeptEnd;
  if (const std::size_t blank = sentence.find(' ', begin); blank != std::string_view::npos) return blank + 1;
  while (begin < sentence.size() && IsInsideOfCharacter(sentence[begin])) ++begin;
  return begin;
}

// How much of its beginning is kept, of at most `longest` bytes.
std::size_t KeptTo(std::string_view sentence, std::size_t longest) {
  if (const std::size_t blank = sentence.rfind(' ', longest); blank != std::string_view::npos && blank > longest / 2)
    return blank;
  while (longest > 0 && IsInsideOfCharacter(sentence[longest])) --longest;
  return longest;
}

// The middle of a sentence that quotes too much of an input, or says too much, is left out.
std::string Shortened(std::string_view sentence) {
  if (sentence.size() <= kLongestSentence) return std::string(sentence);
  const std::string_view end = sentence.substr(KeptFrom(sentence));
  const std::size_t begin = KeptTo(sentence, kLongestSentence - kDots.size() - end.size());
  return std::string(sentence.substr(0, begin)) + std::string(kDots) + std::string(end);
}

bool IsJson() { return TheLogging().format == LogFormat::kJson; }

std::string TextEvent(std::string_view event, std::string_view text) {
  return EventLine(event, "\"text\":" + JsonString(text));
}

void SayLine(std::string_view event, std::string_view kind, std::string_view sentence) {
  const std::string line = TheLogging().command + ": " + std::string(kind) + std::string(sentence);
  std::cerr << (IsJson() ? TextEvent(event, Shortened(sentence)) : Shortened(Printable(line)) + "\n") << std::flush;
}

// Of UTF-8: U+0000 to U+001F and U+007F are a byte each, U+0080 to U+009F two.
bool IsControl(char byte) { return static_cast<unsigned char>(byte) < 0x20U || byte == '\x7f'; }
bool IsSecondOfControl(char byte) { return (static_cast<unsigned char>(byte) & 0xE0U) == 0x80U; }

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

std::string Printable(std::string_view line) {
  std::string printable;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool is_pair = line[i] == '\xc2' && i + 1 < line.size() && IsSecondOfControl(line[i + 1]);
    printable += is_pair || IsControl(line[i]) ? '?' : line[i];
    if (is_pair) ++i;
  }
  return printable;
}

void SayError(std::string_view sentence) { SayLine("error", "", sentence); }

void SayWarning(std::string_view sentence) {
  if (TheLogging().level < LogLevel::kWarning) return;
  SayLine("warning", "warning: ", sentence);
}

void SayNote(std::string_view sentence) {
  if (TheLogging().level < LogLevel::kInfo) return;
  std::cout << (IsJson() ? TextEvent("note", sentence) : "note: " + Printable(sentence) + "\n") << std::flush;
}

void SayResult(std::string_view text) {
  if (TheLogging().level < LogLevel::kInfo) return;
  while (text.ends_with('\n')) text.remove_suffix(1);
  for (const std::string_view line : Split(text, '\n'))
    std::cout << (IsJson() ? TextEvent("result", line) : Printable(line) + "\n");
  std::cout << std::flush;
}

}  // namespace pliant::cli
