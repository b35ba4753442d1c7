// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The depth of the surface at every pixel of an image, by multi-view stereo in which the other images are seen through
// the deformation (docs/method.md, eq. V1 to V9): a point on a pixel's ray is moved as the tracked points around it
// have moved, and then projected. Where images say nothing of the depth (highlights, contours, no texture) there is
// none.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/image/texture.h"
#include "pliant/image/working_image.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

struct DenseDepthOptions {
  int max_width = 960;            // px: larger images are reduced to it, and depths interpolated in between
  double window = 0.75;           // side of a compared window by that of a tracked patch
  double max_sigma = 0.02;        // of a depth, by the depth, beside that of the tracked points around it
  double min_correlation = 0.5;   // of the windows, by that which noise leaves of equal ones
  double max_disagreement = 3.0;  // of the depths from two halves of the images, by its standard deviation

  void List(OptionTable& table);  // group "Surface"
};

// An image of a run: its pose and tracked points in one world.
struct SurfaceView {
  cv::Mat image;                               // 8-bit, 1 or 3 (BGR) channels, the camera's size
  cv::Mat valid;                               // CV_8UC1, 0 = not the surface
  Rigid3 cam_from_world;                       // map units
  std::vector<PointObservation> observations;  // sorted by id
};

// How the images were tracked: what noise and texture of a recording ask for.
struct TrackedImage {
  WorkingImage working;
  int patch_px = 15;        // side of a patch, in pixels of the working image
  double noise_levels = 0;  // standard deviation of its gray levels; 0: unknown
};

// Why a pixel has no depth: the first of these that holds.
enum class DepthRejection {
  kNotSurface,      // a mask, a highlight, the dark border
  kUnseen,          // no other image shows it, or nothing like it
  kLittleParallax,  // so little that no match is exact enough for max_sigma
  kNoMinimum,       // no depth is better than others: no texture
  kOutermost,       // the best depth is as far from that of the points as any that is tried
  kNearContour,     // a window sees surfaces of different depth
  kDisagreement,    // the two halves of the images tell different depths
  kUnlike,          // the windows differ at all depths
  kUncertain,       // sigma is above max_sigma
  kSpeckle,         // a small piece alone
};
inline constexpr std::size_t kDepthRejections = 10;

// In pixels of the images that are compared, each reason at its place.
using RejectedPixels = std::array<int, kDepthRejections>;

struct DenseDepth {
  cv::Mat depth;  // CV_32FC1, the camera's size, z along the optical axis, map units; 0 = none
  cv::Mat sigma;  // CV_32FC1, standard deviation of the depth by the depth; 0 = none
  RejectedPixels rejected = {};
};

class DenseDepthEstimator {
 public:
  // Fails as Camera::Resized.
  // Images are compared as they were tracked, but never enlarged.
  static Result<DenseDepthEstimator> Create(const Camera& camera, const TrackedImage& tracked,
                                            const DenseDepthOptions& options, int threads);
  DenseDepthEstimator(DenseDepthEstimator&&) noexcept;
  DenseDepthEstimator& operator=(DenseDepthEstimator&&) noexcept;
  ~DenseDepthEstimator();

  // Of `reference`, by `neighbors`. The same input gives the same answer on any number of threads. Fails with
  // kInsufficient where there are no neighbors, or fewer than 12 points in common with each of them.
  Result<DenseDepth> Estimate(const SurfaceView& reference, std::span<const SurfaceView> neighbors) const;

  // By which windows images are compared in the end.
  ComparedWindows windows() const;

 private:
  struct State;
  explicit DenseDepthEstimator(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pliant
