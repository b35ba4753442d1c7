// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The run folder: what it says about itself (run.json), shared by its writer and its reader.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

enum class RunStatus {
  kCompleted,    // the sequence's end was reached
  kLost,         // too few points were left
  kInterrupted,  // stopped on request, or killed: a run says so until it can say something else
  kFailed,       // an input could not be read, an output could not be written
};

template <>
struct EnumNames<RunStatus> {
  static constexpr std::array kNames = {std::pair{RunStatus::kCompleted, std::string_view("completed")},
                                        std::pair{RunStatus::kLost, std::string_view("lost")},
                                        std::pair{RunStatus::kInterrupted, std::string_view("interrupted")},
                                        std::pair{RunStatus::kFailed, std::string_view("failed")}};
};

// Which of a recording's frames a run takes.
struct FrameSelection {
  int start = 0;   // the first
  int end = -1;    // one past the last; -1: to the recording's end
  int stride = 1;  // of so many frames one
  bool operator==(const FrameSelection&) const = default;
};

// What a refinement took a submap for.
enum class RefinedModel {
  kRigid,
  kDeforming,
  kUnchanged,  // it could not be refined, and is as it was
};

template <>
struct EnumNames<RefinedModel> {
  static constexpr std::array kNames = {std::pair{RefinedModel::kRigid, std::string_view("rigid")},
                                        std::pair{RefinedModel::kDeforming, std::string_view("deforming")},
                                        std::pair{RefinedModel::kUnchanged, std::string_view("unchanged")}};
};

// Of a refined run.
struct RunRefinement {
  std::vector<RefinedModel> models;  // of its submaps, in order
  double depth_sigma = 0;            // median of a point's standard deviation by its distance; 0: unknown
  bool has_estimated_camera = false;
  std::string focal_length_kept = {};  // why the focal length was not estimated where it was to be; empty: it was
};

// What is known when a run begins.
struct RunDescription {
  std::string program_version;
  std::vector<std::string> command_line;
  std::uint64_t seed = 0;
  std::string input;                      // the images' path, absolute; empty: images of a program
  std::string camera = {};                // the calibration's path, absolute; empty: the one that belongs to the images
  std::string mask = {};                  // the masks' path, absolute; empty: none, or those that belong to the images
  std::vector<std::string> oracles = {};  // parts of the method that were replaced by the truth; empty in an honest run
  // The images in which points were tracked: their size by that of the source; in their pixels, their smoothing and the
  // side of a point's patch (0: unknown).
  double image_scale = 1;
  double image_smoothing_px = 0;
  int patch_size = 0;
  // Measured on the first of those images, in their pixels and gray levels; 0: unknown.
  double image_noise_levels = 0;
  double track_noise_px = 0;      // standard deviation of a coordinate of a point's track
  double alive_after_9 = 0;       // share of the corners that are tracked through nine frames
  std::string refined_from = {};  // the run that was refined, absolute; empty: a run of its own
  // Whether a map unit is a millimeter, since the map starts from known depth; nothing: it does not say (an earlier
  // version's, or another program's result).
  std::optional<bool> metric = {};
  std::string tracks = {};       // the file of tracks that was followed, absolute; empty: our own tracker's
  std::string depth_prior = {};  // the folder of the depth prior, absolute; empty: none
  // Parts that the calling program gave: "initializer NAME", "tracks", "cost NAME".
  std::vector<std::string> extensions = {};
  FrameSelection range = {};                     // all frames in runs of earlier versions, which do not say
  std::vector<std::string> joined_from = {};     // the runs that were joined, absolute; empty: a run of its own
  bool interlaced = false;                       // the images are: their odd rows were not used
  std::optional<RunRefinement> refinement = {};  // nothing: not refined, or by an earlier version
  // What is odd about the recording and what belongs to it: sentences without a full stop, known at the run's end.
  std::vector<std::string> warnings = {};
};

// Images of a source that went on while they were tracked.
struct StreamCounts {
  std::int64_t received = 0;
  std::int64_t skipped = 0;  // of those: newer ones had come
  std::int64_t damaged = 0;  // not among those: they were cut off or could not be decoded
  // Images a second, by which the frames have their times; 0: unknown (earlier versions). Measured as they came, or
  // the word of the source, else of the calibration.
  double fps = 0;
  bool measured = false;
};

// Of frames, from arrival until everything was done that a frame asked for, in milliseconds.
struct Latency {
  double p50 = 0;
  double p99 = 0;
  double max = 0;
};

// Frames whose depth prior was compared with what else says the depths of their points (FramePrior).
struct PriorCounts {
  std::int64_t compared = 0;
  std::int64_t agree = 0;
  std::int64_t fall = 0;
  std::int64_t by_brightness = 0;     // of those compared
  std::int64_t reestimated_maps = 0;  // that used it
};

// run.json.
struct RunSummary {
  RunDescription description;
  RunStatus status = RunStatus::kInterrupted;
  std::string note;                            // why the run ended, one sentence
  ErrorCode error = ErrorCode::kInsufficient;  // of a failed run, what went wrong: never kOk; run.json does not say it
  std::vector<FirstMapFrames> first_maps;      // one a map that was made, in the order of time

  std::optional<StreamCounts> stream;  // nothing: all images were there before
  std::int64_t frames_read = 0;
  std::int64_t frames_tracked = 0;                             // that have a pose
  std::vector<std::pair<TrackingState, std::int64_t>> states;  // frames in each state that occurred
  double median_reprojection_error_px = 0;                     // of the frames' medians; 0: there is none
  double median_coverage = 0;           // of frames that were tracked (FrameReport::coverage); 0: unknown
  double median_followed_coverage = 0;  // the same with points that have no certain depth yet; 0: unknown
  int submaps = 0;                      // maps with a world of their own, one after the other
  std::int64_t points = 0;
  std::int64_t observations = 0;
  std::vector<std::pair<std::string, std::int64_t>> losses;  // points given up, by reason
  PriorCounts prior;

  double total_s = 0;
  double frames_per_second = 0;
  std::vector<std::pair<std::string, double>> mean_ms;  // a frame, by stage
  std::optional<Latency> latency;                       // nothing: not measured
};

// Writes it under another name and renames it, so that there is always a whole file. Fails with kUnwritable.
Status WriteRunSummary(const std::string& path, const RunSummary& summary);
// Fails with kNotFound, or with kUnreadable if it is not JSON or not a run's.
Result<RunSummary> ReadRunSummary(const std::string& path);

}  // namespace pliant
