// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The main job: a sequence in, a run folder out (docs/formats.md). A frame is on disk as soon as its report is final,
// so that a run which is lost, interrupted, killed or fails leaves what it had. The frames that wait for a first map,
// or in which the map before was lost, are final when it is made or the old one found again: those before its reference
// are then tracked back from it. A run that is interrupted or fails before writes them without poses, and one that is
// killed has not written them.
#pragma once

#include <array>
#include <atomic>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/datasets/live_source.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/datasets/sequence_tracks.h"
#include "pliant/io/run_summary.h"
#include "pliant/io/run_writer.h"
#include "pliant/scene/frame_report.h"
#include "pliant/tracking/tracker.h"

namespace pliant {

enum class Preset {
  kDefault,  // ours
  kPaper,    // every choice and constant as published, for comparison
};
template <>
struct EnumNames<Preset> {
  static constexpr std::array kNames = {std::pair{Preset::kDefault, std::string_view("default")},
                                        std::pair{Preset::kPaper, std::string_view("paper")}};
};

// How the images in which points are tracked come from those of the source (WorkingImage).
enum class WorkingImageMode {
  kMeasured,  // resized and smoothed as most points last
  kFixed,     // by the options
};
template <>
struct EnumNames<WorkingImageMode> {
  static constexpr std::array kNames = {std::pair{WorkingImageMode::kMeasured, std::string_view("measured")},
                                        std::pair{WorkingImageMode::kFixed, std::string_view("fixed")}};
};

// Whether the source's images are interlaced: their odd rows are of another time then, and are not used.
enum class Interlacing {
  kMeasured,  // with WorkingImageMode::kMeasured; else they are not
  kOff,
  kOn,
};
template <>
struct EnumNames<Interlacing> {
  static constexpr std::array kNames = {std::pair{Interlacing::kMeasured, std::string_view("measured")},
                                        std::pair{Interlacing::kOff, std::string_view("off")},
                                        std::pair{Interlacing::kOn, std::string_view("on")}};
};

struct ImageOptions {
  WorkingImageMode working = WorkingImageMode::kMeasured;
  double scale = 1;         // fixed: size of the working image by that of the source
  double smoothing_px = 0;  // fixed: standard deviation of a Gaussian, in working pixels
  Interlacing interlaced = Interlacing::kMeasured;

  void List(OptionTable& table);  // group "Image"
};

struct TrackOptions {
  int seed = 1;
  int threads = 2;  // 1: everything on one thread; 2 and more: images are read ahead, points are followed in parallel
  int checkpoint_frames = 1000;  // what RunRequest::resume goes on with is written every Nth frame; 0: never
  RunTimings timings = RunTimings::kWritten;
  int max_frames_back = 10000;  // without a map, tracked back from a first map's reference or where it is found again
  LiveInputOptions live_input;  // where the image path names a live source
  ImageOptions image;
  TrackFileOptions track_file;  // where it is given, points are followed by it
  TrackerOptions tracker;

  // Whether pixels come from outside, in those of the source: the tracker then works in the source's images.
  bool FollowsInSource() const { return tracker.oracle.Any() || track_file.IsGiven(); }
  void List(OptionTable& table);  // groups "General", "Image", "TrackFile" and the tracker's
};

TrackOptions MakeTrackOptions(Preset preset);

// Fails with kInvalidArgument where options contradict each other.
Status CheckTrackOptions(const TrackOptions& options);

struct RunRequest {
  // An image path may name a live source (pliant/datasets/live_source.h): its images are recorded as the sequence
  // RecordingOf(output_path), which is the run's input from then on. `stop` ends it like the end of a sequence.
  SequenceRequest input;
  std::string output_path;
  // Go on with the run in output_path that was stopped, failed or was killed, from its last checkpoint (option
  // General.checkpoint_frames), with the same result as if it had not been: bytes too, but for wall times. Where it has
  // no checkpoint it begins anew, and where it has come to its end there is nothing to do. Observers are told of the
  // frames that follow.
  bool resume = false;
  std::vector<std::string> command_line;    // for run.json
  TrackerExtensions extensions = {};        // asked from the calling thread
  const std::atomic<bool>* stop = nullptr;  // becomes true when the run is to end after the present frame; may be null
  bool replaces_run = true;  // one with poses that is in output_path; false: kMismatch, before the first frame
};

class TrackObserver {
 public:
  virtual ~TrackObserver() = default;
  // Before the first frame; `frames` is what the sequence says of its length.
  virtual void OnStart(int frames) = 0;
  // What is odd about the sequence, before OnStart, or about the images that were read, at the end; a sentence each.
  virtual void OnWarning(const std::string& /*sentence*/) {}
  // The sequence's camera, before OnStart.
  virtual void OnCamera(const Camera& /*camera*/) {}
  // Before a frame is tracked; once more where tracking went back to a provisional map; and the first one that is read,
  // before all others and OnStart. The image is 8-bit with one or three (BGR) channels; it is not written to any more,
  // so that it may be kept.
  virtual void OnImage(int /*frame_idx*/, const cv::Mat& /*image*/) {}
  // After a frame's rows are on disk: once a frame, in order of time. A later report's `merge` may move it into another
  // world; the run folder has it there in the end.
  virtual void OnFrame(const FrameReport& report) = 0;
  // A frame was processed whose report waits for a map: what is known so far. Its OnFrame follows later. Once more
  // where tracking went back.
  virtual void OnHeld(const FrameReport& /*report*/) {}
};

// Runs the tracker over the sequence. Fails when there is nothing to run on: options that contradict each other
// (CheckTrackOptions), an input that cannot be opened, an output that cannot be made, a checkpoint that is damaged or
// of another run; with kInterrupted where `stop` becomes true before the first frame. Once frames are read the answer
// is a summary, whose status and note say how the run ended:
//   completed    at the sequence's end            lost    too few points (the note says in which frame)
//   interrupted  `stop` became true               failed  an image could not be read, a row not be written, or the
//                                                         sequence ended without a first map
// The result depends on input, options and seed, not on the number of threads. Sets OpenCV's number of threads.
Result<RunSummary> RunTrack(const RunRequest& request, const TrackOptions& options,
                            std::span<TrackObserver* const> observers);

// Whether a run of this summary, in the folder `output_path`, did all that it could. Fails with kInterrupted for one
// that was stopped, and with the summary's error for one that failed (kInsufficient: there was no first map); the
// sentence says how it ended, and how much there is of it.
Status EndOf(const RunSummary& summary, const std::string& output_path);

}  // namespace pliant
