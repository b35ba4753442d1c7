// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far to trust a run of which the truth is not known: what it measured of itself, in plain words.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pliant/io/run_summary.h"

namespace pliant {

// Topics (frames, depth, depth_prior, camera, calibration, recording, images, tracks, coverage, advice) with one or
// more sentences each, in this order; those of which nothing is known are left out. Of a refined run they say what the
// refinement knows, and nothing of the first map. Empty for a run that has no frames. Only the summary's own numbers
// are used.
std::vector<std::pair<std::string, std::string>> TrustIn(const RunSummary& summary);

// Of a run on a live source that has no map and skipped images: how many, and what to do; without a full stop. Empty
// for others.
std::string AdviceOnSkippedImages(const RunSummary& summary);

// Where a depth prior falls in nearly all frames in which it should grow: the question whether its kind is right, with
// the numbers; without a full stop. Empty for others.
std::string DoubtOfPrior(const RunSummary& summary);

}  // namespace pliant
