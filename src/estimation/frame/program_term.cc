// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/frame/program_term.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <ceres/cost_function.h>

namespace pliant {
namespace {

using Points = std::vector<Eigen::Vector3d>;

// Nothing where the program has no answer, or one that is not a number.
std::optional<FrameCostValue> ValueAt(const FrameData& data, const Points& positions) {
  FrameCostValue value;
  const FrameCostInput input{.frame_idx = data.frame_idx,
                             .ids = data.ids,
                             .positions = positions,
                             .previous = data.positions,
                             .pixels = data.pixels,
                             .edges = data.edges,
                             .initial_cam_from_world = data.pose.Pose(Vector6d::Zero())};
  if (!data.cost->Evaluate(input, &value)) return std::nullopt;
  const auto is_number = [](double number) { return std::isfinite(number); };
  if (!std::ranges::all_of(value.residuals, is_number) ||
      !std::ranges::all_of(value.jacobian, is_number, &FrameCostValue::Entry::value))
    return std::nullopt;
  assert(std::ranges::all_of(value.jacobian, [&](const FrameCostValue::Entry& entry) {
    return entry.row >= 0 && entry.row < static_cast<int>(value.residuals.size()) && entry.column >= 0 &&
           entry.column < 3 * data.num_points();
  }));
  return value;
}

double CostOf(const FrameCostValue& value) {
  double sum = 0;
  for (const double residual : value.residuals) sum += residual * residual;
  return 0.5 * sum;
}

// All residuals and every displacement in one block, since any of them may depend on any.
class ProgramCost final : public ceres::CostFunction {
 public:
  ProgramCost(const FrameData& data, int num_residuals) : data_(data) {
    set_num_residuals(num_residuals);
    mutable_parameter_block_sizes()->assign(data.positions.size(), 3);
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    Points positions = data_.positions;
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += Eigen::Map<const Eigen::Vector3d>(parameters[i]);
    const auto value = ValueAt(data_, positions);
    if (!value || static_cast<int>(value->residuals.size()) != num_residuals()) return false;
    std::ranges::copy(value->residuals, residuals);
    if (jacobians == nullptr) return true;
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (jacobians[i] != nullptr) std::fill_n(jacobians[i], 3 * num_residuals(), 0.0);
    for (const FrameCostValue::Entry& entry : value->jacobian)
      if (double* of_point = jacobians[entry.column / 3]; of_point != nullptr)
        of_point[3 * entry.row + entry.column % 3] += entry.value;
    return true;
  }

 private:
  const FrameData& data_;
};

class ProgramTerm final : public FrameTerm {
 public:
  explicit ProgramTerm(const FrameData& data) : FrameTerm(data.cost->name(), data) {}

  std::optional<double> Cost(const Rigid3&, const Points& positions) const override {
    const auto value = ValueAt(data_, positions);
    return value ? std::optional(CostOf(*value)) : std::nullopt;
  }

  // The displacements in the world are R' e_i, R = Exp(omega) R0: by e_i the derivative is R dE/d(delta_i), and by a
  // rotation phi of the camera that leaves the e_i, which moves R' e_i by -R' (phi x e_i), it is R dE/d(delta_i) x e_i.
  bool AddPointEnergy(const FrameVariables& at, double* energy, FrameGradient& gradient) const override {
    const Eigen::Matrix3d cam_from_world = at.rotation * data_.pose.reference_rotation();
    Points positions = data_.positions;
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += cam_from_world.transpose() * at.displacements[i];
    const auto value = ValueAt(data_, positions);
    if (!value) return false;
    *energy += CostOf(*value);
    Points by_positions(positions.size(), Eigen::Vector3d::Zero());
    for (const FrameCostValue::Entry& entry : value->jacobian)
      by_positions[entry.column / 3][entry.column % 3] += entry.value * value->residuals[entry.row];
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Eigen::Vector3d by_displacement = cam_from_world * by_positions[i];
      gradient.by_displacements[i] += by_displacement;
      gradient.by_rotation += by_displacement.cross(at.displacements[i]);
    }
    return true;
  }

  // Of each point alone, alike in all directions; what this leaves out costs iterations.
  void AddStiffness(const Points&, FrameStiffness* stiffness) const override {
    const auto value = ValueAt(data_, data_.positions);
    if (!value) return;
    for (const FrameCostValue::Entry& entry : value->jacobian)
      stiffness->of_points[entry.column / 3] += entry.value * entry.value / 3.0;
  }

  void AddFrameBlock(FrameBlocks* blocks) const override {
    const auto value = ValueAt(data_, data_.positions);
    if (!value || value->residuals.empty()) return;
    std::vector<double*> deltas;
    for (Eigen::Vector3d& delta : blocks->deltas) deltas.push_back(delta.data());
    blocks->problem->AddResidualBlock(new ProgramCost(data_, static_cast<int>(value->residuals.size())), nullptr,
                                      deltas);
  }
};

}  // namespace

std::unique_ptr<FrameTerm> MakeProgramTerm(const FrameData& data) { return std::make_unique<ProgramTerm>(data); }

}  // namespace pliant
