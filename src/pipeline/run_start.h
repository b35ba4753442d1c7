// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a run starts from besides its images.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pipeline/choose_working_image.h"
#include "pipeline/model_start.h"
#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/image/working_image.h"
#include "pliant/pipeline/track.h"
#include "pliant/scene/pixel_track.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "pliant/tracking/tracks/image_statistics.h"

namespace pliant {

struct RunStart {
  WorkingImage working_image;
  ImageStatistics images;                // of the first working images
  std::optional<Camera> working_camera;  // of the working images; always there
  std::optional<ModelStart> model;
  cv::Mat cloud_depth_mm;  // of the first frame; empty: there is no cloud
  int first_frame_idx = 0;
  std::vector<PixelTrack> tracks;  // of another program; empty: there are none
  // What is odd about the tracks or the cloud, and what the first frames themselves say against the pairs or the depth
  // that the map is to come from.
  std::vector<std::string> warnings;
};

// Fails where the sequence has not what Init.method asks for, and as the readers of tracks, models and clouds do, and
// where a camera cannot be resized; with kInterrupted where `watch` is stopped.
Result<RunStart> ReadStart(const RunRequest& request, const TrackOptions& options, const Sequence& sequence,
                           const ImageWatch& watch);

}  // namespace pliant
