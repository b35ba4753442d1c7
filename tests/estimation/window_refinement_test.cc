// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/window/window_refinement.h"

#include <gtest/gtest.h>

#include "support/synthetic_scene.h"

namespace pliant {
namespace {

using test::MakeScene;
using test::RaysOf;
using test::Scene;
using test::SceneOptions;

constexpr double kConverged_mm = 1e-5;  // where the solver rests, poses alone, some 50 mm away

Window TrueWindow(const Scene& scene, const SceneOptions& options) {
  Window window{scene.cams_from_world, scene.points, {}};
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    for (std::size_t k = 0; k < scene.pixels.size(); ++k)
      window.observations.push_back({static_cast<int>(k), static_cast<int>(i), RaysOf(scene, options, k)[i]});
  return window;
}

TEST(WindowRefinement, FindsExactPosesAndPointsWithoutNoise) {
  const SceneOptions options{.surface = test::Surface::kBlob, .motion = test::Motion::kSideways, .num_points = 60};
  const Scene scene = MakeScene(options);
  Window start = TrueWindow(scene, options);
  for (std::size_t i = 0; i < start.points_in_world.size(); ++i) start.points_in_world[i] *= i % 2 == 0 ? 1.05 : 0.95;
  for (std::size_t k = 1; k + 1 < start.cams_from_world.size(); ++k) start.cams_from_world[k].translation.x() += 0.05;
  const auto refined = RefineWindow(start, options.focal_px, WindowPoints::kRefined, {});
  ASSERT_TRUE(refined.ok()) << refined.status().message();
  constexpr double kExactMm = 1e-4;  // where the solver rests, of 50 mm
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    EXPECT_LT((refined->window.points_in_world[i] - scene.points[i]).norm(), kExactMm) << i;
  for (std::size_t k = 0; k < scene.cams_from_world.size(); ++k)
    EXPECT_LT((refined->window.cams_from_world[k].translation - scene.cams_from_world[k].translation).norm(), kExactMm);
  EXPECT_EQ(refined->window.cams_from_world.front().translation, Eigen::Vector3d::Zero());
}

TEST(WindowRefinement, FindsPosesOnFixedPoints) {
  const SceneOptions options{.num_points = 60};
  const Scene scene = MakeScene(options);
  Window start = TrueWindow(scene, options);
  for (Rigid3& pose : start.cams_from_world) pose = Rigid3();
  const auto refined = RefineWindow(start, options.focal_px, WindowPoints::kFixed, {.loss_scale_px = 10});
  ASSERT_TRUE(refined.ok());
  for (std::size_t k = 0; k < scene.cams_from_world.size(); ++k)
    EXPECT_LT((refined->window.cams_from_world[k].translation - scene.cams_from_world[k].translation).norm(),
              kConverged_mm);
  EXPECT_EQ(refined->window.points_in_world, start.points_in_world);
}

TEST(SpreadViews, AreEvenFromTheFirstFrameToTheLast) {
  using Views = std::vector<std::size_t>;
  EXPECT_EQ(SpreadViews(9, 3), (Views{0, 4, 8}));
  EXPECT_EQ(SpreadViews(10, 4), (Views{0, 3, 6, 9}));
  EXPECT_EQ(SpreadViews(6, 4), (Views{0, 2, 3, 5}));
  EXPECT_EQ(SpreadViews(100, 2), (Views{0, 99}));
  EXPECT_EQ(SpreadViews(3, 8), (Views{0, 1, 2}));
}

TEST(WindowRefinement, RefusesBadWindows) {
  const SceneOptions options{.num_points = 20};
  const Scene scene = MakeScene(options);
  Window window = TrueWindow(scene, options);
  window.observations.front().point_idx = 20;
  EXPECT_EQ(RefineWindow(window, 450, WindowPoints::kRefined, {}).status().code(), ErrorCode::kInvalidArgument);
  window = TrueWindow(scene, options);
  window.points_in_world[3] = -window.points_in_world[3];
  EXPECT_EQ(RefineWindow(window, 450, WindowPoints::kRefined, {}).status().code(), ErrorCode::kInvalidArgument);
  window.cams_from_world.resize(1);
  EXPECT_EQ(RefineWindow(window, 450, WindowPoints::kRefined, {}).status().code(), ErrorCode::kInsufficient);
}

}  // namespace
}  // namespace pliant
