// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run as far as it has come, frame by frame, for those who have seen a part of it.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pliant/camera/camera.h"
#include "pliant/scene/frame_report.h"
#include "pliant/viewer/view.h"

namespace pliant {

class LiveRun {
 public:
  explicit LiveRun(std::string name) { run_.name = std::move(name); }

  void SetCamera(const Camera& camera) { run_.camera = camera; }
  // The next frame's final report. A merge moves its submap's frames, up to this one,
  // into the other submap's world.
  void Add(const FrameReport& report);

  int rows() const { return static_cast<int>(frames_.size()); }
  // Changes where what was given before is void.
  int epoch() const { return epoch_; }
  // The frames from a row on: what is quick to take, and then the run that they make, with the points that they see and
  // those that became better known in them.
  struct Part {
    ViewedRun run;  // without frames, with all points
    std::vector<std::shared_ptr<const ViewedFrame>> frames;
    std::set<PointId> refined;

    ViewedRun ToRun() &&;
  };
  Part From(int row) const;

 private:
  ViewedRun run_;  // without frames
  std::vector<std::shared_ptr<const ViewedFrame>> frames_;
  std::map<PointId, int> refined_in_;  // the last row that did
  int epoch_ = 0;
};

}  // namespace pliant
