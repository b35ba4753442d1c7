// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Frames without a map: those before a first map, which had no reference or one that was given up, and those in which
// the map was lost. When there is one again they are read once more and tracked back in time, from the reference frame
// of the first map or from the frame in which the lost one was found, so that they too have poses and points.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "pliant/camera/camera.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/image/working_image.h"
#include "pliant/pipeline/track.h"
#include "pliant/scene/frame_report.h"
#include "pliant/tracking/tracker.h"

namespace pliant {

class StateArchive;

class FramesBefore {
 public:
  // `camera` is that of the working images; `tracker`, whose reports come, has to outlive this: the points that are new
  // in frames tracked back get ids that it does not use. `inputs` are the tracker's, of which the oracles are not used.
  FramesBefore(const SequenceRequest& input, const WorkingImage& working, const Camera& camera,
               const TrackOptions& options, const TrackerInputs& inputs, Tracker* tracker);

  // Takes the tracker's final reports, in order of time, and answers with those that are to be written, in order of
  // time: the ones that may still get a pose wait here, at most `General.max_frames_back` of them.
  std::vector<FrameReport> Pass(std::vector<FrameReport> reports);
  // Those that wait, as they are: no map comes any more.
  std::vector<FrameReport> Finish();

  void Serialize(StateArchive& archive);

 private:
  std::vector<PreparedFrame> Read(int first, int last, std::size_t count) const;
  void TrackBack(const FrameReport& last);
  void FollowBack(Tracker* tracker, const std::string& note);
  void MoveNewPoints(FrameReport* last);

  SequenceRequest input_;
  WorkingImage working_;
  Camera camera_;
  TrackOptions options_;
  TrackerInputs inputs_;
  Tracker* tracker_;
  std::vector<FrameReport> waiting_;
  std::map<int, FirstMapEvidence> evidence_;  // by submap
};

}  // namespace pliant
