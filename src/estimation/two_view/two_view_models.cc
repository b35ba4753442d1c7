// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/two_view/two_view_models.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <Eigen/QR>

#include "pliant/base/statistics.h"
#include "pliant/geometry/decompositions.h"
#include "pliant/geometry/triangulation.h"

namespace pliant {
namespace {

using Rays = std::span<const Eigen::Vector3d>;

Status CheckCounts(Rays rays0, Rays rays1, std::size_t least) {
  if (rays0.size() != rays1.size())
    return {ErrorCode::kInvalidArgument, "the two views to compare have different numbers of rays"};
  if (rays0.size() < least)
    return {ErrorCode::kInsufficient, "fitting this model takes at least " + std::to_string(least) +
                                          " correspondences; there are " + std::to_string(rays0.size())};
  return Status::Ok();
}

// Wahba's problem: the rotation that maximizes sum_i w_i f1_i . (R f0_i).
Eigen::Quaterniond BestRotation(Rays rays0, Rays rays1, const std::vector<double>& weights) {
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < rays0.size(); ++i) correlation += weights[i] * rays1[i] * rays0[i].transpose();
  const Svd3 svd = SvdOf(correlation);
  const double sign = (svd.u * svd.v.transpose()).determinant() < 0 ? -1.0 : 1.0;
  return Eigen::Quaterniond(Eigen::Matrix3d(svd.u * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.v.transpose()))
      .normalized();
}

// The rows f1 x (H f0) = 0 add to the normal equations of H, its rows stacked.
void AddHomographyRows(const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1,
                       Eigen::Matrix<double, 9, 9>* normal_equations) {
  Eigen::Matrix<double, 3, 9> rows;
  const Eigen::Matrix3d cross = Skew(ray1);
  for (int k = 0; k < 3; ++k) rows.middleCols<3>(3 * k) = cross.col(k) * ray0.transpose();
  normal_equations->noalias() += rows.transpose() * rows;
}

Eigen::Matrix3d FromStackedRows(const Eigen::Matrix<double, 9, 1>& h) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data());
}

// The homography through four correspondences: the null space of eight rows, by QR of their transpose.
std::optional<Eigen::Matrix3d> HomographyThroughFour(Rays rays0, Rays rays1, const std::array<std::size_t, 4>& sample) {
  Eigen::Matrix<double, 9, 8> rows;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d& f0 = rays0[sample[static_cast<std::size_t>(k)]];
    const Eigen::Vector3d& f1 = rays1[sample[static_cast<std::size_t>(k)]];
    // Two directions across f1: f1 ~ H f0 exactly when both are normal to H f0.
    const Eigen::Vector3d a = f1.unitOrthogonal();
    const Eigen::Vector3d b = f1.cross(a);
    for (int r = 0; r < 3; ++r) {
      rows.col(2 * k).segment<3>(3 * r) = a[r] * f0;
      rows.col(2 * k + 1).segment<3>(3 * r) = b[r] * f0;
    }
  }
  const Eigen::HouseholderQR<Eigen::Matrix<double, 9, 8>> qr(rows);
  Eigen::Matrix<double, 9, 1> last = Eigen::Matrix<double, 9, 1>::Unit(8);
  const Eigen::Matrix<double, 9, 1> h = qr.householderQ() * last;
  if (!h.allFinite()) return std::nullopt;
  return FromStackedRows(h);
}

// Angle between H f0 and f1 below the threshold given as its sine; the sign of H is free here.
bool Carries(const Eigen::Matrix3d& homography, const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1,
             double max_sine) {
  const Eigen::Vector3d carried = homography * ray0;
  return carried.cross(ray1).squaredNorm() <= max_sine * max_sine * carried.squaredNorm();
}

HomographyFit Score(const Eigen::Matrix3d& homography, Rays rays0, Rays rays1, double max_sine) {
  HomographyFit fit;
  fit.cam1_from_cam0 = homography;
  fit.inliers.resize(rays0.size());
  for (std::size_t i = 0; i < rays0.size(); ++i) {
    fit.inliers[i] = Carries(homography, rays0[i], rays1[i], max_sine) ? 1 : 0;
    fit.num_inliers += fit.inliers[i];
  }
  return fit;
}

Eigen::Matrix3d LeastSquaresHomography(Rays rays0, Rays rays1, const std::vector<char>& inliers) {
  Eigen::Matrix<double, 9, 9> normal_equations = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < rays0.size(); ++i)
    if (inliers[i] != 0) AddHomographyRows(rays0[i], rays1[i], &normal_equations);
  return FromStackedRows(EigenOfSymmetric(normal_equations).vectors.col(0));
}

// H is known up to scale and sign: middle singular value 1, and rays carried forwards, not backwards.
Eigen::Matrix3d Normalized(const Eigen::Matrix3d& homography, Rays rays0, Rays rays1) {
  const double middle = SvdOf(homography).singular_values[1];
  int forwards = 0;
  for (std::size_t i = 0; i < rays0.size(); ++i) forwards += (homography * rays0[i]).dot(rays1[i]) > 0 ? 1 : -1;
  return (forwards >= 0 ? 1.0 : -1.0) / std::max(middle, std::numeric_limits<double>::min()) * homography;
}

}  // namespace

