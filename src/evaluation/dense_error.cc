// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/dense_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/surface/interpolated_depth.h"

namespace pliant {
namespace {

// The pixels of a frame that have both depths.
struct Pixels {
  std::vector<double> truth_mm;
  std::vector<double> estimate;
  std::vector<double> sigma;          // by the depth
  std::vector<double> interpolation;  // empty: too few points
  int with_truth = 0;
  std::vector<double> filled_truth_mm;  // of those that were filled, which are not among the others
  std::vector<double> filled_estimate;
  // Of the mesh's vertices: those at pixels with a depth of the frame's own come first.
  std::vector<double> vertex_truth_mm;
  std::vector<double> vertex_estimate;
  std::size_t vertices_with_depth = 0;

  std::size_t Vertices(bool with_depth) const {
    return with_depth ? vertices_with_depth : vertex_truth_mm.size() - vertices_with_depth;
  }
};

Pixels PixelsOf(const SurfaceDepth& dense, const cv::Mat& truth_mm, const std::optional<cv::Mat>& interpolated) {
  Pixels pixels;
  for (int y = 0; y < truth_mm.rows; ++y)
    for (int x = 0; x < truth_mm.cols; ++x) {
      const float truth = truth_mm.at<float>(y, x);
      if (!(truth > 0.0F)) continue;
      ++pixels.with_truth;
      const float depth = dense.depth.at<float>(y, x);
      if (!dense.filled.empty() && dense.filled.at<std::uint8_t>(y, x) != 0) {
        pixels.filled_truth_mm.push_back(truth);
        pixels.filled_estimate.push_back(depth);
        continue;
      }
      if (!(depth > 0.0F) || (interpolated && !(interpolated->at<float>(y, x) > 0.0F))) continue;
      pixels.truth_mm.push_back(truth);
      pixels.estimate.push_back(depth);
      pixels.sigma.push_back(dense.sigma.at<float>(y, x));
      if (interpolated) pixels.interpolation.push_back(interpolated->at<float>(y, x));
    }
  return pixels;
}

void AddVertices(const Camera& camera, const std::vector<Eigen::Vector3d>& vertices, const SurfaceDepth& dense,
                 const cv::Mat& truth_mm, Pixels* pixels) {
  for (const bool with_depth : {true, false}) {
    for (const Eigen::Vector3d& vertex : vertices) {
      const auto pixel = camera.Project(vertex);
      if (!pixel || !camera.Contains(*pixel)) continue;
      const cv::Point at(static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y())));
      if (!(truth_mm.at<float>(at) > 0.0F) || (dense.depth.at<float>(at) > 0.0F) != with_depth) continue;
      pixels->vertex_truth_mm.push_back(truth_mm.at<float>(at));
      pixels->vertex_estimate.push_back(vertex.z());
    }
    if (with_depth) pixels->vertices_with_depth = pixels->vertex_truth_mm.size();
  }
}

double ScaleOf(const std::vector<double>& estimate, const std::vector<double>& truth) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < truth.size(); ++i) ratios.push_back(truth[i] / estimate[i]);
  return Median(std::move(ratios));
}

// `at(i)` is the depth of pixel i after its scale.
template <class Depth>
DepthFigures FiguresOf(const std::vector<double>& truth, const Depth& at, const std::vector<bool>& counts) {
  DepthFigures sum;
  double count = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!counts.empty() && !counts[i]) continue;
    ++count;
    const double error = std::abs(at(i) - truth[i]);
    const double ratio = std::max(at(i) / truth[i], truth[i] / at(i));
    sum.abs_rel += error / truth[i];
    sum.sq_rel_mm += error * error / truth[i];
    sum.rmse_mm += error * error;
    sum.rmse_log += std::pow(std::log(ratio), 2);
    for (std::size_t k = 0; k < 3; ++k) {
      sum.below[k] += ratio < std::pow(1.25, static_cast<double>(k + 1)) ? 1.0 : 0.0;
      sum.within_mm[k] += error < kDepthBoundsMm[k] ? 1.0 : 0.0;
    }
  }
  count = std::max(1.0, count);
  sum.abs_rel /= count;
  sum.sq_rel_mm /= count;
  sum.rmse_mm = std::sqrt(sum.rmse_mm / count);
  sum.rmse_log = std::sqrt(sum.rmse_log / count);
  for (std::size_t k = 0; k < 3; ++k) {
    sum.below[k] /= count;
    sum.within_mm[k] /= count;
  }
  return sum;
}

void Add(const DepthFigures& figures, double weight, DepthFigures* sum) {
  sum->abs_rel += weight * figures.abs_rel;
  sum->sq_rel_mm += weight * figures.sq_rel_mm;
  sum->rmse_mm += weight * figures.rmse_mm;
  sum->rmse_log += weight * figures.rmse_log;
  for (std::size_t k = 0; k < 3; ++k) {
    sum->below[k] += weight * figures.below[k];
    sum->within_mm[k] += weight * figures.within_mm[k];
  }
}

