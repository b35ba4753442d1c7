// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The submaps of a run: the current one, which is tracked, lost or awaited, and the inactive ones, which were left and
// can be found again or merged.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "tracking/relocalization/relocalizer.h"
#include "tracking/submap/submap.h"

namespace pliant {

class Submaps {
 public:
  // `tracks` must outlive this.
  Submaps(const Camera& camera, const TrackerOptions& options, TrackSource* tracks);

  Submap& current() { return *current_; }
  const Submap& current() const { return *current_; }
  bool HasInactive() const { return !inactive_.empty(); }

  // The current submap has a map now.
  void CountMap() { ++maps_made_; }
  // The current submap becomes inactive, and an empty one with a world, unit and points of its own takes its place. Of
  // too many inactive ones the oldest is forgotten.
  void LeaveCurrent();

  enum class Former { kDropped, kInactive };
  // Searches the inactive submaps in this image, the last one first. The one that is found becomes the current one;
  // what was current is dropped or becomes inactive. False: none was found, and nothing changes.
  bool FindAgain(const PreparedFrame& frame, Former former, Relocalizer* relocalizer);

  // An inactive submap that this image shows while the current one is tracked in it. One is searched at a time, in
  // turn.
  struct FoundMerge {
    std::size_t inactive = 0;  // index of it
    SubmapMerge merge = {};
  };
  std::optional<FoundMerge> FindMerge(const PreparedFrame& frame, Relocalizer* relocalizer);
  // The two become the current one. The older one's world stays.
  void Apply(const FoundMerge& found);

  void Serialize(StateArchive& archive);

 private:
  bool CanMerge() const;

  Camera camera_;
  TrackerOptions options_;
  TrackSource* tracks_;
  std::unique_ptr<Submap> current_;
  std::vector<std::unique_ptr<Submap>> inactive_;  // the last one left last
  int maps_made_ = 0;
};

}  // namespace pliant
