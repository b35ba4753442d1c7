// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "pliant/base/statistics.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "support/synthetic_frames.h"
#include "support/synthetic_scene.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using test::FramesOf;
using test::MakeScene;
using test::Motion;
using test::Scene;
using test::SceneCamera;
using test::SceneOptions;
using test::Surface;

constexpr double kExactPose_mm = 1e-3;  // where the solver rests, at the nominal depth
// Median relative depth error: 0.9 % is predicted for two views, 0.3 px, 4 degrees and f = 450 px.
constexpr double kDepth = 0.015;
constexpr double kDepthByOpengv = 0.04;           // its refinement is not robust
constexpr double kDepthOfThePaper = 0.25;         // four frames in, at little parallax
constexpr double kDepthOfRansac = 0.05;           // at 0.1 px: a motion that is not refined
constexpr double kMaxShareWrong = 0.01;           // by more than a tenth: what is uncertain stays out
constexpr int kMaxOutliers = 2;                   // that lie on their epipolar lines in all views by chance
constexpr double kParallax_deg = 0.3;             // the median is of the points that stay in view
constexpr double kMinByRotation = 0.95;           // share of the tracks; noise takes the others
constexpr int kMaxMaps = 1;                       // of 20 trials
constexpr std::size_t kMinMonocularPoints = 200;  // of 500, of which some leave the image and some are uncertain
constexpr double kByEightViews = 0.85;  // a line through eight even positions has 0.77 of the error of its ends alone

// A sequence need not begin where the reference is taken.
constexpr int kFirstIdx = 10;
// Of all points; those that move most leave the image in forward motion, and the median of the rest is about 4.
constexpr double kEnoughDeg = 6.0;

InitOutcome Try(const SceneOptions& options, const MonocularInitOptions& init = {},
                InitMethod method = InitMethod::kGated) {
  const auto frames = FramesOf(MakeScene(options), options, kFirstIdx);
  InitOptions options_of_method;
  options_of_method.method = method;
  options_of_method.monocular = init;
  return MakeInitializer(options_of_method, Random(1))->Try({SceneCamera(options), frames, {}});
}

struct MapError {
  double median = 0;    // relative distance error after the best scale (median of ratios)
  double share_10 = 0;  // share of points more than 10 % off
};

MapError ErrorOf(const InitOutcome& outcome, const Scene& scene) {
  std::vector<double> ratios;
  for (const InitPoint& point : outcome.points)
    ratios.push_back(point.position.norm() / scene.points[static_cast<std::size_t>(point.id.value)].norm());
  std::vector<double> sorted = ratios;
  std::sort(sorted.begin(), sorted.end());
  const double scale = sorted[sorted.size() / 2];
  for (double& ratio : ratios) ratio = std::abs(ratio / scale - 1.0);
  std::sort(ratios.begin(), ratios.end());
  const auto bad = std::count_if(ratios.begin(), ratios.end(), [](double error) { return error > 0.1; });
  return {ratios[ratios.size() / 2], static_cast<double>(bad) / static_cast<double>(ratios.size())};
}

TEST(MonocularInitializer, RecoversTheSceneExactlyWithoutNoise) {
  for (const Motion motion : {Motion::kForward, Motion::kSideways}) {
    const SceneOptions options{.motion = motion, .parallax_deg = kEnoughDeg};
    const Scene scene = MakeScene(options);
    const InitOutcome outcome = Try(options);
    ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
    constexpr double kExact = 1e-5;  // relative: the solvers rest at 1e-7 rad, parallax is 0.03 rad and more
    const double scale = outcome.points.front().position.norm() /
                         scene.points[static_cast<std::size_t>(outcome.points.front().id.value)].norm();
    for (const InitPoint& point : outcome.points) {
      const Eigen::Vector3d truth = scale * scene.points[static_cast<std::size_t>(point.id.value)];
      EXPECT_LT((point.position - truth).norm(), kExact * truth.norm());
    }
    ASSERT_EQ(outcome.frames.size(), scene.cams_from_world.size());
    for (std::size_t k = 0; k < outcome.frames.size(); ++k) {
      EXPECT_EQ(outcome.frames[k].frame_idx, kFirstIdx + static_cast<int>(k));
      EXPECT_LT((outcome.frames[k].cam_from_world.translation - scale * scene.cams_from_world[k].translation).norm(),
                kExactPose_mm);
    }
  }
}

