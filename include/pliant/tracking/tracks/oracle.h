// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Oracle switches: parts of the method replaced by the truth of a simulated scene, one at a time, to see which of them
// bounds the result. The rest of the method runs as it is; in particular the gates that drop points stay on.
//   first_map  the first image with enough corners is the reference, and the map exists there: every corner that shows
//              the surface, at its true depth on the ray of its pixel. Unit and sigmas are those of Init.method (mm, or
//              scaled to the nominal median depth), so that the map's error alone is switched off.
//   tracks     a point's pixel is that of the material point that it started on, for as long as that is visible, with
//              noise of a known size where that is wanted.
//   poses      the camera's pose is the true one and is held in the joint problem. World frame: the reference camera;
//              unit: the map's own, one unit being worth the median of the points' estimated by true depths.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/ids.h"
#include "pliant/base/options.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/tracking/bootstrapping/initializer.h"

namespace pliant {

struct OracleOptions {
  Switch first_map = Switch::kOff;
  Switch tracks = Switch::kOff;
  Switch poses = Switch::kOff;
  double track_noise_px = 0;  // standard deviation of a coordinate of a true track, after its first frame

  bool Any() const;
  std::vector<std::string_view> Names() const;  // of those that are on, in the order above
  void List(OptionTable& table);                // group "Oracle"
};

// Where a material point truly is in an image.
struct TrueTrack {
  enum class Sight { kVisible, kOccluded, kOutsideImage };
  Sight sight = Sight::kOutsideImage;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // when visible
};

// What an oracle is asked. Frames by the sequence's own numbers, lengths in mm, pixels as everywhere; the scene's world
// frame is its own affair. One caller at a time.
class TrackingTruth {
 public:
  virtual ~TrackingTruth() = default;

  virtual Rigid3 WorldFromCamera(int frame_idx) const = 0;
  // z in the frame's camera at each pixel, nothing where no surface is seen.
  virtual std::vector<std::optional<double>> DepthsAt(int frame_idx, std::span<const Eigen::Vector2d> pixels) = 0;
  // Starts to follow the material points seen at these pixels of the frame. One flag a point: zero where no surface is
  // seen, and nothing is followed.
  virtual std::vector<char> Follow(int frame_idx, std::span<const InitObservation> points) = 0;
  // The followed points in a frame, in the order of `ids`; ids that are not followed are outside the image.
  virtual std::vector<TrueTrack> Locate(int frame_idx, std::span<const PointId> ids) = 0;
};

}  // namespace pliant
