// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/frame/frame_terms.h"

#include <algorithm>
#include <array>

#include "estimation/frame/program_term.h"
#include "pliant/residuals/ceres_adapter.h"
#include "pliant/residuals/edge_length.h"
#include "pliant/residuals/huber.h"
#include "pliant/residuals/reprojection.h"
#include "pliant/residuals/spatial.h"
#include "pliant/residuals/temporal.h"

namespace pliant {
namespace {

using Points = std::vector<Eigen::Vector3d>;
using Loss = std::unique_ptr<ceres::LossFunction>;

// An edge that stands for both directions counts twice.
class EdgeLoss {
 public:
  EdgeLoss(double chi2, double lambda)
      : by_multiplicity_{Loss(NewRobustLoss(chi2, lambda)), Loss(NewRobustLoss(chi2, 2.0 * lambda))} {}
  ceres::LossFunction* Of(const GraphEdge& edge) const {
    return by_multiplicity_[static_cast<std::size_t>(edge.multiplicity - 1)].get();
  }

 private:
  std::array<Loss, 2> by_multiplicity_;
};

// Eq. E1. Its stiffness is the preconditioner's own matter.
class ReprojectionTerm final : public FrameTerm {
 public:
  ReprojectionTerm(std::string_view name, const FrameData& data)
      : FrameTerm(name, data), loss_(NewRobustLoss(data.options.chi2_rep, 1.0)) {}
  static bool IsOn(const FrameProblemOptions&) { return true; }

  std::optional<double> Cost(const Rigid3& cam_from_world, const Points& positions) const override {
    const FrameProblemOptions& options = data_.options;
    return data_.camera->Visit([&]<class Model>(const Model& model) -> std::optional<double> {
      const ReprojectionKernel<Model> kernel(model, options.sigma_rep_px);
      Eigen::Vector2d residual;
      double cost = 0;
      for (int i = 0; i < data_.num_points(); ++i) {
        const Eigen::Vector3d in_cam = cam_from_world * positions[i];
        if (!kernel.template Residual<double>(data_.pixels[i], in_cam, &residual)) return std::nullopt;
        cost += 0.5 * Huber(residual.squaredNorm(), options.chi2_rep).rho;
      }
      return cost;
    });
  }

  bool AddPointEnergy(const FrameVariables& at, double* energy, FrameGradient& gradient) const override {
    const FrameProblemOptions& options = data_.options;
    return data_.camera->Visit([&]<class Model>(const Model& model) {
      const ReprojectionKernel<Model> kernel(model, options.sigma_rep_px);
      Eigen::Vector2d residual;
      ReprojectionJacobian jacobian;
      double sum = 0;
      for (int i = 0; i < data_.num_points(); ++i) {
        if (!kernel.ResidualAndJacobian(data_.pixels[i], at.points[i], &residual, &jacobian)) return false;
        const RobustCost cost = Huber(residual.squaredNorm(), options.chi2_rep);
        sum += cost.rho;
        gradient.by_points[i].noalias() += jacobian.transpose() * (cost.derivative * residual);
      }
      *energy += 0.5 * sum;
      return true;
    });
  }

  void AddPointBlock(int i, FrameBlocks* blocks) const override {
    blocks->problem->AddResidualBlock(
        NewReprojectionCost(*data_.camera, data_.pose, data_.positions[i], data_.pixels[i], data_.options.sigma_rep_px),
        loss_.get(), blocks->increment.data(), blocks->deltas[i].data());
  }

 private:
  Loss loss_;
};

// Eq. E2.
class SpatialTerm final : public FrameTerm {
 public:
  SpatialTerm(std::string_view name, const FrameData& data)
      : FrameTerm(name, data), loss_(data.options.chi2_spa, data.options.lambda_spa) {
    pairs_.reserve(data.edges.size());
    for (const GraphEdge& edge : data.edges)
      pairs_.push_back({edge.i, edge.j, data.options.lambda_spa * edge.multiplicity, KernelOf(edge).scale()});
  }
  static bool IsOn(const FrameProblemOptions&) { return true; }

  std::optional<double> Cost(const Rigid3&, const Points& positions) const override {
    const FrameProblemOptions& options = data_.options;
    double cost = 0;
    for (const GraphEdge& edge : data_.edges) {
      const Eigen::Vector3d residual = KernelOf(edge).Residual<double>(positions[edge.i] - data_.positions[edge.i],
                                                                       positions[edge.j] - data_.positions[edge.j]);
      cost += 0.5 * options.lambda_spa * edge.multiplicity * Huber(residual.squaredNorm(), options.chi2_spa).rho;
    }
    return cost;
  }

