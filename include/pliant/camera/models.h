// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The camera models, as values that a solver's loop can be compiled for (Camera::Visit hands out the concrete one).
// Frame: x right, y down, z forward; pixel (0, 0) is the center of the first pixel; lengths in any unit.
//
// Perspective models, with x = X/Z, y = Y/Z, r^2 = x^2 + y^2 (Brown, Photogrammetric Engineering 1966):
//   xd = x (1 + k1 r^2 + k2 r^4) + 2 p1 x y + p2 (r^2 + 2 x^2)      u = fx xd + cx
//   yd = y (1 + k1 r^2 + k2 r^4) + 2 p2 x y + p1 (r^2 + 2 y^2)      v = fy yd + cy
// Domain: Z > 0 and r below the radius at which the distortion first stops growing in some direction. On that disc the
// distortion's Jacobian is symmetric and positive definite, so no two rays share a pixel.
// Fisheye (Kannala and Brandt, PAMI 2006), with theta the angle to the optical axis:
//   theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)   along the point's direction in the image.
// Domain: theta below the angle at which theta_d stops growing; points beside and behind the camera are seen.
//
// Every model has the same members: kName, kParamNames, kNumParams, params() and
//   template <class T> bool Project(const T point[3], T pixel[2]) const;
//   bool ProjectWithJacobian(const double point[3], double pixel[2], double jacobian[6]) const;
//   bool Unproject(const double pixel[2], double ray[3]) const;
// T is double or a type of automatic derivatives, the Jacobian is 2x3 row-major, rays have unit length.
// They answer false, and write nothing that may be used, outside of the domain and for what is not a number. Unproject
// is exact to rounding or false: never an approximation.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string_view>

namespace pliant {

template <int kFocals, int kDistortions>  // kFocals: 1 (f) or 2 (fx, fy); kDistortions: 0, 1 (k1), 2 (k1, k2) or 4
class PerspectiveModel {
 public:
  static constexpr int kNumParams = kFocals + 2 + kDistortions;
  using Params = std::array<double, kNumParams>;

  explicit PerspectiveModel(const Params& params);

  const Params& params() const { return params_; }
  double fx() const { return params_[0]; }
  double fy() const { return params_[kFocals - 1]; }
  double cx() const { return params_[kFocals]; }
  double cy() const { return params_[kFocals + 1]; }
  // The domain's bound on r, computed once; at most kLargestRadius, where a ray is perpendicular to the axis within
  // 1e-8 rad.
  double max_radius() const { return max_radius_; }

  template <class T>
  bool Project(const T point[3], T pixel[2]) const {
    if (!(point[2] > 0.0)) return false;
    const T x = point[0] / point[2];
    const T y = point[1] / point[2];
    const T r2 = x * x + y * y;
    if (!(r2 < max_radius_sq_)) return false;
    ProjectNormalized(params_.data(), x, y, r2, pixel);
    return true;
  }

  // The formula for parameters of type P that are being estimated: in front of the camera, without the domain's bound
  // on r, which depends on them.
  template <class P, class T>
  static bool ProjectUnbounded(const P* params, const T point[3], T pixel[2]) {
    if (!(point[2] > 0.0)) return false;
    const T x = point[0] / point[2];
    const T y = point[1] / point[2];
    ProjectNormalized(params, x, y, x * x + y * y, pixel);
    return true;
  }

  bool ProjectWithJacobian(const double point[3], double pixel[2], double jacobian[6]) const {
    if (!(point[2] > 0.0)) return false;
    const double inverse_z = 1.0 / point[2];
    const double x = point[0] * inverse_z;
    const double y = point[1] * inverse_z;
    const double r2 = x * x + y * y;
    if (!(r2 < max_radius_sq_)) return false;
    double distorted[2];
    double d[3];
    Distort(x, y, distorted, d);
    pixel[0] = fx() * distorted[0] + cx();
    pixel[1] = fy() * distorted[1] + cy();
    const double sx = fx() * inverse_z;
    const double sy = fy() * inverse_z;
    jacobian[0] = sx * d[0];
    jacobian[1] = sx * d[1];
    jacobian[2] = -sx * (d[0] * x + d[1] * y);
    jacobian[3] = sy * d[1];
    jacobian[4] = sy * d[2];
    jacobian[5] = -sy * (d[1] * x + d[2] * y);
    return true;
  }

  bool Unproject(const double pixel[2], double ray[3]) const;

 private:
  static constexpr double kLargestRadius = 1e8;

  template <class P, class T>
  static void ProjectNormalized(const P* params, const T& x, const T& y, const T& r2, T pixel[2]) {
    const P& fx = params[0];
    const P& fy = params[kFocals - 1];
    const P& cx = params[kFocals];
    const P& cy = params[kFocals + 1];
    if constexpr (kDistortions == 0) {
      pixel[0] = fx * x + cx;
      pixel[1] = fy * y + cy;
    } else {
      const P* const k = params + kFocals + 2;
      T radial;
      if constexpr (kDistortions == 1) {
        radial = 1.0 + r2 * k[0];
      } else {
        radial = 1.0 + r2 * (k[0] + r2 * k[1]);
      }
      T xd = x * radial;
      T yd = y * radial;
      if constexpr (kDistortions == 4) {
        xd += 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x);
        yd += 2.0 * k[3] * x * y + k[2] * (r2 + 2.0 * y * y);
      }
      pixel[0] = fx * xd + cx;
      pixel[1] = fy * yd + cy;
    }
  }

