// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/deforming_window.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <future>
#include <limits>
#include <string>

#include <Eigen/Eigenvalues>

#include "estimation/deforming_problem.h"
#include "estimation/light_depth.h"
#include "estimation/mode_basis.h"
#include "estimation/ray_residuals.h"
#include "estimation/window_samples.h"
#include "pliant/base/statistics.h"
#include "pliant/geometry/triangulation.h"

namespace pliant {
namespace {

constexpr int kLeastViews = 3;
constexpr int kLeastPoints = 12;
// The courses are first sought in the motions of points seen in this share of the views, and of so many in any case ...
constexpr double kStartShare = 0.8;
constexpr std::size_t kLeastStartPoints = 12;
// ... none of which counts for more than this many times the median one: a wrong track moves most.
constexpr double kLargestMotion = 3.0;
// A lower rank explains the images less well in any case; it must explain the light better by so much.
constexpr double kClearlyBetter = 0.85;
// The last solution, with all points free, starts close to its minimum: its steps are at most max_iterations by this.
constexpr int kLastDivisor = 2;
// Steps of a rigid solution by max_iterations: they are cheap, and one that has not arrived looks like a deforming
// scene.
constexpr int kRigidFactor = 4;

Status CheckStart(const DeformingWindow& start) {
  const std::size_t views = start.cams_from_world.size();
  const std::size_t points = start.points_in_world.size();
  if (start.times.size() != views ||
      (start.courses.rows() > 0 && start.courses.cols() != static_cast<Eigen::Index>(views)) ||
      (start.courses.rows() > 0 && start.modes.size() != points))
    return {ErrorCode::kInvalidArgument, "the parts of the deforming window differ in size"};
  if (static_cast<int>(views) < kLeastViews || static_cast<int>(points) < kLeastPoints)
    return {ErrorCode::kInsufficient, "a deforming window takes at least " + std::to_string(kLeastViews) +
                                          " views and " + std::to_string(kLeastPoints) + " points; there are " +
                                          std::to_string(views) + " and " + std::to_string(points)};
  const auto finite = [](const Eigen::Vector3d& vector) { return vector.allFinite(); };
  if (!std::all_of(start.points_in_world.begin(), start.points_in_world.end(), finite))
    return {ErrorCode::kInvalidArgument, "a point of the deforming window is not a finite number"};
  for (const DeformingObservation& observation : start.observations)
    if (!observation.ray.allFinite() || observation.view_idx < 0 ||
        static_cast<std::size_t>(observation.view_idx) >= views || observation.point_idx < 0 ||
        static_cast<std::size_t>(observation.point_idx) >= points)
      return {ErrorCode::kInvalidArgument,
              "an observation of the window has no ray, or names a view or point that is not there"};
  return Status::Ok();
}

// Motions of the points across their first rays that the start's rigid scene leaves unexplained, in map units: two rows
// a point, a column a view. Points seen in most views alone; where one is not seen, its motion is that of the view
// before.
Eigen::MatrixXd UnexplainedMotions(const DeformingWindow& start) {
  const auto views = static_cast<Eigen::Index>(start.cams_from_world.size());
  std::vector<int> seen(start.points_in_world.size(), 0);
  for (const DeformingObservation& observation : start.observations)
    ++seen[static_cast<std::size_t>(observation.point_idx)];
  std::vector<int> most_seen = seen;
  std::sort(most_seen.begin(), most_seen.end(), std::greater<>());
  const double least = std::min(kStartShare * static_cast<double>(views),
                                static_cast<double>(most_seen[std::min(seen.size(), kLeastStartPoints) - 1]));
  std::vector<Eigen::Index> row(seen.size(), -1);
  Eigen::Index rows = 0;
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen[i] >= least) row[i] = 2 * rows++;

