// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/track.h"

namespace pliant {

void ImageOptions::List(OptionTable& table) {
  table.BeginGroup("Image", "the working image: the source resized and smoothed, in which points are tracked");
  table.AddChoice(
      "working", &working,
      "measured: the size and smoothing in which most points of the first images last, and larger patches where "
      "more last with them; fixed: by scale and smoothing_px");
  table.Add("scale", &scale, "-", "fixed: size of the working image divided by that of the source", 0.05, 4);
  table.Add("smoothing_px", &smoothing_px, "px",
            "fixed: standard deviation of the Gaussian that smooths the working image, in its pixels; 0: none", 0, 20);
  table.AddChoice("interlaced", &interlaced,
                  "whether the odd rows of the images are of another time than the even ones, and are not used; "
                  "measured: by the combs that motion makes in the first images, where working is measured, too");
}

void TrackOptions::List(OptionTable& table) {
  table.BeginGroup("General", "the run as a whole");
  table.Add("seed", &seed, "-", "decides every random choice; the same seed gives the same files", 0, 2147483647);
  table.Add("threads", &threads, "-",
            "1: everything on one thread; 2 and more: images are read ahead, points followed in parallel; never "
            "changes the result",
            1, 1024);
  table.Add("max_frames_back", &max_frames_back, "frames",
            "frames without a map that are tracked backwards in time, from a first map's reference or where a map is "
            "found again",
            0, 100000);
  table.Add("checkpoint_frames", &checkpoint_frames, "frames",
            "what --resume goes on with is written every Nth frame, 15 to 60 MB, and deleted at the end; 0: never", 0,
            1000000);
  table.AddChoice("timings", &timings, "none: wall times are written as 0, so that two runs are equal byte for byte");
  live_input.List(table);
  image.List(table);
  track_file.List(table);
  tracker.List(table);
}

TrackOptions MakeTrackOptions(Preset preset) {
  TrackOptions options;
  if (preset == Preset::kDefault) return options;
  options.max_frames_back = 0;
  options.image.working = WorkingImageMode::kFixed;
  options.image.interlaced = Interlacing::kOff;
  TrackerOptions& tracker = options.tracker;
  tracker.corners.contour_filter = Switch::kOff;
  tracker.masks.highlights = Switch::kOff;
  tracker.masks.border = Switch::kOff;
  tracker.point_tracker.patch_policy = PatchPolicy::kPeriodic;
  tracker.point_tracker.forward_backward = Switch::kOff;
  tracker.point_tracker.lucas_kanade.patch_size = 21;
  tracker.point_tracker.lucas_kanade.shading = Shading::kNone;
  tracker.point_tracker.lucas_kanade.similarity = SimilarityMode::kPlain;
  tracker.init.method = InitMethod::kPaper;
  tracker.neighbor_agreement = Switch::kOff;
  tracker.common_motion_share = 0;
  tracker.find_lost = Switch::kOff;
  tracker.growth.grow = Switch::kOff;
  tracker.relocalization.relocalize = Switch::kOff;
  tracker.track_blurred = Switch::kOff;
  tracker.submaps = Switch::kOff;
  return options;
}

Status CheckTrackOptions(const TrackOptions& options) {
  const InitOptions& init = options.tracker.init;
  if (init.method != InitMethod::kDepth && !init.depth.cloud_path.empty())
    return {ErrorCode::kInvalidArgument, "Init.depth_cloud is for a start from depth; give Init.method depth as well"};
  if (init.method == InitMethod::kDepthPrior && !options.tracker.depth_prior.IsGiven())
    return {ErrorCode::kInvalidArgument,
            "Init.method depth_prior starts from the depth images of another program; name their folder with "
            "--depth_prior (DepthPrior.path)"};
  if (options.track_file.IsGiven() && options.tracker.oracle.tracks == Switch::kOn)
    return {ErrorCode::kInvalidArgument,
            "a file of tracks and Oracle.tracks both say where points are; give one of them"};
  if (options.FollowsInSource() && (options.image.scale != 1.0 || options.image.interlaced == Interlacing::kOn))
    return {ErrorCode::kInvalidArgument,
            "with an Oracle option or a file of tracks points are where these have them, in pixels of the source: "
            "leave Image.scale at 1, and do not give Image.interlaced on"};
  return Status::Ok();
}

}  // namespace pliant
