// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/run_refinement.h"

#include "cli/messages.h"
#include "cli/progress.h"
#include "pliant/base/text.h"

namespace pliant::cli {

namespace {

void Say(const RefinedFocalLength& focal) {
  if (focal.failure.empty())
    SayResult("focal length " + Digits(focal.estimated_px, 1) + " +- " + Digits(focal.sigma_px, 1) +
              " px, assumed were " + Digits(focal.assumed_px, 1) + " px" +
              (focal.distortion_sigma > 0
                   ? "; distortion k " + Digits(focal.distortion, 3) + " +- " + Digits(focal.distortion_sigma, 3)
                   : ""));
  else
    SayResult("focal length kept at " + Digits(focal.assumed_px, 1) + " px: " + focal.failure);
}

void Say(const SubmapRefinement& submap) {
  const std::string name = "submap " + std::to_string(submap.submap);
  if (!submap.failure.empty()) {
    SayResult(name + " is as it was, since it cannot be refined: " + submap.failure);
    return;
  }
  SayResult(name + ": " + (submap.deforming ? "deforming" : "rigid") + ", " + std::to_string(submap.frames) +
            " frames, " + std::to_string(submap.points) + " points, track noise " + Digits(submap.noise_px, 3) +
            " px, " + std::to_string(submap.wrong_observations) + " of " + std::to_string(submap.observations) +
            " observations left out");
}

}  // namespace

int RefineAndSay(const RefineRequest& request, const RefineOptions& options) {
  const Result<RefineSummary> summary = [&] {
    Progress progress("refine", 100, "%");
    return RefineRun(request, options, [&](const RefinementProgress& at) {
      progress.Update(static_cast<int>(100.0 * at.share), std::string(at.stage) + ", cost " + Digits(at.cost, 1));
    });
  }();
  if (!summary.ok()) {
    SayError(summary.status().message());
    return kExitFailed;
  }
  if (summary->focal_length) Say(*summary->focal_length);
  for (const SubmapRefinement& submap : summary->submaps) Say(submap);
  SayResult(request.output_path);
  if (!summary->stopped) return kExitOk;
  SayError("the refinement was stopped before its end; the last solution of all frames is in " + request.output_path);
  return kExitFailed;
}

}  // namespace pliant::cli
