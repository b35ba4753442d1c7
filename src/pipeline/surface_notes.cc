// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/surface_notes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <set>
#include <span>
#include <string_view>

#include "pliant/base/text.h"
#include "pliant/datasets/native_layout.h"

namespace pliant {
namespace {

constexpr const char* kNotTracked = "it was not tracked";
constexpr const char* kNotInRun = "the run has no such frame";

// Pixels without a depth that have one cause, and what to say of them.
struct CauseOfHoles {
  int pixels = 0;
  std::string what;
  std::string advice;
};

std::array<CauseOfHoles, 6> CausesOf(const RejectedPixels& rejected, const DenseDepthOptions& options) {
  const auto pixels = [&](DepthRejection why) { return rejected[static_cast<std::size_t>(why)]; };
  return {{{pixels(DepthRejection::kLittleParallax) + pixels(DepthRejection::kUncertain),
            "the other images show too little parallax for a depth with a sigma of " + Percent(options.max_sigma, 1),
            "take frames farther away (raise Surface.max_frames_apart, lower Surface.min_common_points), or raise "
            "Surface.max_sigma"},
           {pixels(DepthRejection::kUnseen) + pixels(DepthRejection::kNoMinimum),
            "pixels have no texture, or no other image shows them", "raise Surface.window or Surface.neighbors"},
           {pixels(DepthRejection::kDisagreement), "the two halves of the other images tell different depths",
            "refine the run, or raise Surface.max_disagreement"},
           {pixels(DepthRejection::kUnlike), "the images differ at all depths",
            "refine the run, or lower Surface.min_correlation"},
           {pixels(DepthRejection::kOutermost), "depths are farther from those of the points than what is tried",
            "refine the run, or track more points"},
           {pixels(DepthRejection::kNearContour) + pixels(DepthRejection::kSpeckle),
            "depths jump between neighboring pixels", "raise Surface.window"}}};
}

std::string FramesOf(const Run& run) {
  const auto [first, last] = std::ranges::minmax(run.frames, {}, &RunFrame::frame_idx);
  return std::to_string(first.frame_idx) + " to " + std::to_string(last.frame_idx);
}

// "frame 70", "frames 70, 71, 72 and 12 more".
std::string FrameNumbers(const std::vector<SurfaceFrame>& frames) {
  constexpr std::size_t kMostNamed = 10;
  const std::span named(frames.data(), std::min(frames.size(), kMostNamed));
  std::string text = frames.size() == 1 ? "frame " : "frames ";
  text += CommaSeparated(named, [](const SurfaceFrame& frame) { return std::to_string(frame.frame_idx); });
  if (frames.size() > kMostNamed) text += " and " + std::to_string(frames.size() - kMostNamed) + " more";
  return text;
}

}  // namespace

std::string NoteWithoutNeighbors(const SurfaceRunOptions& options) {
  return "no other frame has " + Percent(options.min_common_points) +
         " of its points, seen from elsewhere by at most " + Digits(options.max_parallax_deg, 0) +
         " deg; track more frames, or raise Surface.max_parallax_deg or lower Surface.min_common_points";
}

std::string NoteWithoutDepth(const RejectedPixels& rejected, const DenseDepthOptions& options) {
  const auto causes = CausesOf(rejected, options);
  const CauseOfHoles& largest = *std::ranges::max_element(causes, {}, &CauseOfHoles::pixels);
  if (largest.pixels == 0)
    return "masks, highlights and the dark border leave no pixel of it; check the masks and the options of group Masks";
  const int all = std::accumulate(causes.begin(), causes.end(), 0,
                                  [](int sum, const CauseOfHoles& cause) { return sum + cause.pixels; });
  return largest.what + " (" + Percent(static_cast<double>(largest.pixels) / all) + " of the usable pixels); " +
         largest.advice;
}

std::vector<SurfaceFrame> FramesWithoutPose(const SurfaceRequest& request, const Run& run,
                                            const std::vector<PosedFrame>& posed) {
  std::set<int> tracked;
  std::set<int> read;
  for (const PosedFrame& frame : posed) tracked.insert(frame.frame_idx);
  for (const RunFrame& frame : run.frames) read.insert(frame.frame_idx);
  std::vector<SurfaceFrame> missing;
  for (const int frame_idx : std::set<int>(request.frames.begin(), request.frames.end())) {
    if (tracked.contains(frame_idx)) continue;
    const bool was_read = read.empty() || read.contains(frame_idx);
    missing.push_back(
        {.frame_idx = frame_idx, .name = native::FrameFileName(frame_idx), .note = was_read ? kNotTracked : kNotInRun});
  }
  return missing;
}

std::vector<std::string> WarningsOf(const std::vector<SurfaceFrame>& missing, const Run& run) {
  std::vector<std::string> warnings;
  for (const std::string_view note : {kNotInRun, kNotTracked}) {
    std::vector<SurfaceFrame> frames;
    std::ranges::copy_if(missing, std::back_inserter(frames), [&](const auto& frame) { return frame.note == note; });
    if (frames.empty()) continue;
    const std::string left_out = " and " + std::string(frames.size() == 1 ? "is" : "are") + " left out";
    warnings.push_back(note == kNotInRun ? FrameNumbers(frames) + (frames.size() == 1 ? " is" : " are") +
                                               " not in the run, whose frames are " + FramesOf(run) + "," + left_out
                                         : FrameNumbers(frames) + (frames.size() == 1 ? " was" : " were") +
                                               " not tracked" + left_out);
  }
  return warnings;
}

Status NoFrameChosen(const SurfaceRequest& request, const Run& run, const std::vector<SurfaceFrame>& missing) {
  if (!missing.empty() &&
      std::ranges::all_of(missing, [](const SurfaceFrame& frame) { return frame.note == kNotInRun; }))
    return {ErrorCode::kInvalidArgument, "the run " + Quoted(request.run_path) + " has none of the chosen frames (" +
                                             FrameNumbers(missing) + "); its frames are " + FramesOf(run)};
  return {ErrorCode::kInsufficient, "none of the chosen frames was tracked in " + Quoted(request.run_path)};
}

std::string ReasonOf(const std::vector<SurfaceFrame>& frames) {
  for (const SurfaceFrame& frame : frames)
    if (!frame.note.empty() && frame.note != kNotTracked && frame.note != kNotInRun) return frame.note;
  return "it was stopped before one was found";
}

std::string ProvisionalWarning(const std::vector<SurfaceFrame>& frames) {
  const auto provisional = std::ranges::count_if(frames, &SurfaceFrame::provisional);
  if (provisional == 0) return {};
  return std::to_string(provisional) + " of " + std::to_string(frames.size()) +
         " frames are of a provisional map, whose depths are less certain than demanded: so is what the surface has "
         "from it (poses, and the motion through which images are compared)";
}

std::string StillWarning(const std::vector<PosedFrame>& frames, const std::vector<std::size_t>& chosen,
                         const RunMap& run) {
  constexpr double kStill = 1e-4;  // by the distance from the camera
  const auto is_still = [&](std::size_t k) {
    const PosedFrame& frame = frames[k];
    return std::ranges::none_of(frame.observations, [&](const PointObservation& seen) {
      const auto point = run.points.find(seen.id);
      const double distance = (frame.cam_from_world * seen.position).norm();
      return point != run.points.end() && (seen.position - point->second.position).norm() > kStill * distance;
    });
  };
  const auto still = std::ranges::count_if(chosen, is_still);
  if (still == 0) return {};
  return "the run takes the scene as rigid in " + std::to_string(still) + " of " + std::to_string(chosen.size()) +
         " frames: displacement and strain of the mesh are 0 there, whatever the tissue did";
}

std::string MeshWarning(const MadeMeshes& made, const SurfaceRunOptions& options) {
  if (options.mesh_columns == 0)
    return options.obj ? "there is no obj/ without a mesh, which Surface.mesh_columns 0 leaves out" : "";
  if (made.stopped || made.meshes == made.submaps) return {};
  const std::string where = made.submaps > 1 ? " of " + std::to_string(made.submaps - made.meshes) + " of " +
                                                   std::to_string(made.submaps) + " submaps"
                                             : "";
  return "there is no mesh" + where + ": its depths give no connected piece of enough triangles; raise " +
         "Surface.mesh_columns (" + std::to_string(options.mesh_columns) + ")";
}

}  // namespace pliant
