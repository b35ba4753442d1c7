// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/state.h"

namespace pliant {

TrackingState NextState(TrackingState state, TrackingEvent event) {
  switch (state) {
    case TrackingState::kWaitingForReference:
      if (event == TrackingEvent::kReferenceFound) return TrackingState::kInitializing;
      if (event == TrackingEvent::kMapCreated) return TrackingState::kTracking;
      if (event == TrackingEvent::kMapFoundAgain) return TrackingState::kLost;
      return state;
    case TrackingState::kAmbiguous:  // no states of the tracker: said of frames in their reports
    case TrackingState::kProvisional:
      return state;
    case TrackingState::kInitializing:
      if (event == TrackingEvent::kMapCreated) return TrackingState::kTracking;
      if (event == TrackingEvent::kReferenceSpent) return TrackingState::kWaitingForReference;
      if (event == TrackingEvent::kMapFoundAgain) return TrackingState::kLost;
      return state;
    case TrackingState::kTracking:
      return event == TrackingEvent::kTooFewPoints ? TrackingState::kLost : state;
    case TrackingState::kLost:
      if (event == TrackingEvent::kFrameTracked) return TrackingState::kTracking;
      if (event == TrackingEvent::kMapLeft) return TrackingState::kWaitingForReference;
      return state;
  }
  return state;
}

}  // namespace pliant
