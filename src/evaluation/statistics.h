// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Small statistics. A median reorders its values and takes them by copy.
#pragma once

#include <vector>

namespace pliant {

// The middle value, the mean of the two middle ones for an even count; 0 for none.
double Median(std::vector<double> values);
// 0 for none.
double Mean(const std::vector<double>& values);
// sqrt(mean of squares); 0 for none.
double Rms(const std::vector<double>& values);

}  // namespace pliant