TEST(MonocularInitializer, HasItsPointsInEveryFrameInWhichTheyWereSeen) {
  constexpr double kExactPx = 1e-3;  // as above: 1e-5 of the distance, 450 px focal length, 6 degrees of parallax
  const SceneOptions options{.parallax_deg = kEnoughDeg};
  const Camera camera = SceneCamera(options);
  auto frames = FramesOf(MakeScene(options), options, kFirstIdx);
  // One point is seen in the reference and the current frame, but not in the second.
  const PointId hidden = frames.back().observations[7].id;
  std::erase_if(frames[1].observations, [&](const InitObservation& seen) { return seen.id == hidden; });
  const InitOutcome outcome = MakeGatedInitializer({}, Random(1))->Try({camera, frames, {}});
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const InitFrameState& state = outcome.frames[k];
    EXPECT_EQ(state.positions.size(), outcome.points.size() - (k == 1 ? 1 : 0));
    auto seen = frames[k].observations.begin();
    for (const InitPosition& point : state.positions) {
      while (seen != frames[k].observations.end() && seen->id < point.id) ++seen;
      ASSERT_TRUE(seen != frames[k].observations.end() && seen->id == point.id);
      const auto projected = camera.Project(state.cam_from_world * point.position);
      ASSERT_TRUE(projected);
      EXPECT_LT((*projected - seen->pixel).norm(), kExactPx);
    }
  }
}

TEST(MonocularInitializer, ScalesTheMapToTheNominalDepth) {
  MonocularInitOptions init;
  init.nominal_depth_mm = 80;
  const InitOutcome outcome = Try({.parallax_deg = kEnoughDeg, .noise_px = 0.3}, init);
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  std::vector<double> depths;
  for (const InitPoint& point : outcome.points) depths.push_back(point.position.z());
  EXPECT_NEAR(Median(depths), 80.0, kLengthRoundOff_mm);
}

TEST(MonocularInitializer, StaysWithinBoundsUnderNoiseAndOutliers) {
  for (const Motion motion : {Motion::kForward, Motion::kSideways}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const SceneOptions options{
          .motion = motion, .parallax_deg = kEnoughDeg, .noise_px = 0.3, .outlier_share = 0.3, .seed = seed};
      const Scene scene = MakeScene(options);
      const InitOutcome outcome = Try(options);
      ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
      const MapError error = ErrorOf(outcome, scene);
      EXPECT_LT(error.median, kDepth);
      EXPECT_LT(error.share_10, kMaxShareWrong);
      int outliers = 0;
      for (const InitPoint& point : outcome.points)
        outliers += scene.is_outlier[static_cast<std::size_t>(point.id.value)];
      EXPECT_LE(outliers, kMaxOutliers);
    }
  }
}

TEST(MonocularInitializer, AccountsForEveryPointOfTheReference) {
  const SceneOptions options{.parallax_deg = kEnoughDeg, .noise_px = 0.3, .outlier_share = 0.2};
  const InitOutcome outcome = Try(options);
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  std::set<PointId> ids;
  for (const InitPoint& point : outcome.points) ids.insert(point.id);
  for (const InitRejectedPoint& point : outcome.rejected) EXPECT_TRUE(ids.insert(point.id).second);
  EXPECT_EQ(ids.size(), FramesOf(MakeScene(options), options, kFirstIdx).front().observations.size());
  const auto by_id = [](const auto& a, const auto& b) { return a.id < b.id; };
  EXPECT_TRUE(std::is_sorted(outcome.points.begin(), outcome.points.end(), by_id));
  EXPECT_TRUE(std::is_sorted(outcome.rejected.begin(), outcome.rejected.end(), by_id));
}

