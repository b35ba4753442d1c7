// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/live_start.h"

#include <algorithm>

#include "pliant/camera/assumed_camera.h"

namespace pliant {

TrackOptions ForLiveInput(TrackOptions options) {
  if (options.live_input.frames != LiveFrames::kNewest) return options;
  options.max_frames_back = 0;
  options.tracker.handover_waits = Switch::kOff;
  options.tracker.handover_frames = std::max(options.tracker.handover_frames, options.live_input.handover_frames);
  return options;
}

Status PassOldImages(const TrackOptions& options, const RunStart& start, SequenceRequest* input,
                     std::unique_ptr<Sequence>* sequence) {
  if (!input->IsLive() || options.live_input.frames != LiveFrames::kNewest) return Status::Ok();
  if (input->end >= 0 || !start.cloud_depth_mm.empty()) return Status::Ok();
  input->start = std::max(input->start, input->given->images->Passed());
  auto reopened = OpenSequence(*input);
  if (!reopened.ok()) return reopened.status();
  *sequence = *std::move(reopened);
  return Status::Ok();
}

Result<std::shared_ptr<LiveSource>> OpenLive(const LiveInputOptions& options, RunRequest* request) {
  SequenceRequest& input = request->input;
  auto live = LiveSource::Open({.source = input.image_path,
                                .camera_path = input.camera_path,
                                .recording_path = RecordingOf(request->output_path),
                                .options = options,
                                .stop = request->stop});
  if (!live.ok()) return live;
  input.given = LiveSource::Given(*live);
  input.image_path = RecordingOf(request->output_path);
  if (!IsAssumedCamera(input.camera_path.string())) input.camera_path.clear();  // the recording has it
  request->stop = nullptr;
  return live;
}

}  // namespace pliant
