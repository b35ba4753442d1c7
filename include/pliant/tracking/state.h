// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The tracker's states and what moves it from one to the next: a pure function, so that the whole of it is a table.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "pliant/scene/frame_report.h"

namespace pliant {

// What happened in a frame.
enum class TrackingEvent {
  kTooFewCorners,   // no reference: the image has too little to follow
  kReferenceFound,  // corners were placed; this image is the reference
  kMapAwaited,      // the initializer needs more (parallax, frames)
  kReferenceSpent,  // the initializer gave this reference up
  kMapCreated,      // the first map exists
  kFrameTracked,    // pose and deformation were found
  kTooFewPoints,    // too few points could be followed or explained
  kMapLeft,         // the map was not found again for so long that another one is begun
  kMapFoundAgain,   // an earlier map was
};

template <>
struct EnumNames<TrackingEvent> {
  static constexpr std::array kNames = {std::pair{TrackingEvent::kTooFewCorners, std::string_view("too_few_corners")},
                                        std::pair{TrackingEvent::kReferenceFound, std::string_view("reference_found")},
                                        std::pair{TrackingEvent::kMapAwaited, std::string_view("map_awaited")},
                                        std::pair{TrackingEvent::kReferenceSpent, std::string_view("reference_spent")},
                                        std::pair{TrackingEvent::kMapCreated, std::string_view("map_created")},
                                        std::pair{TrackingEvent::kFrameTracked, std::string_view("frame_tracked")},
                                        std::pair{TrackingEvent::kTooFewPoints, std::string_view("too_few_points")},
                                        std::pair{TrackingEvent::kMapLeft, std::string_view("map_left")},
                                        std::pair{TrackingEvent::kMapFoundAgain, std::string_view("map_found_again")}};
};

// The state after `event` in `state`. Events that cannot happen in a state leave it as it is.
//   waiting       --reference_found-->  initializing     --map_created--> tracking
//   initializing  --reference_spent-->  waiting          (or straight to tracking from waiting: a start from depth)
//   tracking      --too_few_points-->   lost             lost --frame_tracked--> tracking
//   lost          --map_left-->         waiting          waiting, initializing --map_found_again--> lost
TrackingState NextState(TrackingState state, TrackingEvent event);

}  // namespace pliant
