// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One solution of a deforming window by Ceres (docs/method.md, eq. W2 to W7), and what can be said of it.
#pragma once

#include <memory>
#include <vector>

#include <ceres/ceres.h>

#include "estimation/deforming_costs.h"
#include "estimation/light_depth.h"
#include "pliant/estimation/deforming_window.h"

namespace pliant {

class DeformingProblem {
 public:
  // Everything is free but the first view. Neighbours, slopes and scale are those of `start`'s points.
  DeformingProblem(const DeformingWindow& start, double focal_px, const DeformingWindowOptions& options);

  void FixPoints();  // and their modes
  void FixViews();   // and their courses; they hold the scale

  // The cost at the solution, what could not be measured included; kDegenerate when there is no usable step.
  Result<double> Solve(int max_iterations);

  DeformingWindow Window() const;

  // One a point, at the present values. See DeformingSolution.
  std::vector<double> LogDepthSigmas();

 private:
  struct View {
    Eigen::Vector4d rotation;  // x, y, z, w
    Eigen::Vector3d translation;
    Eigen::VectorXd courses;
  };
  struct Point {
    PointChart chart;
    Eigen::Vector3d parameters;
    Eigen::VectorXd modes;  // 3 x R, column by column
  };

  std::vector<int> GaugePoints() const;
  void AddObservations();
  void AddSmoothness();
  void AddScale();
  void AddLight();
  double EdgeWeight(double distance) const;

  DeformingWindow start_;
  double focal_px_;
  DeformingWindowOptions options_;
  int rank_;
  double median_distance_ = 1;
  std::vector<View> views_;
  std::vector<Point> points_;
  NeighborLists neighbors_;  // of the points, at the start
  double light_offset_ = 0;
  int unmeasured_ = 0;  // observations of which no point is in front at the start

  ceres::CauchyLoss cauchy_;
  ceres::ScaledLoss loss_;
  ceres::CauchyLoss light_loss_;
  ceres::EigenQuaternionManifold rotation_manifold_;
  std::unique_ptr<ceres::Problem> problem_;
  ceres::ResidualBlockId scale_ = nullptr;
};

}  // namespace pliant
