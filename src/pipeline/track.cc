// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/track.h"

#include <algorithm>
#include <memory>
#include <thread>

#include <opencv2/core.hpp>

#include "datasets/video_index.h"
#include "pipeline/frame_source.h"
#include "pipeline/live_start.h"
#include "pipeline/recorder.h"
#include "pipeline/run_checkpoint.h"
#include "pipeline/run_start.h"
#include "pipeline/simulation_truth.h"
#include "pipeline/working_frame.h"
#include "pliant/base/version.h"
#include "pliant/estimation/frame/frame_problem.h"
#include "pliant/io/checkpoint.h"
#include "pliant/io/run_trust.h"
#include "pliant/tracking/stage_times.h"

namespace pliant {
namespace {

// How a run ended.
struct Ending {
  RunStatus status = RunStatus::kCompleted;
  std::string note;
  ErrorCode error = ErrorCode::kInsufficient;  // of a failed run: by itself, no map was made
  bool came_without_map = false;               // the sequence's end
};

Ending FailedBecauseOf(const Status& status) { return {RunStatus::kFailed, status.message(), status.code()}; }

RunColumns ColumnsOfFrames(const TrackerExtensions& extensions) {
  RunColumns columns;
  for (CostTerm& term : NoFrameCosts()) columns.costs.push_back(std::move(term.name));
  if (extensions.cost) columns.costs.emplace_back(extensions.cost->name());
  columns.stages = StageNames();
  return columns;
}

// What else could start, after a run that has no map.
std::string OtherStarts(const Tracker& tracker, const Sequence& sequence, InitMethod method) {
  std::string other;
  if (sequence.BaselineMm() && method != InitMethod::kStereo)
    other = "; the sequence has pairs of images: --Init.method stereo starts from one";
  if (!tracker.WouldStart().empty()) other += "; " + tracker.WouldStart();
  return other;
}

// The ending at the sequence's end; `last_tracked` is the name of the last tracked frame, if there is one.
Ending AtTheEnd(const Tracker& tracker, int frames, const std::string& last_note, const std::string& last_tracked,
                const std::string& other_starts) {
  if (tracker.state() == TrackingState::kTracking) return {RunStatus::kCompleted, "the sequence's end was reached"};
  if (tracker.state() == TrackingState::kLost || tracker.HasInactiveSubmaps())
    return {RunStatus::kLost, "after frame " + last_tracked + "; in the sequence's last frame: " + last_note};
  if (frames == 1)
    return {RunStatus::kFailed, "one frame is not enough for a map; give two or more, between which the camera moved",
            ErrorCode::kInsufficient, true};
  return {RunStatus::kFailed, "the sequence ended without a first map: " + last_note + other_starts,
          ErrorCode::kInsufficient, true};
}

// Of the frames so far, for what is said at the end.
struct TrackedSoFar {
  std::string last_note = "the sequence has no frames";
  std::string last_tracked = {};  // its name
  std::string ambiguity = {};
  int frames = 0;
};

// Everything that goes on from frame to frame.
class FrameLoop {
 public:
  // All are used as long as this lives.
  FrameLoop(CheckedSequence& sequence, const RunRequest& request, const RunIdentity& identity,
            const TrackOptions& options, const RunStart& start, TrackingTruth* truth, RunWriter& writer,
            std::span<TrackObserver* const> observers)
      : sequence_(sequence),
        request_(request),
        identity_(identity),
        options_(options),
        start_(start),
        writer_(writer),
        observers_(observers),
        inputs_{truth, start.tracks, sequence.Photometric(), request.extensions,
                OriginOf(request.input.camera_path.string())},
        tracker_(*start.working_camera, options.tracker, static_cast<std::uint64_t>(options.seed), options.threads,
                 inputs_),
        recorder_(writer, observers, start.working_image,
                  {request.input, start.working_image, *start.working_camera, options, inputs_, &tracker_}) {}

  // Goes on after a checkpoint: what WriteCheckpoint wrote behind the writer's part. Fails with kUnreadable.
  Status TakeCheckpoint(OpenedCheckpoint& checkpoint) {
    last_frame_idx_ = checkpoint.point.frame_idx;
    checkpoint.archive(sequence_);
    SerializeRest(checkpoint.archive);
    if (checkpoint.archive.ok() && checkpoint.archive.AtEnd()) return Status::Ok();
    return {ErrorCode::kUnreadable, "the checkpoint in " + request_.output_path +
                                        " does not belong to this program; track the sequence anew, with --overwrite"};
  }

  Ending Run() {
    const Ending ending = TrackFrames();
    // Whatever the ending: the frames that waited for a map are written too.
    Status recorded = recorder_.Record(tracker_.Finish());
    if (recorded.ok()) recorded = recorder_.Finish();
    return recorded.ok() || ending.status == RunStatus::kFailed ? ending : FailedBecauseOf(recorded);
  }

