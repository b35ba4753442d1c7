// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/dense_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

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
  std::vector<double> vertex_sigma;  // by the distance; empty: the mesh has none
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

void AddVertices(const Camera& camera, const PlyVertices& vertices, const SurfaceDepth& dense, const cv::Mat& truth_mm,
                 Pixels* pixels) {
  for (const bool with_depth : {true, false}) {
    for (std::size_t v = 0; v < vertices.positions.size(); ++v) {
      const Eigen::Vector3d& vertex = vertices.positions[v];
      if (!vertex.allFinite()) continue;
      const auto pixel = camera.Project(vertex);
      if (!pixel || !camera.Contains(*pixel)) continue;
      const cv::Point at(static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y())));
      if (!(truth_mm.at<float>(at) > 0.0F) || (dense.depth.at<float>(at) > 0.0F) != with_depth) continue;
      pixels->vertex_truth_mm.push_back(truth_mm.at<float>(at));
      pixels->vertex_estimate.push_back(vertex.z());
      if (!vertices.sigmas.empty()) pixels->vertex_sigma.push_back(vertices.sigmas[v] / vertex.norm());
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

// Means are sums that are divided at the end: those of shares are at most 1 then, which weighted sums exceed by
// rounding.
void AddFigures(const DepthFigures& figures, DepthFigures* sum) {
  sum->abs_rel += figures.abs_rel;
  sum->sq_rel_mm += figures.sq_rel_mm;
  sum->rmse_mm += figures.rmse_mm;
  sum->rmse_log += figures.rmse_log;
  for (std::size_t k = 0; k < 3; ++k) {
    sum->below[k] += figures.below[k];
    sum->within_mm[k] += figures.within_mm[k];
  }
}

DepthFigures MeanFigures(DepthFigures sum, std::ptrdiff_t frames) {
  const auto count = static_cast<double>(frames);
  for (double* value : {&sum.abs_rel, &sum.sq_rel_mm, &sum.rmse_mm, &sum.rmse_log}) *value /= count;
  for (std::size_t k = 0; k < 3; ++k) {
    sum.below[k] /= count;
    sum.within_mm[k] /= count;
  }
  return sum;
}

// Of those frames that have such pixels.
std::optional<DepthFigures> MeanOfSome(const DepthFigures& sum, std::ptrdiff_t frames) {
  return frames > 0 ? std::optional(MeanFigures(sum, frames)) : std::nullopt;
}

// Of a frame, before its pixels are read again: all frames' pixels at once would be gigabytes.
struct FrameScale {
  int submap = 0;
  double scale = 1;          // of the surface's depths
  double interpolation = 1;  // of those that are interpolated between the points; 0: there are none
  bool has_filled = false;
};

FrameScale ScaleOfFrame(const Pixels& pixels, int submap) {
  return {.submap = submap,
          .scale = ScaleOf(pixels.estimate, pixels.truth_mm),
          .interpolation = pixels.interpolation.empty() ? 0.0 : ScaleOf(pixels.interpolation, pixels.truth_mm),
          .has_filled = !pixels.filled_truth_mm.empty()};
}

// One scale a submap, the median of its frames', for the depths that `of` gives.
void ShareScale(double FrameScale::*of, std::vector<FrameScale>* frames) {
  std::map<int, std::vector<double>> scales;
  for (const FrameScale& frame : *frames)
    if (frame.*of > 0) scales[frame.submap].push_back(frame.*of);
  for (FrameScale& frame : *frames)
    if (frame.*of > 0) frame.*of = Median(scales.at(frame.submap));
}

void SetScales(ErrorScale scale, std::vector<FrameScale>* frames) {
  if (scale == ErrorScale::kPerFrame) return;
  for (double FrameScale::*of : {&FrameScale::scale, &FrameScale::interpolation})
    if (scale == ErrorScale::kGlobal)
      ShareScale(of, frames);
    else
      for (FrameScale& frame : *frames) frame.*of = frame.*of > 0 ? 1.0 : 0.0;
}

// The figures of one frame's vertices after the other.
class VertexSum {
 public:
  // Of the vertices whose frame has a depth of its own there, or of the others.
  void Add(const Pixels& pixels, double scale, bool with_depth) {
    if (pixels.Vertices(with_depth) == 0) return;
    std::vector<bool> counts(pixels.vertex_truth_mm.size());
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = (i < pixels.vertices_with_depth) == with_depth;
    const auto estimate = [&](std::size_t i) { return scale * pixels.vertex_estimate[i]; };
    AddFigures(FiguresOf(pixels.vertex_truth_mm, estimate, counts), &depth_);
    ++frames_;
    if (pixels.vertex_sigma.empty()) return;
    ++frames_with_sigma_;
    const auto all = static_cast<double>(pixels.Vertices(with_depth));
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (!counts[i]) continue;
      const double error = std::abs(estimate(i) - pixels.vertex_truth_mm[i]) / estimate(i);
      for (std::size_t k = 0; k < 2; ++k)
        within_[k] += error < static_cast<double>(k + 1) * pixels.vertex_sigma[i] ? 1.0 / all : 0.0;
    }
  }

  // Nothing: there were none.
  std::optional<VertexFigures> Mean() const {
    if (frames_ == 0) return std::nullopt;
    VertexFigures figures{MeanFigures(depth_, frames_), std::nullopt};
    if (frames_with_sigma_ > 0)
      figures.within_sigma = {within_[0] / frames_with_sigma_, within_[1] / frames_with_sigma_};
    return figures;
  }

 private:
  DepthFigures depth_;  // sums
  std::array<double, 2> within_ = {};
  int frames_ = 0;
  int frames_with_sigma_ = 0;
};

