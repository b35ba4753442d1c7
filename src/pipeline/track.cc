// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/track.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <map>
#include <memory>
#include <thread>

#include <opencv2/core.hpp>

#include "pipeline/frames_before.h"
#include "pipeline/run_start.h"
#include "pipeline/simulation_truth.h"
#include "pipeline/working_frame.h"
#include "pliant/base/prefetcher.h"
#include "pliant/base/version.h"
#include "pliant/camera/assumed_camera.h"
#include "pliant/datasets/check_images.h"
#include "pliant/estimation/frame/frame_problem.h"
#include "pliant/tracking/bootstrapping/stereo_pair.h"
#include "pliant/tracking/stage_times.h"

namespace pliant {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kFramesAhead = 3;
constexpr int kLiveFramesAhead = 1;  // it is prepared while tracking is busy; more would be old by then

struct ReadFrame {
  PreparedFrame frame;
  cv::Mat image;  // as the source has it
  Status depth;   // of reading its depth image, or its right one; matters only while the tracker wants depth
};

// Reads and prepares the next frame; nothing at the end.
std::optional<Result<ReadFrame>> NextFrame(Sequence& sequence, const TrackerOptions& options, int threads,
                                           const RunStart& start, const std::atomic<bool>& wants_depth) {
  const WorkingImage& working = start.working_image;
  auto next = sequence.Next();
  if (!next.ok()) return next.status();
  if (!next->has_value()) return std::nullopt;
  const SequenceFrame& frame = **next;
  ReadFrame read{PrepareWorkingFrame(frame, working, options), frame.image, {}};
  if (!wants_depth) return read;
  if (options.init.method == InitMethod::kColmapModel) {
    read.frame.known_points = [&start, name = frame.name] {
      std::vector<PixelDepth> points = start.model->PointsIn(name);
      for (PixelDepth& point : points) point.pixel = start.working_image.ToWorking(point.pixel);
      return points;
    };
  } else if (!start.cloud_depth_mm.empty()) {
    if (frame.frame_idx == start.first_frame_idx) read.frame.depth_mm = working.Nearest(start.cloud_depth_mm);
  } else if (options.init.method == InitMethod::kStereo) {
    const auto right = sequence.Right();
    read.depth = right.status();
    if (right.ok() && right->has_value())
      read.frame.known_points = [left = read.frame, right = working.Image(**right), camera = *start.working_camera,
                                 baseline_mm = sequence.BaselineMm().value_or(0.0), &options,
                                 threads] { return PointsOfPair(left, right, camera, baseline_mm, options, threads); };
  } else {
    const auto depth = sequence.Depth(frame.frame_idx);
    read.depth = depth.status();
    if (depth.ok() && depth->has_value()) read.frame.depth_mm = working.Nearest(**depth);
  }
  return read;
}

// How a run ended.
struct Ending {
  RunStatus status = RunStatus::kCompleted;
  std::string note;
};

RunColumns ColumnsOfFrames() {
  RunColumns columns;
  for (CostTerm& term : NoFrameCosts()) columns.costs.push_back(std::move(term.name));
  columns.stages = StageNames();
  return columns;
}

// Final reports on their way to the run folder and then to the observers.
class Recorder {
 public:
  Recorder(RunWriter& writer, std::span<TrackObserver* const> observers, const WorkingImage& working,
           FramesBefore before)
      : writer_(writer), observers_(observers), working_(working), before_(std::move(before)) {}

  // The frame's latency, once it is known; to be called before its report is recorded.
  void SetLatency(int frame_idx, double ms) { latencies_ms_[frame_idx] = ms; }
  Status Record(std::vector<FrameReport> reports) { return Write(before_.Pass(std::move(reports))); }
  // No map comes any more.
  Status Finish() { return Write(before_.Finish()); }
  void Show(const ReadFrame& read) {
    for (TrackObserver* observer : observers_) observer->OnImage(read.frame.frame_idx, read.image);
  }
  void Announce(const FrameReport& held) {
    for (TrackObserver* observer : observers_) observer->OnHeld(held);
  }

 private:
  Status Write(std::vector<FrameReport> reports) {
    for (FrameReport& of_tracker : reports) {
      if (const auto latency = latencies_ms_.extract(of_tracker.frame_idx)) of_tracker.latency_ms = latency.mapped();
      const FrameReport report = InSourcePixels(std::move(of_tracker), working_);
      if (Status written = writer_.Write(report); !written.ok()) return written;
      for (TrackObserver* observer : observers_) observer->OnFrame(report);
    }
    return Status::Ok();
  }

