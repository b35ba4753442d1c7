// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/run_refinement.h"

#include <iostream>

#include "cli/progress.h"
#include "pliant/base/text.h"

namespace pliant::cli {

int RefineAndSay(std::string_view command, const RefineRequest& request, const RefineOptions& options, Saying saying) {
  const Result<RefineSummary> summary = [&] {
    Progress progress(std::cerr, saying == Saying::kErrors ? ProgressStyle::kQuiet : ProgressStyleOfStandardError(),
                      "refine", 100, "%");
    return RefineRun(request, options, [&](const RefinementProgress& at) {
      progress.Update(static_cast<int>(100.0 * at.share), std::string(at.stage) + ", cost " + Digits(at.cost, 1));
    });
  }();
  if (!summary.ok()) {
    SayError(command, summary.status().message());
    return kExitFailed;
  }
  if (saying == Saying::kErrors) return kExitOk;
  if (summary->stopped) std::cout << "note: stopped before the end; this is the best so far\n";
  if (const auto& focal = summary->focal_length) {
    if (focal->failure.empty())
      std::cout << "focal length " << Digits(focal->estimated_px, 1) << " +- " << Digits(focal->sigma_px, 1)
                << " px, assumed were " << Digits(focal->assumed_px, 1) << " px\n";
    else
      std::cout << "focal length kept at " << Digits(focal->assumed_px, 1) << " px: " << focal->failure << "\n";
  }
  for (const SubmapRefinement& submap : summary->submaps) {
    if (!submap.failure.empty()) {
      std::cout << "submap " << submap.submap << " is as it was, since it cannot be refined: " << submap.failure
                << "\n";
      continue;
    }
    std::cout << "submap " << submap.submap << ": " << (submap.deforming ? "deforming" : "rigid") << ", "
              << submap.frames << " frames, " << submap.points << " points, track noise " << Digits(submap.noise_px, 3)
              << " px, " << submap.wrong_observations << " of " << submap.observations << " observations left out\n";
  }
  std::cout << request.output_path << std::endl;
  return kExitOk;
}

}  // namespace pliant::cli
