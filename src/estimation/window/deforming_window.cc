// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/window/deforming_window.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <future>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "estimation/ray_residuals.h"
#include "estimation/window/deforming_problem.h"
#include "estimation/window/deforming_uncertainty.h"
#include "estimation/window/planar_ambiguity.h"
#include "estimation/window/window_samples.h"
#include "pliant/base/statistics.h"
#include "pliant/estimation/window/shape_basis.h"
#include "pliant/geometry/decompositions.h"
#include "pliant/geometry/triangulation.h"

namespace pliant {
namespace {

// The coefficients start from the motions of points seen in this share of the views, and of so many in any
// case ...
constexpr double kStartShare = 0.8;
constexpr std::size_t kMinStartPoints = 12;
// ... none of which counts for more than this many times the median one: a wrong track moves most.
constexpr double kLargestMotion = 3.0;
// A lower rank explains the images less well in any case; it must explain the light better by so much.
constexpr double kClearlyBetter = 0.85;
// The last solution, with all points free, starts close to its minimum, and all frames refine its points later: its
// steps are at most max_iterations by this.
constexpr int kLastDivisor = 6;
// Steps of a rigid solution by max_iterations: they are cheap, and one that has not arrived looks like a deforming
// scene.
constexpr int kRigidFactor = 2;
// A solution by the other motion of a plane is none if it explains images or light so many times worse.
constexpr double kClearlyWorse = 1.3;

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
                                static_cast<double>(most_seen[std::min(seen.size(), kMinStartPoints) - 1]));
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

// The coefficients that explain most of what the rigid start leaves unexplained, of unit mean square about their mean.
// A wrong depth looks like a motion too, with the same coefficient for all points, so it does no harm here.
void SetCoefficients(int rank, DeformingWindow* window, SurfaceNodes* nodes) {
  Eigen::MatrixXd motions = UnexplainedMotions(*window);
  std::vector<double> sizes;
  for (Eigen::Index k = 0; k + 1 < motions.rows(); k += 2) sizes.push_back(motions.middleRows<2>(k).norm());
  const double largest = sizes.empty() ? 0.0 : kLargestMotion * Median(sizes);
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (sizes[i] > largest) motions.middleRows<2>(2 * static_cast<Eigen::Index>(i)) *= largest / sizes[i];
  const auto eigen = EigenOfSymmetric(Eigen::MatrixXd(motions.transpose() * motions));  // the strongest last
  const auto views = static_cast<double>(window->cams_from_world.size());
  window->coefficients = std::sqrt(views) * eigen.vectors.rightCols(rank).rowwise().reverse().transpose();
  window->coefficients.colwise() -= Eigen::VectorXd(window->coefficients.col(0));
  window->shapes.resize(window->points_in_world.size());
  for (Eigen::Matrix3Xd& shapes : window->shapes) shapes.setZero(3, rank);
  nodes->shapes.setZero(3 * rank, static_cast<Eigen::Index>(nodes->positions.size()));
}

// A sample's solutions, each extended to all points: of `rank`, and then, each from the one before, down to
// `last_rank`.
using SampleSolutions = std::vector<Result<DeformingSolution>>;

// What all samples of a window have in common.
struct SampleProblem {
  const DeformingWindow& start;
  PointSample node_points;
  double focal_px;
  const DeformingWindowOptions& options;
};

// All points, in the views of a part of them, with that part's shapes at the nodes.
Result<DeformingSolution> Extended(const SampleProblem& common, const DeformingWindow& part,
                                   const Eigen::MatrixXd& node_shapes, const PointSample& sample) {
  const DeformingWindow all = ExtendToAll(common.start, part, sample);
  SurfaceNodes nodes = NodesAt(all.points_in_world, common.node_points);
  nodes.shapes = node_shapes;
  DeformingProblem problem(all, nodes, common.focal_px, common.options);
  const auto cost = problem.OptimizePoints();
  if (!cost.ok()) return cost.status();
  return MakeSolution(problem, *cost, nodes);
}

SampleSolutions SolveSample(const SampleProblem& common, const PointSample& sample, int rank, int last_rank) {
  SurfaceNodes nodes = NodesAt(common.start.points_in_world, common.node_points);
  DeformingWindow part = PartOf(common.start, sample);
  SetCoefficients(rank, &part, &nodes);
  SampleSolutions solutions;
  for (int of_rank = rank; of_rank >= last_rank; --of_rank) {
    if (of_rank < rank) KeepStrongestShapes(of_rank, &part, &nodes);
    DeformingProblem problem(part, nodes, common.focal_px, common.options);
    const auto cost = problem.Solve(common.options.max_iterations);
    if (!cost.ok()) {
      solutions.emplace_back(cost.status());
      continue;
    }
    part = problem.Window();
    nodes.shapes = problem.NodeShapes();
    if (sample.size() < common.start.points_in_world.size())
      solutions.push_back(Extended(common, part, nodes.shapes, sample));
    else
      solutions.emplace_back(MakeSolution(problem, *cost, nodes));
  }
  return solutions;
}

// The samples' solutions with this index in their lists; null where there is none.
using Solutions = std::vector<const DeformingSolution*>;

Solutions SolutionsAt(std::size_t index, const std::vector<SampleSolutions>& samples) {
  Solutions found;
  for (const SampleSolutions& solutions : samples)
    found.push_back(index < solutions.size() && solutions[index].ok() ? &*solutions[index] : nullptr);
  return found;
}

const DeformingSolution* MostPlausible(const Solutions& solutions) {
  const DeformingSolution* best = nullptr;
  for (const DeformingSolution* solution : solutions)
    if (solution != nullptr && (best == nullptr || MorePlausible(*solution, *best))) best = solution;
  return best;
}

std::vector<SampleSolutions> SolveSamples(const SampleProblem& common, const std::vector<PointSample>& point_samples,
                                          int rank, int last_rank, int threads) {
  std::vector<std::future<SampleSolutions>> solving;
  for (const PointSample& sample : point_samples)
    solving.push_back(std::async(threads > 1 ? std::launch::async : std::launch::deferred,
                                 [&, sample] { return SolveSample(common, sample, rank, last_rank); }));
  std::vector<SampleSolutions> samples;
  for (std::future<SampleSolutions>& solved : solving) samples.push_back(solved.get());
  return samples;
}

// The solutions of the first rank, or those of the next lower one, where the most plausible of these explains the light
// clearly better or where the first rank has none.
Solutions ChooseRank(const std::vector<SampleSolutions>& samples) {
  Solutions first = SolutionsAt(0, samples);
  Solutions lower = SolutionsAt(1, samples);
  const DeformingSolution* best = MostPlausible(first);
  if (best == nullptr) return lower;
  const DeformingSolution* other = MostPlausible(lower);
  const bool clearly_better =
      other != nullptr && other->light_error > 0.0 && other->light_error < kClearlyBetter * best->light_error;
  return clearly_better ? lower : first;
}

// With predicted sigmas and the correlation of its residuals.
DeformingSolution WithUncertainty(DeformingSolution solution, double focal_px, const DeformingWindowOptions& options,
                                  int threads) {
  solution.log_depth_sigmas = FoundLogDepthSigmas(solution, FoundNoisePx(solution.window, focal_px),
                                                  solution.window.points_in_world.size(), focal_px, options, threads);
  solution.residual_correlation = ResidualCorrelation(solution.window, options.patch_px / focal_px);
  return solution;
}

Result<DeformingSolution> SolvedRigid(const DeformingWindow& start, double focal_px,
                                      const DeformingWindowOptions& options, int threads) {
  DeformingProblem problem(start, {}, focal_px, options);
  const auto cost = problem.Solve(kRigidFactor * options.max_iterations, threads);
  if (!cost.ok()) return cost.status();
  return MakeSolution(problem, *cost, {});
}

// The sample solved from the other motion of the plane, where the points of the best solution are close to one.
std::optional<DeformingSolution> SolveFromOtherMotion(const DeformingSolution& best, const SampleProblem& common,
                                                      const PointSample& sample) {
  if (!NearlyFlat(best.window.points_in_world)) return std::nullopt;
  const int rank = static_cast<int>(best.window.coefficients.rows());
  DeformingWindow rigid = best.window;
  rigid.coefficients.resize(0, rigid.coefficients.cols());
  rigid.shapes.clear();
  const auto start = OtherPlanarMotion(rigid, common.focal_px, common.options);
  if (!start) return std::nullopt;
  auto solved = SolveSample({*start, common.node_points, common.focal_px, common.options}, sample, rank, rank);
  if (!solved.front().ok()) return std::nullopt;
  return std::move(*solved.front());
}

bool ClearlyWorse(const DeformingSolution& a, const DeformingSolution& b) {
  return a.cost >= kClearlyWorse * b.cost || (b.light_error > 0.0 && a.light_error >= kClearlyWorse * b.light_error);
}

// The larger of two; either may be empty.
std::vector<double> LargerOf(std::vector<double> a, const std::vector<double>& b) {
  if (a.empty()) return b;
  for (std::size_t i = 0; i < b.size(); ++i) a[i] = std::max(a[i], b[i]);
  return a;
}

}  // namespace

