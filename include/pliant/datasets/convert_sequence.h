// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Any sequence written in Pliant's own layout.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"

namespace pliant {

struct ConvertSummary {
  int frames = 0;
  int right = 0;
  int masks = 0;
  int depths = 0;
  int poses = 0;
  std::int64_t clipped_depths = 0;  // pixels whose depth is too large for the 16 bits, written as none
};

// Called after each frame is on disk; false asks to stop.
using ConvertProgress = std::function<bool(int frames_done)>;

// Reads `sequence`, of which every `stride`-th frame was asked for, to its end. The folder must be new or empty
// (kInvalidArgument). Fails as Sequence::Next and NativeWriter, and with kInterrupted; what was written until then is
// readable.
Result<ConvertSummary> ConvertSequence(Sequence& sequence, const std::filesystem::path& folder,
                                       const ConvertProgress& progress = {}, int stride = 1);

}  // namespace pliant
