// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// ImageStatistics of a sequence on disk, in the working image that the tracker would track it in.
#pragma once

#include <opencv2/core/types.hpp>

#include "pliant/base/job_progress.h"
#include "pliant/base/status.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/image/working_image.h"
#include "pliant/pipeline/track.h"
#include "pliant/tracking/tracks/image_statistics.h"

namespace pliant {

struct SequenceStatistics {
  WorkingImage working_image;  // measured, or fixed by options.image
  cv::Size size;               // of the working image, px; noise and track noise are those of its pixels
  ImageStatistics images;
};

// Reads runs of kStatisticsRunFrames frames, at most 30 of them, evenly spread over the sequence. Fails as the readers
// do, with kInsufficient where the sequence has no whole run, and with kInterrupted by `progress`, whose task is
// "statistics". The result does not depend on options.threads.
Result<SequenceStatistics> MeasureSequenceStatistics(const SequenceRequest& request, const TrackOptions& options,
                                                     const JobProgress& progress = {});

}  // namespace pliant