TEST(MonocularInitializer, LeavesOutPointsNearTheFocusOfExpansion) {
  const InitOutcome outcome = Try({.parallax_deg = kEnoughDeg, .noise_px = 0.3});
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  const MonocularInitOptions defaults;
  ASSERT_FALSE(outcome.points.empty());
  for (const InitPoint& point : outcome.points)
    EXPECT_LE(point.depth_sigma, defaults.max_depth_sigma * point.position.norm() * (1 + kRoundOff));
  EXPECT_TRUE(std::any_of(outcome.rejected.begin(), outcome.rejected.end(), [](const InitRejectedPoint& point) {
    return point.reason == InitRejection::kUncertainDepth;
  }));
}

TEST(MonocularInitializer, WaitsForParallax) {
  const InitOutcome outcome = Try({.parallax_deg = 1.0, .noise_px = 0.3});
  EXPECT_EQ(outcome.decision, InitDecision::kWait);
  EXPECT_NE(outcome.reason.find("parallax"), std::string::npos) << outcome.reason;
  EXPECT_NEAR(outcome.measured.median_parallax_deg, 1.0, kParallax_deg);
}

// Every combination that is worth having.
TEST(MonocularInitializer, MakesAMapByAnySolverLoopRefinementAndTriangulation) {
  const SceneOptions options{
      .motion = Motion::kSideways, .parallax_deg = kEnoughDeg, .noise_px = 0.3, .outlier_share = 0.2};
  const auto median_error = [&](const MonocularInitOptions& init, InitMethod method) {
    const InitOutcome outcome = Try(options, init, method);
    EXPECT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
    return outcome.decision == InitDecision::kMap ? ErrorOf(outcome, MakeScene(options)).median : 1.0;
  };
  for (const auto& [solver, solver_name] : EnumNames<RelativePoseSolver>::kNames) {
    if (solver > RelativePoseSolver::kOpencvUsac) continue;  // of a rigid scene that is not flat
    for (const auto& [robust, robust_name] : EnumNames<RobustLoop>::kNames) {
      MonocularInitOptions init{.solver = solver, .robust = robust};
      EXPECT_LT(median_error(init, InitMethod::kGated), kDepth) << solver_name << " " << robust_name;
      init.refinement = RigidRefinement::kOpengv;
      EXPECT_LT(median_error(init, InitMethod::kGated), kDepthByOpengv) << solver_name << " " << robust_name;
      EXPECT_LT(median_error(init, InitMethod::kPaper), kDepthOfThePaper) << solver_name << " " << robust_name;
    }
  }
  for (const auto& [triangulation, name] : EnumNames<TriangulationMethod>::kNames)
    EXPECT_LT(median_error({.triangulation = triangulation}, InitMethod::kGated), kDepth) << name;
}

TEST(MonocularInitializer, RefusesAMapFromARotationAlone) {
  const InitOutcome outcome =
      Try({.motion = Motion::kSideways, .parallax_deg = kEnoughDeg},
          {.solver = RelativePoseSolver::kRotationOnly, .max_error_px = 50.0, .max_rotation_share = 1.0});
  EXPECT_EQ(outcome.decision, InitDecision::kWait);
  EXPECT_NE(outcome.reason.find("determines no depth"), std::string::npos) << outcome.reason;
}

TEST(MonocularInitializer, RefusesRotationAndStandstill) {
  for (const Motion motion : {Motion::kRotation, Motion::kStill}) {
    for (const double noise_px : {0.0, 0.3}) {
      const InitOutcome outcome = Try({.motion = motion, .rotation_deg = 6.0, .noise_px = noise_px});
      EXPECT_EQ(outcome.decision, InitDecision::kWait);
      EXPECT_NE(outcome.reason.find("rotation alone"), std::string::npos) << outcome.reason;
      EXPECT_GT(outcome.measured.rotation_only_share, kMinByRotation);
    }
  }
}