 private:
  Ending TrackFrames() {
    const int checkpoint_frames = request_.input.given == nullptr ? options_.checkpoint_frames : 0;
    FrameSource frames(sequence_, request_.input, options_, start_, tracker_.WantsDepth(), last_frame_idx_,
                       checkpoint_frames);
    while (true) {
      const auto frame = frames.Next();
      if (frame && !frame->ok()) return FailedBecauseOf(frame->status());
      if (frame) {
        if (auto ending = TrackFrame(**frame, frames)) return *ending;
      } else {
        tracker_.EndSequence();
      }
      const auto back = tracker_.TakeGoesBackTo();
      if (!frame && !back) break;
      if (!back) {
        if (!(*frame)->checked.empty() && tracker_.IsSerializable()) WriteCheckpointAfter(**frame);
        continue;
      }
      if (const Status reopened = frames.GoBackTo(*back); !reopened.ok()) return FailedBecauseOf(reopened);
    }
    if (!tracker_.held().empty()) so_far_.last_note = tracker_.held().back().note;
    for (const FrameReport& report : tracker_.held())
      if (HasPose(report.state)) so_far_.last_tracked = report.name;
    // What holds for a whole window says more than how the last one ended.
    if (so_far_.last_tracked.empty() && !so_far_.ambiguity.empty()) so_far_.last_note = so_far_.ambiguity;
    return AtTheEnd(tracker_, so_far_.frames, so_far_.last_note, so_far_.last_tracked,
                    OtherStarts(tracker_, sequence_, options_.tracker.init.method));
  }

  // How the run ends with this frame; nothing: it goes on.
  std::optional<Ending> TrackFrame(const ReadFrame& read, FrameSource& frames) {
    // What was read ahead for nothing cannot end the run, or the number of threads would decide.
    if (tracker_.NeedsDepth() && read.depth_status)
      if (const Status depth = read.depth_status(); !depth.ok()) return FailedBecauseOf(depth);
    recorder_.Show(read);
    std::vector<FrameReport> done = tracker_.Process(read.frame);
    recorder_.SetLatency(frames.last_frame_idx(), frames.LatencyMs());
    ++so_far_.frames;
    frames.SetWantsDepth(tracker_.WantsDepth());
    const FrameReport& present = tracker_.held().empty() ? done.back() : tracker_.held().back();
    if (!HasPose(present.state)) recorder_.Announce(present);
    so_far_.last_note = present.note;
    for (const FrameReport& report : done) {
      if (HasPose(report.state)) so_far_.last_tracked = report.name;
      if (report.state == TrackingState::kAmbiguous) so_far_.ambiguity = report.note;
    }
    if (const Status recorded = recorder_.Record(std::move(done)); !recorded.ok()) return FailedBecauseOf(recorded);
    if (tracker_.GaveUp())
      return Ending{RunStatus::kLost, "after frame " + so_far_.last_tracked + "; given up in frame " + read.frame.name +
                                          ": " + so_far_.last_note};
    if (request_.stop != nullptr && *request_.stop)
      return Ending{RunStatus::kInterrupted, "stopped on request after frame " + read.frame.name};
    return std::nullopt;
  }

  // A run that cannot write one goes on: the former one is still there.
  void WriteCheckpointAfter(const ReadFrame& read) {
    StateArchive archive;
    ResumePoint point{identity_, read.frame.frame_idx, read.frame.name, ChecksumOf(read.image)};
    archive(point);
    Status status = writer_.Serialize(archive);
    if (status.ok()) {
      std::string checked = read.checked;
      archive.Bytes(checked.data(), checked.size());
      SerializeRest(archive);
      status = WriteCheckpoint(request_.output_path, archive.bytes());
    }
    if (status.ok()) return;
    for (TrackObserver* observer : observers_)
      observer->OnWarning("what --resume needs could not be written: " + status.message());
  }

  void SerializeRest(StateArchive& archive) {
    archive.Members<4>(so_far_);
    archive(recorder_, tracker_);
  }

