// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/geometry/triangulation.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "pliant/geometry/decompositions.h"

namespace pliant {
namespace {

// Below this sine of the parallax two unit rays are parallel: what is left is rounding of the rays themselves.
constexpr double kParallelSine = 1e-12;

TriangulatedPoint Rejected(TriangulationStatus status) { return {status, Eigen::Vector3d::Zero()}; }

}  // namespace

TriangulatedPoint TriangulateIdwm(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0,
                                  const Eigen::Vector3d& ray1) {
  const Eigen::Vector3d& t = cam1_from_cam0.translation;
  const Eigen::Vector3d y = cam1_from_cam0.rotation * ray0;
  const double p = y.cross(ray1).norm();
  const double q = y.cross(t).norm();
  const double r = ray1.cross(t).norm();
  if (!std::isfinite(p + q + r)) return Rejected(TriangulationStatus::kInvalidRay);
  // Both rays along the baseline: p is zero too, or the rays oppose each other; q + r guards the weight below.
  if (p < kParallelSine || q + r <= 0.0) return Rejected(TriangulationStatus::kParallel);

  const Eigen::Vector3d foot0 = (r / p) * y;
  const Eigen::Vector3d foot1 = (q / p) * ray1;
  const double chosen = (t + foot0 - foot1).squaredNorm();
  const double others = std::min(
      {(t + foot0 + foot1).squaredNorm(), (t - foot0 - foot1).squaredNorm(), (t - foot0 + foot1).squaredNorm()});
  if (!(chosen < others)) return Rejected(TriangulationStatus::kCheirality);

  const Eigen::Vector3d point_in_cam1 = q / (q + r) * (t + (r / p) * (y + ray1));
  return {TriangulationStatus::kOk, cam1_from_cam0.rotation.conjugate() * (point_in_cam1 - t)};
}

TriangulatedPoint TriangulateMidpoint(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0,
                                      const Eigen::Vector3d& ray1) {
  const Eigen::Vector3d& t = cam1_from_cam0.translation;
  const Eigen::Vector3d y = cam1_from_cam0.rotation * ray0;
  const Eigen::Vector3d normal = y.cross(ray1);
  const double sine_squared = normal.squaredNorm();
  if (!std::isfinite(sine_squared + t.squaredNorm())) return Rejected(TriangulationStatus::kInvalidRay);
  if (sine_squared < kParallelSine * kParallelSine) return Rejected(TriangulationStatus::kParallel);

  // Feet of the common perpendicular of t + s0 y and s1 f1.
  const double s0 = ray1.cross(t).dot(normal) / sine_squared;
  const double s1 = y.cross(t).dot(normal) / sine_squared;
  if (!(s0 > 0.0 && s1 > 0.0)) return Rejected(TriangulationStatus::kCheirality);
  const Eigen::Vector3d point_in_cam1 = 0.5 * (t + s0 * y + s1 * ray1);
  return {TriangulationStatus::kOk, cam1_from_cam0.rotation.conjugate() * (point_in_cam1 - t)};
}

TriangulatedPoint TriangulateLinear(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0,
                                    const Eigen::Vector3d& ray1) {
  const Eigen::Vector3d& t = cam1_from_cam0.translation;
  if (!std::isfinite(ray0.sum() + ray1.sum() + t.sum())) return Rejected(TriangulationStatus::kInvalidRay);
  if ((cam1_from_cam0.rotation * ray0).cross(ray1).norm() < kParallelSine)
    return Rejected(TriangulationStatus::kParallel);
  Eigen::Matrix<double, 6, 4> equations;
  equations << Skew(ray0), Eigen::Vector3d::Zero(), Skew(ray1) * cam1_from_cam0.RotationMatrix(), Skew(ray1) * t;
  const Eigen::Vector4d x = SmallestRightSingularVector(equations);
  if (std::abs(x[3]) < kParallelSine) return Rejected(TriangulationStatus::kParallel);
  const Eigen::Vector3d point_in_cam0 = x.hnormalized();
  if (!(point_in_cam0.dot(ray0) > 0.0 && (cam1_from_cam0 * point_in_cam0).dot(ray1) > 0.0))
    return Rejected(TriangulationStatus::kCheirality);
  return {TriangulationStatus::kOk, point_in_cam0};
}

TriangulatedPoint TriangulateOptimalL2(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0,
                                       const Eigen::Vector3d& ray1) {
  const Eigen::Vector3d y = cam1_from_cam0.rotation * ray0;
  const double baseline = cam1_from_cam0.translation.norm();
  if (!std::isfinite(y.sum() + ray1.sum() + baseline)) return Rejected(TriangulationStatus::kInvalidRay);
  if (!(baseline > 0.0)) return Rejected(TriangulationStatus::kParallel);
  // A plane through the baseline has its normal n in the plane spanned by a and b; the sines are n . y and n . f1.
  const Eigen::Vector3d a = cam1_from_cam0.translation.unitOrthogonal();
  const Eigen::Vector3d b = cam1_from_cam0.translation.cross(a) / baseline;
  const Eigen::Vector2d u(a.dot(y), b.dot(y));
  const Eigen::Vector2d v(a.dot(ray1), b.dot(ray1));
  const Eigen::Matrix2d normal_equations = u * u.transpose() + v * v.transpose();
  const Eigen::Matrix2d eigenvectors = EigenOfSymmetric(normal_equations).vectors;
  const Eigen::Vector3d n = eigenvectors(0, 0) * a + eigenvectors(1, 0) * b;
  const Eigen::Vector3d y_in_plane = (y - n.dot(y) * n).normalized();
  const Eigen::Vector3d f1_in_plane = (ray1 - n.dot(ray1) * n).normalized();
  return TriangulateMidpoint(cam1_from_cam0, cam1_from_cam0.rotation.conjugate() * y_in_plane, f1_in_plane);
}

std::vector<TriangulatedPoint> Triangulate(TriangulationMethod method, const Rigid3& cam1_from_cam0,
                                           std::span<const Eigen::Vector3d> rays0,
                                           std::span<const Eigen::Vector3d> rays1) {
  assert(rays0.size() == rays1.size());
  constexpr std::array kByName = {&TriangulateIdwm, &TriangulateMidpoint, &TriangulateLinear, &TriangulateOptimalL2};
  const auto triangulate = kByName[static_cast<std::size_t>(method)];
  std::vector<TriangulatedPoint> points;
  points.reserve(rays0.size());
  for (std::size_t i = 0; i < rays0.size(); ++i) points.push_back(triangulate(cam1_from_cam0, rays0[i], rays1[i]));
  return points;
}

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double RelativeDepthSigma(double sigma_px, double focal_px, double parallax_rad) {
  const double sine = std::sin(parallax_rad);
  if (!(sine > 0.0)) return std::numeric_limits<double>::infinity();
  return std::sqrt(2.0) * sigma_px / (focal_px * sine);
}

Eigen::Matrix3d PointCovariance(std::span<const Rigid3> cams_from_world, const Eigen::Vector3d& point_in_world,
                                double sigma_rad) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const Rigid3& cam_from_world : cams_from_world) {
    // The ray from the camera to the point, given in the world frame: R' f.
    const Eigen::Vector3d x = point_in_world - cam_from_world.OriginInSource();
    const double distance_squared = x.squaredNorm();
    information += (Eigen::Matrix3d::Identity() - x * x.transpose() / distance_squared) /
                   (sigma_rad * sigma_rad * distance_squared);
  }
  const auto [eigenvalues, eigenvectors] = EigenOfSymmetric(information);
  if (!(eigenvalues[0] > kParallelSine * kParallelSine * eigenvalues[2]) || !std::isfinite(eigenvalues[2]))
    return Eigen::Matrix3d::Constant(std::numeric_limits<double>::infinity());
  return eigenvectors * eigenvalues.cwiseInverse().asDiagonal() * eigenvectors.transpose();
}

double DepthSigma(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& point_in_world) {
  if (!covariance.allFinite()) return std::numeric_limits<double>::infinity();
  const Eigen::Vector3d direction = point_in_world.normalized();
  return std::sqrt(direction.dot(covariance * direction));
}

}  // namespace pliant
