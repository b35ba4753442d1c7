// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What OpenGV's robust loops sample and score: motions between two views from a few pairs of rays, by any of OpenGV's
// solvers, scored by the epipolar error (docs/method.md, eq. I1).
#pragma once

#include <vector>

#include <opengv/relative_pose/CentralRelativeAdapter.hpp>
#include <opengv/sac/SampleConsensusProblem.hpp>

#include "pliant/estimation/relative_pose.h"

namespace pliant {

class RelativePoseProblem final : public opengv::sac::SampleConsensusProblem<Rigid3> {
 public:
  // Takes the rays as they are: unit vectors, of equal number. A sample's solutions, and the two signs of a
  // translation, are told apart by the number of pairs that agree with them (AgreesWithMotion).
  RelativePoseProblem(opengv::bearingVectors_t rays0, opengv::bearingVectors_t rays1, double focal_px,
                      const RelativePoseOptions& options);

  // The error (|I1|, radians) of a pair that agrees with a motion is at most this.
  double Threshold() const;

  // Pairs in a sample.
  static int SampleSize(RelativePoseSolver solver);

  int getSampleSize() const override { return SampleSize(options_.solver); }
  bool computeModelCoefficients(const std::vector<int>& sample, Rigid3& cam1_from_cam0) const override;
  void optimizeModelCoefficients(const std::vector<int>& inliers, const Rigid3& start, Rigid3& refined) override;
  void getSelectedDistancesToModel(const Rigid3& cam1_from_cam0, const std::vector<int>& indices,
                                   std::vector<double>& errors_rad) const override;

 private:
  std::vector<Rigid3> MotionsThrough(const std::vector<int>& sample) const;
  Rigid3 MotionWithRotation(const Eigen::Matrix3d& cam0_from_cam1, const std::vector<int>& sample) const;
  struct Candidate {
    Rigid3 cam1_from_cam0;
    std::vector<int> inliers;
  };
  Candidate Judged(const Rigid3& motion_of_any_sign, std::size_t to_beat) const;
  Rigid3 Refined(const std::vector<int>& inliers, const Rigid3& start) const;

  opengv::bearingVectors_t rays0_;
  opengv::bearingVectors_t rays1_;
  opengv::relative_pose::CentralRelativeAdapter adapter_;  // keeps references to both
  double focal_px_;
  double max_error_rad_;  // of one view
  RelativePoseOptions options_;
  mutable std::size_t most_inliers_ = 0;  // of any motion so far, for kLocal
};

}  // namespace pliant
