// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/rest_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "pliant/base/parallel.h"
#include "pliant/base/statistics.h"
#include "pliant/deformation/graph.h"
#include "surface/sparse_surface.h"

namespace pliant {
namespace {

constexpr std::array kNeighborCounts = {8, 12, 16};
constexpr double kAffineDamping = 0.03;  // of the affine part, by the neighbors' own spread
constexpr double kCauchy = 3.0;          // of the residuals by their median
constexpr int kInversions = 3;
constexpr double kMinWeight = 1e-3;

// Of the neighbors, nearest first: 1 near the query, 0 at the last one, so that the result has no steps where it
// changes.
std::vector<double> WeightsOf(std::span<const Eigen::Vector3d> rest, const std::vector<int>& neighbors,
                              const Eigen::Vector3d& query) {
  const double reach = (rest[static_cast<std::size_t>(neighbors.back())] - query).squaredNorm();
  std::vector<double> weights;
  for (const int k : neighbors) {
    const double share = (rest[static_cast<std::size_t>(k)] - query).squaredNorm() / std::max(reach, 1e-30);
    weights.push_back(std::max(kMinWeight, std::pow(1.0 - share, 2)));
  }
  return weights;
}

// An affine motion: the displacement at `center + offset` is `mean + affine * offset`.
struct AffineMotion {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d affine = Eigen::Matrix3d::Zero();
  double radius = 0;  // of the points that it was fitted to

  // Beyond these the motion goes on as it is at their edge.
  Eigen::Vector3d At(const Eigen::Vector3d& position) const {
    Eigen::Vector3d offset = position - center;
    const double distance = offset.norm();
    if (distance > radius) offset *= radius / distance;
    return mean + affine * offset;
  }
};

AffineMotion FitAffine(std::span<const Eigen::Vector3d> rest, std::span<const Eigen::Vector3d> displacements,
                       const std::vector<int>& neighbors, const std::vector<double>& weights) {
  AffineMotion motion;
  double sum = 0.0;
  for (std::size_t n = 0; n < neighbors.size(); ++n) {
    const auto k = static_cast<std::size_t>(neighbors[n]);
    sum += weights[n];
    motion.center += weights[n] * rest[k];
    motion.mean += weights[n] * displacements[k];
  }
  motion.center /= sum;
  motion.mean /= sum;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  for (std::size_t n = 0; n < neighbors.size(); ++n) {
    const auto k = static_cast<std::size_t>(neighbors[n]);
    const Eigen::Vector3d offset = rest[k] - motion.center;
    spread += weights[n] * offset * offset.transpose();
    cross += weights[n] * (displacements[k] - motion.mean) * offset.transpose();
  }
  const double trace = spread.trace();
  if (!(trace > 0.0)) return motion;
  spread += kAffineDamping * trace * Eigen::Matrix3d::Identity();
  motion.affine = spread.ldlt().solve(cross.transpose()).transpose();
  motion.radius = std::sqrt(2.0 * trace / sum);
  return motion;
}

// Twice, so that wrong tracks, which move as no other, count little.
Eigen::Vector3d DisplacementAt(std::span<const Eigen::Vector3d> rest, std::span<const Eigen::Vector3d> displacements,
                               const std::vector<int>& neighbors, const Eigen::Vector3d& query) {
  std::vector<double> weights = WeightsOf(rest, neighbors, query);
  const AffineMotion first = FitAffine(rest, displacements, neighbors, weights);
  std::vector<double> residuals;
  for (const int n : neighbors) {
    const auto k = static_cast<std::size_t>(n);
    residuals.push_back((displacements[k] - first.At(rest[k])).norm());
  }
  const double scale = kCauchy * Median(residuals);
  if (!(scale > 0.0)) return first.At(query);
  for (std::size_t n = 0; n < weights.size(); ++n) weights[n] /= 1.0 + std::pow(residuals[n] / scale, 2);
  return FitAffine(rest, displacements, neighbors, weights).At(query);
}

}  // namespace

std::optional<RestMotion> RestMotion::Create(const RestPositions& rest,
                                             std::span<const PointObservation> observations) {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3d> displacements;
  for (const PointObservation& observation : observations) {
    const auto known = rest.find(observation.id);
    if (known == rest.end()) continue;
    positions.push_back(known->second);
    displacements.push_back(observation.position - known->second);
  }
  if (positions.size() < kMinPoints) return std::nullopt;
  RestMotion motion(std::move(positions), std::move(displacements));
  // Few neighbors follow a rough motion, many average what is wrong of each.
  int best = kNeighborCounts.front();
  motion.error_ = std::numeric_limits<double>::max();
  for (const int count : kNeighborCounts) {
    motion.neighbors_ = count;
    const double error = motion.HeldOutError();
    if (error >= motion.error_) continue;
    motion.error_ = error;
    best = count;
  }
  motion.neighbors_ = best;
  return motion;
}

std::vector<Eigen::Vector3d> RestMotion::Displacements(std::span<const Eigen::Vector3d> rest, int threads) const {
  const NeighborLists neighbors = NearestNeighbors(rest_, rest, neighbors_);
  std::vector<Eigen::Vector3d> result(rest.size());
  ParallelFor(static_cast<int>(rest.size()), threads, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    result[k] = DisplacementAt(rest_, displacements_, neighbors[k], rest[k]);
  });
  return result;
}

std::vector<Eigen::Vector3d> RestMotion::Undeformed(std::span<const Eigen::Vector3d> now, int threads) const {
  std::vector<Eigen::Vector3d> moved;
  std::vector<Eigen::Vector3d> back;
  for (std::size_t k = 0; k < rest_.size(); ++k) {
    moved.push_back(rest_[k] + displacements_[k]);
    back.push_back(-displacements_[k]);
  }
  RestMotion inverse(std::move(moved), std::move(back));
  inverse.neighbors_ = neighbors_;
  std::vector<Eigen::Vector3d> result = inverse.Displacements(now, threads);
  for (std::size_t i = 0; i < now.size(); ++i) result[i] += now[i];
  for (int n = 0; n < kInversions; ++n) {
    const std::vector<Eigen::Vector3d> displacements = Displacements(result, threads);
    for (std::size_t i = 0; i < now.size(); ++i) result[i] = now[i] - displacements[i];
  }
  return result;
}

double RestMotion::HeldOutError() const {
  const NeighborLists neighbors = NearestNeighbors(rest_, neighbors_);
  std::vector<double> errors;
  for (std::size_t k = 0; k < rest_.size(); ++k)
    errors.push_back((DisplacementAt(rest_, displacements_, neighbors[k], rest_[k]) - displacements_[k]).norm());
  return Median(std::move(errors));
}

}  // namespace pliant
