// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the evaluation takes of a run: Pliant's own, from its folder or straight from the tracker's frame reports, or
// another system's, which consists of a TUM trajectory and observations.csv (docs/formats.md). Another system's poses
// are given to the sequence's frames by time: the nearest frame, if it is near enough.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/datasets/sequence.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

// One frame of a run. Points and poses in map units, world frame.
struct EvaluationFrame {
  int frame_idx = 0;  // the sequence's own number
  double timestamp_s = 0;
  std::optional<Rigid3> cam_from_world;        // nothing: not tracked
  std::vector<PointObservation> observations;  // sorted by id
  std::optional<FirstMapFrames> first_map;     // where pose and points came with the first map, and the run says so
  bool makes_map_alone = false;  // a map was made of this frame and no other: perhaps of its pair or depth image
  double initialize_ms = 0;      // wall time that the initializer took; 0 where the run does not say
  int submap = 0;                // whose world and unit pose and points are in
};

struct EvaluationInput {
  std::string name;                     // for messages: the run's folder
  std::vector<EvaluationFrame> frames;  // every frame read, in order
  std::optional<Camera> camera;         // where the folder has one (sparse/cameras)
  std::optional<double> seconds;        // that the run took, where it says so (run.json)
  std::vector<std::string> notes;       // what was left out in reading, one sentence each
  bool metric = false;                  // a map unit is a millimeter, as the run says (run.json)
};

// Whether the camera that a run's folder names must be the sequence's.
enum class CameraAgreement {
  kSame,  // to a hundredth of a pixel all over the image
  kAny,   // a run on a calibration made wrong on purpose; the image size must agree all the same
};

template <>
struct EnumNames<CameraAgreement> {
  static constexpr std::array kNames = {std::pair{CameraAgreement::kSame, std::string_view("same")},
                                        std::pair{CameraAgreement::kAny, std::string_view("any")}};
};

struct MatchingOptions {
  double max_time_difference_s = 0.01;  // of another system's pose and its frame
  CameraAgreement camera = CameraAgreement::kSame;

  void List(OptionTable& table);
};

// Takes over what the evaluation needs of a frame report.
EvaluationFrame FrameFromReport(const FrameReport& report);

// Reads a run folder. Of another system's result (no frames.csv) the frames read are those with a pose or points; a
// pose that is near no frame, and points in a frame without a pose, are left out and noted. Rows of a killed run's
// last, unfinished frame are left out. Errors as io's ReadRun, kMismatch as MatchPoses (pliant/datasets/match_poses.h),
// and where there are as many poses as frames with points, and many of these have no pose.
Result<EvaluationInput> ReadEvaluationInput(const std::string& run_path, const Sequence& sequence,
                                            const MatchingOptions& options);

// The same of Pliant's own run, without its sequence. Fails with kNotFound where the folder is another system's result,
// whose poses only the sequence's times can give to frames.
Result<EvaluationInput> ReadEvaluationInput(const std::string& run_path);

// Whether run and sequence belong together: every frame of the run is in the sequence, at the same time, and the camera
// is the same. Fails with kMismatch; the sentence says what does not fit.
Status CheckBelongsTo(const EvaluationInput& run, const Sequence& sequence, const MatchingOptions& options);

}  // namespace pliant
