// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Options that are several numbers in one text: "1, 2.5,-3".
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace pliant::simulation {

// Nothing where the text is not finite numbers separated by commas.
std::optional<std::vector<double>> ParseNumbers(std::string_view text);

}  // namespace pliant::simulation
