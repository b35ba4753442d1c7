// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/geometry/essential.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "pliant/geometry/decompositions.h"
#include "pliant/geometry/triangulation.h"

namespace pliant {

Eigen::Matrix3d EssentialFromMotion(const Rigid3& cam1_from_cam0) {
  return Skew(cam1_from_cam0.translation) * cam1_from_cam0.RotationMatrix();
}

Result<EssentialMotions> DecomposeEssential(const Eigen::Matrix3d& essential) {
  if (!essential.allFinite() || !(essential.norm() > 0.0))
    return Status(ErrorCode::kInvalidArgument, "an essential matrix to decompose is zero or not a number");
  const Svd3 svd = SvdOf(essential);
  Eigen::Matrix3d u = svd.u;
  Eigen::Matrix3d v = svd.v;
  // The sign of E is free, and so are the signs of the null vectors: take both factors as rotations.
  if (u.determinant() < 0) u.col(2) = -u.col(2);
  if (v.determinant() < 0) v.col(2) = -v.col(2);
  Eigen::Matrix3d w;
  w << 0, -1, 0, 1, 0, 0, 0, 0, 1;

  EssentialMotions motions;
  motions.rotations = {Eigen::Quaterniond(u * w * v.transpose()).normalized(),
                       Eigen::Quaterniond(u * w.transpose() * v.transpose()).normalized()};
  motions.translation = u.col(2);
  if (RotationAngle(motions.rotations[1]) < RotationAngle(motions.rotations[0]))
    std::swap(motions.rotations[0], motions.rotations[1]);
  return motions;
}

Result<EssentialChoice> ChooseMotion(const Eigen::Matrix3d& essential, std::span<const Eigen::Vector3d> rays0,
                                     std::span<const Eigen::Vector3d> rays1) {
  assert(rays0.size() == rays1.size());
  const auto motions = DecomposeEssential(essential);
  if (!motions.ok()) return motions.status();

  EssentialChoice choice;
  choice.cam1_from_cam0 = Rigid3(motions->rotations[0], motions->translation);
  const Rigid3 opposite(motions->rotations[0], -motions->translation);
  for (std::size_t i = 0; i < rays0.size(); ++i) {
    choice.in_front += TriangulateIdwm(choice.cam1_from_cam0, rays0[i], rays1[i]).ok() ? 1 : 0;
    choice.opposed += TriangulateIdwm(opposite, rays0[i], rays1[i]).ok() ? 1 : 0;
  }
  if (choice.in_front == choice.opposed)
    return Status(ErrorCode::kDegenerate,
                  "as many points lie in front of the cameras with a translation as with its "
                  "opposite: the views hardly move or do not match");
  if (choice.in_front < choice.opposed) {
    std::swap(choice.in_front, choice.opposed);
    choice.cam1_from_cam0 = opposite;
  }
  return choice;
}

double SampsonErrorRad(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1) {
  const Eigen::Vector3d& t = cam1_from_cam0.translation;
  const Eigen::Vector3d y = cam1_from_cam0.rotation * ray0;
  const Eigen::Vector3d t_cross_y = t.cross(y);
  const double c = ray1.dot(t_cross_y);
  const double gradient = t_cross_y.squaredNorm() + t.cross(ray1).squaredNorm() - 2.0 * c * c;
  return gradient > 0.0 ? c / std::sqrt(gradient) : 0.0;
}

double EpipolarPlaneAngle(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1) {
  const Eigen::Vector3d normal = cam1_from_cam0.translation.cross(cam1_from_cam0.rotation * ray0);
  const double length = normal.norm();
  if (!(length > 0.0)) return 0.0;
  return std::asin(std::min(1.0, std::abs(ray1.dot(normal)) / length));
}

}  // namespace pliant
