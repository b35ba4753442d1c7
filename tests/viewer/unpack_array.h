// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Reads the page's arrays as the page does (web/README.md).
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <zlib.h>

namespace pliant {

inline std::string FromBase64(const std::string& text) {
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t held = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    held = held << 6 | static_cast<std::uint32_t>(alphabet.find(c));
    bits += 6;
    if (bits >= 8) bytes.push_back(static_cast<char>(held >> (bits -= 8) & 0xFFU));
  }
  return bytes;
}

// Row by row.
inline std::vector<double> Unpack(const nlohmann::ordered_json& array) {
  const auto rows = array["rows"].get<std::size_t>();
  const auto columns = array["columns"].get<std::size_t>();
  const std::string type = array["type"];
  const std::size_t bytes = type == "u8" ? 1 : type == "u16" ? 2 : 4;
  std::string planes(rows * columns * bytes, '\0');
  const std::string packed = FromBase64(array["data"]);
  uLongf size = planes.size();
  if (uncompress(reinterpret_cast<Bytef*>(planes.data()), &size, reinterpret_cast<const Bytef*>(packed.data()),
                 packed.size()) != Z_OK ||
      size != planes.size())
    return {};
  const std::uint64_t base = std::uint64_t{1} << (8 * bytes);
  std::vector<double> values(rows * columns);
  for (std::size_t column = 0; column < columns; ++column) {
    std::uint64_t last = 0;
    for (std::size_t row = 0; row < rows; ++row) {
      std::uint64_t value = 0;
      for (std::size_t byte = 0; byte < bytes; ++byte)
        value |= std::uint64_t{static_cast<unsigned char>(planes[(column * bytes + byte) * rows + row])} << (8 * byte);
      if (array.value("delta", false)) value = (value + last) % base;
      last = value;
      double& out = values[row * columns + column];
      if (type == "f32")
        out = std::bit_cast<float>(static_cast<std::uint32_t>(value));
      else if (!array.contains("low"))
        out = static_cast<double>(value);
      else if (value == base - 1)
        out = std::numeric_limits<double>::quiet_NaN();
      else
        out = array["low"][column].get<double>() + array["step"][column].get<double>() * static_cast<double>(value);
    }
  }
  return values;
}

}  // namespace pliant
