// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The page as the build bundled it from web/, or nothing (PLIANT_BUILD_VIEWER=OFF).
#pragma once

#include <string_view>

#include "pliant/base/status.h"

namespace pliant {

// Where the data go: before its end tag. The page has this exactly once.
inline constexpr std::string_view kPageDataEnd = "</script>";
inline constexpr std::string_view kPageDataMarker = "<script type=\"application/json\" id=\"pliant-data\"></script>";

// Empty where the build left it out.
std::string_view PageAsset();

// kNotFound where the build left it out, with the sentence that says so.
Status CheckPageAsset();

}  // namespace pliant
