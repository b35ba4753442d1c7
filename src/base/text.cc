// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "pliant/base/options.h"

namespace pliant {
namespace {

template <class Integer>
bool ParseWhole(std::string_view text, Integer* value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::string FormatNumber(const char* format, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::string Digits(double value, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

std::string Percent(double share, int digits) { return Digits(100.0 * share, digits) + " %"; }

std::string Seconds(double seconds) { return FormatDouble(std::round(1e6 * seconds) / 1e6) + " s"; }

std::string PathAndLine(const std::string& path, std::int64_t line) { return path + ":" + std::to_string(line); }

void AppendInt(std::string* out, std::int64_t value) {
  std::array<char, 24> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  out->append(buffer.data(), end);
}

void AppendFixed(std::string* out, double value, int decimals) {
  static constexpr std::array<std::int64_t, 10> kPowers = {1,      10,      100,      1000,      10000,
                                                           100000, 1000000, 10000000, 100000000, 1000000000};
  const std::int64_t power = kPowers[static_cast<std::size_t>(decimals)];
  const double scaled = value * static_cast<double>(power);
  if (!(std::abs(scaled) < 9e15)) {  // beyond the integers that a double holds
    std::array<char, 400> buffer;
    const auto [end, error] =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, decimals);
    out->append(buffer.data(), end);
    return;
  }
  const std::int64_t rounded = std::llround(scaled);
  const std::int64_t magnitude = std::abs(rounded);
  if (rounded < 0) out->push_back('-');
  AppendInt(out, magnitude / power);
  if (decimals == 0) return;
  std::array<char, 10> digits;
  std::int64_t rest = magnitude % power;
  for (int i = decimals; i > 0; --i, rest /= 10)
    digits[static_cast<std::size_t>(i)] = static_cast<char>('0' + rest % 10);
  digits[0] = '.';
  out->append(digits.data(), static_cast<std::size_t>(decimals) + 1);
}

void AppendExact(std::string* out, double value) {
  std::array<char, 40> buffer;
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, 17);
  out->append(buffer.data(), end);
}

void AppendBytes(std::string* out, std::uint64_t value, int num_bytes) {
  for (int i = 0; i < num_bytes; ++i) out->push_back(static_cast<char>((value >> (8 * i)) & 0xff));
}

void AppendDouble(std::string* out, double value) { AppendBytes(out, std::bit_cast<std::uint64_t>(value), 8); }

void AppendFloat(std::string* out, float value) { AppendBytes(out, std::bit_cast<std::uint32_t>(value), 4); }

std::vector<std::string_view> Split(std::string_view text, char separator) {
  const std::string_view separators = separator == ' ' ? " \t" : std::string_view(&separator, 1);
  std::vector<std::string_view> fields;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    if (separator != ' ' || end > begin) fields.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

std::vector<std::string_view> Words(std::string_view text) {
  constexpr std::string_view kSeparators = " \t\r\n,;[]";
  std::vector<std::string_view> words;
  std::size_t end = 0;
  while (true) {
    const std::size_t begin = text.find_first_not_of(kSeparators, end);
    if (begin == std::string_view::npos) return words;
    end = std::min(text.find_first_of(kSeparators, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
  }
}

std::optional<std::vector<double>> ParseNumbers(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string_view word : Words(text))
    if (!ParseFinite(word, &numbers.emplace_back())) return std::nullopt;
  return numbers;
}

bool ParseFinite(std::string_view text, double* value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return ParseDouble(text, value) && std::isfinite(*value);
}

bool ParseInt64(std::string_view text, std::int64_t* value) { return ParseWhole(text, value); }

bool ParseUint64(std::string_view text, std::uint64_t* value) { return ParseWhole(text, value); }

bool IsUtf8(std::string_view text) {
  // By the bytes that follow the first one: the least code point that needs so many.
  static constexpr std::array<std::uint32_t, 4> kLeast = {0, 0x80, 0x800, 0x10000};
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i++]);
    const int ones = std::countl_one(first);
    if (ones == 0) continue;
    if (ones == 1 || ones > 4) return false;
    std::uint32_t code = first & (0x7FU >> ones);
    for (int k = 1; k < ones; ++k) {
      if (i == text.size()) return false;
      const auto next = static_cast<unsigned char>(text[i++]);
      if (std::countl_one(next) != 1) return false;
      code = code << 6U | (next & 0x3FU);
    }
    const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
    if (code < kLeast[static_cast<std::size_t>(ones - 1)] || is_surrogate || code > 0x10FFFF) return false;
  }
  return true;
}

}  // namespace pliant
