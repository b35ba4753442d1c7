// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The options that a run was made with.
#pragma once

#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/viewer/view.h"

namespace pliant {

// config.yaml of a run folder; none where it has no such file. Fails with kUnreadable.
Result<std::vector<NamedText>> ReadRunOptions(const std::string& run_path);

// Whether the maps of a run with these options have true millimeters, since they start from known depth.
bool AreMetric(const std::vector<NamedText>& options);

}  // namespace pliant
