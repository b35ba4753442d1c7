// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The monocular initializers, each in its own source file.
#pragma once

#include <memory>

#include "pliant/tracking/monocular_initializer.h"

namespace pliant {

std::unique_ptr<Initializer> MakeGatedInitializer(const MonocularInitOptions& options, Random random);
std::unique_ptr<Initializer> MakePaperInitializer(const MonocularInitOptions& options, Random random);

}  // namespace pliant
