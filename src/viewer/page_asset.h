// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The page as the build bundled it from web/.
#pragma once

#include <string_view>

namespace pliant {

// Where the data go: before its end tag. The page has this exactly once.
inline constexpr std::string_view kPageDataEnd = "</script>";
inline constexpr std::string_view kPageDataMarker = "<script type=\"application/json\" id=\"pliant-data\"></script>";

std::string_view PageAsset();

}  // namespace pliant
