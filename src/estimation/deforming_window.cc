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
void SetCourses(int rank, DeformingWindow* window) {
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
}

// The R strongest courses of all the points' motions, of unit mean square, and the modes that go with them: the best
// approximation of rank R (Eckart, Young). Courses of rank R of a window that starts from zero start from zero.
void KeepStrongestCourses(int rank, DeformingWindow* window) {
  const Eigen::Index views = window->courses.cols();
  Eigen::MatrixXd second_moment = Eigen::MatrixXd::Zero(window->courses.rows(), window->courses.rows());
  for (const Eigen::Matrix3Xd& modes : window->modes) second_moment += modes.transpose() * modes;
  const Eigen::MatrixXd motions = window->courses.transpose() * second_moment * window->courses;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(motions);  // the strongest last
  const Eigen::MatrixXd strongest = eigen.eigenvectors().rightCols(rank).rowwise().reverse();
  const double length = std::sqrt(static_cast<double>(views));
  const Eigen::MatrixXd change = window->courses * strongest / length;
  for (Eigen::Matrix3Xd& modes : window->modes) modes = Eigen::Matrix3Xd(modes * change);
  window->courses = length * strongest.transpose();
  window->courses.col(0).setZero();  // but for rounding it is
}

// The views by which a window's shape is judged: the first, the middle and the last.
std::array<int, 3> JudgedViews(const DeformingWindow& window) {
  const int views = static_cast<int>(window.cams_from_world.size());
  return {0, views / 2, views - 1};
}

// (W8) How far the window's shape in the judged views is from what the light says of it; 0: no light.
double WindowLightError(const DeformingWindow& window) {
  const std::array<int, 3> views = JudgedViews(window);
  double sum = 0;
  for (const int view : views) {
    std::vector<Eigen::Vector3d> positions;
    std::vector<double> log_light;
    for (const DeformingObservation& observation : window.observations) {
      if (observation.view_idx != view) continue;
      positions.push_back(window.cams_from_world[static_cast<std::size_t>(view)] *
                          window.Position(observation.point_idx, view));
      log_light.push_back(observation.log_light);
    }
    const double error = LightError(positions, log_light);
    if (!(error > 0.0)) return 0.0;
    sum += error;
  }
  return sum / static_cast<double>(views.size());
}

// The problem's solution. Its light error is filled in where there is light, its sigmas are not.
Result<DeformingSolution> Solve(DeformingProblem* problem, int max_iterations) {
  const auto cost = problem->Solve(max_iterations);
  if (!cost.ok()) return cost.status();
  DeformingSolution solution;
  solution.cost = *cost;
  solution.window = problem->Window();
  solution.light_error = WindowLightError(solution.window);
  return solution;
}

// A sample's solutions, each extended to all points: of `rank`, and then, each from the one before, down to
// `last_rank`.
using SampleSolutions = std::vector<Result<DeformingSolution>>;

