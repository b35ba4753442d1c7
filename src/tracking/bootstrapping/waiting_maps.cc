// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/waiting_maps.h"

#include <utility>

#include "tracking/serialize.h"

namespace pliant {
namespace {

bool AllowsDeformation(const InitOutcome& map) { return map.deforming || map.allows_deformation; }

// (W19) A rigid window's whose halves agree, and stands out.
bool IsCheckedByHalves(const InitOutcome& map) {
  return map.allows_deformation && map.measured.DepthSignal() >= kMinProvisionalSignal;
}

// Its sigmas, which are linear, may be too small by far.
bool IsLinear(const InitOutcome& map) { return map.deforming && map.measured.DepthSignal() < kMinDepthSignal; }

bool AreOfOneReference(const InitOutcome& first, const InitOutcome& second) {
  return !first.frames.empty() && !second.frames.empty() &&
         first.frames.front().frame_idx == second.frames.front().frame_idx;
}

// Of two provisional maps, the second one made later. Sigmas of a rigid window may know nothing of a
// deformation: where a longer one deforms they do not count, but where they are of its halves, they count more than
// linear ones. Those by own distances are not compared with others. A longer window of the same reference knows all
// that the other one does, and a part of its frames that contradicts it (W21) may be what is wrong: it has to be less
// certain by its own sigmas, too.
bool IsBetter(const InitOutcome& first, const InitOutcome& second) {
  if (first.far_by_own_distance != second.far_by_own_distance) return second.far_by_own_distance;
  if (IsCheckedByHalves(first) && IsLinear(second)) return true;
  if (IsLinear(first) && IsCheckedByHalves(second)) return false;
  if (!AllowsDeformation(first) && AllowsDeformation(second)) return false;
  if (first.measured.DepthSignal() < second.measured.DepthSignal()) return false;
  return !AreOfOneReference(first, second) || first.measured.LinearDepthSignal() >= second.measured.LinearDepthSignal();
}

}  // namespace

bool IsWeak(const InitOutcome& map) {
  return map.provisional && AllowsDeformation(map) && map.measured.DepthSignal() < kMinProvisionalSignal &&
         map.measured.LinearDepthSignal() < kMinDepthSignal;
}

void WaitingMaps::CountFrame() {
  if (weak_) ++weak_frames_;
}

void WaitingMaps::Put(MadeMap made) {
  if (!of_reference_ || !IsBetter(of_reference_->map.outcome, made.map.outcome)) of_reference_ = std::move(made);
}

bool WaitingMaps::HasBetterThan(const InitOutcome& map) const {
  return (of_reference_ && IsBetter(of_reference_->map.outcome, map)) || (weak_ && IsBetter(weak_->map.outcome, map));
}

std::optional<MadeMap> WaitingMaps::GiveUpReference(int reference_frames, int max_frames) {
  if (!weak_) weak_frames_ = reference_frames;
  EndWait();
  const bool waits = of_reference_ && IsWeak(of_reference_->map.outcome) && weak_frames_ < max_frames;
  if (waits) weak_ = std::exchange(of_reference_, std::nullopt);
  return Take();
}

void WaitingMaps::EndWait() {
  auto weak = std::exchange(weak_, std::nullopt);
  if (weak && (!of_reference_ || IsBetter(weak->map.outcome, of_reference_->map.outcome)))
    of_reference_ = std::move(weak);
}

std::optional<MadeMap> WaitingMaps::Take() { return std::exchange(of_reference_, std::nullopt); }

void WaitingMaps::Doubt(bool camera_may_stand_still) {
  const bool is_uncertain = of_reference_ && of_reference_->map.outcome.measured.DepthSignal() < kMinDepthSignal;
  if (is_uncertain || camera_may_stand_still) of_reference_.reset();
  if (weak_ && weak_->map.outcome.measured.LinearDepthSignal() < kMinProvisionalSignal) weak_.reset();
}

void WaitingMaps::DropReference() { of_reference_.reset(); }

void WaitingMaps::DropAll() {
  of_reference_.reset();
  weak_.reset();
}

std::optional<int> WaitingMaps::WeakSince() const {
  return weak_ ? std::optional(weak_->map.frames.front().frame_idx) : std::nullopt;
}

void MadeMap::Serialize(StateArchive& archive) { archive.Members<2>(*this); }
void WaitingMaps::Serialize(StateArchive& archive) { archive(of_reference_, weak_, weak_frames_); }

}  // namespace pliant
