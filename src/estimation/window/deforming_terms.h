// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The terms of a deforming window (docs/method.md, eq. W2 to W6): their cost, and their linear equations a point.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "estimation/window/light_depth.h"
#include "estimation/window/point_chart.h"
#include "pliant/estimation/window/deforming_window.h"
#include "pliant/estimation/window/shape_basis.h"

namespace pliant {

constexpr int kMaxPointSize = 3 + 3 * kMaxWindowRank;
constexpr int kMaxViewSize = 6 + kMaxWindowRank;
template <int kRows, int kMaxRows, int kMaxCols>
using SmallMatrix = Eigen::Matrix<double, kRows, Eigen::Dynamic, Eigen::ColMajor, kMaxRows, kMaxCols>;
using PointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxPointSize, 1>;
using ViewDerivative = SmallMatrix<2, 2, kMaxViewSize>;
using PointMatrix = SmallMatrix<Eigen::Dynamic, kMaxPointSize, kMaxPointSize>;

// cam_from_world of a view. Its rotation is a matrix because every observation is turned by it.
struct ViewPose {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

// What is solved for.
struct DeformingState {
  std::vector<ViewPose> poses;
  Eigen::MatrixXd coefficients;  // R x views
  Eigen::MatrixXd points;        // a column a point: its chart's parameters, then its basis shapes
  Eigen::MatrixXd node_shapes;   // a column a node
  double light_offset = 0;
};

// Moves poses and coefficients but the first view's by the beginning of `step`: a turn of the camera, translation and
// coefficients of each.
void MoveViews(const Eigen::VectorXd& step, DeformingState* state);

// Parts of the points whose equations are summed by themselves, on whatever threads there are.
constexpr std::size_t kEquationParts = 4;

// A point's observation in units of its standard deviation, weighted by its loss: error and derivatives by the point
// and by the view (a turn of the camera, translation, coefficients).
struct SeenEquations {
  Eigen::Vector2d error;
  SmallMatrix<2, 2, kMaxPointSize> by_point;
  ViewDerivative by_view;
};

// A point's share of the normal equations but for the views.
struct PointEquations {
  PointMatrix own;
  PointVector gradient;
  double by_offset = 0;         // second derivative by its log distance and the light's offset
  double offset_gradient = 0;   // by the light's offset
  PointVector node_difference;  // of its shapes from what the nodes say; nothing where there are no coefficients
};

class DeformingTerms {
 public:
  // Surface normals, sizes and the nodes around a point are those of `start`.
  DeformingTerms(const DeformingWindow& start, const SurfaceNodes& nodes, double focal_px,
                 const DeformingWindowOptions& options);

  // An observation that is measured, of the point in whose list it is.
  struct Seen {
    int view_idx = 0;
    Eigen::Vector3d ray;
    RayBasis basis;
  };

  int rank() const { return rank_; }
  Eigen::Index num_views() const { return static_cast<Eigen::Index>(start_.times.size()); }
  Eigen::Index num_nodes() const { return node_hessian_.rows(); }
  std::size_t num_points() const { return charts_.size(); }
  bool camera_translates() const { return start_.camera == WindowCamera::kFree; }
  Eigen::Index view_size() const { return 6 + rank_; }
  Eigen::Index shapes_size() const { return 3 * rank_; }
  Eigen::Index point_size() const { return 3 + 3 * rank_; }
  const std::vector<Seen>& seen(std::size_t point) const { return seen_[point]; }  // by view
  const std::vector<NodeWeight>& nodes(std::size_t point) const { return around_[point].weights; }
  double node_information(std::size_t point) const {
    return node_information_[point];
  }                                                                      // 1 / variance of node_difference
  const Eigen::MatrixXd& node_hessian() const { return node_hessian_; }  // (W3), (W4) of one component, nodes square
  const Eigen::MatrixXd& coefficient_hessian() const { return coefficient_hessian_; }  // (W5), all views but the first
  double unmeasured_cost() const;  // of the observations of which no point is in front at the start

  DeformingState Start() const;
  DeformingWindow Window(const DeformingState& state) const;

  // Nothing where a point is not in front of a ray.
  std::optional<double> Cost(const DeformingState& state) const;
  std::optional<double> PointCost(std::size_t point, const DeformingState& state) const;

  // `seen` may be null; else it becomes one a measured observation.
  PointEquations Linearized(std::size_t point, const DeformingState& state, std::vector<SeenEquations>* seen) const;
  // Error and derivative by the view alone of each.
  void LinearizeViews(std::size_t point, const DeformingState& state, std::vector<SeenEquations>* seen) const;

 private:
  struct Light {
    double log_distance = 0;
    double sigma = 1;
    bool lit = false;
  };

  // An observation's error in units of its standard deviation, and its derivatives; weighted by its loss.
  struct Sight {
    Eigen::Vector3d turned;  // the point, turned as the camera
    Eigen::Vector2d error;
    Eigen::Matrix<double, 2, 3> by_x;         // in the camera
    Eigen::Matrix<double, 2, 3> by_position;  // in the world
  };

  void PrepareObservations();
  void PrepareNodes(const SurfaceNodes& nodes);
  void PrepareCoefficients();
  void PrepareLight();
  Eigen::Vector3d Position(std::size_t point, int view_idx, const Eigen::Vector3d& rest,
                           const DeformingState& state) const;
  Sight LinearizedSight(const Seen& seen, std::size_t point, const Eigen::Vector3d& rest,
                        const DeformingState& state) const;
  ViewDerivative ByView(const Sight& sight, std::size_t point, const DeformingState& state) const;
  PointVector NodeDifference(std::size_t point, const DeformingState& state) const;
  // (W6), (W3): the point's own terms that are no observations.
  void AddLightAndNodes(std::size_t point, const DeformingState& state, PointEquations* equations) const;

  DeformingWindow start_;
  DeformingWindowOptions options_;
  int rank_;
  double scale_;  // pixels of an angle by their standard deviation
  double median_distance_ = 1;
  std::vector<PointChart> charts_;
  std::vector<std::vector<Seen>> seen_;
  int unmeasured_ = 0;
  std::vector<NodesOfPoint> around_;
  std::vector<double> node_information_;
  Eigen::MatrixXd node_shapes_;  // at the start
  Eigen::MatrixXd node_hessian_;
  Eigen::MatrixXd coefficient_hessian_;
  std::vector<Light> lights_;
  double light_offset_ = 0;  // at the start
};

}  // namespace pliant
