// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The terms of the joint problem's energy (pliant/estimation/frame/frame_problem.h). A term is a class in
// frame_terms.cc and a line of the list there: the costs by name, the energy with its gradient, the preconditioner and
// the residual blocks of Levenberg-Marquardt all go over that list.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <ceres/problem.h>

#include "estimation/frame/frame_data.h"

namespace pliant {

// Where the energy is evaluated (frame_energy.h): camera frame, mm.
struct FrameVariables {
  const std::vector<Eigen::Vector3d>& points;         // x_i
  const std::vector<Eigen::Vector3d>& displacements;  // e_i
  const Eigen::Matrix3d& rotation;                    // Exp(omega)
};

// The energy's derivatives; a term adds to them.
struct FrameGradient {
  std::vector<Eigen::Vector3d>& by_points;         // by x_i, everything else held
  std::vector<Eigen::Vector3d>& by_displacements;  // by e_i
  Eigen::Vector3d& by_rotation;                    // by phi in Exp(phi) Exp(omega), beyond what moves the e_i
};

// An edge's part of the Hessian, for the preconditioner: of_displacements * I by the difference of the displacements,
// of_positions * u u' by that of the points.
struct EdgeStiffness {
  double of_displacements = 0;
  double of_positions = 0;
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
};

// The terms' Hessian without the reprojection term's.
struct FrameStiffness {
  std::vector<double> of_points;                     // by each displacement, times I
  std::vector<std::vector<EdgeStiffness>> of_edges;  // for each term of edges one an edge
};

// The variables of Levenberg-Marquardt: the pose's increment and every displacement in the world.
struct FrameBlocks {
  ceres::Problem* problem;
  Vector6d increment;
  std::vector<Eigen::Vector3d> deltas;
};

// One term. What it does not have to do with stays as it is: a term of points leaves out the functions of edges.
class FrameTerm {
 public:
  FrameTerm(std::string_view name, const FrameData& data) : data_(data), name_(name) {}
  virtual ~FrameTerm() = default;

  std::string_view name() const { return name_; }

  // 0.5 * lambda * sum of rho at a pose and positions X_i + delta_i in the world; nothing where a point does not
  // project.
  virtual std::optional<double> Cost(const Rigid3& cam_from_world,
                                     const std::vector<Eigen::Vector3d>& positions) const = 0;

  // The same in the camera frame, with its derivatives. The points' part of all terms comes before the edges'. False
  // where a point leaves the camera's domain.
  virtual bool AddPointEnergy(const FrameVariables&, double* /*energy*/, FrameGradient&) const { return true; }
  virtual void AddEdgeEnergy(const FrameVariables&, double* /*energy*/, FrameGradient&) const {}

  // With no loss active, at points in the camera frame.
  virtual void AddStiffness(const std::vector<Eigen::Vector3d>& /*points*/, FrameStiffness*) const {}

  // Its residual block of a point, or of an edge, for Ceres.
  virtual void AddPointBlock(int /*i*/, FrameBlocks*) const {}
  virtual void AddEdgeBlock(const GraphEdge&, FrameBlocks*) const {}
  // Or one of all points.
  virtual void AddFrameBlock(FrameBlocks*) const {}

 protected:
  const FrameData& data_;

 private:
  std::string_view name_;
};

using FrameTerms = std::vector<std::unique_ptr<FrameTerm>>;

// Those that data.options switch on, in the list's order, then the program's own; `data` must outlive them.
FrameTerms MakeFrameTerms(const FrameData& data);

// The costs by name, 0 of what is switched off; nothing where a point does not project.
std::optional<std::vector<CostTerm>> FrameCosts(const FrameTerms& terms, const Rigid3& cam_from_world,
                                                const std::vector<Eigen::Vector3d>& positions);

}  // namespace pliant
