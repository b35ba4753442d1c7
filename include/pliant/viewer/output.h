// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What is written of runs, and the endings of its file: a page (report.h), a figure or a film (figure.h).
#pragma once

#include <string>

#include "pliant/base/status.h"

namespace pliant {

enum class ViewOutput { kPage, kFigure, kFilm };

// Fails with kInvalidArgument where the ending of `output_path` is not one of those that such a file may have.
Status CheckEnding(ViewOutput output, const std::string& output_path);

}  // namespace pliant
