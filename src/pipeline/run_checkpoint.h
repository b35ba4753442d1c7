// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs that are resumed: which run a checkpoint belongs to, and after which frame it was written.
#pragma once

#include <optional>
#include <string>

#include "pliant/base/state_archive.h"
#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/pipeline/track.h"

namespace pliant {

// What has to be the same when a run is resumed.
struct RunIdentity {
  std::string options;  // and extensions, a line each, without options that never change a result
  std::string frames;   // start, end and stride
  std::string camera;   // model and parameters
};
RunIdentity IdentityOf(const RunRequest& request, const TrackOptions& options, const Camera& camera);

// The head of a checkpoint.
struct ResumePoint {
  RunIdentity run;
  int frame_idx = 0;       // the last frame that was processed
  std::string frame_name;  // of it
};
void Serialize(StateArchive& archive, ResumePoint& point);

// Of a run that has come to its end, with which its checkpoint is deleted: there is nothing to resume. Fails with
// kMismatch where it had other options.
Result<std::optional<RunSummary>> SummaryOfEnded(const std::string& run_path, const TrackOptions& options);

// The checkpoint in the request's output folder, opened behind its head; nothing: the run begins with its first frame.
// Fails as ReadCheckpoint.
struct OpenedCheckpoint {
  StateArchive archive;
  ResumePoint point;
};
Result<std::optional<OpenedCheckpoint>> OpenCheckpoint(const std::string& run_path);

// Fails with kMismatch where the checkpoint is of a run with other options, frames or another camera; says which.
Status CheckIdentity(const RunIdentity& of_checkpoint, const RunIdentity& wanted, const std::string& run_path);

// The sequence from the frame after the checkpoint's on, which may be none. Fails as OpenSequence, and with kMismatch
// where the checkpoint's frame has another name.
Result<std::unique_ptr<Sequence>> OpenAfter(const ResumePoint& point, const SequenceRequest& input);

}  // namespace pliant