  // The energy's hot loop; pairs are sorted by i, whose own part stays in registers.
  void AddEdgeEnergy(const FrameVariables& at, double* energy, FrameGradient& gradient) const override {
    const double chi2 = data_.options.chi2_spa;
    const Points& displacements = at.displacements;
    Points& by_displacements = gradient.by_displacements;
    double sum = 0;
    for (std::size_t k = 0; k < pairs_.size();) {
      const int i = pairs_[k].i;
      const Eigen::Vector3d e_i = displacements[i];
      Eigen::Vector3d by_i = Eigen::Vector3d::Zero();
      for (; k < pairs_.size() && pairs_[k].i == i; ++k) {
        const Pair& pair = pairs_[k];
        const Eigen::Vector3d residual = (e_i - displacements[pair.j]) * pair.scale;
        const RobustCost cost = Huber(residual.squaredNorm(), chi2);
        sum += pair.factor * cost.rho;
        const Eigen::Vector3d by_difference = (pair.factor * cost.derivative * pair.scale) * residual;
        by_i += by_difference;
        by_displacements[pair.j] -= by_difference;
      }
      by_displacements[i] += by_i;
    }
    *energy += 0.5 * sum;
  }

  void AddStiffness(const Points&, FrameStiffness* stiffness) const override {
    std::vector<EdgeStiffness>& of_edges = stiffness->of_edges.emplace_back();
    of_edges.reserve(pairs_.size());
    for (const Pair& pair : pairs_) of_edges.push_back({.of_displacements = pair.factor * pair.scale * pair.scale});
  }

  void AddEdgeBlock(const GraphEdge& edge, FrameBlocks* blocks) const override {
    blocks->problem->AddResidualBlock(new DifferenceCost(KernelOf(edge)), loss_.Of(edge), blocks->deltas[edge.i].data(),
                                      blocks->deltas[edge.j].data());
  }

 private:
  struct Pair {
    int i;
    int j;
    double factor;  // lambda * multiplicity
    double scale;   // of SpatialKernel
  };

  SpatialKernel KernelOf(const GraphEdge& edge) const { return SpatialKernel(edge.weight, data_.options.sigma_spa_mm); }

  EdgeLoss loss_;
  std::vector<Pair> pairs_;
};

// Eq. E3.
class TemporalTerm final : public FrameTerm {
 public:
  TemporalTerm(std::string_view name, const FrameData& data)
      : FrameTerm(name, data),
        kernel_(data.options.sigma_tmp_mm),
        loss_(NewRobustLoss(data.options.chi2_tmp, data.options.lambda_tmp)) {}
  static bool IsOn(const FrameProblemOptions&) { return true; }

  std::optional<double> Cost(const Rigid3&, const Points& positions) const override {
    const FrameProblemOptions& options = data_.options;
    double cost = 0;
    for (int i = 0; i < data_.num_points(); ++i) {
      const Eigen::Vector3d residual = kernel_.Residual<double>(positions[i] - data_.positions[i]);
      cost += 0.5 * options.lambda_tmp * Huber(residual.squaredNorm(), options.chi2_tmp).rho;
    }
    return cost;
  }

  bool AddPointEnergy(const FrameVariables& at, double* energy, FrameGradient& gradient) const override {
    const FrameProblemOptions& options = data_.options;
    double sum = 0;
    for (int i = 0; i < data_.num_points(); ++i) {
      const Eigen::Vector3d residual = kernel_.Residual<double>(at.displacements[i]);
      const RobustCost cost = Huber(residual.squaredNorm(), options.chi2_tmp);
      sum += cost.rho;
      gradient.by_displacements[i] += (options.lambda_tmp * cost.derivative * kernel_.scale()) * residual;
    }
    *energy += 0.5 * options.lambda_tmp * sum;
    return true;
  }

  void AddStiffness(const Points&, FrameStiffness* stiffness) const override {
    const double temporal = data_.options.lambda_tmp * kernel_.scale() * kernel_.scale();
    for (double& of_point : stiffness->of_points) of_point += temporal;
  }

  void AddPointBlock(int i, FrameBlocks* blocks) const override {
    blocks->problem->AddResidualBlock(new DisplacementCost(kernel_), loss_.get(), blocks->deltas[i].data());
  }

 private:
  TemporalKernel kernel_;
  Loss loss_;
};

// Eq. E8.
class EdgeLengthTerm final : public FrameTerm {
 public:
  EdgeLengthTerm(std::string_view name, const FrameData& data)
      : FrameTerm(name, data), loss_(data.options.chi2_len, data.options.lambda_len) {}
  static bool IsOn(const FrameProblemOptions& options) { return options.edge_length == Switch::kOn; }

