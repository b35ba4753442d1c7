// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Images as a program's state (pliant/base/state_archive.h).
#pragma once

#include <opencv2/core/mat.hpp>

#include "pliant/base/state_archive.h"

namespace pliant {

// Of two dimensions, with its pixels; what is read has memory of its own.
void Serialize(StateArchive& archive, cv::Mat& image);

}  // namespace pliant
