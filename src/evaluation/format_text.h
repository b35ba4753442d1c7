// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// printf into a string, for tables.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace pliant {

// Longer lines are cut at 255 characters: append what may be long, such as a path, apart.
[[gnu::format(printf, 1, 2)]] inline std::string FormatText(const char* format, ...) {
  char text[256];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

}  // namespace pliant
