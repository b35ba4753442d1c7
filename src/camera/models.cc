// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/camera/models.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "camera/roots.h"

namespace pliant {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kLargestTheta = std::numbers::pi - 1e-3;
constexpr int kMaxNewtonSteps = 60;

void Normalize(double x, double y, double z, double ray[3]) {
  const double norm = std::sqrt(x * x + y * y + z * z);
  ray[0] = x / norm;
  ray[1] = y / norm;
  ray[2] = z / norm;
}

}  // namespace

// With |p| the length of (p1, p2), in the frame whose first axis is the point's direction and at angle a from (p2, p1),
// the distortion's Jacobian is
//   [lr + 6 r|p| cos a,  2 r|p| sin a;  2 r|p| sin a,  lt + 2 r|p| cos a],  lr = 1 + 3 k1 r^2 + 5 k2 r^4,
//                                                                          lt = 1 +   k1 r^2 +   k2 r^4.
// It is positive definite for every a when lr > 6 r|p| and lt > 4 r|p|; the first bound is reached exactly at a = pi.
template <int kFocals, int kDistortions>
PerspectiveModel<kFocals, kDistortions>::PerspectiveModel(const Params& params) : params_(params) {
  if constexpr (kDistortions > 0) {
    const double p = std::hypot(p1(), p2());
    const std::array<double, 5> along = {1.0, -6.0 * p, 3.0 * k1(), 0.0, 5.0 * k2()};
    const std::array<double, 5> across = {1.0, -4.0 * p, k1(), 0.0, k2()};
    for (const auto& coefficients : {along, across})
      if (const auto root = FirstRoot(coefficients, kLargestRadius)) max_radius_ = std::min(max_radius_, *root);
    max_radius_sq_ = max_radius_ * max_radius_;
  }
}

template <int kFocals, int kDistortions>
bool PerspectiveModel<kFocals, kDistortions>::Undistort(double xd, double yd, double* x, double* y) const {
  const double rd = std::hypot(xd, yd);
  if (!(rd < std::numeric_limits<double>::max())) return false;
  const auto radial = [&](double r, double* derivative) {
    const double r2 = r * r;
    *derivative = 1.0 + r2 * (3.0 * k1() + 5.0 * r2 * k2());
    return r * (1.0 + r2 * (k1() + r2 * k2()));
  };
  double derivative = 0;
  const double target = kDistortions == 4 ? std::min(rd, 0.999 * radial(max_radius_, &derivative)) : rd;
  const auto r = InvertGrowing(radial, target, max_radius_);
  if (!r) return false;
  *x = rd > 0.0 ? xd * (*r / rd) : 0.0;
  *y = rd > 0.0 ? yd * (*r / rd) : 0.0;
  if constexpr (kDistortions < 4) return true;

  // Newton's method from the solution without tangential terms; its steps always point downhill in the residual, and
  // are halved until they go there and stay on the disc.
  const double tolerance = 8.0 * kEpsilon * (1.0 + rd);
  double distorted[2];
  double d[3];
  Distort(*x, *y, distorted, d);
  double residual = std::hypot(distorted[0] - xd, distorted[1] - yd);
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    const double det = d[0] * d[2] - d[1] * d[1];
    const double ex = distorted[0] - xd;
    const double ey = distorted[1] - yd;
    const double dx = -(d[2] * ex - d[1] * ey) / det;
    const double dy = -(d[0] * ey - d[1] * ex) / det;
    bool moved = false;
    for (double length = 1.0; length > 1e-6 && !moved; length *= 0.5) {
      const double next_x = *x + length * dx;
      const double next_y = *y + length * dy;
      if (!(next_x * next_x + next_y * next_y < max_radius_sq_)) continue;
      Distort(next_x, next_y, distorted, d);
      const double next_residual = std::hypot(distorted[0] - xd, distorted[1] - yd);
      if (!(next_residual < residual)) continue;
      *x = next_x;
      *y = next_y;
      residual = next_residual;
      moved = true;
    }
    if (!moved || residual == 0.0) break;  // rounding is reached, or the disc's edge
  }
  return residual <= tolerance && *x * *x + *y * *y < max_radius_sq_;
}