  Eigen::MatrixXd motions = Eigen::MatrixXd::Constant(2 * rows, views, std::numeric_limits<double>::quiet_NaN());
  for (const DeformingObservation& observation : start.observations) {
    const Eigen::Index first = row[static_cast<std::size_t>(observation.point_idx)];
    if (first < 0) continue;
    const Rigid3& cam_from_world = start.cams_from_world[static_cast<std::size_t>(observation.view_idx)];
    const Eigen::Vector3d& point = start.points_in_world[static_cast<std::size_t>(observation.point_idx)];
    const double distance = (cam_from_world * point).norm();
    const Eigen::Vector3d found = cam_from_world.Inverse() * (distance * observation.ray);
    motions.block<2, 1>(first, observation.view_idx) = BasisAcross(point.normalized()) * (found - point);
  }
  for (Eigen::Index v = 1; v < views; ++v)
    for (Eigen::Index k = 0; k < motions.rows(); ++k)
      if (!std::isfinite(motions(k, v))) motions(k, v) = motions(k, v - 1);
  return motions.unaryExpr([](double value) { return std::isfinite(value) ? value : 0.0; });
}

// The courses that explain most of what the rigid start leaves unexplained, of unit mean square about their mean. A
// wrong depth looks like a motion too, the same course for all, so it does no harm here.
void SetCourses(int rank, DeformingWindow* window, SurfaceNodes* nodes) {
  Eigen::MatrixXd motions = UnexplainedMotions(*window);
  std::vector<double> sizes;
  for (Eigen::Index k = 0; k + 1 < motions.rows(); k += 2) sizes.push_back(motions.middleRows<2>(k).norm());
  const double largest = sizes.empty() ? 0.0 : kLargestMotion * Median(sizes);
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (sizes[i] > largest) motions.middleRows<2>(2 * static_cast<Eigen::Index>(i)) *= largest / sizes[i];
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(motions.transpose() * motions);  // the strongest last
  const auto views = static_cast<double>(window->cams_from_world.size());
  window->courses = std::sqrt(views) * eigen.eigenvectors().rightCols(rank).rowwise().reverse().transpose();
  window->courses.colwise() -= Eigen::VectorXd(window->courses.col(0));
  window->modes.resize(window->points_in_world.size());
  for (Eigen::Matrix3Xd& modes : window->modes) modes.setZero(3, rank);
  nodes->modes.setZero(3 * rank, static_cast<Eigen::Index>(nodes->positions.size()));
}

// The R strongest courses of all the points' motions, of unit mean square, and the modes that go with them: the best
// approximation of rank R (Eckart, Young). Courses of rank R of a window that starts from zero start from zero.
void KeepStrongestCourses(int rank, DeformingWindow* window, SurfaceNodes* nodes) {
  const Eigen::Index views = window->courses.cols();
  Eigen::MatrixXd second_moment = Eigen::MatrixXd::Zero(window->courses.rows(), window->courses.rows());
  for (const Eigen::Matrix3Xd& modes : window->modes) second_moment += modes.transpose() * modes;
  const Eigen::MatrixXd motions = window->courses.transpose() * second_moment * window->courses;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(motions);  // the strongest last
  const Eigen::MatrixXd strongest = eigen.eigenvectors().rightCols(rank).rowwise().reverse();
  const double length = std::sqrt(static_cast<double>(views));
  const Eigen::MatrixXd change = window->courses * strongest / length;
  for (Eigen::Matrix3Xd& modes : window->modes) modes = Eigen::Matrix3Xd(modes * change);
  Eigen::MatrixXd node_modes(3 * rank, nodes->modes.cols());
  for (Eigen::Index n = 0; n < node_modes.cols(); ++n)
    node_modes.col(n) = (nodes->modes.col(n).reshaped(3, change.rows()) * change).reshaped();
  nodes->modes = node_modes;
  window->courses = length * strongest.transpose();
  window->courses.col(0).setZero();  // but for rounding it is
}

// The views by which a window's shape is judged: the first, the middle and the last.
std::array<int, 3> JudgedViews(const DeformingWindow& window) {
  const int views = static_cast<int>(window.cams_from_world.size());
  return {0, views / 2, views - 1};
}

// (W8) How far the window's shape in the judged views is from what the light says of it, and from one distance for all;
// zeros: no light.
LightFit CompareWindowWithLight(const DeformingWindow& window) {
  const std::array<int, 3> views = JudgedViews(window);
  LightFit mean;
  for (const int view : views) {
    std::vector<Eigen::Vector3d> positions;
    std::vector<double> log_light;
    for (const DeformingObservation& observation : window.observations) {
      if (observation.view_idx != view) continue;
      positions.push_back(window.cams_from_world[static_cast<std::size_t>(view)] *
                          window.Position(observation.point_idx, view));
      log_light.push_back(observation.log_light);
    }
    const LightFit fit = CompareWithLight(positions, log_light);
    if (!(fit.error > 0.0)) return {};
    mean.error += fit.error / static_cast<double>(views.size());
    mean.spread += fit.spread / static_cast<double>(views.size());
  }
  return mean;
}

// A solution with its nodes. Its light error is filled in where there is light, its sigmas are not.
struct SolvedPart {
  DeformingSolution solution;
  SurfaceNodes nodes;
};

SolvedPart Taken(const DeformingProblem& problem, double cost, SurfaceNodes nodes) {
  SolvedPart part;
  part.solution.cost = cost;
  part.solution.window = problem.Window();
  const LightFit light = CompareWindowWithLight(part.solution.window);
  part.solution.light_error = light.error;
  part.solution.log_distance_spread = light.spread;
  part.nodes = std::move(nodes);
  part.nodes.modes = problem.NodeModes();
  return part;
}

// A sample's solutions, each extended to all points: of `rank`, and then, each from the one before, down to
// `last_rank`.
using SampleSolutions = std::vector<Result<SolvedPart>>;

// What all samples of a window have in common.
struct SampleProblem {
  const DeformingWindow& start;
  PointSample node_points;
  double focal_px;
  const DeformingWindowOptions& options;
};

// All points, in the views of a part of them, with that part's modes at the nodes.
Result<SolvedPart> Extended(const SampleProblem& common, const DeformingWindow& part, const Eigen::MatrixXd& node_modes,
                            const PointSample& sample) {
  const DeformingWindow all = ExtendToAll(common.start, part, sample);
  SurfaceNodes nodes = NodesAt(all.points_in_world, common.node_points);
  nodes.modes = node_modes;
  DeformingProblem problem(all, nodes, common.focal_px, common.options);
  const auto cost = problem.SettlePoints();
  if (!cost.ok()) return cost.status();
  return Taken(problem, *cost, std::move(nodes));
}

SampleSolutions SolveSample(const SampleProblem& common, const PointSample& sample, int rank, int last_rank) {
  SurfaceNodes nodes = NodesAt(common.start.points_in_world, common.node_points);
  DeformingWindow part = PartOf(common.start, sample);
  SetCourses(rank, &part, &nodes);
  SampleSolutions solutions;
  for (int of_rank = rank; of_rank >= last_rank; --of_rank) {
    if (of_rank < rank) KeepStrongestCourses(of_rank, &part, &nodes);
    DeformingProblem problem(part, nodes, common.focal_px, common.options);
    const auto cost = problem.Solve(common.options.max_iterations);
    if (!cost.ok()) {
      solutions.emplace_back(cost.status());
      continue;
    }
    part = problem.Window();
    nodes.modes = problem.NodeModes();
    if (sample.size() < common.start.points_in_world.size())
      solutions.push_back(Extended(common, part, nodes.modes, sample));
    else
      solutions.emplace_back(Taken(problem, *cost, nodes));
  }
  return solutions;
}

// (W9) Whether `a` is the more plausible: minus the log likelihood by images and priors, and by the light, if both have
// it, as one measurement a point of unknown spread.
bool MorePlausible(const DeformingSolution& a, const DeformingSolution& b) {
  double difference = a.cost - b.cost;
  if (a.light_error > 0.0 && b.light_error > 0.0)
    difference += static_cast<double>(a.window.points_in_world.size()) * std::log(a.light_error / b.light_error);
  return difference < 0.0;
}

// The samples' solutions with this place in their lists; null where there is none.
using SolvedParts = std::vector<const SolvedPart*>;

SolvedParts SolutionsAt(std::size_t place, const std::vector<SampleSolutions>& samples) {
  SolvedParts found;
  for (const SampleSolutions& solutions : samples)
    found.push_back(place < solutions.size() && solutions[place].ok() ? &*solutions[place] : nullptr);
  return found;
}

const SolvedPart* MostPlausible(const SolvedParts& parts) {
  const SolvedPart* best = nullptr;
  for (const SolvedPart* part : parts)
    if (part != nullptr && (best == nullptr || MorePlausible(part->solution, best->solution))) best = part;
  return best;
}

// (W10) One a point, of two samples' solutions; infinite where one has none, and empty for one sample.
std::vector<double> SigmasBetween(const SolvedParts& parts, std::size_t points) {
  if (parts.size() < 2) return {};
  if (parts[0] == nullptr || parts[1] == nullptr)
    return std::vector<double>(points, std::numeric_limits<double>::infinity());
  const DeformingWindow& first = parts[0]->solution.window;
  const DeformingWindow& second = parts[1]->solution.window;
  const std::array<int, 3> views = JudgedViews(first);
  std::vector<double> squares(points, 0.0);
  for (const int view : views) {
    const auto v = static_cast<std::size_t>(view);
    std::vector<double> differences;
    for (std::size_t i = 0; i < points; ++i)
      differences.push_back(std::log((first.cams_from_world[v] * first.Position(static_cast<int>(i), view)).norm() /
                                     (second.cams_from_world[v] * second.Position(static_cast<int>(i), view)).norm()));
    const double scale = Median(differences);
    for (std::size_t i = 0; i < points; ++i) squares[i] += std::pow(differences[i] - scale, 2);
  }
  for (double& square : squares) square = std::sqrt(square / (2.0 * static_cast<double>(views.size())));
  return squares;
}

// Of a solution by what it turned out to be: its own errors as the noise, its own modes' sizes and differences as what
// was to be expected of them, each times kCaution, because a solution adapts to the noise, and modes to their priors.
std::vector<double> LogDepthSigmas(const SolvedPart& part, double focal_px, const DeformingWindowOptions& options) {
  constexpr double kCaution = 2.0;
  constexpr double kLeastNoisePx = 0.05;
  constexpr double kLeastSigma = 0.01;
  DeformingWindowOptions found = options;
  const DeformingWindow& window = part.solution.window;
  found.loss_scale_px = std::max(kLeastNoisePx, kCaution * Median(PointErrorsPx(window, focal_px)));
  if (window.courses.rows() > 0) {
    const ModeSizes sizes = SizesOf(part.nodes);
    found.mode_sigma = std::max(kLeastSigma, kCaution * sizes.size / MedianDistance(window.points_in_world));
    found.gradient_sigma = std::max(kLeastSigma, kCaution * sizes.gradient);
  }
  return DeformingProblem(window, part.nodes, focal_px, found).LogDepthSigmas();
}

DeformingSolution Judged(SolvedPart part, double focal_px, const DeformingWindowOptions& options) {
  part.solution.log_depth_sigmas = LogDepthSigmas(part, focal_px, options);
  part.solution.residual_correlation = ResidualCorrelation(part.solution.window);
  return std::move(part.solution);
}

}  // namespace

