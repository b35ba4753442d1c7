// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/frame/frame_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "estimation/frame_scene.h"
#include "pliant/estimation/pose/camera_pose.h"

namespace pliant {
namespace {

constexpr double kSmooth_px = 0.1;     // what the regularizers hold back of a smooth deformation
constexpr double kBystander_mm = 0.1;  // how far an outlier of no size moves the others, on average
constexpr double kSaturated = 1.1;     // with squares instead it would be ten times as strong
constexpr double kSolvedRad = 1e-8;    // zero noise: the gradient's tolerance over the weakest curvature
constexpr double kSolvedMm = 1e-6;
constexpr double kSameSolvedCost = 1e-6;  // relative; what both solvers' convergence guarantees

Rigid3 PoseOnLastGeometry(const FrameScene& scene) {
  return EstimateCameraPose(scene.camera, scene.positions, scene.pixels, Predicted(scene), {}).value().cam_from_world;
}

FrameSolution Solve(const FrameScene& scene, const Rigid3& initial, const FrameProblemOptions& options = {}) {
  auto solution = SolveFrameProblem(scene.camera, scene.Input(initial), options);
  EXPECT_TRUE(solution.ok()) << solution.status().message();
  return solution.ok() ? *solution : FrameSolution{};
}

double LargestPositionError(const FrameSolution& solution, const std::vector<Eigen::Vector3d>& expected) {
  double largest = 0;
  for (std::size_t i = 0; i < expected.size(); ++i)
    largest = std::max(largest, (solution.points[i].position - expected[i]).norm());
  return largest;
}

// Both ends of the gauge: with nothing to explain, the temporal term leaves all motion to the camera.
TEST(FrameProblem, RecoversARigidSceneExactlyFromConstantVelocity) {
  const FrameScene scene = MakeFrameScene({.deformation_mm = 0, .pixel_noise_px = 0, .outlier_ratio = 0});
  for (const FrameSolver solver : {FrameSolver::kLbfgs, FrameSolver::kLevenbergMarquardt}) {
    FrameProblemOptions options;
    options.solver = solver;
    options.function_tolerance = 0;  // on to the gradient's tolerance
    const FrameSolution solution = Solve(scene, Predicted(scene), options);
    EXPECT_TRUE(solution.converged) << solution.message;
    EXPECT_LT(RotationAngle(solution.cam_from_world.rotation * scene.true_cam_from_world.rotation.conjugate()),
              kSolvedRad);
    EXPECT_LT((solution.cam_from_world.translation - scene.true_cam_from_world.translation).norm(), kSolvedMm);
    EXPECT_LT(LargestPositionError(solution, scene.positions), kSolvedMm);
  }
}

// What the whole scene does together, the camera takes; what is left of a smooth deformation is small in the image.
TEST(FrameProblem, FollowsASmoothDeformationInTheImage) {
  const FrameScene scene = MakeFrameScene({.pixel_noise_px = 0, .outlier_ratio = 0});
  const FrameSolution solution = Solve(scene, PoseOnLastGeometry(scene));
  EXPECT_TRUE(solution.converged) << solution.message;
  ASSERT_EQ(solution.points.size(), scene.positions.size());
  for (const FramePoint& point : solution.points) EXPECT_LT(point.reprojection_error_px, kSmooth_px);
  EXPECT_LT(TotalCost(solution.costs), TotalCost(solution.initial_costs));
}

TEST(FrameProblem, AHeldPoseStaysAndBothSolversFindTheSameDisplacements) {
  const FrameScene scene = MakeFrameScene({.num_points = 150});
  FrameProblemInput input = scene.Input(scene.true_cam_from_world);
  input.pose = FramePose::kHeld;
  double cost = 0;
  for (const FrameSolver solver : {FrameSolver::kLevenbergMarquardt, FrameSolver::kLbfgs}) {
    FrameProblemOptions options;
    options.solver = solver;
    const auto solution = SolveFrameProblem(scene.camera, input, options);
    ASSERT_TRUE(solution.ok()) << solution.status().message();
    EXPECT_TRUE(solution->converged) << solution->message;
    EXPECT_LT(RotationAngle(solution->cam_from_world.rotation * scene.true_cam_from_world.rotation.conjugate()),
              kSolvedRad);
    EXPECT_LT((solution->cam_from_world.translation - scene.true_cam_from_world.translation).norm(), kSolvedMm);
    EXPECT_LT(TotalCost(solution->costs), TotalCost(solution->initial_costs));
    if (solver == FrameSolver::kLevenbergMarquardt) cost = TotalCost(solution->costs);
    EXPECT_NEAR(TotalCost(solution->costs), cost, kSameSolvedCost * cost);
  }
  // The pose was held against its will: freed, it moves.
  EXPECT_LT(TotalCost(Solve(scene, scene.true_cam_from_world).costs), (1 - kSameSolvedCost) * cost);
}

struct Variant {
  const char* name;
  FrameSceneOptions scene;
  void (*adjust)(FrameProblemOptions*);
};

class FrameProblemVariant : public testing::TestWithParam<Variant> {};

TEST_P(FrameProblemVariant, BothSolversEndInTheSameMinimum) {
  const FrameScene scene = MakeFrameScene(GetParam().scene);
  const Rigid3 initial = PoseOnLastGeometry(scene);
  FrameProblemOptions options;
  GetParam().adjust(&options);
  const FrameSolution ours = Solve(scene, initial, options);
  options.solver = FrameSolver::kLevenbergMarquardt;
  options.function_tolerance = 1e-12;
  const FrameSolution reference = Solve(scene, initial, options);
  ASSERT_TRUE(ours.converged && reference.converged) << ours.message << " / " << reference.message;
  EXPECT_NEAR(TotalCost(ours.costs), TotalCost(reference.costs), kSameSolvedCost * TotalCost(reference.costs));
  EXPECT_DOUBLE_EQ(TotalCost(ours.initial_costs), TotalCost(reference.initial_costs));
}

INSTANTIATE_TEST_SUITE_P(
    Options, FrameProblemVariant,
    testing::Values(
        Variant{"AsPublished", {}, [](FrameProblemOptions*) {}},
        Variant{"FewPoints", {.num_points = 12}, [](FrameProblemOptions*) {}},
        Variant{"FourPoints", {.num_points = 4}, [](FrameProblemOptions*) {}},
        Variant{"Fisheye", {.camera_model = "OPENCV_FISHEYE"}, [](FrameProblemOptions*) {}},
        Variant{"LargeDeformation", {.deformation_mm = 3}, [](FrameProblemOptions*) {}},
        Variant{"ManyOutliers", {.outlier_ratio = 0.3}, [](FrameProblemOptions*) {}},
        Variant{"StiffRegularizers", {}, [](FrameProblemOptions* o) { o->sigma_spa_mm = o->sigma_tmp_mm = 0.3; }},
        Variant{"ActiveRobustLosses",
                {.outlier_ratio = 0.1},
                [](FrameProblemOptions* o) {
                  o->sigma_spa_mm = o->sigma_tmp_mm = 0.3;
                  o->chi2_rep = o->chi2_spa = o->chi2_tmp = 0.5;
                }},
        // The edge-length term is not convex: with noise the solvers may end in different minima.
        Variant{"EdgeLength",
                {.pixel_noise_px = 0, .outlier_ratio = 0},
                [](FrameProblemOptions* o) { o->edge_length = Switch::kOn; }},
        Variant{"StiffEdgeLength",
                {},
                [](FrameProblemOptions* o) {
                  o->edge_length = Switch::kOn;
                  o->sigma_len_mm = 0.1;
                }},
        Variant{"Weighted",
                {},
                [](FrameProblemOptions* o) {
                  o->lambda_spa = 3;
                  o->lambda_tmp = 0.1;
                }},
        Variant{"NoSpatialTerm", {}, [](FrameProblemOptions* o) { o->lambda_spa = 0; }}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(FrameProblem, OutliersHaveBoundedInfluence) {
  const FrameSceneOptions clean = {.deformation_mm = 0, .pixel_noise_px = 0, .outlier_ratio = 0};
  FrameScene scene = MakeFrameScene(clean);
  const std::vector<Eigen::Vector2d> pixels = scene.pixels;
  double shift_mm[3];  // mean over the other points
  for (int k = 0; k < 3; ++k) {
    constexpr double kErrorPx[] = {50.0, 5000.0, 50000.0};
    scene.pixels[0].x() = pixels[0].x() + kErrorPx[k];
    const FrameSolution solution = Solve(scene, Predicted(scene));
    EXPECT_TRUE(solution.converged) << solution.message;
    double sum = 0;
    for (std::size_t i = 1; i < scene.positions.size(); ++i)
      sum += (solution.points[i].position - scene.positions[i]).norm();
    shift_mm[k] = sum / static_cast<double>(scene.positions.size() - 1);
  }
  EXPECT_LT(shift_mm[0], kBystander_mm);
  EXPECT_LT(shift_mm[2], kSaturated * shift_mm[1]);
}

TEST(FrameProblem, DisagreementPointsAtWrongTracks) {
  const FrameScene scene = MakeFrameScene({});
  const FrameSolution solution = Solve(scene, PoseOnLastGeometry(scene));
  ASSERT_EQ(solution.points.size(), scene.positions.size());
  double largest_good = 0;
  double smallest_bad = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < solution.points.size(); ++i) {
    const double disagreement = solution.points[i].disagreement_mm;
    if (scene.is_outlier[i])
      smallest_bad = std::min(smallest_bad, disagreement);
    else
      largest_good = std::max(largest_good, disagreement);
  }
  ASSERT_TRUE(std::isfinite(smallest_bad)) << "there are no outliers";
  EXPECT_GT(smallest_bad, largest_good);
}

TEST(FrameProblem, RepeatsBitForBitWhateverWasSolvedBefore) {
  const FrameScene scene = MakeFrameScene({});
  const Rigid3 initial = PoseOnLastGeometry(scene);
  const FrameSolution first = Solve(scene, initial);
  const FrameScene other = MakeFrameScene({.num_points = 321, .seed = 9});
  (void)Solve(other, PoseOnLastGeometry(other));
  const FrameSolution second = Solve(scene, initial);
  EXPECT_EQ(first.cam_from_world.rotation.coeffs(), second.cam_from_world.rotation.coeffs());
  EXPECT_EQ(first.cam_from_world.translation, second.cam_from_world.translation);
  ASSERT_EQ(first.points.size(), scene.positions.size());
  ASSERT_EQ(second.points.size(), first.points.size());
  for (std::size_t i = 0; i < first.points.size(); ++i) EXPECT_EQ(first.points[i].position, second.points[i].position);
}

TEST(FrameProblem, LeavesOutPointsBehindTheCamera) {
  FrameScene scene = MakeFrameScene({.deformation_mm = 0, .pixel_noise_px = 0, .outlier_ratio = 0});
  const Eigen::Vector3d behind = scene.true_cam_from_world.Inverse() * Eigen::Vector3d(1, 2, -30);
  scene.positions[17] = behind;
  FrameProblemOptions options;
  options.function_tolerance = 0;
  const FrameSolution solution = Solve(scene, Predicted(scene), options);
  EXPECT_EQ(solution.num_used, 499);
  EXPECT_FALSE(solution.points[17].used);
  EXPECT_EQ(solution.points[17].position, behind);
  EXPECT_TRUE(std::isinf(solution.points[17].reprojection_error_px));
  EXPECT_LT(LargestPositionError(solution, scene.positions), kSolvedMm);
}

TEST(FrameProblem, SaysWhyThereIsNoSolution) {
  FrameScene scene = MakeFrameScene({.num_points = 30});
  const Rigid3 initial = Predicted(scene);
  const auto code = [&](const FrameProblemInput& input) {
    return SolveFrameProblem(scene.camera, input, {}).status().code();
  };
  FrameProblemInput input = scene.Input(initial);
  input.pixels = input.pixels.first(29);
  EXPECT_EQ(code(input), ErrorCode::kMismatch);
  input.positions = input.positions.first(29);  // edges now point outside
  EXPECT_EQ(code(input), ErrorCode::kMismatch);
  input.edges = {};
  input.positions = input.positions.first(3);
  input.pixels = input.pixels.first(3);
  EXPECT_EQ(code(input), ErrorCode::kInsufficient);
  EXPECT_EQ(code({{}, {}, {}, initial}), ErrorCode::kInsufficient);
  EXPECT_EQ(code(scene.Input(Rigid3(RotationExp({3.14, 0, 0}), {0, 0, 0}) * initial)), ErrorCode::kInsufficient);

  scene.pixels[5].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(scene.Input(initial)), ErrorCode::kInvalidArgument);
  scene.pixels[5] = {1, 2};
  scene.positions[4].z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(scene.Input(initial)), ErrorCode::kInvalidArgument);
}

TEST(FrameProblemOptions, ListTheConstantsUnderTheirNames) {
  FrameProblemOptions options;
  OptionTable table;
  options.List(table);
  EXPECT_TRUE(table.Set("Optimization.lambda_spa", "2.5").ok());
  EXPECT_TRUE(table.Set("Optimization.solver", "levenberg_marquardt").ok());
  EXPECT_EQ(options.lambda_spa, 2.5);
  EXPECT_EQ(options.solver, FrameSolver::kLevenbergMarquardt);
  EXPECT_FALSE(table.Set("Optimization.sigma_tmp_mm", "0").ok());
}

}  // namespace
}  // namespace pliant
