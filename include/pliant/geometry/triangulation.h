// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A point from two unit rays, and how far it can be trusted. Frames: cam0 is the reference view, cam1 the other one,
// x1 = cam1_from_cam0 * x0; rays are unit vectors in their own camera's frame, so pinhole and fisheye are alike. Points
// are returned in cam0 in the unit of the translation. A point that cannot be had carries the reason: nothing throws,
// and a caller counts the reasons. Equations: docs/method.md, eq. I4, I6, I9 and I11.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

enum class TriangulationMethod {
  kIdwm,       // inverse depth weighted midpoint: the better reprojection at low parallax and in forward motion
  kMidpoint,   // the middle of the shortest segment between the rays (OpenGV's triangulate2)
  kLinear,     // the direct linear transform (OpenGV's triangulate)
  kOptimalL2,  // the least sum of squared sines of the turns that make the rays meet
};

template <>
struct EnumNames<TriangulationMethod> {
  static constexpr std::array kNames = {std::pair{TriangulationMethod::kIdwm, std::string_view("idwm")},
                                        std::pair{TriangulationMethod::kMidpoint, std::string_view("midpoint")},
                                        std::pair{TriangulationMethod::kLinear, std::string_view("linear")},
                                        std::pair{TriangulationMethod::kOptimalL2, std::string_view("optimal_l2")}};
};

enum class TriangulationStatus {
  kOk,
  kInvalidRay,  // a ray or the motion is not a number
  kParallel,    // the rays do not part by more than rounding: the depth is arbitrary
  kCheirality,  // the rays part: their nearest points lie behind a camera
};

struct TriangulatedPoint {
  TriangulationStatus status = TriangulationStatus::kInvalidRay;
  Eigen::Vector3d point_in_cam0 = Eigen::Vector3d::Zero();  // meaningful only when ok()
  bool ok() const { return status == TriangulationStatus::kOk; }
};

// Inverse depth weighted midpoint with its cheirality test (Lee and Civera, "Triangulation: Why Optimize?", BMVC 2019).
TriangulatedPoint TriangulateIdwm(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0,
                                  const Eigen::Vector3d& ray1);
// The midpoint of the common perpendicular; both feet have to lie in front of their cameras.
TriangulatedPoint TriangulateMidpoint(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0,
                                      const Eigen::Vector3d& ray1);
// The point x of least |A x|, |x| = 1, in homogeneous coordinates, A = the equations f1 x (R x + t) = 0 and f0 x x = 0
// of unit rays (Hartley and Zisserman, "Multiple View Geometry", 12.2); it has to lie in front of both cameras.
TriangulatedPoint TriangulateLinear(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0,
                                    const Eigen::Vector3d& ray1);
// Both rays are turned into one epipolar plane, the one for which the sum of squared sines of the turns is least; then
// they meet (Oliensis, "Exact Two-Image Structure from Motion", PAMI 2002; Lee and Civera, ICCV 2019). Both have to
// meet in front of their cameras.
TriangulatedPoint TriangulateOptimalL2(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0,
                                       const Eigen::Vector3d& ray1);
// One result a pair of rays, by the method's name.
std::vector<TriangulatedPoint> Triangulate(TriangulationMethod method, const Rigid3& cam1_from_cam0,
                                           std::span<const Eigen::Vector3d> rays0,
                                           std::span<const Eigen::Vector3d> rays1);

// The angle between two directions, radians in [0, pi]; exact to rounding near zero.
double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b);
// The parallax of a correspondence: the angle between its rays once the rotation is taken off, radians.
inline double ParallaxAngle(const Eigen::Quaterniond& cam1_from_cam0, const Eigen::Vector3d& ray0,
                            const Eigen::Vector3d& ray1) {
  return AngleBetween(cam1_from_cam0 * ray0, ray1);
}

// The predicted relative standard deviation of a depth from two views, sigma_z / z = sqrt(2) * sigma / sin(parallax),
// where sigma = sigma_px / focal_px is the direction's noise in radians. Infinite at zero parallax. The motion counts
// as known: its own error comes on top.
double RelativeDepthSigma(double sigma_px, double focal_px, double parallax_rad);

// The covariance of a point seen from several known poses, each ray with an isotropic noise of sigma_rad: the inverse
// of sum_k R_k' (I - f_k f_k') R_k / (sigma_rad |x_k|)^2. In the frame of `point_in_world`, squared length units.
// Entries are infinite where the views do not determine the point (all rays parallel).
Eigen::Matrix3d PointCovariance(std::span<const Rigid3> cams_from_world, const Eigen::Vector3d& point_in_world,
                                double sigma_rad);
// The standard deviation along the ray of the view at the origin of that frame (sqrt of d' C d with d the direction).
double DepthSigma(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& point_in_world);

}  // namespace pliant
