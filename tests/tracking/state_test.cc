// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/state.h"

#include <map>

#include <gtest/gtest.h>

namespace pliant {
namespace {

// The whole transition table: what is not listed keeps the state.
TEST(TrackingStates, FollowTheTable) {
  using S = TrackingState;
  using E = TrackingEvent;
  const std::map<std::pair<S, E>, S> moves = {
      {{S::kWaitingForReference, E::kReferenceFound}, S::kInitializing},
      {{S::kWaitingForReference, E::kMapCreated}, S::kTracking},
      {{S::kInitializing, E::kMapCreated}, S::kTracking},
      {{S::kInitializing, E::kReferenceSpent}, S::kWaitingForReference},
      {{S::kTracking, E::kTooFewPoints}, S::kLost},
      {{S::kLost, E::kFrameTracked}, S::kTracking},
      {{S::kLost, E::kMapLeft}, S::kWaitingForReference},
      {{S::kWaitingForReference, E::kMapFoundAgain}, S::kLost},
      {{S::kInitializing, E::kMapFoundAgain}, S::kLost},
  };
  for (const auto& [state, state_name] : EnumNames<S>::kNames) {
    for (const auto& [event, event_name] : EnumNames<E>::kNames) {
      const auto move = moves.find({state, event});
      EXPECT_EQ(NextState(state, event), move == moves.end() ? state : move->second) << state_name << " " << event_name;
    }
  }
}

}  // namespace
}  // namespace pliant