  CheckedSequence& sequence_;
  const RunRequest& request_;
  const RunIdentity& identity_;
  const TrackOptions& options_;  // of the working image
  const RunStart& start_;
  RunWriter& writer_;
  std::span<TrackObserver* const> observers_;
  TrackerInputs inputs_;
  Tracker tracker_;
  Recorder recorder_;
  TrackedSoFar so_far_;
  int last_frame_idx_ = -1;  // before the run was resumed
};

// Of this machine and these frames. More threads than processors gain nothing, and TBB complains of them on standard
// error.
TrackOptions UsableOptions(TrackOptions options, const SequenceRequest& input) {
  options.threads = std::min(options.threads, std::max(2, static_cast<int>(std::thread::hardware_concurrency())));
  options.tracker.frame_stride = input.stride;
  return options;
}

// `options` are those of the working image.
RunDescription DescriptionOf(const RunRequest& request, const TrackOptions& options, const RunStart& start) {
  const std::vector<std::string_view> oracles = options.tracker.oracle.Names();
  return {kVersion,
          request.command_line,
          static_cast<std::uint64_t>(options.seed),
          request.input.image_path.string(),
          request.input.camera_path.string(),
          request.input.mask_path.string(),
          {oracles.begin(), oracles.end()},
          start.working_image.scale,
          start.working_image.smoothing_px,
          options.tracker.point_tracker.lucas_kanade.patch_size,
          start.images.noise_levels,
          start.images.track_noise_px,
          start.images.alive_after_9,
          "",
          options.tracker.init.IsMetric(),
          options.track_file.path,
          options.tracker.depth_prior.path,
          request.extensions.Names(),
          SelectionOf(request.input),
          {},
          start.working_image.interlaced};
}

// Frames of a video that are read again are found again.
RunRequest WithVideoIndex(RunRequest request) {
  request.input.video_index = std::make_shared<VideoIndex>();
  return request;
}

Status CheckImagesComeAgain(const SequenceRequest& input) {
  if (!input.given && !IsLiveSource(input.image_path)) return Status::Ok();
  return {ErrorCode::kInvalidArgument,
          "images that come from a live source or a program do not come again: such a run cannot be resumed"};
}

// The warnings of the beginning.
std::vector<std::string> TellBeginning(const Sequence& sequence, const RunStart& start,
                                       std::span<TrackObserver* const> observers) {
  std::vector<std::string> warnings = sequence.Warnings();
  warnings.insert(warnings.end(), start.warnings.begin(), start.warnings.end());
  for (TrackObserver* observer : observers) {
    for (const std::string& warning : warnings) observer->OnWarning(warning);
    observer->OnCamera(sequence.camera());
  }
  return warnings;
}

// Adds to the warnings of the beginning.
void TellOfImages(const CheckedSequence& checked, std::span<TrackObserver* const> observers,
                  std::vector<std::string>* warnings) {
  for (const std::string& warning : checked.Check().wrong) {
    for (TrackObserver* observer : observers) observer->OnWarning(warning);
    warnings->push_back(warning);
  }
}

// Once all frames are counted.
void TellOfPrior(const RunSummary& summary, std::span<TrackObserver* const> observers) {
  const std::string doubt = DoubtOfPrior(summary);
  for (TrackObserver* observer : observers)
    if (!doubt.empty()) observer->OnWarning(doubt);
}

// Null: no oracle is on.
Result<std::unique_ptr<TrackingTruth>> TruthOf(const TrackOptions& options, const RunRequest& request,
                                               const Sequence& sequence) {
  if (!options.tracker.oracle.Any()) return std::unique_ptr<TrackingTruth>();
  return OpenSimulationTruth(request.input.image_path, sequence);
}

// The images of a live source end when they are to be stopped, and with a map such a run is complete.
Ending OfStopped(Ending ending) {
  if (ending.came_without_map) ending = {RunStatus::kInterrupted, "stopped on request; " + ending.note};
  return ending;
}

// `live`: null for files. What could not be recorded is not found out later.
RunSummary FinishRun(RunWriter& writer, LiveSource* live, Ending ending) {
  if (live != nullptr) {
    writer.SetStream(live->counts());
    const Status recorded = live->FinishRecording();
    if (!recorded.ok() && ending.status != RunStatus::kFailed) ending = FailedBecauseOf(recorded);
    if (const std::string advice = AdviceOnSkippedImages(writer.summary()); !advice.empty())
      ending.note += "; " + advice;
  }
  const Status finished = writer.Finish(ending.status, ending.note);
  RunSummary summary = writer.summary();
  if (ending.status == RunStatus::kFailed) summary.error = ending.error;
  if (!finished.ok()) {
    summary.status = RunStatus::kFailed;
    summary.note = finished.message();
    summary.error = finished.code();
  }
  return summary;
}

// `usable`: the options of the working image; `options`: as they are listed.
Result<RunWriter> BeginWriting(const RunRequest& request, const TrackOptions& usable, const TrackOptions& options,
                               const RunStart& start, const Camera& camera,
                               std::optional<OpenedCheckpoint>* checkpoint) {
  OptionTable table;
  TrackOptions listed = options;
  listed.List(table);
  RunWriterOptions writer_options;
  writer_options.timings = options.timings;
  writer_options.replaces_run = request.replaces_run;
  RunDescription description = DescriptionOf(request, usable, start);
  if (checkpoint->has_value())
    return RunWriter::Resume(request.output_path, camera, std::move(description), table.ToYaml(),
                             ColumnsOfFrames(request.extensions), writer_options, (*checkpoint)->archive);
  return RunWriter::Create(request.output_path, camera, std::move(description), table.ToYaml(),
                           ColumnsOfFrames(request.extensions), writer_options);
}

// Null for files, and where images are given.
Result<std::shared_ptr<LiveSource>> OpenIfLive(const LiveInputOptions& options, RunRequest* request) {
  if (request->input.given || !IsLiveSource(request->input.image_path)) return std::shared_ptr<LiveSource>();
  return OpenLive(options, request);
}

// `observers` are shown the first image.
ImageWatch WatchOf(const RunRequest& request, std::span<TrackObserver* const> observers) {
  return {[observers](const SequenceFrame& first) {
            for (TrackObserver* observer : observers) observer->OnImage(first.frame_idx, first.image);
          },
          request.stop};
}

}  // namespace

Status EndOf(const RunSummary& summary, const std::string& output_path) {
  if (summary.status != RunStatus::kFailed && summary.status != RunStatus::kInterrupted) return Status::Ok();
  std::string sentence = summary.note;
  if (summary.frames_tracked > 0)
    sentence += "; " + std::to_string(summary.frames_tracked) + " tracked frames are in " + output_path;
  return {summary.status == RunStatus::kFailed ? summary.error : ErrorCode::kInterrupted, sentence};
}

Result<RunSummary> RunTrack(const RunRequest& given, const TrackOptions& wanted,
                            std::span<TrackObserver* const> observers) {
  if (Status status = CheckTrackOptions(wanted); !status.ok()) return status;
  RunRequest request = WithVideoIndex(given);
  std::optional<OpenedCheckpoint> checkpoint;  // nothing: the run begins with its first frame
  if (request.resume) {
    if (Status status = CheckImagesComeAgain(request.input); !status.ok()) return status;
    auto ended = SummaryOfEnded(request, wanted);
    if (!ended.ok()) return ended.status();
    if (ended->has_value()) {
      ForgetCheckpoint(request.output_path);  // it may have been stopped while it did that
      return **std::move(ended);
    }
    auto opened = OpenCheckpoint(request.output_path);
    if (!opened.ok()) return opened.status();
    checkpoint = *std::move(opened);
  }
  const auto live = OpenIfLive(wanted.live_input, &request);
  if (!live.ok()) return live.status();
  const TrackOptions options = request.input.IsLive() ? ForLiveInput(wanted) : wanted;
  if (options.tracker.depth_prior.IsGiven()) request.input.depth_prior_path = options.tracker.depth_prior.path;
  TrackOptions usable = UsableOptions(options, request.input);
  cv::setNumThreads(usable.threads);
  auto sequence = OpenSequence(request.input);
  if (!sequence.ok()) return sequence.status();
  if (Status status = (*sequence)->CheckFiles(); !status.ok()) return status;
  const RunIdentity identity = IdentityOf(request, options, **sequence);
  if (checkpoint)
    if (Status status = CheckIdentity(checkpoint->point.run, identity, request.output_path); !status.ok())
      return status;
  const auto truth = TruthOf(options, request, **sequence);
  if (!truth.ok()) return truth.status();

  const ImageWatch watch = WatchOf(given, checkpoint ? std::span<TrackObserver* const>() : observers);
  const auto start = ReadStart(request, usable, **sequence, watch);
  if (!start.ok()) return start.status();
  if (const Status begun = PassOldImages(options, *start, &request.input, &*sequence); !begun.ok()) return begun;
  usable.tracker = WorkingOptions(std::move(usable.tracker), start->working_image);

  std::vector<std::string> warnings = TellBeginning(**sequence, *start, observers);
  int frames = (*sequence)->size();
  if (checkpoint) {
    frames -= (checkpoint->point.frame_idx - request.input.start) / request.input.stride + 1;
    sequence = OpenAfter(checkpoint->point, request.input);
    if (!sequence.ok()) return sequence.status();
  }
  auto writer = BeginWriting(request, usable, options, *start, (*sequence)->camera(), &checkpoint);
  if (!writer.ok()) return writer.status();
  CheckedSequence checked(**sequence);
  FrameLoop loop(checked, request, identity, usable, *start, truth->get(), *writer, observers);
  if (checkpoint) {
    if (Status status = loop.TakeCheckpoint(*checkpoint); !status.ok()) return status;
    checkpoint.reset();
  }
  for (TrackObserver* observer : observers) observer->OnStart(std::max(frames, 0));
  Ending ending = loop.Run();
  if (*live && watch.IsStopped()) ending = OfStopped(std::move(ending));
  TellOfImages(checked, observers, &warnings);
  TellOfPrior(writer->summary(), observers);
  writer->SetWarnings(std::move(warnings));
  return FinishRun(*writer, live->get(), std::move(ending));
}

}  // namespace pliant
