// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/rigid_history.h"

#include <cmath>
#include <utility>

#include "pliant/base/statistics.h"

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

std::optional<Rigid3> ReplaceMap(const InitOutcome& outcome, const Rigid3& cam_from_world, Map* map,
                                 std::vector<RefinedPoint>* refined) {
  const InitFrameState& now = outcome.frames.back();
  std::vector<double> ratios;
  for (const Landmark& landmark : map->landmarks)
    if (const InitPosition* point = FindById(now.positions, landmark.id); point != nullptr)
      ratios.push_back((cam_from_world * landmark.position).norm() / (now.cam_from_world * point->position).norm());
  if (ratios.empty()) return std::nullopt;
  const double scale = Median(std::move(ratios));
  const Rigid3 now_from_world(now.cam_from_world.rotation, scale * now.cam_from_world.translation);
  const Rigid3 now_from_before = now_from_world.Inverse() * cam_from_world;
  for (Landmark& landmark : map->landmarks) {
    const InitPosition* point = FindById(now.positions, landmark.id);
    const Eigen::Vector3d position = point != nullptr ? scale * point->position : now_from_before * landmark.position;
    landmark.rest_position = point != nullptr ? position : landmark.rest_position + position - landmark.position;
    landmark.position = position;
    landmark.last_motion.setZero();
    refined->push_back({landmark.id, landmark.rest_position});
  }
  return now_from_world;
}

}  // namespace pliant