  std::optional<double> Cost(const Rigid3&, const Points& positions) const override {
    const FrameProblemOptions& options = data_.options;
    double cost = 0;
    for (const GraphEdge& edge : data_.edges) {
      const double residual = KernelOf(edge).Residual<double>(positions[edge.i], positions[edge.j]);
      cost += 0.5 * options.lambda_len * edge.multiplicity * Huber(residual * residual, options.chi2_len).rho;
    }
    return cost;
  }

  void AddEdgeEnergy(const FrameVariables& at, double* energy, FrameGradient& gradient) const override {
    const FrameProblemOptions& options = data_.options;
    double sum = 0;
    for (const GraphEdge& edge : data_.edges) {
      const EdgeLengthKernel kernel = KernelOf(edge);
      const double residual = kernel.Residual<double>(at.points[edge.i], at.points[edge.j]);
      const RobustCost cost = Huber(residual * residual, options.chi2_len);
      sum += edge.multiplicity * cost.rho;
      const Eigen::Vector3d by_difference = (options.lambda_len * edge.multiplicity * cost.derivative * residual) *
                                            kernel.Jacobian(at.points[edge.i], at.points[edge.j]);
      gradient.by_points[edge.i] += by_difference;
      gradient.by_points[edge.j] -= by_difference;
    }
    *energy += 0.5 * options.lambda_len * sum;
  }

  void AddStiffness(const Points& points, FrameStiffness* stiffness) const override {
    std::vector<EdgeStiffness>& of_edges = stiffness->of_edges.emplace_back();
    of_edges.reserve(data_.edges.size());
    for (const GraphEdge& edge : data_.edges)
      of_edges.push_back({.of_positions = data_.options.lambda_len * edge.multiplicity,
                          .u = KernelOf(edge).Jacobian(points[edge.i], points[edge.j])});
  }

  void AddEdgeBlock(const GraphEdge& edge, FrameBlocks* blocks) const override {
    blocks->problem->AddResidualBlock(NewEdgeLengthCost(data_.positions[edge.i], data_.positions[edge.j],
                                                        edge.rest_length_mm, data_.options.sigma_len_mm),
                                      loss_.Of(edge), blocks->deltas[edge.i].data(), blocks->deltas[edge.j].data());
  }

 private:
  EdgeLengthKernel KernelOf(const GraphEdge& edge) const {
    return EdgeLengthKernel(edge.rest_length_mm, data_.options.sigma_len_mm);
  }

  EdgeLoss loss_;
};

struct ListedTerm {
  std::string_view name;
  bool (*is_on)(const FrameProblemOptions&);
  std::unique_ptr<FrameTerm> (*make)(std::string_view name, const FrameData&);
};

template <class Term>
constexpr ListedTerm Listed(std::string_view name) {
  return {name, Term::IsOn, [](std::string_view of_term, const FrameData& data) -> std::unique_ptr<FrameTerm> {
            return std::make_unique<Term>(of_term, data);
          }};
}

// The names are those of the columns cost_<name> of frames.csv.
constexpr std::array kTerms = {Listed<ReprojectionTerm>("reprojection"), Listed<SpatialTerm>("spatial"),
                               Listed<TemporalTerm>("temporal"), Listed<EdgeLengthTerm>("edge_length")};

}  // namespace

FrameTerms MakeFrameTerms(const FrameData& data) {
  FrameTerms terms;
  for (const ListedTerm& term : kTerms)
    if (term.is_on(data.options)) terms.push_back(term.make(term.name, data));
  if (data.cost != nullptr) terms.push_back(MakeProgramTerm(data));
  return terms;
}

std::vector<CostTerm> NoFrameCosts() {
  std::vector<CostTerm> costs;
  for (const ListedTerm& term : kTerms) costs.push_back({std::string(term.name), 0.0});
  return costs;
}

std::optional<std::vector<CostTerm>> FrameCosts(const FrameTerms& terms, const Rigid3& cam_from_world,
                                                const Points& positions) {
  std::vector<CostTerm> costs = NoFrameCosts();
  for (const auto& term : terms) {
    const std::optional<double> cost = term->Cost(cam_from_world, positions);
    if (!cost) return std::nullopt;
    const auto named = std::ranges::find(costs, term->name(), &CostTerm::name);
    if (named != costs.end())
      named->value = *cost;
    else
      costs.push_back({std::string(term->name()), *cost});
  }
  return costs;
}

}  // namespace pliant