Eigen::Vector3d DeformingWindow::Position(int point_idx, int view_idx) const {
  const Eigen::Vector3d& rest = points_in_world[static_cast<std::size_t>(point_idx)];
  if (courses.rows() == 0) return rest;
  return rest + modes[static_cast<std::size_t>(point_idx)] * courses.col(view_idx);
}

double DeformingSolution::LogDepthSigma(std::size_t point) const {
  return sample_sigmas.empty() ? log_depth_sigmas[point] : std::hypot(log_depth_sigmas[point], sample_sigmas[point]);
}

void DeformingWindowOptions::List(OptionTable& table) {
  table.BeginGroup("Window", "the deforming window from which the first map is made");
  table.Add("rank", &rank, "-", "ways in which the scene moves at a time: courses in time common to all points", 1,
            kMaxWindowRank);
  table.Add("loss_scale_px", &loss_scale_px, "px", "scale of the Cauchy loss: about a tracked pixel's noise", 1e-3,
            100);
  table.Add("gradient_sigma", &gradient_sigma, "-",
            "difference of neighbours' modes by their distance, standard deviation; smaller is smoother", 1e-4, 100);
  table.Add("mode_sigma", &mode_sigma, "-", "a mode's size by the median distance, standard deviation", 1e-4, 100);
  table.Add("acceleration_sigma", &acceleration_sigma, "1/frame^2",
            "second derivative of a course (whose size is about 1), standard deviation", 1e-6, 1e3);
  table.Add("light_sigma", &light_sigma, "-",
            "log distance from brightness, standard deviation; large, because neighbours err alike", 1e-3, 1e6);
  table.Add("neighbors", &neighbors, "-", "neighbours with which a point's modes are compared", 1, 100);
  table.Add("nodes", &nodes, "-", "of the surface, at which modes are free; between them they are interpolated", 4,
            1000);
  table.Add("sample_points", &sample_points, "-",
            "points in each of the two samples that are solved before all; fewer is faster", 60, 100000);
  table.Add("max_iterations", &max_iterations, "-", "most iterations of one solution", 1, 10000);
}

