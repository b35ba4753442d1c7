// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run as far as it has come, frame by frame, for those who have seen a part of it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pliant/camera/camera.h"
#include "pliant/tracking/frame_report.h"
#include "pliant/viewer/view.h"

namespace pliant {

class LiveRun {
 public:
  explicit LiveRun(std::string name) { run_.name = std::move(name); }

  void SetCamera(const Camera& camera) { run_.camera = camera; }
  // The next frame's final report. A join takes the frames of its map, up to this one, into the other one's world.
  void Add(const FrameReport& report);

  int rows() const { return static_cast<int>(run_.frames.size()); }
  // Changes where what was given before is void.
  int epoch() const { return epoch_; }
  // The frames from a row on, with the points that they see and those that became better known in them.
  ViewedRun From(int row) const;

 private:
  ViewedRun run_;
  std::map<PointId, int> refined_in_;  // the last row that did
  int epoch_ = 0;
};

}  // namespace pliant