Eigen::Vector3d DeformingWindow::Position(int point_idx, int view_idx) const {
  const Eigen::Vector3d& rest = points_in_world[static_cast<std::size_t>(point_idx)];
  if (coefficients.rows() == 0) return rest;
  return rest + shapes[static_cast<std::size_t>(point_idx)] * coefficients.col(view_idx);
}

double DeformingWindow::MedianDistance() const {
  std::vector<double> distances;
  for (const Eigen::Vector3d& position : points_in_world) distances.push_back(position.norm());
  return Median(std::move(distances));
}

double DeformingSolution::LogDepthSigma(std::size_t point) const {
  return sample_sigmas.empty() ? log_depth_sigmas[point] : std::hypot(log_depth_sigmas[point], sample_sigmas[point]);
}

void DeformingWindowOptions::List(OptionTable& table) {
  table.BeginGroup("Window", "bundle adjustment of a window with a low-rank deformation model, for the first map");
  table.Add("rank", &rank, "-",
            "number of basis shapes of the low-rank deformation model, each with one temporal coefficient", 1,
            kMaxWindowRank);
  table.Add("loss_scale_px", &loss_scale_px, "px", "scale of the Cauchy loss; about the noise of a tracked pixel", 1e-3,
            100);
  table.Add("gradient_sigma", &gradient_sigma, "-",
            "standard deviation of the difference of neighbors' basis shapes divided by their distance; smaller "
            "is smoother",
            1e-4, 100);
  table.Add("shape_sigma", &shape_sigma, "-", "standard deviation of a basis shape divided by the median distance",
            1e-4, 100);
  table.Add("acceleration_sigma", &acceleration_sigma, "1/frame^2",
            "standard deviation of the second derivative of a temporal coefficient, which is of size 1", 1e-6, 1e3);
  table.Add("light_sigma", &light_sigma, "-",
            "standard deviation of log distance from brightness; large, because errors of neighbors are "
            "correlated",
            1e-3, 1e6);
  table.Add("neighbors", &neighbors, "-", "neighbors of a node whose basis shapes are compared with its own", 1, 100);
  table.Add("nodes", &nodes, "-",
            "nodes of the surface at which basis shapes are estimated; between nodes they are interpolated", 4, 1000);
  table.Add("sample_points", &sample_points, "-",
            "points in each of the two samples that are solved before all points; fewer is faster", 60, 100000);
  table.Add("max_iterations", &max_iterations, "-", "maximum number of iterations of one solution", 1, 10000);
  table.Renamed("mode_sigma", "shape_sigma");
}

