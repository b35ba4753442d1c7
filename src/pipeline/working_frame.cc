// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/working_frame.h"

#include <algorithm>
#include <cmath>

#include "pliant/photometric/patch.h"

namespace pliant {

PreparedFrame PrepareWorkingFrame(const SequenceFrame& frame, const WorkingImage& working,
                                  const TrackerOptions& options) {
  PreparedFrame prepared = PrepareFrame(frame.frame_idx, frame.name, frame.timestamp_s, working.Image(frame.image),
                                        working.Nearest(frame.mask), options);
  prepared.depth_prior = frame.depth_prior;
  return prepared;
}

TrackerOptions WorkingOptions(TrackerOptions options, const WorkingImage& working) {
  int& size = options.point_tracker.lucas_kanade.patch_size;
  size = std::min(static_cast<int>(std::lround(working.patch_scale * size)) | 1, kMaxPatchSize);
  return options;
}

FrameReport InSourcePixels(FrameReport report, const WorkingImage& working) {
  if (working.scale == 1) return report;
  for (PointObservation& seen : report.observations) seen.pixel = working.ToSource(seen.pixel);
  report.median_reprojection_error_px /= working.scale;
  if (report.first_map) report.first_map->evidence.median_error_px /= working.scale;
  return report;
}

}  // namespace pliant
