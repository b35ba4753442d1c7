// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The motion between two views from matched unit rays, against outliers, by a method chosen by name: OpenGV's minimal
// solvers of the essential matrix in OpenGV's loops, OpenCV's MAGSAC for comparison, and the two models that hold
// where an essential matrix means nothing, a plane and a rotation (docs/method.md, eq. I1 to I3).
// Translations have unit length: two views have no scale. The result depends on the inputs and on `random` alone:
// OpenGV's own generator is held at its fixed seed, and the correspondences are handed to it in an order drawn from
// `random`.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"
#include "pliant/base/random.h"
#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

enum class RelativePoseSolver {
  // Essential matrices through OpenGV, each sample's best solution by its errors.
  kNister,       // five points, PAMI 2004
  kStewenius,    // five points by a Groebner basis, ISPRS 2006
  kKneip,        // five points for the rotation, ECCV 2012; the translation is that of the sample's epipolar planes
  kSevenPoint,   // Hartley and Zisserman, 11.1.2
  kEightPoint,   // Longuet-Higgins 1981, Hartley 1997
  kEigensolver,  // eight points; the rotation as an eigenvalue problem, Kneip and Lynen, ICCV 2013
  // With a loop of their own.
  kOpencvUsac,    // OpenCV's USAC with MAGSAC++ (Barath et al., CVPR 2020); rays must point forwards (z > 0)
  kHomography,    // the motion of a plane: of its two the one that more points agree with
  kRotationOnly,  // translation zero
};

template <>
struct EnumNames<RelativePoseSolver> {
  static constexpr std::array kNames = {
      std::pair{RelativePoseSolver::kNister, std::string_view("nister")},
      std::pair{RelativePoseSolver::kStewenius, std::string_view("stewenius")},
      std::pair{RelativePoseSolver::kKneip, std::string_view("kneip")},
      std::pair{RelativePoseSolver::kSevenPoint, std::string_view("sevenpt")},
      std::pair{RelativePoseSolver::kEightPoint, std::string_view("eightpt")},
      std::pair{RelativePoseSolver::kEigensolver, std::string_view("eigensolver")},
      std::pair{RelativePoseSolver::kOpencvUsac, std::string_view("opencv_usac")},
      std::pair{RelativePoseSolver::kHomography, std::string_view("homography")},
      std::pair{RelativePoseSolver::kRotationOnly, std::string_view("rotation_only")}};
};

// How samples make a motion; of the solvers through OpenGV alone.
enum class RobustLoop {
  kRansac,  // most inliers
  kLmeds,   // least median of the errors: needs no threshold to choose, and more than half inliers
  kLocal,   // RANSAC, each better motion refined on its inliers (LO-RANSAC, Chum, Matas and Kittler, DAGM 2003)
};

template <>
struct EnumNames<RobustLoop> {
  static constexpr std::array kNames = {std::pair{RobustLoop::kRansac, std::string_view("ransac")},
                                        std::pair{RobustLoop::kLmeds, std::string_view("lmeds")},
                                        std::pair{RobustLoop::kLocal, std::string_view("local")}};
};

struct RelativePoseOptions {
  RelativePoseSolver solver = RelativePoseSolver::kNister;
  RobustLoop robust = RobustLoop::kRansac;
  double max_error_px = 1.5;  // a correspondence this far from the model (per view, at the mean focal length) is out
  int max_iterations = 300;   // samples
  double confidence = 0.999;  // stop when a clean sample was drawn with this probability
};

struct RelativePose {
  Rigid3 cam1_from_cam0;      // |translation| = 1 (rotation_only: 0); not refined
  std::vector<char> inliers;  // one a correspondence, 0 or 1
  int num_inliers = 0;
};

// Whether a correspondence's rays meet in front of both cameras, or are too nearly parallel to say.
bool MeetInFront(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1,
                 double max_error_rad);

// Whether a correspondence agrees with a motion: its epipolar error is at most max_error_rad a view, and its rays meet
// in front of both cameras, or are too nearly parallel to say.
bool AgreesWithMotion(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1,
                      double max_error_rad);

// The least number of correspondences: five make the model, three choose among its solutions.
inline constexpr int kRelativePoseMinPoints = 8;

// Fails with kInvalidArgument (a ray that is not a unit vector, counts that differ), kInsufficient (too few
// correspondences or inliers, also for so many samples to find them), kDegenerate (fewer than kRelativePoseMinPoints of
// them differ, all rays are alike in a view, or no ray moves; the inliers lie on a line of an image, to max_error_px,
// where there is a translation; a homography without translation).
Result<RelativePose> EstimateRelativePose(std::span<const Eigen::Vector3d> rays0,
                                          std::span<const Eigen::Vector3d> rays1, double focal_px, Random random,
                                          const RelativePoseOptions& options);

}  // namespace pliant
