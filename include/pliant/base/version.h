// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The version of the library and the program, and what they were built of.
#pragma once

#include <string_view>

namespace pliant {

inline constexpr const char* kVersion = "0.2.0";  // CMakeLists.txt reads it from here

// "GNU 12.2.0, x86_64, Release".
std::string_view BuildText();
// The libraries with the versions that were found when it was built: "Eigen 3.4.0, Ceres 2.1.0, ...".
std::string_view LibrariesText();

}  // namespace pliant