  RunWriter& writer_;
  std::span<TrackObserver* const> observers_;
  WorkingImage working_;
  FramesBefore before_;
  std::map<int, double> latencies_ms_;  // of frames that are not written yet
};

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
    return {RunStatus::kFailed, "one frame is not enough for a map; give two or more, between which the camera moved"};
  return {RunStatus::kFailed, "the sequence ended without a first map: " + last_note + other_starts};
}

// Frames of the sequence, read ahead, in which one can go back: then some are read once more.
class FrameSource {
 public:
  // All are used as long as this lives.
  FrameSource(Sequence& sequence, const SequenceRequest& input, const TrackOptions& options, const RunStart& start,
              bool wants_depth)
      : input_(input), options_(options), start_(start), wants_depth_(wants_depth) {
    ReadAhead(sequence, &frames_);
  }

  // An image of a file arrives when it is asked for.
  std::optional<Result<ReadFrame>> Next() {
    if (again_) {
      if (auto frame = again_->Next()) return frame;
      again_.reset();
    }
    const auto asked = Clock::now();
    auto frame = frames_->Next();
    if (!frame || !frame->ok()) return frame;
    arrived_ = asked;
    last_frame_idx_ = (*frame)->frame.frame_idx;
    if (input_.IsLive()) {
      const auto arrived = input_.given->images->Arrived(last_frame_idx_);
      arrived_ = arrived.value_or(arrived_);
    }
    return frame;
  }
  // Of those that came for the first time the last one, and for how long it has been there.
  int last_frame_idx() const { return last_frame_idx_; }
  double LatencyMs() const { return std::chrono::duration<double, std::milli>(Clock::now() - arrived_).count(); }
  // Once there is a map no depth image is read any more; those read ahead in the meantime change nothing.
  void SetWantsDepth(bool wants) { wants_depth_ = wants; }
  // What comes next is the frame after this one, which has come already. Fails as OpenSequence does.
  Status GoBackTo(int frame_idx) {
    again_.reset();
    if (frame_idx >= last_frame_idx_) return Status::Ok();
    SequenceRequest part = input_;
    part.start = frame_idx + input_.stride;
    part.end = last_frame_idx_ + 1;
    auto reopened = OpenSequence(part);
    if (!reopened.ok()) return reopened.status();
    reopened_ = *std::move(reopened);
    ReadAhead(*reopened_, &again_);
    return Status::Ok();
  }

 private:
  using Frames = std::optional<Prefetcher<Result<ReadFrame>>>;
  void ReadAhead(Sequence& sequence, Frames* frames) {
    frames->emplace([&] { return NextFrame(sequence, options_.tracker, options_.threads, start_, wants_depth_); },
                    options_.threads == 1 ? 0 : (input_.IsLive() ? kLiveFramesAhead : kFramesAhead));
  }

  const SequenceRequest& input_;
  const TrackOptions& options_;
  const RunStart& start_;
  std::atomic<bool> wants_depth_;
  int last_frame_idx_ = -1;  // of the frames that came for the first time
  Clock::time_point arrived_;
  std::unique_ptr<Sequence> reopened_;
  Frames frames_;
  Frames again_;
};

Ending TrackFrames(Sequence& sequence, const RunRequest& request, const TrackOptions& options, const RunStart& start,
                   Tracker& tracker, Recorder& recorder) {
  FrameSource frames(sequence, request.input, options, start, tracker.WantsDepth());
  std::string last_note = "the sequence has no frames";
  std::string last_tracked;
  std::string ambiguity;
  int count = 0;
  while (true) {
    const auto frame = frames.Next();
    if (frame && !frame->ok()) return {RunStatus::kFailed, frame->status().message()};
    if (frame) {
      const ReadFrame& read = **frame;
      // What was read ahead for nothing cannot end the run, or the number of threads would decide.
      if (tracker.NeedsDepth() && !read.depth.ok()) return {RunStatus::kFailed, read.depth.message()};
      recorder.Show(read);
      std::vector<FrameReport> done = tracker.Process(read.frame);
      recorder.SetLatency(frames.last_frame_idx(), frames.LatencyMs());
      ++count;
      frames.SetWantsDepth(tracker.WantsDepth());
      const FrameReport& present = tracker.held().empty() ? done.back() : tracker.held().back();
      if (!HasPose(present.state)) recorder.Announce(present);
      last_note = present.note;
      for (const FrameReport& report : done) {
        if (HasPose(report.state)) last_tracked = report.name;
        if (report.state == TrackingState::kAmbiguous) ambiguity = report.note;
      }
      if (const Status recorded = recorder.Record(std::move(done)); !recorded.ok())
        return {RunStatus::kFailed, recorded.message()};
      if (tracker.GaveUp())
        return {RunStatus::kLost,
                "after frame " + last_tracked + "; given up in frame " + read.frame.name + ": " + last_note};
      if (request.stop != nullptr && *request.stop)
        return {RunStatus::kInterrupted, "stopped on request after frame " + read.frame.name};
    } else {
      tracker.EndSequence();
    }
    const auto back = tracker.TakeGoesBackTo();
    if (!frame && !back) break;
    if (!back) continue;
    if (const Status reopened = frames.GoBackTo(*back); !reopened.ok()) return {RunStatus::kFailed, reopened.message()};
  }
  if (!tracker.held().empty()) last_note = tracker.held().back().note;
  // What holds for a whole window says more than how the last one ended.
  if (last_tracked.empty() && !ambiguity.empty()) last_note = ambiguity;
  return AtTheEnd(tracker, count, last_note, last_tracked, OtherStarts(tracker, sequence, options.tracker.init.method));
}

