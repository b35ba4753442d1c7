// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/bundle_covariance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <random>
#include <unordered_map>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <ceres/cost_function.h>

#include "refinement/model_point.h"

namespace pliant {
namespace {

constexpr int kSamples = 150;  // the standard deviation of a sigma found by n samples is 1 / sqrt(2 n) of it
constexpr unsigned kSeed = 1;

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Permutation = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>;
using BlockPair = std::pair<int, int>;  // the second is not above the first

// A view or a node.
struct Block {
  int begin = 0;  // of its numbers among those of all
  int size = 0;
};

// The normal equations by blocks: of every point with itself and with the blocks that its terms have, and of these.
struct PointNormal {
  Eigen::MatrixXd self;
  std::map<int, Eigen::MatrixXd> by_block;  // block x point
};

// A term at the problem's variables.
struct Linearization {
  Eigen::VectorXd residual;
  std::vector<RowMajorMatrix> jacobians;  // by its parameter blocks
};

std::optional<Linearization> Linearize(const ceres::CostFunction& cost, const std::vector<double*>& parameters) {
  Linearization term{Eigen::VectorXd(cost.num_residuals()), {}};
  std::vector<double*> data;
  for (const int size : cost.parameter_block_sizes()) term.jacobians.emplace_back(cost.num_residuals(), size);
  for (RowMajorMatrix& jacobian : term.jacobians) data.push_back(jacobian.data());
  if (!cost.Evaluate(parameters.data(), term.residual.data(), data.data())) return std::nullopt;
  return term;
}

class Covariance {
 public:
  explicit Covariance(const BundleProblem& problem) : problem_(problem), point_normals_(problem.points().size()) {
    for (const double* const view : problem.views()) AddBlock(view, 6 + problem.rank());
    for (const double* const node : problem.nodes()) AddBlock(node, 3 * problem.rank());
    for (std::size_t i = 0; i < problem.points().size(); ++i)
      point_of_.emplace(problem.points()[i], static_cast<int>(i));
    AddTerms();
  }

  Status Sample() {
    EliminatePoints();
    const Permutation order = EliminationOrder();
    std::vector<int> held;
    for (const int k : NumbersWithoutTerms()) held.push_back(order.indices()[k]);
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> cholesky(
        LowerNormal(order, held));
    if (cholesky.info() != Eigen::Success)
      return {ErrorCode::kDegenerate, "the refinement's terms do not determine its variables"};
    std::mt19937_64 generator(kSeed);
    std::normal_distribution<double> normal;
    const Eigen::MatrixXd white = Eigen::MatrixXd::NullaryExpr(size_, kSamples, [&] { return normal(generator); });
    // P H P^T = L L^T: x = P^T L^-T z has the covariance H^-1.
    samples_ = cholesky.matrixU().solve(white);
    for (const int k : held) samples_.row(k).setZero();
    samples_ = order.transpose() * samples_;
    common_.setZero(kSamples);
    return Status::Ok();
  }

  // From here on in the unit that keeps the mean of the log distances of the points, each from its middle view.
  void SetUnit(const std::vector<std::vector<int>>& views_of_point) {
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(kSamples);
    int count = 0;
    for (std::size_t i = 0; i < point_normals_.size(); ++i) {
      const PointNormal& normal = point_normals_[i];
      if (normal.self.size() == 0) continue;
      const int view = views_of_point[i][views_of_point[i].size() / 2];
      const LogDistanceGradient gradient = GradientOf(i, static_cast<std::size_t>(view));
      sum += gradient.by_view * SamplesOf(view) +
             gradient.by_point * SampledPoint(normal, Eigen::LLT<Eigen::MatrixXd>(normal.self));
      ++count;
    }
    common_ = sum / std::max(1, count);
  }

  // Of every view: itself, or the nearest that has observations in the problem.
  std::vector<int> NearestViewInProblem() const {
    std::vector<int> known;
    for (int v = 0; v < static_cast<int>(problem_.views().size()); ++v)
      if (v == 0 || normal_.contains({v, v})) known.push_back(v);
    std::vector<int> nearest;
    for (int v = 0; v < static_cast<int>(problem_.views().size()); ++v)
      nearest.push_back(*std::ranges::min_element(known, {}, [&](int k) { return std::abs(k - v); }));
    return nearest;
  }