void AddMesh(const std::vector<Pixels>& frames, const std::vector<double>& scales, DenseError* error) {
  const auto add = [&](bool with_depth, DepthFigures* figures) {
    double count = 0.0;
    for (const Pixels& pixels : frames) count += pixels.Vertices(with_depth) > 0 ? 1.0 : 0.0;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const Pixels& pixels = frames[k];
      if (pixels.Vertices(with_depth) == 0) continue;
      std::vector<bool> counts(pixels.vertex_truth_mm.size());
      for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = (i < pixels.vertices_with_depth) == with_depth;
      const auto estimate = [&](std::size_t i) { return scales[k] * pixels.vertex_estimate[i]; };
      Add(FiguresOf(pixels.vertex_truth_mm, estimate, counts), 1.0 / count, figures);
    }
  };
  add(true, &error->mesh);
  add(false, &error->mesh_alone);
  double all = 0.0;
  double alone = 0.0;
  for (const Pixels& pixels : frames) {
    all += static_cast<double>(pixels.vertex_truth_mm.size());
    alone += static_cast<double>(pixels.Vertices(false));
  }
  error->mesh_vertices = all / static_cast<double>(frames.size());
  error->mesh_alone_share = all > 0.0 ? alone / all : 0.0;
}

// The pixels that were filled.
void AddFilled(const std::vector<Pixels>& frames, const std::vector<double>& scales, DenseError* error) {
  const auto count = static_cast<double>(
      std::ranges::count_if(frames, [](const Pixels& pixels) { return !pixels.filled_truth_mm.empty(); }));
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Pixels& pixels = frames[k];
    if (pixels.filled_truth_mm.empty()) continue;
    const auto estimate = [&](std::size_t i) { return scales[k] * pixels.filled_estimate[i]; };
    Add(FiguresOf(pixels.filled_truth_mm, estimate, {}), 1.0 / count, &error->filled);
    error->filled_share +=
        static_cast<double>(pixels.filled_truth_mm.size()) / (pixels.with_truth * static_cast<double>(frames.size()));
  }
}

// Adds a frame, as one of `frames`.
void AddFrame(const Pixels& pixels, double scale, double frames, DenseError* error) {
  const double weight = 1.0 / frames;
  const auto& truth = pixels.truth_mm;
  const auto estimate = [&](std::size_t i) { return scale * pixels.estimate[i]; };
  const DepthFigures of_estimate = FiguresOf(truth, estimate, {});
  Add(of_estimate, weight, &error->estimate);
  const double middle = Median(pixels.sigma);
  std::vector<bool> certain;
  double inside[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < truth.size(); ++i) {
    certain.push_back(pixels.sigma[i] <= middle);
    const double ratio = std::abs(estimate(i) - truth[i]) / (pixels.sigma[i] * estimate(i));
    for (int k = 0; k < 2; ++k) inside[k] += ratio < k + 1 ? 1.0 : 0.0;
  }
  Add(FiguresOf(truth, estimate, certain), weight, &error->certain_half);
  const auto known = static_cast<double>(truth.size());
  error->within_1_sigma += weight * inside[0] / known;
  error->within_2_sigma += weight * inside[1] / known;
  const double share = known / pixels.with_truth;
  error->known_share += weight * share;
  for (std::size_t k = 0; k < 3; ++k) error->complete_mm[k] += weight * share * of_estimate.within_mm[k];
  const double constant = Median(truth);
  Add(FiguresOf(truth, [&](std::size_t) { return constant; }, {}), weight, &error->null);
  if (pixels.interpolation.empty()) return;
  const double own_scale = ScaleOf(pixels.interpolation, truth);
  Add(FiguresOf(truth, [&](std::size_t i) { return own_scale * pixels.interpolation[i]; }, {}), weight,
      &error->interpolation);
}

}  // namespace

Result<DenseError> ComputeDenseError(const SurfaceFolder& surface, const EvaluationInput& run, const Sequence& sequence,
                                     ErrorScale scale) {
  std::vector<Pixels> frames;
  std::vector<double> scales;
  for (const SurfaceFolder::Frame& frame : surface.frames) {
    const auto truth_mm = sequence.Depth(frame.frame_idx);
    if (!truth_mm.ok()) return truth_mm.status();
    if (!truth_mm->has_value()) continue;
    auto dense = ReadSurfaceDepth(surface, frame);
    if (!dense.ok()) return dense.status();
    if ((*truth_mm)->size() != dense->depth.size())
      return Status(ErrorCode::kMismatch, "the true depth of frame " + std::to_string(frame.frame_idx) +
                                              " has another size than the surface " + Quoted(surface.path.string()));
    std::optional<cv::Mat> interpolated;
    const auto of_run = std::ranges::find(run.frames, frame.frame_idx, &EvaluationFrame::frame_idx);
    if (of_run != run.frames.end() && of_run->cam_from_world)
      interpolated = InterpolatedDepth(surface.camera, *of_run->cam_from_world, of_run->observations);
    Pixels pixels = PixelsOf(*dense, **truth_mm, interpolated);
    dense->KeepMeasured();
    if (pixels.truth_mm.empty()) continue;
    const auto vertices = ReadSurfaceVertices(surface, frame);
    if (!vertices.ok()) return vertices.status();
    AddVertices(surface.camera, *vertices, *dense, **truth_mm, &pixels);
    scales.push_back(ScaleOf(pixels.estimate, pixels.truth_mm));
    frames.push_back(std::move(pixels));
  }
  if (frames.empty())
    return Status(ErrorCode::kInsufficient,
                  "no frame of the surface " + Quoted(surface.path.string()) + " has pixels whose true depth is known");
  DenseError error;
  error.frames = static_cast<int>(frames.size());
  if (scale != ErrorScale::kPerFrame)
    std::ranges::fill(scales, scale == ErrorScale::kGlobal ? Median(std::vector<double>(scales)) : 1.0);
  for (std::size_t k = 0; k < frames.size(); ++k)
    AddFrame(frames[k], scales[k], static_cast<double>(frames.size()), &error);
  AddFilled(frames, scales, &error);
  AddMesh(frames, scales, &error);
  return error;
}

}  // namespace pliant