// A plane approached head-on is explained by two motions; a plane passed sideways, and an organ with 3 mm of relief, by
// one alone.
TEST(MonocularInitializer, RefusesThePlaneOnlyWhereASecondMotionExplainsIt) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const InitOutcome plane = Try({.surface = Surface::kPlane, .noise_px = 0.3, .seed = seed});
    EXPECT_EQ(plane.decision, InitDecision::kWait);
    EXPECT_NE(plane.reason.find("second camera motion"), std::string::npos) << plane.reason;
    for (const auto& [surface, motion] :
         {std::pair{Surface::kPlane, Motion::kSideways}, std::pair{Surface::kOrgan, Motion::kForward},
          std::pair{Surface::kOrgan, Motion::kSideways}}) {
      const SceneOptions options{.surface = surface, .motion = motion, .noise_px = 0.3, .seed = seed};
      const InitOutcome outcome = Try(options);
      ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
      EXPECT_LT(ErrorOf(outcome, MakeScene(options)).median, kDepth);
    }
  }
}

// With motions as the samples gave them, too: competing motions are then compared as they are.
TEST(MonocularInitializer, AsksForCompetingMotionsWhateverTheRefinement) {
  for (const auto& [refinement, name] : EnumNames<RigidRefinement>::kNames) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SceneOptions options{.surface = Surface::kPlane, .noise_px = 0.3, .seed = seed};
      const InitOutcome ahead = Try(options, {.refinement = refinement});
      EXPECT_EQ(ahead.decision, InitDecision::kWait) << name;
      EXPECT_NE(ahead.reason.find("second camera motion"), std::string::npos) << name << ": " << ahead.reason;
      const double ratio = ahead.measured.competing_cost_ratio;
      EXPECT_TRUE(ratio >= 1.0 && ratio < MonocularInitOptions().min_competing_cost_ratio) << name << ": " << ratio;
      options.motion = Motion::kSideways;
      const InitOutcome aside = Try(options, {.refinement = refinement});
      ASSERT_EQ(aside.decision, InitDecision::kMap) << name << ": " << aside.reason;
      EXPECT_GE(aside.measured.competing_cost_ratio, MonocularInitOptions().min_competing_cost_ratio) << name;
    }
  }
}

// Outliers that agree with one of a plane's two motions by chance are no evidence for it.
TEST(MonocularInitializer, OutliersDoNotDecideBetweenAPlanesMotions) {
  int maps = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    for (const double noise_px : {0.1, 0.3}) {
      const SceneOptions options{.surface = Surface::kPlane, .noise_px = noise_px, .outlier_share = 0.3, .seed = seed};
      maps += Try(options, {.refinement = RigidRefinement::kTwoView}).decision == InitDecision::kMap ? 1 : 0;
    }
  EXPECT_LE(maps, kMaxMaps);
}

TEST(MonocularInitializer, TheWindowReducesTheDepthNoiseOfTwoViews) {
  constexpr int kSeeds = 12;
  double two_view = 0;
  double window = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const SceneOptions options{.motion = Motion::kSideways, .noise_px = 0.3, .seed = seed};
    const Scene scene = MakeScene(options);
    MonocularInitOptions init;
    init.refinement = RigidRefinement::kTwoView;
    const InitOutcome pair = Try(options, init);
    const InitOutcome all = Try(options);
    ASSERT_EQ(pair.decision, InitDecision::kMap) << pair.reason;
    ASSERT_EQ(all.decision, InitDecision::kMap) << all.reason;
    two_view += ErrorOf(pair, scene).median / kSeeds;
    window += ErrorOf(all, scene).median / kSeeds;
  }
  EXPECT_LT(window, kByEightViews * two_view);
}

TEST(MonocularInitializer, GivesUpAReferenceThatDoesNotServe) {
  MonocularInitOptions init;
  init.max_window = 8;
  const InitOutcome spent = Try({.motion = Motion::kStill, .noise_px = 0.3}, init);
  EXPECT_EQ(spent.decision, InitDecision::kNewReference);
  EXPECT_NE(spent.reason.find("given up after 8 frames"), std::string::npos) << spent.reason;

  const SceneOptions options;
  auto frames = FramesOf(MakeScene(options), options, kFirstIdx);
  frames.back().observations.resize(100);
  const InitOutcome few = MakeGatedInitializer({}, Random(1))->Try({SceneCamera(options), frames, {}});
  EXPECT_EQ(few.decision, InitDecision::kNewReference);
  frames.resize(1);
  const InitOutcome first = MakeGatedInitializer({}, Random(1))->Try({SceneCamera(options), frames, {}});
  EXPECT_EQ(first.decision, InitDecision::kWait);
}

