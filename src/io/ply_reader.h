// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The vertices of PLY files, by whomever they were written.
#pragma once

#include <string>
#include <string_view>

#include "pliant/base/status.h"
#include "pliant/io/ply.h"

namespace pliant {

// `bytes`: of the file at `path`. As ReadPlyVertices.
Result<PlyVertices> ParsePlyVertices(const std::string& path, std::string_view bytes);

}  // namespace pliant
