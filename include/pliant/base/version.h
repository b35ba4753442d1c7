// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The version of the library and the program; CMakeLists.txt reads it from here.
#pragma once

namespace pliant {

inline constexpr const char* kVersion = "0.1.0";

}  // namespace pliant
