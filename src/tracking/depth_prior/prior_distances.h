// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a frame's depth prior says of the distance of a pixel (docs/method.md, N1 and N2).
#pragma once

#include <span>

#include <Eigen/Core>

#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/depth_prior/depth_prior_options.h"
#include "pliant/tracking/prepared_frame.h"

namespace pliant {

class PriorDistances {
 public:
  // All arguments must outlive this. The frame may have no prior: then nothing is ever said.
  PriorDistances(const PreparedFrame& frame, const Camera& camera, const DepthPriorOptions& options)
      : frame_(frame), camera_(camera), options_(options) {}

  // Scale and shift of the frame, by points whose distance from the camera is known (N2); robust. False, and nothing
  // changes, where fewer than twelve of them have a prior, or where it says the contrary of them.
  bool AlignTo(std::span<const Eigen::Vector2d> pixels, std::span<const double> distances);
  // The same by a map's landmarks, as the frame's camera sees them.
  bool AlignTo(const Map& map, const Rigid3& cam_from_world);

  // Log distance from the camera, in the points' unit; before AlignTo up to a constant, with no shift. NaN: it says
  // nothing, since there is no value, a contour, or no ray.
  double LogAt(const Eigen::Vector2d& pixel) const;

 private:
  // The image's own value, and the share of the distance that lies along the optical axis; NaNs: none.
  struct Value {
    double value;
    double cosine;
  };
  Value ValueAt(const Eigen::Vector2d& pixel) const;

  const PreparedFrame& frame_;
  const Camera& camera_;
  const DepthPriorOptions& options_;
  double scale_ = 1.0;  // scale * value + shift is z, or 1 / z
  double shift_ = 0.0;
};

}  // namespace pliant
