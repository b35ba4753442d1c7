// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Between the images of the source and those in which the tracker works: the tracker sees working images and a working
// camera alone, and what it reports is in pixels of the source again.
#pragma once

#include "pliant/datasets/sequence.h"
#include "pliant/image/working_image.h"
#include "pliant/scene/frame_report.h"
#include "pliant/tracking/prepared_frame.h"
#include "pliant/tracking/tracker_options.h"

namespace pliant {

PreparedFrame PrepareWorkingFrame(const SequenceFrame& frame, const WorkingImage& working,
                                  const TrackerOptions& options);

// The tracker's options for these images, with the patches that they take: odd, as a patch is, and at most the largest.
TrackerOptions WorkingOptions(TrackerOptions options, const WorkingImage& working);

// The tracker's report with pixels and pixel errors of the source.
FrameReport InSourcePixels(FrameReport report, const WorkingImage& working);

}  // namespace pliant