  PoseCovariance PoseOf(std::size_t view) const {
    const PoseIncrement& pose = problem_.poses()[view];
    // Of the camera's center in the world and its rotation, by the increment at zero.
    Eigen::Matrix<double, 6, 6> by_increment = Eigen::Matrix<double, 6, 6>::Zero();
    const Eigen::Matrix3d world_from_cam = pose.reference_rotation().transpose();
    by_increment.topLeftCorner<3, 3>() = -world_from_cam * Skew(pose.pivot_in_cam());
    by_increment.topRightCorner<3, 3>() = -world_from_cam;
    by_increment.bottomLeftCorner<3, 3>().setIdentity();
    Eigen::MatrixXd moved = by_increment * samples_.middleRows(blocks_[view].begin, 6);
    moved.topRows<3>() -= CenterFromFirst(view) * common_;
    return moved * moved.transpose() / kSamples;
  }

  // Of the log distances of a point from the cameras of some views.
  std::vector<double> LogDistanceSigmas(std::size_t point, const std::vector<int>& views) const {
    const PointNormal& normal = point_normals_[point];
    if (normal.self.size() == 0) return std::vector<double>(views.size(), 0.0);
    const Eigen::LLT<Eigen::MatrixXd> own(normal.self);
    const Eigen::MatrixXd moved = SampledPoint(normal, own);
    std::vector<double> sigmas;
    for (const int view : views) {
      const LogDistanceGradient gradient = GradientOf(point, static_cast<std::size_t>(view));
      const Eigen::RowVectorXd sampled = gradient.by_view * SamplesOf(view) + gradient.by_point * moved - common_;
      const double known_views = gradient.by_point * own.solve(gradient.by_point.transpose());
      sigmas.push_back(std::sqrt(known_views + sampled.squaredNorm() / kSamples));
    }
    return sigmas;
  }

  // A term of a view and a point each.
  std::vector<MeasuredResidual> MeasuredResiduals() const {
    std::vector<MeasuredResidual> residuals;
    std::vector<double*> parameters;
    for (const ceres::ResidualBlockId& id : problem_.measured_distances()) {
      problem_.terms().GetParameterBlocksForResidualBlock(id, &parameters);
      const auto term = Linearize(*problem_.terms().GetCostFunctionForResidualBlock(id), parameters);
      if (!term) continue;
      const PointNormal& normal = point_normals_[static_cast<std::size_t>(point_of_.at(parameters[1]))];
      const Eigen::LLT<Eigen::MatrixXd> own(normal.self);
      const RowMajorMatrix& by_view = term->jacobians[0];
      const RowMajorMatrix& by_point = term->jacobians[1];
      const Eigen::RowVectorXd sampled =
          by_view * SamplesOf(block_of_.at(parameters[0])) + by_point * SampledPoint(normal, own);
      const double known_views = (by_point * own.solve(Eigen::MatrixXd(by_point.transpose()))).value();
      const double taken = known_views + sampled.squaredNorm() / kSamples;
      residuals.push_back({term->residual.value(), 1.0 - taken});
    }
    return residuals;
  }

 private:
  struct LogDistanceGradient {
    Eigen::RowVectorXd by_view;
    Eigen::RowVectorXd by_point;
  };

  // A point's numbers, by the samples of views and nodes; `own` is of its normal equations.
  Eigen::MatrixXd SampledPoint(const PointNormal& normal, const Eigen::LLT<Eigen::MatrixXd>& own) const {
    Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(normal.self.rows(), kSamples);
    for (const auto& [block, matrix] : normal.by_block) moved.noalias() -= matrix.transpose() * SamplesOf(block);
    own.solveInPlace(moved);
    return moved;
  }

  // The center of a camera, from the first one's.
  Eigen::Vector3d CenterFromFirst(std::size_t view) const {
    const auto center = [&](std::size_t v) { return problem_.poses()[v].Pose(Vector6d::Zero()).OriginInSource(); };
    return center(view) - center(0);
  }

  Eigen::MatrixXd SamplesOf(int block) const {
    const Block& b = blocks_[static_cast<std::size_t>(block)];
    return samples_.middleRows(b.begin, b.size);
  }

