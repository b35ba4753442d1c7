// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Text in and out: numbers written fast, and read only where they are finite.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

inline std::string Quoted(std::string_view text) { return "'" + std::string(text) + "'"; }

// "a, b, c": the text of every element of a range.
template <typename Range, typename TextOf = std::identity>
std::string CommaSeparated(const Range& range, TextOf text_of = {}) {
  std::string text;
  bool is_first = true;
  for (const auto& element : range) {
    if (!is_first) text += ", ";
    text += std::invoke(text_of, element);
    is_first = false;
  }
  return text;
}

// One number as printf writes it; the format has to be for one double, and gives at most 63 characters.
std::string FormatNumber(const char* format, double value);
// With so many digits after the point.
std::string Digits(double value, int digits);
// A share of 1 as "12 %", with so many digits after the point.
std::string Percent(double share, int digits = 0);

// "1.25 s", to a microsecond.
std::string Seconds(double seconds);

// `path:line`, as compilers write it.
std::string PathAndLine(const std::string& path, std::int64_t line);

void AppendInt(std::string* out, std::int64_t value);
// Rounded to `decimals` (at most 9) places after the point; never "-0.0".
void AppendFixed(std::string* out, double value, int decimals);
// With 17 significant digits, like C's %.17g: what is read back is the same number.
void AppendExact(std::string* out, double value);
// The bytes of a number, little-endian.
void AppendBytes(std::string* out, std::uint64_t value, int num_bytes);
void AppendDouble(std::string* out, double value);
void AppendFloat(std::string* out, float value);

// The fields between separators. With ' ', runs of blanks and tabs count as one and those at the ends as none.
std::vector<std::string_view> Split(std::string_view text, char separator);
// The words between blanks, line ends, commas, semicolons and brackets, any number of them.
std::vector<std::string_view> Words(std::string_view text);
// All words of "1, 2.5;-3" as finite numbers; nothing where one of them is not.
std::optional<std::vector<double>> ParseNumbers(std::string_view text);
// Finite numbers only.
bool ParseFinite(std::string_view text, double* value);
bool ParseInt64(std::string_view text, std::int64_t* value);
bool ParseUint64(std::string_view text, std::uint64_t* value);

// Whether it is UTF-8 (RFC 3629: the shortest form of each character, no surrogates), as JSON and COLMAP's files are.
bool IsUtf8(std::string_view text);

}  // namespace pliant
