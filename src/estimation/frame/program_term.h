// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The term that the calling program adds (pliant/estimation/frame/frame_cost.h), as one of the others.
#pragma once

#include <memory>

#include "estimation/frame/frame_terms.h"

namespace pliant {

// Of data.cost, which is not null; `data` must outlive it.
std::unique_ptr<FrameTerm> MakeProgramTerm(const FrameData& data);

}  // namespace pliant
