// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/grid_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/SparseCholesky>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr int kReweightings = 2;
constexpr double kCauchyScale = 3.0;  // standard deviations
constexpr double kDamping = 1e-9;     // where points leave a plane free

using Triplets = std::vector<Eigen::Triplet<double>>;

// The four nodes around a pixel, and their shares.
struct Bilinear {
  std::array<int, 4> nodes;
  std::array<double, 4> weights;
};

Bilinear BilinearAt(cv::Size nodes, double x, double y) {
  const double column = std::clamp(x, 0.0, nodes.width - 1.0);
  const double row = std::clamp(y, 0.0, nodes.height - 1.0);
  const int c = std::min(static_cast<int>(column), nodes.width - 2);
  const int r = std::min(static_cast<int>(row), nodes.height - 2);
  const double a = column - c;
  const double b = row - r;
  const int first = r * nodes.width + c;
  return {{first, first + 1, first + nodes.width, first + nodes.width + 1},
          {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b}};
}

// Adds weight * (sum of the entries)^2.
template <std::size_t kCount>
void AddSquare(const std::array<int, kCount>& nodes, const std::array<double, kCount>& factors, double weight,
               Triplets* entries) {
  for (std::size_t i = 0; i < kCount; ++i)
    for (std::size_t j = 0; j < kCount; ++j)
      if (nodes[i] >= nodes[j]) entries->emplace_back(nodes[i], nodes[j], weight * factors[i] * factors[j]);
}

Triplets BendingEnergy(cv::Size nodes, double stiffness) {
  Triplets entries;
  const int w = nodes.width;
  for (int r = 0; r < nodes.height; ++r)
    for (int c = 0; c < w; ++c) {
      const int n = r * w + c;
      entries.emplace_back(n, n, kDamping);
      if (c > 0 && c + 1 < w) AddSquare<3>({n - 1, n, n + 1}, {1, -2, 1}, stiffness, &entries);
      if (r > 0 && r + 1 < nodes.height) AddSquare<3>({n - w, n, n + w}, {1, -2, 1}, stiffness, &entries);
      if (c + 1 < w && r + 1 < nodes.height)
        AddSquare<4>({n, n + 1, n + w, n + w + 1}, {1, -1, -1, 1}, 2 * stiffness, &entries);
    }
  return entries;
}

std::vector<double> CauchyWeights(const std::vector<double>& residuals) {
  const double scale = kCauchyScale * Median(residuals) / 0.6745;
  std::vector<double> weights;
  for (const double r : residuals) weights.push_back(scale > 0 ? 1.0 / (1.0 + (r / scale) * (r / scale)) : 1.0);
  return weights;
}

}  // namespace

Eigen::VectorXd GridField::At(const Eigen::Vector2d& pixel) const {
  const Bilinear around = BilinearAt(nodes_, pixel.x() / spacing_px_, pixel.y() / spacing_px_);
  Eigen::VectorXd value = Eigen::VectorXd::Zero(values_.cols());
  for (std::size_t k = 0; k < 4; ++k) value += around.weights[k] * values_.row(around.nodes[k]).transpose();
  return value;
}

cv::Mat GridField::ToImage(cv::Size size, double step) const {
  const auto channels = static_cast<int>(values_.cols());
  const Eigen::MatrixXf values = values_.cast<float>().transpose();
  cv::Mat image(size, CV_32FC(channels));
  for (int y = 0; y < size.height; ++y) {
    auto* out = image.ptr<float>(y);
    for (int x = 0; x < size.width; ++x, out += channels) {
      const Bilinear around =
          BilinearAt(nodes_, ((x + 0.5) * step - 0.5) / spacing_px_, ((y + 0.5) * step - 0.5) / spacing_px_);
      Eigen::Map<Eigen::VectorXf> value(out, channels);
      value.setZero();
      for (std::size_t k = 0; k < 4; ++k) value += static_cast<float>(around.weights[k]) * values.col(around.nodes[k]);
    }
  }
  return image;
}

GridField FitThinPlate(cv::Size size, double spacing_px, std::span<const Eigen::Vector2d> pixels,
                       const Eigen::MatrixXd& values, double stiffness) {
  const cv::Size nodes(static_cast<int>(std::ceil((size.width - 1) / spacing_px)) + 1,
                       static_cast<int>(std::ceil((size.height - 1) / spacing_px)) + 1);
  GridField field(nodes, spacing_px, static_cast<int>(values.cols()));
  std::vector<Bilinear> around;
  for (const Eigen::Vector2d& pixel : pixels)
    around.push_back(BilinearAt(nodes, pixel.x() / spacing_px, pixel.y() / spacing_px));
  const Triplets bending = BendingEnergy(nodes, stiffness);
  std::vector<double> weights(pixels.size(), 1.0);
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver;
  for (int k = 0; k <= kReweightings; ++k) {
    Triplets entries = bending;
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(nodes.area(), values.cols());
    for (std::size_t i = 0; i < around.size(); ++i) {
      AddSquare<4>(around[i].nodes, around[i].weights, weights[i], &entries);
      for (std::size_t n = 0; n < 4; ++n)
        right.row(around[i].nodes[n]) += weights[i] * around[i].weights[n] * values.row(static_cast<Eigen::Index>(i));
    }
    Eigen::SparseMatrix<double> normal(nodes.area(), nodes.area());
    normal.setFromTriplets(entries.begin(), entries.end());
    if (k == 0) solver.analyzePattern(normal);
    solver.factorize(normal);
    field.values() = solver.solve(right);
    std::vector<double> residuals;
    for (std::size_t i = 0; i < around.size(); ++i)
      residuals.push_back((field.At(pixels[i]).transpose() - values.row(static_cast<Eigen::Index>(i))).norm());
    weights = CauchyWeights(residuals);
  }
  return field;
}

}  // namespace pliant