template <int kFocals, int kDistortions>
bool PerspectiveModel<kFocals, kDistortions>::Unproject(const double pixel[2], double ray[3]) const {
  const double xd = (pixel[0] - cx()) / fx();
  const double yd = (pixel[1] - cy()) / fy();
  double x = xd;
  double y = yd;
  if constexpr (kDistortions > 0) {
    if (!Undistort(xd, yd, &x, &y)) return false;
  }
  if (!(x * x + y * y < max_radius_sq_)) return false;
  Normalize(x, y, 1.0, ray);
  return true;
}

template class PerspectiveModel<1, 0>;
template class PerspectiveModel<2, 0>;
template class PerspectiveModel<1, 1>;
template class PerspectiveModel<1, 2>;
template class PerspectiveModel<2, 4>;

OpenCvFisheye::OpenCvFisheye(const Params& params) : params_(params), max_theta_(kLargestTheta) {
  // d theta_d / d theta, a polynomial in theta^2.
  const std::array<double, 5> polynomial = {1.0, 3.0 * params[4], 5.0 * params[5], 7.0 * params[6], 9.0 * params[7]};
  if (const auto root = FirstRoot(polynomial, kLargestTheta * kLargestTheta)) max_theta_ = std::sqrt(*root);
  double derivative = 0;
  max_theta_d_ = DistortedAngle(max_theta_, &derivative);
}

double OpenCvFisheye::DistortedAngle(double theta, double* derivative) const {
  const double t2 = theta * theta;
  const auto [k1, k2, k3, k4] = std::array{params_[4], params_[5], params_[6], params_[7]};
  *derivative = 1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4)));
  return theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))));
}

bool OpenCvFisheye::ProjectWithJacobian(const double point[3], double pixel[2], double jacobian[6]) const {
  const double x = point[0];
  const double y = point[1];
  const double z = point[2];
  const double r2 = x * x + y * y;
  const double z2 = z * z;
  const double norm2 = r2 + z2;
  if (!(norm2 > 0.0 && norm2 < std::numeric_limits<double>::max())) return false;
  double scale = 0;    // theta_d / r
  double scale_r = 0;  // its derivative by r, divided by r
  double scale_z = 0;  // its derivative by z
  if (z > 0.0 && r2 < kNearAxis * z2) {
    const double c = params_[4] - 1.0 / 3.0;
    const double u = r2 / z2;
    scale = (1.0 + c * u) / z;
    scale_r = 2.0 * c / (z * z2);
    scale_z = -(1.0 + 3.0 * c * u) / z2;
  } else {
    const double r = std::sqrt(r2);
    const double theta = std::atan2(r, z);
    if (!(theta < max_theta_)) return false;
    double derivative = 0;
    scale = DistortedAngle(theta, &derivative) / r;
    scale_r = (derivative * z / norm2 - scale) / r2;
    scale_z = -derivative / norm2;
  }
  pixel[0] = fx() * (scale * x) + cx();
  pixel[1] = fy() * (scale * y) + cy();
  jacobian[0] = fx() * (scale + x * x * scale_r);
  jacobian[1] = fx() * (x * y * scale_r);
  jacobian[2] = fx() * (x * scale_z);
  jacobian[3] = fy() * (x * y * scale_r);
  jacobian[4] = fy() * (scale + y * y * scale_r);
  jacobian[5] = fy() * (y * scale_z);
  return true;
}

bool OpenCvFisheye::Unproject(const double pixel[2], double ray[3]) const {
  const double xd = (pixel[0] - cx()) / fx();
  const double yd = (pixel[1] - cy()) / fy();
  const double theta_d = std::hypot(xd, yd);
  if (!(theta_d < max_theta_d_)) return false;
  const auto theta = InvertGrowing([&](double angle, double* derivative) { return DistortedAngle(angle, derivative); },
                                   theta_d, max_theta_);
  if (!theta) return false;
  // sin(theta) / theta_d tends to 1 at the axis.
  const double sine = theta_d > 0.0 ? std::sin(*theta) / theta_d : 1.0;
  Normalize(xd * sine, yd * sine, std::cos(*theta), ray);
  return true;
}

}  // namespace pliant
