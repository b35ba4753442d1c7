// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Maps that are re-estimated beside tracking, and taken over some frames later.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "e2e/e2e_support.h"
#include "support/kept_reports.h"

namespace pliant {
namespace {

constexpr double kMaxRmse_mm = 1.0;  // where one constant depth has 17
constexpr double kTrackedOn = 0.8;   // share of the points that enter a map

// They enter by re-estimates alone: where the frame that takes the map over shows them.
TEST(RigidScene, PointsOfAMapThatIsHandedOverAreTrackedOn) {
  const TestFolder folder;
  TrackOptions options;
  options.tracker.handover_frames = 6;
  options.tracker.init.window.refine_rigid = Switch::kOff;
  options.tracker.growth.window = 15;
  options.tracker.growth.reestimate_every = 5;
  options.tracker.growth.min_views = 1000;
  RunRequest request;
  request.input.image_path = kSequence;
  request.output_path = folder.Path("run");
  KeptReports kept;
  const std::vector<TrackObserver*> observers = {&kept};
  const auto summary = RunTrack(request, options, observers);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  ASSERT_EQ(summary->frames_tracked, 60) << summary->note;
  int added = 0;
  int tracked_on = 0;
  for (std::size_t k = 1; k + 1 < kept.reports.size(); ++k) {
    if (kept.reports[k].first_map) continue;
    for (const NewPoint& point : kept.reports[k].new_points) {
      ++added;
      if (FindById(kept.reports[k + 1].observations, point.id) != nullptr) ++tracked_on;
    }
  }
  EXPECT_GT(added, 20);
  EXPECT_GT(tracked_on, kTrackedOn * added) << added;
  const Evaluation evaluation = EvaluateRun(folder.Path("run"), kSequence, ErrorScale::kPerFrame);
  EXPECT_LT(evaluation.surface->plain.estimate.mean_rmse_mm, kMaxRmse_mm);
}

}  // namespace
}  // namespace pliant
