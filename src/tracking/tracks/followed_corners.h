// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The corners of an image, tracked as far as they go: what measurements on recordings are made from.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/tracking/prepared_frame.h"
#include "pliant/tracking/tracker_options.h"

namespace pliant {

// One track a corner of the first frame that can be tracked at all, each predicted at constant velocity: its pixels in
// the frames from the first to the last one in which it was found. The result does not depend on `threads`.
std::vector<std::vector<Eigen::Vector2d>> FollowCorners(std::span<const PreparedFrame> frames,
                                                        const TrackerOptions& options, int threads);

}  // namespace pliant