Result<DeformingSolution> SolveDeformingWindow(const DeformingWindow& start, double focal_px,
                                               const DeformingWindowOptions& options, int threads) {
  if (Status status = CheckWindow(start); !status.ok()) return status;
  if (options.rank < 1 || options.rank > kMaxWindowRank || options.sample_points < 1)
    return {ErrorCode::kInvalidArgument, "a deforming window takes a rank from 1 to " + std::to_string(kMaxWindowRank) +
                                             " and 1 sample point or more"};
  const int rank = std::min(options.rank, static_cast<int>(start.times.size()) - 1);
  const bool lit = std::any_of(start.observations.begin(), start.observations.end(),
                               [](const auto& observation) { return std::isfinite(observation.log_cue); });
  const int last_rank = lit ? std::max(1, rank - 1) : rank;
  const SampleProblem common{start, SpreadPoints(start.points_in_world, options.nodes), focal_px, options};
  const std::vector<PointSample> point_samples = SamplePoints(start, options.sample_points);
  const std::vector<SampleSolutions> samples = SolveSamples(common, point_samples, rank, last_rank, threads);
  const Solutions of_rank = ChooseRank(samples);
  const DeformingSolution* best = MostPlausible(of_rank);
  if (best == nullptr) return samples.front().front().status();
  std::vector<double> sigmas = SigmasBetween(of_rank, start.points_in_world.size());
  const auto other = SolveFromOtherMotion(*best, common, point_samples.front());
  if (other) {
    const bool wins = MorePlausible(*other, *best);
    if (!ClearlyWorse(wins ? *best : *other, wins ? *other : *best))
      sigmas = LargerOf(std::move(sigmas), SigmasBetween({best, &*other}, start.points_in_world.size()));
    if (wins) best = &*other;
  }

  DeformingProblem problem(best->window, best->nodes, focal_px, options);
  const auto cost = problem.Solve(std::max(1, options.max_iterations / kLastDivisor), threads);
  if (!cost.ok()) return cost.status();
  DeformingSolution solution = WithUncertainty(MakeSolution(problem, *cost, best->nodes), focal_px, options, threads);
  solution.sample_sigmas = std::move(sigmas);
  return solution;
}