  double Distortion(int idx) const { return idx < kDistortions ? params_[kFocals + 2 + idx] : 0.0; }
  double k1() const { return Distortion(0); }
  double k2() const { return Distortion(1); }
  double p1() const { return Distortion(2); }
  double p2() const { return Distortion(3); }

  // The distorted point and the distortion's Jacobian, symmetric: [d[0] d[1]; d[1] d[2]].
  void Distort(double x, double y, double distorted[2], double d[3]) const {
    const double r2 = x * x + y * y;
    const double radial = 1.0 + r2 * (k1() + r2 * k2());
    const double twice_slope = 2.0 * k1() + 4.0 * k2() * r2;
    distorted[0] = x * radial;
    distorted[1] = y * radial;
    d[0] = radial + x * x * twice_slope;
    d[1] = x * y * twice_slope;
    d[2] = radial + y * y * twice_slope;
    if constexpr (kDistortions == 4) {
      distorted[0] += 2.0 * p1() * x * y + p2() * (r2 + 2.0 * x * x);
      distorted[1] += 2.0 * p2() * x * y + p1() * (r2 + 2.0 * y * y);
      d[0] += 2.0 * p1() * y + 6.0 * p2() * x;
      d[1] += 2.0 * p1() * x + 2.0 * p2() * y;
      d[2] += 6.0 * p1() * y + 2.0 * p2() * x;
    }
  }
  bool Undistort(double xd, double yd, double* x, double* y) const;

  Params params_;
  double max_radius_ = kLargestRadius;
  double max_radius_sq_ = kLargestRadius * kLargestRadius;
};

struct SimplePinhole : PerspectiveModel<1, 0> {
  using PerspectiveModel::PerspectiveModel;
  static constexpr std::string_view kName = "SIMPLE_PINHOLE";
  static constexpr std::string_view kParamNames = "f,cx,cy";
};
struct Pinhole : PerspectiveModel<2, 0> {
  using PerspectiveModel::PerspectiveModel;
  static constexpr std::string_view kName = "PINHOLE";
  static constexpr std::string_view kParamNames = "fx,fy,cx,cy";
};
struct SimpleRadial : PerspectiveModel<1, 1> {
  using PerspectiveModel::PerspectiveModel;
  static constexpr std::string_view kName = "SIMPLE_RADIAL";
  static constexpr std::string_view kParamNames = "f,cx,cy,k";
};
struct Radial : PerspectiveModel<1, 2> {
  using PerspectiveModel::PerspectiveModel;
  static constexpr std::string_view kName = "RADIAL";
  static constexpr std::string_view kParamNames = "f,cx,cy,k1,k2";
};
struct OpenCv : PerspectiveModel<2, 4> {
  using PerspectiveModel::PerspectiveModel;
  static constexpr std::string_view kName = "OPENCV";
  static constexpr std::string_view kParamNames = "fx,fy,cx,cy,k1,k2,p1,p2";
};

class OpenCvFisheye {
 public:
  static constexpr std::string_view kName = "OPENCV_FISHEYE";
  static constexpr std::string_view kParamNames = "fx,fy,cx,cy,k1,k2,k3,k4";
  static constexpr int kNumParams = 8;
  using Params = std::array<double, kNumParams>;

  explicit OpenCvFisheye(const Params& params);

  const Params& params() const { return params_; }
  double fx() const { return params_[0]; }
  double fy() const { return params_[1]; }
  double cx() const { return params_[2]; }
  double cy() const { return params_[3]; }
  // The domain's bound on theta, radians, computed once; a thousandth short of pi where theta_d grows all the way.
  double max_theta() const { return max_theta_; }

  template <class T>
  bool Project(const T point[3], T pixel[2]) const {
    using std::atan2;
    using std::sqrt;
    return ProjectBelow(max_theta_, params_.data(), point, pixel);
  }

  // The formula for parameters of type P that are being estimated: without the domain's bound on theta.
  template <class P, class T>
  static bool ProjectUnbounded(const P* params, const T point[3], T pixel[2]) {
    return ProjectBelow(std::numeric_limits<double>::infinity(), params, point, pixel);
  }

  bool ProjectWithJacobian(const double point[3], double pixel[2], double jacobian[6]) const;
  bool Unproject(const double pixel[2], double ray[3]) const;

 private:
  // Below this (r / z)^2 the first two terms of theta_d / r in r / z are exact to rounding, and r need not be divided
  // by.
  static constexpr double kNearAxis = 1e-8;

  template <class P, class T>
  static bool ProjectBelow(double max_theta, const P* params, const T point[3], T pixel[2]) {
    using std::atan2;
    using std::sqrt;
    const P* const k = params + 4;
    const T r2 = point[0] * point[0] + point[1] * point[1];
    const T z2 = point[2] * point[2];
    const T norm2 = r2 + z2;
    if (!(norm2 > 0.0 && norm2 < std::numeric_limits<double>::max())) return false;
    T scale;
    if (point[2] > 0.0 && r2 < kNearAxis * z2) {
      scale = (1.0 + (k[0] - 1.0 / 3.0) * r2 / z2) / point[2];
    } else {
      const T r = sqrt(r2);
      const T theta = atan2(r, point[2]);
      if (!(theta < max_theta)) return false;
      const T t2 = theta * theta;
      scale = theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])))) / r;
    }
    pixel[0] = params[0] * (scale * point[0]) + params[2];
    pixel[1] = params[1] * (scale * point[1]) + params[3];
    return true;
  }

  double DistortedAngle(double theta, double* derivative) const;

  Params params_;
  double max_theta_;
  double max_theta_d_;
};

}  // namespace pliant
