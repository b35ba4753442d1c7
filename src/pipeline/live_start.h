// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How a run begins whose images do not wait.
#pragma once

#include <memory>

#include "pipeline/run_start.h"
#include "pliant/base/status.h"
#include "pliant/datasets/live_source.h"
#include "pliant/datasets/sequence.h"
#include "pliant/pipeline/track.h"

namespace pliant {

// Turns the request into one of the source's images. Fails as LiveSource::Open.
Result<std::shared_ptr<LiveSource>> OpenLive(const LiveInputOptions& options, RunRequest* request);

// What follows for the options: nothing may hold tracking up.
TrackOptions ForLiveInput(TrackOptions options);

// The live images of which the working image was chosen are old by now: tracking begins after them. Unless a cloud of
// depths belongs to the first image, or an end counts from it. Fails as OpenSequence.
Status PassOldImages(const TrackOptions& options, const RunStart& start, SequenceRequest* input,
                     std::unique_ptr<Sequence>* sequence);

}  // namespace pliant
