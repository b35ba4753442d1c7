// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What is written of runs, and the endings of its file: a page (report.h), a figure or a film (figure.h).
#pragma once

#include <string>
#include <string_view>

#include "pliant/base/status.h"

namespace pliant {

enum class ViewOutput { kPage, kFigure, kFilm };

// Fails with kInvalidArgument where the ending of `path` is not one of those that such a file may have. `argument`: the
// name by which it was given.
Status CheckEnding(ViewOutput output, const std::string& path, std::string_view argument = "output_path");

}  // namespace pliant