SampleSolutions SolveSample(const DeformingWindow& start, const PointSample& sample, int rank, int last_rank,
                            double focal_px, const DeformingWindowOptions& options) {
  DeformingWindow part = PartOf(start, sample);
  SetCourses(rank, &part);
  SampleSolutions solutions;
  for (int of_rank = rank; of_rank >= last_rank; --of_rank) {
    if (of_rank < rank) KeepStrongestCourses(of_rank, &part);
    DeformingProblem problem(part, focal_px, options);
    auto solution = Solve(&problem, options.max_iterations);
    if (solution.ok()) {
      part = solution->window;
      if (sample.size() < start.points_in_world.size()) {
        DeformingProblem all(ExtendToAll(start, part, sample), focal_px, options);
        all.FixViews();
        solution = Solve(&all, options.max_iterations);
      }
    }
    solutions.push_back(std::move(solution));
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
std::vector<const DeformingSolution*> SolutionsAt(std::size_t place, const std::vector<SampleSolutions>& samples) {
  std::vector<const DeformingSolution*> found;
  for (const SampleSolutions& solutions : samples)
    found.push_back(place < solutions.size() && solutions[place].ok() ? &*solutions[place] : nullptr);
  return found;
}

const DeformingSolution* MostPlausible(const std::vector<const DeformingSolution*>& solutions) {
  const DeformingSolution* best = nullptr;
  for (const DeformingSolution* solution : solutions)
    if (solution != nullptr && (best == nullptr || MorePlausible(*solution, *best))) best = solution;
  return best;
}

// (W10) One a point, of two samples' solutions; infinite where one has none, and empty for one sample.
std::vector<double> SigmasBetween(const std::vector<const DeformingSolution*>& solutions, std::size_t points) {
  if (solutions.size() < 2) return {};
  if (solutions[0] == nullptr || solutions[1] == nullptr)
    return std::vector<double>(points, std::numeric_limits<double>::infinity());
  const DeformingWindow& first = solutions[0]->window;
  const DeformingWindow& second = solutions[1]->window;
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

}  // namespace

Eigen::Vector3d DeformingWindow::Position(int point_idx, int view_idx) const {
  const Eigen::Vector3d& rest = points_in_world[static_cast<std::size_t>(point_idx)];
  if (courses.rows() == 0) return rest;
  return rest + modes[static_cast<std::size_t>(point_idx)] * courses.col(view_idx);
}

void DeformingWindowOptions::List(OptionTable& table) {
  table.BeginGroup("Window", "the deforming window from which the first map is made");
  table.Add("rank", &rank, "-", "ways in which the scene moves at a time: courses in time common to all points", 1, 12);
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
  table.Add("sample_points", &sample_points, "-",
            "points in each of the two samples that are solved before all; fewer is faster", 60, 100000);
  table.Add("max_iterations", &max_iterations, "-", "most iterations of one solution", 1, 10000);
}

Result<DeformingSolution> SolveDeformingWindow(const DeformingWindow& start, double focal_px,
                                               const DeformingWindowOptions& options, int threads) {
  if (Status status = CheckStart(start); !status.ok()) return status;
  if (options.rank < 1 || options.sample_points < 1)
    return {ErrorCode::kInvalidArgument, "a deforming window takes a rank and a number of sample points of 1 or more"};
  const int rank = std::min(options.rank, static_cast<int>(start.times.size()) - 1);
  const bool lit = std::any_of(start.observations.begin(), start.observations.end(),
                               [](const auto& observation) { return std::isfinite(observation.log_light); });
  const int last_rank = lit ? std::max(1, rank - 1) : rank;
  std::vector<std::future<SampleSolutions>> solving;
  for (const PointSample& sample : SamplePoints(start, options.sample_points))
    solving.push_back(std::async(threads > 1 ? std::launch::async : std::launch::deferred, [&, sample] {
      return SolveSample(start, sample, rank, last_rank, focal_px, options);
    }));
  std::vector<SampleSolutions> samples;
  for (std::future<SampleSolutions>& solved : solving) samples.push_back(solved.get());

  std::vector<const DeformingSolution*> of_rank = SolutionsAt(0, samples);
  const DeformingSolution* best = MostPlausible(of_rank);
  const DeformingSolution* lower = MostPlausible(SolutionsAt(1, samples));
  const bool clearly_better = best != nullptr && lower != nullptr && lower->light_error > 0.0 &&
                              lower->light_error < kClearlyBetter * best->light_error;
  if (clearly_better || best == nullptr) {
    best = lower;
    of_rank = SolutionsAt(1, samples);
  }
  if (best == nullptr) return samples.front().front().status();

  DeformingProblem problem(best->window, focal_px, options);
  auto solution = Solve(&problem, std::max(1, options.max_iterations / kLastDivisor));
  if (!solution.ok()) return solution.status();
  solution->log_depth_sigmas = problem.LogDepthSigmas();
  solution->sample_sigmas = SigmasBetween(of_rank, start.points_in_world.size());
  return solution;
}

Result<DeformingWindow> LocateDeformingViews(const DeformingWindow& views, double focal_px,
                                             const DeformingWindowOptions& options) {
  if (Status status = CheckStart(views); !status.ok()) return status;
  DeformingProblem problem(views, focal_px, options);
  problem.FixPoints();
  if (const auto cost = problem.Solve(options.max_iterations); !cost.ok()) return cost.status();
  return problem.Window();
}

std::vector<double> PointErrorsPx(const DeformingWindow& window, double focal_px) {
  std::vector<double> sums(window.points_in_world.size(), 0.0);
  std::vector<int> counts(sums.size(), 0);
  for (const DeformingObservation& observation : window.observations) {
    if (observation.view_idx == 0) continue;
    const auto i = static_cast<std::size_t>(observation.point_idx);
    const Eigen::Vector3d x = window.cams_from_world[static_cast<std::size_t>(observation.view_idx)] *
                              window.Position(observation.point_idx, observation.view_idx);
    sums[i] += std::pow(focal_px * AngleBetween(x, observation.ray), 2);
    ++counts[i];
  }
  for (std::size_t i = 0; i < sums.size(); ++i)
    sums[i] = counts[i] > 0 ? std::sqrt(sums[i] / counts[i]) : std::numeric_limits<double>::infinity();
  return sums;
}

double LogDistanceFromLight(double brightness, double gamma) {
  if (!(brightness > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return -0.5 * gamma * std::log(brightness / 255.0);
}

}  // namespace pliant