  // Where each number goes. Of whole blocks: the numbers of a block have the same neighbors, and an ordering of single
  // numbers does not see that (of 600 views it left ten times the work).
  Permutation EliminationOrder() const {
    const auto count = static_cast<int>(blocks_.size());
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& [pair, matrix] : normal_) {
      entries.emplace_back(pair.first, pair.second, 1.0);
      entries.emplace_back(pair.second, pair.first, 1.0);
    }
    Eigen::SparseMatrix<double> neighbors(count, count);
    neighbors.setFromTriplets(entries.begin(), entries.end());
    Permutation blocks;
    Eigen::AMDOrdering<int>()(neighbors, blocks);
    Permutation order(size_);
    int next = 0;
    for (const int b : blocks.indices()) {
      const Block& block = blocks_[static_cast<std::size_t>(b)];
      for (int k = 0; k < block.size; ++k) order.indices()[block.begin + k] = next++;
    }
    return order;
  }

  // The lower half in that order; numbers that are held stand alone.
  Eigen::SparseMatrix<double> LowerNormal(const Permutation& order, const std::vector<int>& held) const {
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& [pair, matrix] : normal_)
      for (Eigen::Index r = 0; r < matrix.rows(); ++r)
        for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
          const int a = order.indices()[blocks_[static_cast<std::size_t>(pair.first)].begin + r];
          const int b = order.indices()[blocks_[static_cast<std::size_t>(pair.second)].begin + c];
          if (pair.first != pair.second || a >= b) entries.emplace_back(std::max(a, b), std::min(a, b), matrix(r, c));
        }
    for (const int k : held) entries.emplace_back(k, k, 1.0);
    Eigen::SparseMatrix<double> lower(size_, size_);
    lower.setFromTriplets(entries.begin(), entries.end());
    return lower;
  }

  // The first pose, and poses of views without observations.
  std::vector<int> NumbersWithoutTerms() const {
    std::vector<int> numbers;
    for (int b = 0; b < static_cast<int>(blocks_.size()); ++b) {
      const Block& block = blocks_[static_cast<std::size_t>(b)];
      const auto terms = normal_.find({b, b});
      for (int k = 0; k < block.size; ++k)
        if (terms == normal_.end() || terms->second(k, k) == 0.0) numbers.push_back(block.begin + k);
    }
    return numbers;
  }

  void AddBlock(const double* values, int size) {
    block_of_.emplace(values, static_cast<int>(blocks_.size()));
    blocks_.push_back({size_, size});
    size_ += size;
  }

  void Add(int a, int b, const Eigen::MatrixXd& by_a, const Eigen::MatrixXd& by_b) {
    if (a < b) return;
    AddTo(normal_[{a, b}], by_a.transpose() * by_b);
  }

  static void AddTo(Eigen::MatrixXd& sum, const Eigen::MatrixXd& term) {
    if (sum.size() == 0)
      sum = term;
    else
      sum += term;
  }

  void AddTerms() {
    std::vector<ceres::ResidualBlockId> terms;
    problem_.terms().GetResidualBlocks(&terms);
    std::vector<double*> parameters;
    for (const ceres::ResidualBlockId& term : terms) {
      problem_.terms().GetParameterBlocksForResidualBlock(term, &parameters);
      AddTerm(*problem_.terms().GetCostFunctionForResidualBlock(term),
              problem_.terms().GetLossFunctionForResidualBlock(term), parameters);
    }
  }

  void AddTerm(const ceres::CostFunction& cost, const ceres::LossFunction* loss,
               const std::vector<double*>& parameters) {
    auto term = Linearize(cost, parameters);
    if (!term) return;
    std::vector<RowMajorMatrix>& jacobians = term->jacobians;
    double weight = 1.0;
    if (loss != nullptr) {
      std::array<double, 3> rho = {};
      loss->Evaluate(term->residual.squaredNorm(), rho.data());
      weight = std::sqrt(rho[1]);
    }
    PointNormal* point = nullptr;
    std::size_t point_at = 0;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      jacobians[p] *= weight;
      if (const auto found = point_of_.find(parameters[p]); found != point_of_.end()) {
        point = &point_normals_[static_cast<std::size_t>(found->second)];
        point_at = p;
      } else if (parameters[p] == problem_.held_view()) {
        jacobians[p].leftCols(6).setZero();
      }
    }
    if (point != nullptr) AddTo(point->self, jacobians[point_at].transpose() * jacobians[point_at]);
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      if (point != nullptr && p == point_at) continue;
      const int a = block_of_.at(parameters[p]);
      if (point != nullptr) AddTo(point->by_block[a], jacobians[p].transpose() * jacobians[point_at]);
      for (std::size_t q = 0; q < parameters.size(); ++q)
        if (point == nullptr || q != point_at) Add(a, block_of_.at(parameters[q]), jacobians[p], jacobians[q]);
    }
  }

  void EliminatePoints() {
    for (const PointNormal& point : point_normals_) {
      if (point.self.size() == 0) continue;
      const Eigen::LLT<Eigen::MatrixXd> own(point.self);
      std::vector<std::pair<int, Eigen::MatrixXd>> whitened;
      for (const auto& [block, matrix] : point.by_block)
        whitened.emplace_back(block, own.matrixL().solve(matrix.transpose()));
      for (const auto& [a, by_a] : whitened)
        for (const auto& [b, by_b] : whitened)
          if (b <= a) AddTo(normal_[{a, b}], -by_a.transpose() * by_b);
    }
  }

  LogDistanceGradient GradientOf(std::size_t point, std::size_t view) const {
    const int rank = problem_.rank();
    const ModelPoint moved(problem_.poses()[view], problem_.views()[view], problem_.points()[point], rank);
    const Eigen::RowVector3d by_cam_point = moved.in_cam().transpose() / moved.in_cam().squaredNorm();
    Eigen::RowVectorXd by_view(6 + rank);
    Eigen::RowVectorXd by_point(3 + 3 * rank);
    moved.ByView<1>(by_cam_point, by_view.data());
    moved.ByPoint<1>(by_cam_point, by_point.data());
    return {by_view, by_point};
  }

  const BundleProblem& problem_;
  std::vector<Block> blocks_;  // views, then nodes
  std::unordered_map<const double*, int> block_of_;
  std::unordered_map<const double*, int> point_of_;
  int size_ = 0;
  std::map<BlockPair, Eigen::MatrixXd> normal_;  // of blocks; the lower half
  std::vector<PointNormal> point_normals_;
  Eigen::MatrixXd samples_;
  Eigen::RowVectorXd common_;  // of all log distances, a sample each
};

}  // namespace

