// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Columns of numbers for the page (web/README.md, ARRAY): quantized, as differences from row to row, in byte planes,
// deflated and in base64.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace pliant {

enum class PackedType { kU8, kU16, kU32 };

// Values row by row. Each column's finite range becomes the type's numbers but the largest, which is what is not
// finite. Where stray values would make 16-bit steps coarse for all others, the values are packed as floats instead.
nlohmann::ordered_json PackQuantized(std::span<const float> values, int columns, PackedType type);
nlohmann::ordered_json PackWhole(std::span<const std::uint32_t> values, int columns, PackedType type);
nlohmann::ordered_json PackFloats(std::span<const float> values, int columns);

std::string Base64(std::string_view bytes);

}  // namespace pliant
