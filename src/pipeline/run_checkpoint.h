// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs that are resumed: which run a checkpoint belongs to, and after which frame it was written.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

#include "pliant/base/state_archive.h"
#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/pipeline/track.h"

namespace pliant {

// What has to be the same when a run is resumed.
struct RunIdentity {
  std::string options;  // and extensions, a line each, without options that never change a result
  std::string frames;   // start, end and stride
  std::string camera;   // model and parameters, of the light, too
};
RunIdentity IdentityOf(const RunRequest& request, const TrackOptions& options, const Sequence& sequence);
FrameSelection SelectionOf(const SequenceRequest& input);

// The head of a checkpoint.
struct ResumePoint {
  RunIdentity run;
  int frame_idx = 0;       // the last frame that was processed
  std::string frame_name;  // of it
  std::uint32_t image_checksum = 0;
};
void Serialize(StateArchive& archive, ResumePoint& point);

// CRC-32 of an image's pixels.
std::uint32_t ChecksumOf(const cv::Mat& image);

// Of a run that has come to its end, with which its checkpoint is deleted: there is nothing to resume. Fails with
// kMismatch where it had other options, images or frames.
Result<std::optional<RunSummary>> SummaryOfEnded(const RunRequest& request, const TrackOptions& options);

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
// where the checkpoint's frame has another name or other pixels.
Result<std::unique_ptr<Sequence>> OpenAfter(const ResumePoint& point, const SequenceRequest& input);

}  // namespace pliant