Result<BundleCovariance> ComputeCovariance(const BundleProblem& problem, const Recording& recording) {
  Covariance covariance(problem);
  if (Status status = covariance.Sample(); !status.ok()) return status;
  const std::vector<int> nearest = covariance.NearestViewInProblem();
  const std::size_t points = recording.rest_positions.size();
  std::vector<std::vector<std::size_t>> observations(points);
  std::vector<std::vector<int>> views(points);
  for (std::size_t o = 0; o < recording.observations.size(); ++o) {
    const auto point = static_cast<std::size_t>(recording.observations[o].point_idx);
    observations[point].push_back(o);
    views[point].push_back(nearest[static_cast<std::size_t>(recording.observations[o].view_idx)]);
  }
  covariance.SetUnit(views);

  BundleCovariance result;
  for (const int view : nearest) result.poses.push_back(covariance.PoseOf(static_cast<std::size_t>(view)));
  result.log_distance_sigmas.assign(recording.observations.size(), 0.0);
  for (std::size_t i = 0; i < points; ++i) {
    const std::vector<double> sigmas = covariance.LogDistanceSigmas(i, views[i]);
    for (std::size_t k = 0; k < sigmas.size(); ++k) result.log_distance_sigmas[observations[i][k]] = sigmas[k];
  }
  return result;
}

Result<std::vector<MeasuredResidual>> MeasuredResiduals(const BundleProblem& problem) {
  if (problem.measured_distances().empty()) return std::vector<MeasuredResidual>();
  Covariance covariance(problem);
  if (Status status = covariance.Sample(); !status.ok()) return status;
  return covariance.MeasuredResiduals();
}

}  // namespace pliant
