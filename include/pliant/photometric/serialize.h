// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Reference patches as a program's state (pliant/base/state_archive.h).
#pragma once

#include "pliant/base/state_archive.h"
#include "pliant/photometric/patch.h"

namespace pliant {

// `options`: those that the patch was cut with. Its solutions, which are four times as large as the patch and follow
// from it, are computed again.
void Serialize(StateArchive& archive, const LucasKanadeOptions& options, ReferencePatch& patch);

}  // namespace pliant