// The figures of one frame after the other.
class DenseErrorSum {
 public:
  // `without_pixels`: frames that have a true depth, and no other one; nothing of them is known.
  DenseErrorSum(const std::vector<FrameScale>& frames, int without_pixels, ErrorScale scale)
      : frames_(frames), all_frames_(static_cast<double>(frames.size()) + without_pixels) {
    error_.frames = static_cast<int>(frames.size());
    error_.frames_without_depth = without_pixels;
    error_.scale = scale;
  }

  void Add(const Pixels& pixels, const FrameScale& scale) {
    AddDepths(pixels, scale);
    AddFilled(pixels, scale.scale);
    mesh_.Add(pixels, scale.scale, /*with_depth=*/true);
    mesh_alone_.Add(pixels, scale.scale, /*with_depth=*/false);
    vertices_ += static_cast<double>(pixels.vertex_truth_mm.size());
    vertices_alone_ += static_cast<double>(pixels.Vertices(false));
  }

  DenseError Take() {
    const auto frames = static_cast<double>(frames_.size());
    for (DepthFigures* figures : {&error_.estimate, &error_.certain_half, &error_.null})
      *figures = MeanFigures(*figures, std::ssize(frames_));
    error_.interpolation =
        MeanOfSome(interpolation_,
                   std::ranges::count_if(frames_, [](const FrameScale& frame) { return frame.interpolation > 0; }));
    error_.filled = MeanOfSome(filled_, std::ranges::count(frames_, true, &FrameScale::has_filled));
    error_.mesh = mesh_.Mean();
    error_.mesh_alone = mesh_alone_.Mean();
    for (double* share : {&error_.within_1_sigma, &error_.within_2_sigma, &error_.filled_share}) *share /= frames;
    error_.known_share /= all_frames_;
    for (double& share : error_.complete_mm) share /= all_frames_;
    error_.mesh_vertices = vertices_ / frames;
    if (vertices_ > 0.0) error_.mesh_alone_share = vertices_alone_ / vertices_;
    return error_;
  }

 private:
  void AddDepths(const Pixels& pixels, const FrameScale& scale);
  void AddFilled(const Pixels& pixels, double scale);

  const std::vector<FrameScale>& frames_;
  double all_frames_;
  DenseError error_;
  DepthFigures interpolation_;  // sums
  DepthFigures filled_;
  VertexSum mesh_;
  VertexSum mesh_alone_;
  double vertices_ = 0.0;
  double vertices_alone_ = 0.0;
};

// The pixels that were filled.
void DenseErrorSum::AddFilled(const Pixels& pixels, double scale) {
  if (pixels.filled_truth_mm.empty()) return;
  const auto estimate = [&](std::size_t i) { return scale * pixels.filled_estimate[i]; };
  AddFigures(FiguresOf(pixels.filled_truth_mm, estimate, {}), &filled_);
  error_.filled_share += static_cast<double>(pixels.filled_truth_mm.size()) / pixels.with_truth;
}

