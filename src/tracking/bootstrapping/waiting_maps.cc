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

void PutAside(MadeMap made, std::optional<MadeMap>* best) {
  if (!*best || !IsBetter((*best)->map.outcome, made.map.outcome)) *best = std::move(made);
}

void Doubt(bool camera_may_stand_still, std::optional<MadeMap>* of_reference) {
  const bool is_uncertain = *of_reference && (*of_reference)->map.outcome.measured.DepthSignal() < kMinDepthSignal;
  if (is_uncertain || camera_may_stand_still) of_reference->reset();
}

void DoubtRigidity(std::optional<MadeMap>* of_reference) {
  if (*of_reference && !AllowsDeformation((*of_reference)->map.outcome)) of_reference->reset();
}

void WeakMap::CountFrame() {
  if (weak_) ++frames_;
}

bool WeakMap::HasBetterThan(const InitOutcome& map, const std::optional<MadeMap>& of_reference) const {
  return (of_reference && IsBetter(of_reference->map.outcome, map)) || (weak_ && IsBetter(weak_->map.outcome, map));
}

std::optional<MadeMap> WeakMap::GiveUpReference(std::optional<MadeMap> of_reference, int reference_frames,
                                                int max_frames) {
  if (!weak_) frames_ = reference_frames;
  std::optional<MadeMap> best = EndWait(std::move(of_reference));
  if (best && IsWeak(best->map.outcome) && frames_ < max_frames) weak_ = std::exchange(best, std::nullopt);
  return best;
}

std::optional<MadeMap> WeakMap::EndWait(std::optional<MadeMap> of_reference) {
  auto weak = std::exchange(weak_, std::nullopt);
  if (weak && (!of_reference || IsBetter(weak->map.outcome, of_reference->map.outcome))) return weak;
  return of_reference;
}

void WeakMap::Doubt() {
  if (weak_ && weak_->map.outcome.measured.LinearDepthSignal() < kMinProvisionalSignal) weak_.reset();
}

std::optional<int> WeakMap::Since() const {
  return weak_ ? std::optional(weak_->map.frames.front().frame_idx) : std::nullopt;
}

void MadeMap::Serialize(StateArchive& archive) { archive.Members<2>(*this); }
void WeakMap::Serialize(StateArchive& archive) { archive(weak_, frames_); }

}  // namespace pliant