Ending TrackSequence(Sequence& sequence, const RunRequest& request, const TrackOptions& options, const RunStart& start,
                     TrackingTruth* truth, RunWriter& writer, std::span<TrackObserver* const> observers) {
  const Camera& camera = *start.working_camera;
  const TrackerInputs inputs{truth, start.tracks, sequence.Photometric(), request.extensions};
  Tracker tracker(camera, options.tracker, static_cast<std::uint64_t>(options.seed), options.threads, inputs);
  Recorder recorder(writer, observers, start.working_image,
                    {request.input, start.working_image, camera, options, inputs, &tracker});
  const Ending ending = TrackFrames(sequence, request, options, start, tracker, recorder);
  // Whatever the ending: the frames that waited for a map are written too.
  Status recorded = recorder.Record(tracker.Finish());
  if (recorded.ok()) recorded = recorder.Finish();
  return recorded.ok() || ending.status == RunStatus::kFailed ? ending : Ending{RunStatus::kFailed, recorded.message()};
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
          request.extensions.Names()};
}

// What follows from images that do not wait: nothing may hold tracking up.
TrackOptions ForLiveInput(TrackOptions options) {
  if (options.live_input.frames != LiveFrames::kNewest) return options;
  options.max_frames_back = 0;
  options.tracker.handover_frames = std::max(options.tracker.handover_frames, options.live_input.handover_frames);
  return options;
}

// The live images of which the working image was chosen are old by now: tracking begins after them. Unless a cloud of
// depths belongs to the first image, or an end counts from it.
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

// Turns the request into one of the source's images.
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

}  // namespace

void ImageOptions::List(OptionTable& table) {
  table.BeginGroup("Image", "the working image: the source resized and smoothed, in which points are tracked");
  table.AddChoice(
      "working", &working,
      "measured: the size and smoothing in which most points of the first images last, and larger patches where "
      "more last with them; fixed: by scale and smoothing_px");
  table.Add("scale", &scale, "-", "fixed: size of the working image divided by that of the source", 0.05, 4);
  table.Add("smoothing_px", &smoothing_px, "px",
            "fixed: standard deviation of the Gaussian that smooths the working image, in its pixels; 0: none", 0, 20);
}

void TrackOptions::List(OptionTable& table) {
  table.BeginGroup("General", "the run as a whole");
  table.Add("seed", &seed, "-", "decides every random choice; the same seed gives the same files", 0, 2147483647);
  table.Add("threads", &threads, "-",
            "1: everything on one thread; 2 and more: images are read ahead, points followed in parallel; never "
            "changes the result",
            1, 1024);
  table.Add("max_frames_back", &max_frames_back, "frames",
            "frames without a map, before the reference of a first map, tracked backwards in time from it", 0, 100000);
  table.AddChoice("timings", &timings, "none: wall times are written as 0, so that two runs are equal byte for byte");
  live_input.List(table);
  image.List(table);
  track_file.List(table);
  tracker.List(table);
}

TrackOptions MakeTrackOptions(Preset preset) {
  TrackOptions options;
  if (preset == Preset::kDefault) return options;
  options.max_frames_back = 0;
  options.image.working = WorkingImageMode::kFixed;
  TrackerOptions& tracker = options.tracker;
  tracker.corners.contour_filter = Switch::kOff;
  tracker.masks.highlights = Switch::kOff;
  tracker.masks.border = Switch::kOff;
  tracker.point_tracker.patch_policy = PatchPolicy::kPeriodic;
  tracker.point_tracker.forward_backward = Switch::kOff;
  tracker.point_tracker.lucas_kanade.patch_size = 21;
  tracker.point_tracker.lucas_kanade.shading = Shading::kNone;
  tracker.point_tracker.lucas_kanade.similarity = SimilarityMode::kPlain;
  tracker.init.method = InitMethod::kPaper;
  tracker.neighbor_agreement = Switch::kOff;
  tracker.common_motion_share = 0;
  tracker.find_lost = Switch::kOff;
  tracker.growth.grow = Switch::kOff;
  tracker.relocalization.relocalize = Switch::kOff;
  tracker.track_blurred = Switch::kOff;
  tracker.submaps = Switch::kOff;
  return options;
}

