// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Parts of the tracker that the calling program gives in place of ours, or adds to them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pliant/estimation/frame/frame_cost.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/tracks/track_source.h"

namespace pliant {

struct TrackerExtensions {
  // Asked for first maps in place of the one that Init.method names; null: that one. Asked from one thread.
  std::shared_ptr<const Initializer> initializer = nullptr;
  // Makes what follows the points in place of our own tracker; empty: that one. A run needs several: those that frames
  // are tracked back by in time have one of their own. Asked from one thread.
  std::function<std::unique_ptr<TrackSource>()> make_tracks = {};

  // Adds a term to the joint problem of every frame; null: none. Asked from one thread.
  std::shared_ptr<const FrameCost> cost = nullptr;

  // What is given, for run.json: "initializer NAME", "tracks", "cost NAME".
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    if (initializer) names.push_back("initializer " + std::string(initializer->name()));
    if (make_tracks) names.emplace_back("tracks");
    if (cost) names.push_back("cost " + std::string(cost->name()));
    return names;
  }
};

}  // namespace pliant
