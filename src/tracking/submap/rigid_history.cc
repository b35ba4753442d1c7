// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/rigid_history.h"

#include <cmath>
#include <utility>

#include "tracking/serialize.h"

namespace pliant {
namespace {

constexpr std::size_t kMaxFrames = 64;  // even: of one more the last stays where every other one is left out
constexpr double kGrowth = 1.15;        // of the frames since the reference, from one attempt to the next

int NextAttempt(int seen) { return static_cast<int>(std::ceil(kGrowth * seen)); }

}  // namespace

void RigidHistory::Start(std::vector<InitFrame> frames) {
  frames_ = std::move(frames);
  every_ = 1;
  seen_ = static_cast<int>(frames_.size());
  next_attempt_ = NextAttempt(seen_);
  while (frames_.size() > kMaxFrames) Thin();
}

bool RigidHistory::Add(InitFrame frame) {
  if (empty() || seen_++ % every_ != 0) return false;
  frames_.push_back(std::move(frame));
  if (frames_.size() > kMaxFrames) Thin();
  if (seen_ < next_attempt_) return false;
  next_attempt_ = NextAttempt(seen_);
  return true;
}

void RigidHistory::Stop() { frames_.clear(); }

// The first stays, and the last of an odd number.
void RigidHistory::Thin() {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < frames_.size(); k += 2) {
    if (kept != k) frames_[kept] = std::move(frames_[k]);
    ++kept;
  }
  frames_.resize(kept);
  every_ *= 2;
}

void RigidHistory::Serialize(StateArchive& archive) { archive(frames_, every_, seen_, next_attempt_); }

}  // namespace pliant
