// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// While nothing contradicts that the scene is rigid, every frame since the reference tells of the same points, and the
// map is made again of all of them whenever they have become more by a share (docs/method.md, eq. W13).
#pragma once

#include <cstddef>
#include <vector>

#include "pliant/tracking/bootstrapping/initializer.h"

namespace pliant {

class StateArchive;

// The frames of which the map can be made again. When they get too many every other one is left out, of those there are
// and of those that follow.
class RigidHistory {
 public:
  // `frames` are those of which the map was made, the reference first.
  void Start(std::vector<InitFrame> frames);
  // One that follows. Whether the map should now be made again of frames(), of which this is the last; never after
  // Stop.
  bool Add(InitFrame frame);
  void Stop();

  bool empty() const { return frames_.empty(); }
  const std::vector<InitFrame>& frames() const { return frames_; }

  void Serialize(StateArchive& archive);

 private:
  void Thin();

  std::vector<InitFrame> frames_;
  int every_ = 1;         // frame is taken
  int seen_ = 0;          // frames since the reference
  int next_attempt_ = 0;  // due when so many are seen
};

}  // namespace pliant
