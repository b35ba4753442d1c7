// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/dense_completeness.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

namespace pliant {
namespace {

constexpr int kStepPx = 4;
constexpr int kMinSeen = 2;
constexpr float kHiddenPx = 1.0F;  // of disparity, before a pixel that is hidden in the right image

using PixelList = std::vector<Eigen::Vector2d>;

cv::Point PointOf(const Eigen::Vector2d& pixel) { return {static_cast<int>(pixel.x()), static_cast<int>(pixel.y())}; }

// The disparity that hides what is behind it at every pixel of the right image, CV_32FC1.
cv::Mat NearestDisparities(const cv::Mat& disparities) {
  cv::Mat nearest(disparities.size(), CV_32F, cv::Scalar(0));
  for (int y = 0; y < disparities.rows; ++y)
    for (int x = 0; x < disparities.cols; ++x) {
      const float disparity = disparities.at<float>(y, x);
      const auto there = static_cast<int>(std::lround(static_cast<float>(x) - disparity));
      if (disparity > 0.0F && there >= 0 && there < nearest.cols)
        nearest.at<float>(y, there) = std::max(nearest.at<float>(y, there), disparity);
    }
  return nearest;
}

// How many of the images see what the pixels show.
std::vector<int> SeenInRight(const Camera& camera, double baseline_mm, const cv::Mat& truth_mm,
                             const PixelList& pixels) {
  cv::Mat disparities(truth_mm.size(), CV_32F, cv::Scalar(0));
  for (int y = 0; y < truth_mm.rows; ++y)
    for (int x = 0; x < truth_mm.cols; ++x)
      if (const float depth = truth_mm.at<float>(y, x); depth > 0.0F)
        disparities.at<float>(y, x) = static_cast<float>(camera.params()[0] * baseline_mm / depth);
  const cv::Mat nearest = NearestDisparities(disparities);
  std::vector<int> seen;
  for (const Eigen::Vector2d& pixel : pixels) {
    const cv::Point here = PointOf(pixel);
    const float disparity = disparities.at<float>(here);
    const auto there = static_cast<int>(std::lround(static_cast<float>(here.x) - disparity));
    seen.push_back(there >= 0 && nearest.at<float>(here.y, there) <= disparity + kHiddenPx ? 1 : 0);
  }
  return seen;
}

Result<std::vector<int>> SeenInNeighbors(const SurfaceFolder::Frame& frame, const PixelList& pixels,
                                         MaterialTruth* material) {
  const auto points = material->PointsAt(frame.frame_idx, pixels);
  if (!points.ok()) return points.status();
  std::vector<MaterialId> ids;
  std::vector<std::size_t> of_pixel;
  for (std::size_t i = 0; i < points->size(); ++i) {
    if (!(*points)[i]) continue;
    ids.push_back(*(*points)[i]);
    of_pixel.push_back(i);
  }
  std::vector<int> seen(pixels.size(), 0);
  for (const int neighbor : frame.neighbors) {
    const auto states = material->Observe(neighbor, ids);
    if (!states.ok()) return states.status();
    for (std::size_t k = 0; k < ids.size(); ++k)
      if ((*states)[k] && (*states)[k]->visibility == MaterialVisibility::kVisible) ++seen[of_pixel[k]];
  }
  return seen;
}

// The next frame of this number.
Result<std::optional<SequenceFrame>> ReadFrame(int frame_idx, Sequence* images) {
  while (true) {
    auto frame = images->Next();
    if (!frame.ok() || !frame->has_value() || (*frame)->frame_idx == frame_idx) return frame;
  }
}

// Of one frame: those that are textured and have a true depth; `with_truth`: that have one.
PixelList TexturedOf(const cv::Mat& textured, const cv::Mat& truth_mm, int* with_truth) {
  PixelList pixels;
  for (int y = kStepPx / 2; y < truth_mm.rows; y += kStepPx)
    for (int x = kStepPx / 2; x < truth_mm.cols; x += kStepPx) {
      if (!(truth_mm.at<float>(y, x) > 0.0F)) continue;
      ++*with_truth;
      if (textured.at<std::uint8_t>(y, x) != 0) pixels.emplace_back(x, y);
    }
  return pixels;
}

// Nothing where it is not known what other images see.
Result<std::optional<std::vector<int>>> SeenElsewhere(const SurfaceFolder& surface, const SurfaceFolder::Frame& frame,
                                                      const Sequence& sequence, const cv::Mat& truth_mm,
                                                      const PixelList& pixels, MaterialTruth* material) {
  if (frame.has_pair) {
    const std::optional<double> baseline_mm = sequence.BaselineMm();
    if (!baseline_mm) return std::optional<std::vector<int>>();
    return std::optional(SeenInRight(surface.camera, *baseline_mm, truth_mm, pixels));
  }
  if (material == nullptr) return std::optional<std::vector<int>>();
  auto seen = SeenInNeighbors(frame, pixels, material);
  if (!seen.ok()) return seen.status();
  return std::optional(*std::move(seen));
}

// In the order of time; also those of which no depth is known.
std::vector<SurfaceFolder::Frame> ComparedFrames(const SurfaceFolder& surface) {
  std::vector<SurfaceFolder::Frame> frames = surface.frames;
  std::ranges::copy_if(surface.frames_without_depth, std::back_inserter(frames),
                       [](const auto& frame) { return frame.has_pair || !frame.neighbors.empty(); });
  std::ranges::sort(frames, {}, &SurfaceFolder::Frame::frame_idx);
  return frames;
}

// CV_32FC1, 0: none.
Result<cv::Mat> MeasuredDepth(const SurfaceFolder& surface, const SurfaceFolder::Frame& frame) {
  if (frame.file_name.empty()) return cv::Mat(surface.camera.height(), surface.camera.width(), CV_32F, cv::Scalar(0));
  auto dense = ReadSurfaceDepth(surface, frame);
  if (!dense.ok()) return dense.status();
  dense->KeepMeasured();
  return dense->depth;
}

}  // namespace

Result<std::optional<DenseCompleteness>> ComputeDenseCompleteness(const SurfaceFolder& surface, Sequence* images,
                                                                  MaterialTruth* material, const MaskOptions& masks) {
  if (!surface.windows) return std::optional<DenseCompleteness>();
  const std::vector<SurfaceFolder::Frame> in_order = ComparedFrames(surface);
  DenseCompleteness sum;
  int frames = 0;
  for (const SurfaceFolder::Frame& frame : in_order) {
    const auto truth_mm = images->Depth(frame.frame_idx);
    if (!truth_mm.ok()) return truth_mm.status();
    if (!truth_mm->has_value()) continue;
    const auto image = ReadFrame(frame.frame_idx, images);
    if (!image.ok()) return image.status();
    const auto dense = MeasuredDepth(surface, frame);
    if (!dense.ok()) return dense.status();
    if (!image->has_value() || (*image)->image.size() != dense->size() || (*truth_mm)->size() != dense->size())
      return Status(ErrorCode::kMismatch, "image and true depth of frame " + std::to_string(frame.frame_idx) +
                                              " have not the size of the surface; give the sequence that it is of");
    if (std::ranges::any_of(frame.neighbors, [&](int neighbor) { return neighbor >= images->size(); }))
      return Status(ErrorCode::kMismatch, "frame " + std::to_string(frame.frame_idx) +
                                              " of the surface was compared with frames that the sequence does not "
                                              "have; give the sequence that it is of");
    const cv::Mat valid = ValidMask((*image)->image, (*image)->mask, masks);
    int with_truth = 0;
    const PixelList pixels =
        TexturedOf(TexturedPixels((*image)->image, valid, *surface.windows), **truth_mm, &with_truth);
    const auto seen = SeenElsewhere(surface, frame, *images, **truth_mm, pixels, material);
    if (!seen.ok()) return seen.status();
    if (!seen->has_value()) return std::optional<DenseCompleteness>();
    const int wanted = frame.has_pair ? 1 : std::min(kMinSeen, static_cast<int>(frame.neighbors.size()));
    double expected = 0.0;
    double known = 0.0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if ((**seen)[i] < wanted) continue;
      ++expected;
      known += dense->at<float>(PointOf(pixels[i])) > 0.0F ? 1.0 : 0.0;
    }
    if (expected == 0.0) continue;
    ++frames;
    sum.share += expected / with_truth;
    sum.known_share += known / expected;
  }
  if (frames == 0) return std::optional<DenseCompleteness>();
  return std::optional(DenseCompleteness{sum.share / frames, sum.known_share / frames});
}

}  // namespace pliant