void DenseErrorSum::AddDepths(const Pixels& pixels, const FrameScale& scale) {
  const auto& truth = pixels.truth_mm;
  const auto estimate = [&](std::size_t i) { return scale.scale * pixels.estimate[i]; };
  const DepthFigures of_estimate = FiguresOf(truth, estimate, {});
  AddFigures(of_estimate, &error_.estimate);
  const double middle = Median(pixels.sigma);
  std::vector<bool> certain;
  double inside[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < truth.size(); ++i) {
    certain.push_back(pixels.sigma[i] <= middle);
    const double ratio = std::abs(estimate(i) - truth[i]) / (pixels.sigma[i] * estimate(i));
    for (int k = 0; k < 2; ++k) inside[k] += ratio < k + 1 ? 1.0 : 0.0;
  }
  AddFigures(FiguresOf(truth, estimate, certain), &error_.certain_half);
  const auto known = static_cast<double>(truth.size());
  error_.within_1_sigma += inside[0] / known;
  error_.within_2_sigma += inside[1] / known;
  const double share = known / pixels.with_truth;
  error_.known_share += share;
  for (std::size_t k = 0; k < 3; ++k) error_.complete_mm[k] += share * of_estimate.within_mm[k];
  const double constant = Median(truth);
  AddFigures(FiguresOf(truth, [&](std::size_t) { return constant; }, {}), &error_.null);
  if (pixels.interpolation.empty()) return;
  const auto interpolated = [&](std::size_t i) { return scale.interpolation * pixels.interpolation[i]; };
  AddFigures(FiguresOf(truth, interpolated, {}), &interpolation_);
}

// Nothing: the frame has no true depth. Without pixels: none has both depths.
Result<std::optional<Pixels>> ReadPixels(const SurfaceFolder& surface, const SurfaceFolder::Frame& frame,
                                         const EvaluationFrame* of_run, const Sequence& sequence) {
  const auto truth_mm = sequence.Depth(frame.frame_idx);
  if (!truth_mm.ok()) return truth_mm.status();
  if (!truth_mm->has_value()) return std::optional<Pixels>();
  auto dense = ReadSurfaceDepth(surface, frame);
  if (!dense.ok()) return dense.status();
  if ((*truth_mm)->size() != dense->depth.size())
    return Status(ErrorCode::kMismatch, "the true depth of frame " + std::to_string(frame.frame_idx) +
                                            " has another size than the surface " + Quoted(surface.path.string()));
  std::optional<cv::Mat> interpolated;
  if (of_run != nullptr && of_run->cam_from_world)
    interpolated = InterpolatedDepth(surface.camera, *of_run->cam_from_world, of_run->observations);
  Pixels pixels = PixelsOf(*dense, **truth_mm, interpolated);
  dense->KeepMeasured();
  if (pixels.with_truth == 0) return std::optional<Pixels>();
  if (pixels.truth_mm.empty()) return std::optional(std::move(pixels));
  const auto vertices = ReadSurfaceVertices(surface, frame);
  if (!vertices.ok()) return vertices.status();
  AddVertices(surface.camera, *vertices, *dense, **truth_mm, &pixels);
  return std::optional(std::move(pixels));
}

// Calls `function(pixels, submap)` for every frame that has a true depth.
template <class Function>
Status ForEachFrame(const SurfaceFolder& surface, const EvaluationInput& run, const Sequence& sequence,
                    const Function& function) {
  for (const SurfaceFolder::Frame& frame : surface.frames) {
    const auto found = std::ranges::find(run.frames, frame.frame_idx, &EvaluationFrame::frame_idx);
    const EvaluationFrame* of_run = found == run.frames.end() ? nullptr : &*found;
    const auto pixels = ReadPixels(surface, frame, of_run, sequence);
    if (!pixels.ok()) return pixels.status();
    if (pixels->has_value()) function(**pixels, of_run == nullptr ? 0 : of_run->submap);
  }
  return Status::Ok();
}

}  // namespace

// Twice over all frames: first for their scales.
Result<DenseError> ComputeDenseError(const SurfaceFolder& surface, const EvaluationInput& run, const Sequence& sequence,
                                     ErrorScale scale) {
  std::vector<FrameScale> frames;
  int without_pixels = 0;
  const auto take_scale = [&](const Pixels& pixels, int submap) {
    if (pixels.truth_mm.empty())
      ++without_pixels;
    else
      frames.push_back(ScaleOfFrame(pixels, submap));
  };
  if (Status status = ForEachFrame(surface, run, sequence, take_scale); !status.ok()) return status;
  for (const SurfaceFolder::Frame& frame : surface.frames_without_depth) {
    const auto truth_mm = sequence.Depth(frame.frame_idx);
    if (!truth_mm.ok()) return truth_mm.status();
    without_pixels += truth_mm->has_value() && cv::countNonZero(**truth_mm > 0.0F) > 0 ? 1 : 0;
  }
  if (frames.empty())
    return Status(ErrorCode::kInsufficient,
                  "no frame of the surface " + Quoted(surface.path.string()) + " has pixels whose true depth is known");
  SetScales(scale, &frames);
  DenseErrorSum sum(frames, without_pixels, scale);
  std::size_t next = 0;
  const auto add = [&](const Pixels& pixels, int /*submap*/) {
    if (!pixels.truth_mm.empty()) sum.Add(pixels, frames[next++]);
  };
  if (Status status = ForEachFrame(surface, run, sequence, add); !status.ok()) return status;
  return sum.Take();
}

}  // namespace pliant