Result<RotationFit> FitRotation(Rays rays0, Rays rays1, double focal_px, double max_error_px) {
  if (Status status = CheckCounts(rays0, rays1, 3); !status.ok()) return status;
  constexpr int kMaxRounds = 20;
  constexpr double kAtRestRad = 1e-9;
  std::vector<double> weights(rays0.size(), 1.0);
  std::vector<double> errors_px(rays0.size());
  RotationFit fit;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Eigen::Quaterniond rotation = BestRotation(rays0, rays1, weights);
    const double change = RotationAngle(rotation * fit.cam1_from_cam0.conjugate());
    fit.cam1_from_cam0 = rotation;
    for (std::size_t i = 0; i < rays0.size(); ++i)
      errors_px[i] = focal_px * AngleBetween(rotation * rays0[i], rays1[i]);
    if (round > 0 && change < kAtRestRad) break;
    // A loss no tighter than the fit itself: outliers lose their hold without the start having to be good.
    const double scale = std::max(max_error_px, Median(errors_px));
    for (std::size_t i = 0; i < rays0.size(); ++i) weights[i] = 1.0 / (1.0 + std::pow(errors_px[i] / scale, 2));
  }
  fit.median_error_px = Median(errors_px);
  fit.median_error_rad = fit.median_error_px / focal_px;
  fit.num_inliers = static_cast<int>(
      std::count_if(errors_px.begin(), errors_px.end(), [&](double error) { return error <= max_error_px; }));
  return fit;
}

Result<HomographyFit> FitHomography(Rays rays0, Rays rays1, double focal_px, double max_error_px, Random random) {
  if (Status status = CheckCounts(rays0, rays1, 4); !status.ok()) return status;
  constexpr int kMaxSamples = 200;
  constexpr double kConfidence = 0.999;
  constexpr int kPolishRounds = 3;
  const double max_sine = std::sin(std::atan(max_error_px / focal_px));
  HomographyFit best;
  double needed = kMaxSamples;
  for (int k = 0; k < kMaxSamples && k < needed; ++k) {
    std::array<std::size_t, 4> sample{};
    for (std::size_t& index : sample) index = static_cast<std::size_t>(random.Index(static_cast<int>(rays0.size())));
    const auto homography = HomographyThroughFour(rays0, rays1, sample);
    if (!homography) continue;
    HomographyFit candidate = Score(*homography, rays0, rays1, max_sine);
    if (candidate.num_inliers <= best.num_inliers) continue;
    best = std::move(candidate);
    const double clean = std::pow(static_cast<double>(best.num_inliers) / static_cast<double>(rays0.size()), 4);
    needed = clean < 1.0 ? std::log(1.0 - kConfidence) / std::log(1.0 - clean) : 1.0;
  }
  for (int round = 0; round < kPolishRounds && best.num_inliers >= 4; ++round) {
    HomographyFit polished = Score(LeastSquaresHomography(rays0, rays1, best.inliers), rays0, rays1, max_sine);
    if (polished.num_inliers < best.num_inliers) break;
    best = std::move(polished);
  }
  best.cam1_from_cam0 = Normalized(best.cam1_from_cam0, rays0, rays1);
  return best;
}

std::vector<Rigid3> MotionsFromHomography(const Eigen::Matrix3d& homography, Rays rays0) {
  // H'H = V diag(s1^2, 1, s3^2) V': the two planes through v2 whose lengths H keeps hold t's image (Ma, Soatto,
  // Kosecka, Sastry, "An Invitation to 3-D Vision", 5.3.3).
  constexpr double kMinStretch = 1e-9;  // s1^2 - s3^2 of a rotation
  const Svd3 svd = SvdOf(homography);
  const Eigen::Vector3d squares = (svd.singular_values / svd.singular_values[1]).array().square();
  const Eigen::Matrix3d h = homography / svd.singular_values[1];
  std::vector<Rigid3> motions;
  if (!squares.allFinite() || squares[0] - squares[2] < kMinStretch) return motions;

  const Eigen::Matrix3d& v = svd.v;
  const double a = std::sqrt(std::max(0.0, 1.0 - squares[2]) / (squares[0] - squares[2]));
  const double b = std::sqrt(std::max(0.0, squares[0] - 1.0) / (squares[0] - squares[2]));
  for (const double sign : {1.0, -1.0}) {
    const Eigen::Vector3d u = a * v.col(0) + sign * b * v.col(2);
    Eigen::Matrix3d from;
    Eigen::Matrix3d to;
    from << v.col(1), u, v.col(1).cross(u);
    to << h * v.col(1), h * u, (h * v.col(1)).cross(h * u);
    const Eigen::Quaterniond rotation(Eigen::Matrix3d(to * from.transpose()));
    Eigen::Vector3d normal = v.col(1).cross(u);
    Eigen::Vector3d translation = (h - rotation.toRotationMatrix()) * normal;
    if (!(translation.norm() > kMinStretch)) continue;
    // (t, n) and (-t, -n) are one motion's two signs: the plane has to lie in front, n . f0 > 0.
    int front = 0;
    for (const Eigen::Vector3d& ray : rays0) front += normal.dot(ray) > 0 ? 1 : -1;
    if (front == 0) continue;
    if (front < 0) translation = -translation;
    motions.emplace_back(rotation, translation.normalized());
  }
  return motions;
}

}  // namespace pliant