Result<DeformingSolution> SolveDeformingWindow(const DeformingWindow& start, double focal_px,
                                               const DeformingWindowOptions& options, int threads) {
  if (Status status = CheckStart(start); !status.ok()) return status;
  if (options.rank < 1 || options.rank > kMaxWindowRank || options.sample_points < 1)
    return {ErrorCode::kInvalidArgument, "a deforming window takes a rank from 1 to " + std::to_string(kMaxWindowRank) +
                                             " and 1 sample point or more"};
  const int rank = std::min(options.rank, static_cast<int>(start.times.size()) - 1);
  const bool lit = std::any_of(start.observations.begin(), start.observations.end(),
                               [](const auto& observation) { return std::isfinite(observation.log_light); });
  const int last_rank = lit ? std::max(1, rank - 1) : rank;
  const SampleProblem common{start, SpreadPoints(start.points_in_world, options.nodes), focal_px, options};
  std::vector<std::future<SampleSolutions>> solving;
  for (const PointSample& sample : SamplePoints(start, options.sample_points))
    solving.push_back(std::async(threads > 1 ? std::launch::async : std::launch::deferred,
                                 [&, sample] { return SolveSample(common, sample, rank, last_rank); }));
  std::vector<SampleSolutions> samples;
  for (std::future<SampleSolutions>& solved : solving) samples.push_back(solved.get());

  SolvedParts of_rank = SolutionsAt(0, samples);
  const SolvedPart* best = MostPlausible(of_rank);
  const SolvedPart* lower = MostPlausible(SolutionsAt(1, samples));
  const bool clearly_better = best != nullptr && lower != nullptr && lower->solution.light_error > 0.0 &&
                              lower->solution.light_error < kClearlyBetter * best->solution.light_error;
  if (clearly_better || best == nullptr) {
    best = lower;
    of_rank = SolutionsAt(1, samples);
  }
  if (best == nullptr) return samples.front().front().status();

  DeformingProblem problem(best->solution.window, best->nodes, focal_px, options);
  const auto cost = problem.Solve(std::max(1, options.max_iterations / kLastDivisor));
  if (!cost.ok()) return cost.status();
  DeformingSolution solution = Judged(Taken(problem, *cost, best->nodes), focal_px, options);
  solution.sample_sigmas = SigmasBetween(of_rank, start.points_in_world.size());
  return solution;
}

