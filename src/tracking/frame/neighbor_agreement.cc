// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/frame/neighbor_agreement.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "pliant/base/parallel.h"
#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr double kTukey = 4.685;  // 95 % efficiency under normal noise

// displacement(anchor) = offset + gradient * (anchor - center), with weights of how far each neighbor is to be
// trusted.
struct AffineMotion {
  Eigen::Vector3d center;
  Eigen::Matrix<double, 4, 3> coefficients;

  Eigen::Vector3d At(const Eigen::Vector3d& anchor) const {
    const Eigen::Vector4d basis(1, anchor.x() - center.x(), anchor.y() - center.y(), anchor.z() - center.z());
    return coefficients.transpose() * basis;
  }
};

// One serves many points in turn, and keeps its memory.
class MotionFit {
 public:
  void Take(std::span<const NeighborMotion> motions, const std::vector<int>& neighbors) {
    anchors_.clear();
    displacements_.clear();
    for (const int j : neighbors) {
      anchors_.push_back(motions[j].anchor);
      displacements_.emplace_back(motions[j].position - motions[j].anchor);
    }
    weights_.assign(anchors_.size(), 1.0);
  }

  // Weights from the distance to the median displacement, then two rounds of weighted least squares.
  AffineMotion Run(const Eigen::Vector3d& center) {
    Eigen::Vector3d median;
    for (int axis = 0; axis < 3; ++axis) {
      values_.clear();
      for (const Eigen::Vector3d& displacement : displacements_) values_.push_back(displacement[axis]);
      median[axis] = MedianInPlace(values_);
    }
    Reweigh([&](std::size_t k) { return (displacements_[k] - median).norm(); });
    AffineMotion motion = Solve(center);
    Reweigh([&](std::size_t k) { return (displacements_[k] - motion.At(anchors_[k])).norm(); });
    return Solve(center);
  }

  // Robust spread of the neighbors' residuals across the viewing ray.
  double Sigma(const AffineMotion& motion, const Eigen::Vector3d& ray) {
    values_.clear();
    for (std::size_t k = 0; k < anchors_.size(); ++k)
      values_.push_back((displacements_[k] - motion.At(anchors_[k])).cross(ray).norm());
    return kMedianToSigma * MedianInPlace(values_);
  }

 private:
  template <class Distance>
  void Reweigh(const Distance& distance) {
    residuals_.clear();
    for (std::size_t k = 0; k < anchors_.size(); ++k) residuals_.push_back(distance(k));
    values_ = residuals_;
    // Never so tight that rounding decides: at least a micrometer.
    const double cutoff = kTukey * std::max(1e-3, kMedianToSigma * MedianInPlace(values_));
    for (std::size_t k = 0; k < residuals_.size(); ++k) {
      const double ratio = residuals_[k] / cutoff;
      weights_[k] = ratio < 1 ? (1 - ratio * ratio) * (1 - ratio * ratio) : 0.0;
    }
  }

  AffineMotion Solve(const Eigen::Vector3d& center) const {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
    double spread = 0;
    for (std::size_t k = 0; k < anchors_.size(); ++k) {
      const Eigen::Vector3d offset = anchors_[k] - center;
      const Eigen::Vector4d basis(1, offset.x(), offset.y(), offset.z());
      normal += weights_[k] * basis * basis.transpose();
      right += weights_[k] * basis * displacements_[k].transpose();
      spread += weights_[k] * offset.squaredNorm();
    }
    // The neighbors lie on a surface: across it the gradient is not observed, and stays small.
    normal.diagonal().tail<3>().array() += 0.01 * spread / 3 + 1e-12;
    normal(0, 0) += 1e-12;
    return {center, normal.ldlt().solve(right)};
  }

  std::vector<Eigen::Vector3d> anchors_;
  std::vector<Eigen::Vector3d> displacements_;
  std::vector<double> weights_;
  std::vector<double> residuals_;
  std::vector<double> values_;  // whose median is asked: their order is lost
};

}  // namespace

void AgreementOptions::List(OptionTable& table) {
  table.Add("max_disagreement_px", &max_disagreement_px, "px",
            "a point further than this from where its neighbors' motion puts it is dropped", 0.1, 1e6);
  table.Add("max_disagreement_sigmas", &max_disagreement_sigmas, "-",
            "and further than this many robust spreads of its neighbors", 0, 1e6);
  table.Add("min_agreement_neighbors", &min_neighbors, "-", "no statement about points with fewer neighbors", 4, 100);
}

std::vector<Disagreement> MeasureDisagreement(std::span<const NeighborMotion> motions,
                                              std::span<const std::vector<int>> neighbors,
                                              const Eigen::Vector3d& camera_center, int threads) {
  std::vector<Disagreement> disagreements(motions.size());
  ParallelFor(static_cast<int>(motions.size()), threads, [&](int point) {
    const auto i = static_cast<std::size_t>(point);
    if (neighbors[i].size() < 4) return;
    thread_local MotionFit fit;
    fit.Take(motions, neighbors[i]);
    const AffineMotion motion = fit.Run(motions[i].anchor);
    const Eigen::Vector3d ray = (motions[i].position - camera_center).normalized();
    const Eigen::Vector3d predicted = motions[i].anchor + motion.At(motions[i].anchor);
    disagreements[i].distance_mm = (motions[i].position - predicted).cross(ray).norm();
    disagreements[i].sigma_mm = fit.Sigma(motion, ray);
    disagreements[i].neighbors = static_cast<int>(neighbors[i].size());
  });
  return disagreements;
}

bool Contradicts(const Disagreement& disagreement, double px_per_mm, const AgreementOptions& options) {
  return disagreement.neighbors >= options.min_neighbors &&
         disagreement.distance_mm * px_per_mm > options.max_disagreement_px &&
         disagreement.distance_mm > options.max_disagreement_sigmas * disagreement.sigma_mm;
}

}  // namespace pliant
