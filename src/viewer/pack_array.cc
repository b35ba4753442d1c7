// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/pack_array.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <zlib.h>

namespace pliant {
namespace {

constexpr std::array<const char*, 3> kTypeNames = {"u8", "u16", "u32"};

constexpr double kCoarsestStep = 1.0 / 2000;  // of the usual range

int BytesOf(PackedType type) { return 1 << static_cast<int>(type); }

std::uint32_t LargestOf(PackedType type) {
  return static_cast<std::uint32_t>((std::uint64_t{1} << (8 * BytesOf(type))) - 1);
}

// Row by row -> column after column, of a column one byte plane after the other.
std::string BytePlanes(std::span<const std::uint32_t> values, std::size_t columns, int bytes) {
  const std::size_t rows = values.size() / columns;
  std::string planes;
  planes.reserve(values.size() * static_cast<std::size_t>(bytes));
  for (std::size_t column = 0; column < columns; ++column)
    for (int byte = 0; byte < bytes; ++byte)
      for (std::size_t row = 0; row < rows; ++row)
        planes.push_back(static_cast<char>((values[row * columns + column] >> (8 * byte)) & 0xFFU));
  return planes;
}

// Of a column: what lies between its first and last hundredth.
double UsualRange(std::span<const float> values, std::size_t column, std::size_t columns) {
  std::vector<float> finite;
  for (std::size_t i = column; i < values.size(); i += columns)
    if (std::isfinite(values[i])) finite.push_back(values[i]);
  if (finite.empty()) return 0;
  const auto at = [&](double share) {
    const auto quantile = finite.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(finite.size() - 1));
    std::nth_element(finite.begin(), quantile, finite.end());
    return static_cast<double>(*quantile);
  };
  return at(0.99) - at(0.01);
}

std::string Deflated(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
            static_cast<uLong>(bytes.size()), Z_DEFAULT_COMPRESSION);  // cannot fail into a buffer of this size
  packed.resize(size);
  return packed;
}

nlohmann::ordered_json Pack(const char* type, std::span<const std::uint32_t> values, int columns, int bytes) {
  return {{"type", type},
          {"rows", values.size() / static_cast<std::size_t>(columns)},
          {"columns", columns},
          {"data", Base64(Deflated(BytePlanes(values, static_cast<std::size_t>(columns), bytes)))}};
}

}  // namespace

nlohmann::ordered_json PackWhole(std::span<const std::uint32_t> values, int columns, PackedType type) {
  std::vector<std::uint32_t> differences(values.size());
  const auto step = static_cast<std::size_t>(columns);
  for (std::size_t i = 0; i < values.size(); ++i)
    differences[i] = (values[i] - (i >= step ? values[i - step] : 0)) & LargestOf(type);
  nlohmann::ordered_json packed = Pack(kTypeNames[static_cast<std::size_t>(type)], differences, columns, BytesOf(type));
  packed["delta"] = true;
  return packed;
}

nlohmann::ordered_json PackQuantized(std::span<const float> values, int columns, PackedType type) {
  const auto count = static_cast<std::size_t>(columns);
  const std::uint32_t none = LargestOf(type);
  std::vector<double> low(count, std::numeric_limits<double>::infinity());
  std::vector<double> high(count, -std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    low[i % count] = std::min(low[i % count], static_cast<double>(values[i]));
    high[i % count] = std::max(high[i % count], static_cast<double>(values[i]));
  }
  std::vector<double> steps(count);
  for (std::size_t column = 0; column < count; ++column) {
    if (!(low[column] <= high[column])) low[column] = high[column] = 0;
    const double step = (high[column] - low[column]) / (none - 1.0);
    steps[column] = step > 0 ? step : 1.0;
    if (type == PackedType::kU16 && step > kCoarsestStep * UsualRange(values, column, count))
      return PackFloats(values, columns);
  }
  std::vector<std::uint32_t> whole(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    whole[i] = std::isfinite(values[i])
                   ? static_cast<std::uint32_t>(std::lround((values[i] - low[i % count]) / steps[i % count]))
                   : none;
  nlohmann::ordered_json packed = PackWhole(whole, columns, type);
  packed["low"] = low;
  packed["step"] = steps;
  return packed;
}

nlohmann::ordered_json PackFloats(std::span<const float> values, int columns) {
  std::vector<std::uint32_t> bits(values.size());
  std::transform(values.begin(), values.end(), bits.begin(),
                 [](float value) { return std::bit_cast<std::uint32_t>(value); });
  return Pack("f32", bits, columns, 4);
}

std::string Base64(std::string_view bytes) {  // RFC 4648, section 4
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text.push_back(i + k <= bytes.size() ? kAlphabet[three >> (18 - 6 * k) & 63U] : '=');
  }
  return text;
}

}  // namespace pliant