Result<DeformingSolution> SolveRigidWindow(const DeformingWindow& start, double focal_px,
                                           const DeformingWindowOptions& options, int threads) {
  if (Status status = CheckWindow(start); !status.ok()) return status;
  DeformingWindow rigid = start;
  rigid.coefficients.resize(0, static_cast<Eigen::Index>(rigid.times.size()));
  rigid.shapes.clear();
  auto solution = SolvedRigid(rigid, focal_px, options, threads);
  if (!solution.ok()) return solution.status();
  std::vector<double> between_sigmas;
  if (const auto other_start = OtherPlanarMotion(solution->window, focal_px, options)) {
    auto other = SolvedRigid(*other_start, focal_px, options, threads);
    if (other.ok()) {
      if (other->cost < solution->cost) std::swap(*other, *solution);
      if (!ClearlyWorse(*other, *solution))
        between_sigmas = SigmasBetween({&*solution, &*other}, start.points_in_world.size());
    }
  }
  DeformingSolution certain = WithUncertainty(std::move(*solution), focal_px, options, threads);
  certain.sample_sigmas = std::move(between_sigmas);
  return certain;
}

Result<double> RigidResidualCorrelation(const DeformingWindow& start, double focal_px,
                                        const DeformingWindowOptions& options) {
  if (Status status = CheckWindow(start); !status.ok()) return status;
  const DeformingWindow part = PartOf(start, SamplePoints(start, options.sample_points).front());
  DeformingProblem problem(part, {}, focal_px, options);
  const auto cost = problem.Solve(kRigidFactor * options.max_iterations);
  if (!cost.ok()) return cost.status();
  return ResidualCorrelation(problem.Window(), options.patch_px / focal_px);
}

}  // namespace pliant