Result<DeformingSolution> SolveRigidWindow(const DeformingWindow& start, double focal_px,
                                           const DeformingWindowOptions& options) {
  if (Status status = CheckStart(start); !status.ok()) return status;
  DeformingWindow rigid = start;
  rigid.courses.resize(0, static_cast<Eigen::Index>(rigid.times.size()));
  rigid.modes.clear();
  DeformingProblem problem(rigid, {}, focal_px, options);
  const auto cost = problem.Solve(kRigidFactor * options.max_iterations);
  if (!cost.ok()) return cost.status();
  return Judged(Taken(problem, *cost, {}), focal_px, options);
}

Result<double> RigidResidualCorrelation(const DeformingWindow& start, double focal_px,
                                        const DeformingWindowOptions& options) {
  if (Status status = CheckStart(start); !status.ok()) return status;
  const DeformingWindow part = PartOf(start, SamplePoints(start, options.sample_points).front());
  DeformingProblem problem(part, {}, focal_px, options);
  const auto cost = problem.Solve(kRigidFactor * options.max_iterations);
  if (!cost.ok()) return cost.status();
  return ResidualCorrelation(problem.Window());
}

Result<DeformingWindow> LocateDeformingViews(const DeformingWindow& views, double focal_px,
                                             const DeformingWindowOptions& options) {
  if (Status status = CheckStart(views); !status.ok()) return status;
  SurfaceNodes none = NodesAt(views.points_in_world, {0});
  none.modes.setZero(3 * views.courses.rows(), 1);
  DeformingProblem problem(views, none, focal_px, options);
  if (const auto cost = problem.Solve(options.max_iterations, FreeParts::kViews); !cost.ok()) return cost.status();
  return problem.Window();
}

double LogDistanceFromLight(double brightness, double gamma) {
  if (!(brightness > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return -0.5 * gamma * std::log(brightness / 255.0);
}

}  // namespace pliant