TEST(MonocularInitializer, SaysThatAllPointsWereLostOrThatNoImageFollows) {
  const SceneOptions options;
  auto frames = FramesOf(MakeScene(options), options, kFirstIdx);
  const auto reason = [&](const std::unique_ptr<Initializer>& initializer, InitMoment moment) {
    const InitOutcome outcome = initializer->Try({SceneCamera(options), frames, {}, moment});
    EXPECT_EQ(outcome.decision, InitDecision::kNewReference) << outcome.reason;
    return outcome.reason;
  };
  std::vector<std::unique_ptr<Initializer>> initializers;
  initializers.push_back(MakeGatedInitializer({}, Random(1)));
  initializers.push_back(MakeWindowInitializer({}, MonocularInitOptions().nominal_depth_mm));
  frames.back().observations.clear();
  for (const auto& initializer : initializers)
    EXPECT_EQ(reason(initializer, InitMoment::kMoreFollow), "all points were lost") << initializer->name();
  frames.resize(1);
  for (const auto& initializer : initializers)
    EXPECT_EQ(reason(initializer, InitMoment::kLastFrame), "no image follows the reference") << initializer->name();
}

TEST(MonocularInitializer, SurvivesNotANumberAndEqualPixels) {
  const SceneOptions options{.num_points = 100};
  auto frames = FramesOf(MakeScene(options), options, kFirstIdx);
  frames.back().observations[5].pixel.x() = std::numeric_limits<double>::quiet_NaN();
  const auto initializer = MakeGatedInitializer({}, Random(1));
  const InitOutcome outcome = initializer->Try({SceneCamera(options), frames, {}});
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  EXPECT_TRUE(std::any_of(outcome.rejected.begin(), outcome.rejected.end(),
                          [](const InitRejectedPoint& point) { return point.reason == InitRejection::kNoRay; }));
  for (InitFrame& frame : frames)
    for (InitObservation& observation : frame.observations) observation.pixel = {100, 100};
  EXPECT_EQ(initializer->Try({SceneCamera(options), frames, {}}).decision, InitDecision::kWait);
}

TEST(MonocularInitializer, RepeatsBitForBit) {
  const SceneOptions options{.parallax_deg = kEnoughDeg, .noise_px = 0.3, .outlier_share = 0.2};
  const InitOutcome a = Try(options);
  const InitOutcome b = Try(options);
  ASSERT_EQ(a.decision, InitDecision::kMap) << a.reason;
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) EXPECT_EQ(a.points[i].position, b.points[i].position);
}

TEST(PaperInitializer, MakesItsMapThreeFramesAfterTheReference) {
  SceneOptions options{.noise_px = 0.1};
  options.num_frames = 3;
  EXPECT_EQ(Try(options, {}, InitMethod::kPaper).decision, InitDecision::kWait);
  options.num_frames = 4;
  const InitOutcome outcome = Try(options, {}, InitMethod::kPaper);
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  EXPECT_EQ(outcome.frames.size(), 4U);
  EXPECT_GT(outcome.points.size(), kMinMonocularPoints);
  EXPECT_LT(ErrorOf(outcome, MakeScene(options)).median, kDepthOfRansac);
}

TEST(PaperInitializer, HasNoGates) {
  SceneOptions options{.parallax_deg = 0.5, .noise_px = 0.3};
  options.num_frames = 4;
  EXPECT_EQ(Try(options, {}, InitMethod::kPaper).decision, InitDecision::kMap);
  EXPECT_EQ(Try(options).decision, InitDecision::kWait);
}

TEST(MonocularInitOptions, AreListedWithinTheirRanges) {
  MonocularInitOptions options;
  OptionTable table;
  table.BeginGroup("Init", "the first map");
  options.List(table);
  ASSERT_FALSE(table.fields().empty());
  for (const OptionField& field : table.fields()) EXPECT_TRUE(table.Set(field.name, field.get()).ok()) << field.name;
  EXPECT_FALSE(table.Set("Init.min_parallax_deg", "-1").ok());
}

}  // namespace
}  // namespace pliant
