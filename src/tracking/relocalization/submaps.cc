// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/relocalization/submaps.h"

#include <algorithm>
#include <utility>

#include "pliant/base/state_archive.h"
#include "tracking/relocalization/submap_merging.h"

namespace pliant {

Submaps::Submaps(const Camera& camera, const TrackerOptions& options, TrackSource* tracks)
    : camera_(camera), options_(options), tracks_(tracks), current_(std::make_unique<Submap>(0, camera, options)) {}

void Submaps::LeaveCurrent() {
  current_->lost_frames = 0;
  current_->blurred_frames = 0;
  inactive_.push_back(std::exchange(current_, std::make_unique<Submap>(maps_made_, camera_, options_)));
  if (static_cast<int>(inactive_.size()) <= options_.relocalization.max_inactive_submaps) return;
  inactive_.front()->RemoveFrom(tracks_);
  inactive_.erase(inactive_.begin());
}

bool Submaps::FindAgain(const PreparedFrame& frame, Former former, Relocalizer* relocalizer) {
  for (std::size_t k = inactive_.size(); k-- > 0;) {
    if (relocalizer->Relocalize(frame, inactive_[k].get()).size() == 0) continue;
    std::swap(current_, inactive_[k]);
    if (former == Former::kDropped) {
      inactive_[k]->RemoveFrom(tracks_);
      inactive_.erase(inactive_.begin() + static_cast<std::ptrdiff_t>(k));
    } else {
      inactive_[k]->lost_frames = 0;
    }
    return true;
  }
  return false;
}

// The points of an inactive submap are found in the image like lost ones.
bool Submaps::CanMerge() const {
  return options_.relocalization.merge == Switch::kOn && options_.relocalization.relocalize == Switch::kOn &&
         options_.find_lost == Switch::kOn && options_.point_tracker.patch_policy == PatchPolicy::kAdaptive &&
         !options_.oracle.Any();
}

std::optional<Submaps::FoundMerge> Submaps::FindMerge(const PreparedFrame& frame, Relocalizer* relocalizer) {
  const int every = options_.relocalization.merge_every;
  if (!CanMerge() || inactive_.empty() || frame.step % every != 0 || current_->blurred_frames > 0) return std::nullopt;
  FoundMerge merge{.inactive = static_cast<std::size_t>(frame.step / every) % inactive_.size()};
  Submap& inactive = *inactive_[merge.inactive];
  const FollowedPoints found = relocalizer->Relocalize(frame, &inactive);
  if (found.size() == 0 || found.in_blur) return std::nullopt;
  const auto inactive_from_current =
      InactiveFromCurrent(found, *current_, camera_.width(), options_.relocalization.max_unit_spread);
  if (!inactive_from_current) return std::nullopt;
  const bool inactive_is_older = inactive.idx < current_->idx;
  merge.merge = {std::max(inactive.idx, current_->idx), std::min(inactive.idx, current_->idx),
                 inactive_is_older ? *inactive_from_current : inactive_from_current->Inverse()};
  return merge;
}

void Submaps::Apply(const FoundMerge& found) {
  Submap& inactive = *inactive_[found.inactive];
  Submap& younger = inactive.idx == found.merge.submap ? inactive : *current_;
  younger.MoveInto(found.merge.into_from_submap);
  current_->idx = found.merge.into;
  current_->TakeOver(std::move(inactive), tracks_);
  inactive_.erase(inactive_.begin() + static_cast<std::ptrdiff_t>(found.inactive));
}

void Submaps::Serialize(StateArchive& archive) {
  archive(*current_, maps_made_);
  inactive_.resize(archive.Size(inactive_.size()));
  for (std::unique_ptr<Submap>& submap : inactive_) {
    if (archive.reads()) submap = std::make_unique<Submap>(0, camera_, options_);
    archive(*submap);
  }
}

}  // namespace pliant