Status CheckTrackOptions(const TrackOptions& options) {
  const InitOptions& init = options.tracker.init;
  if (init.method != InitMethod::kDepth && !init.depth.cloud_path.empty())
    return {ErrorCode::kInvalidArgument, "Init.depth_cloud is for a start from depth; give Init.method depth as well"};
  if (init.method == InitMethod::kDepthPrior && !options.tracker.depth_prior.IsGiven())
    return {ErrorCode::kInvalidArgument,
            "Init.method depth_prior starts from the depth images of another program; name their folder with "
            "--depth_prior (DepthPrior.path)"};
  return Status::Ok();
}

Status EndOf(const RunSummary& summary, const std::string& output_path) {
  if (summary.status != RunStatus::kFailed && summary.status != RunStatus::kInterrupted) return Status::Ok();
  std::string sentence = summary.note;
  if (summary.frames_tracked > 0)
    sentence += "; " + std::to_string(summary.frames_tracked) + " tracked frames are in " + output_path;
  return {summary.status == RunStatus::kFailed ? ErrorCode::kInsufficient : ErrorCode::kInterrupted, sentence};
}

Result<RunSummary> RunTrack(const RunRequest& given, const TrackOptions& wanted,
                            std::span<TrackObserver* const> observers) {
  RunRequest request = given;
  std::shared_ptr<LiveSource> live;
  if (!request.input.given && IsLiveSource(request.input.image_path)) {
    auto opened = OpenLive(wanted.live_input, &request);
    if (!opened.ok()) return opened.status();
    live = *std::move(opened);
  }
  const TrackOptions options = request.input.IsLive() ? ForLiveInput(wanted) : wanted;
  if (options.tracker.depth_prior.IsGiven()) request.input.depth_prior_path = options.tracker.depth_prior.path;
  // More threads than processors gain nothing, and TBB complains of them on standard error.
  TrackOptions usable = options;
  usable.threads = std::min(options.threads, std::max(2, static_cast<int>(std::thread::hardware_concurrency())));
  cv::setNumThreads(usable.threads);
  auto sequence = OpenSequence(request.input);
  if (!sequence.ok()) return sequence.status();
  if (Status status = (*sequence)->CheckSizes(); !status.ok()) return status;
  std::unique_ptr<TrackingTruth> truth;
  if (options.tracker.oracle.Any()) {
    auto opened = OpenSimulationTruth(request.input.image_path, **sequence);
    if (!opened.ok()) return opened.status();
    truth = *std::move(opened);
  }

  const auto start = ReadStart(request, usable, **sequence);
  if (!start.ok()) return start.status();
  if (const Status begun = PassOldImages(options, *start, &request.input, &*sequence); !begun.ok()) return begun;
  usable.tracker = WorkingOptions(std::move(usable.tracker), start->working_image);

  OptionTable table;
  TrackOptions listed = options;
  listed.List(table);
  RunWriterOptions writer_options;
  writer_options.timings = options.timings;
  auto writer = RunWriter::Create(request.output_path, (*sequence)->camera(), DescriptionOf(request, usable, *start),
                                  table.ToYaml(), ColumnsOfFrames(), writer_options);
  if (!writer.ok()) return writer.status();

  for (TrackObserver* observer : observers) {
    for (const std::string& warning : (*sequence)->Warnings()) observer->OnWarning(warning);
    for (const std::string& warning : start->warnings) observer->OnWarning(warning);
    observer->OnCamera((*sequence)->camera());
    observer->OnStart((*sequence)->size());
  }
  CheckedSequence checked(**sequence);
  const Ending ending = TrackSequence(checked, request, usable, *start, truth.get(), *writer, observers);
  for (const std::string& warning : checked.Check().wrong)
    for (TrackObserver* observer : observers) observer->OnWarning(warning);
  if (live) writer->SetStream(live->counts());
  const Status finished = writer->Finish(ending.status, ending.note);
  RunSummary summary = writer->summary();
  if (!finished.ok()) {
    summary.status = RunStatus::kFailed;
    summary.note = finished.message();
  }
  return summary;
}

}  // namespace pliant
