// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Maps that meet become one (docs/method.md, eq. R4): an image in which a map that was left is found, while another one
// is tracked, has a pose in both worlds, and points whose depths tell the one's unit in the other's.
#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/base/statistics.h"
#include "pliant/tracking/tracker.h"
#include "tracking/followed.h"
#include "tracking/oracle_answers.h"
#include "tracking/submap.h"
#include "tracking/tracker_support.h"

namespace pliant {
namespace {

constexpr std::size_t kNearest = 8;     // landmarks that tell the depth of a pixel
constexpr double kFarthestShare = 0.1;  // of the image's width, they are away from it
constexpr double kNear = 0.01;          // squared share of that: nearer ones count alike
constexpr double kFlat = 0.1;           // weight of no slope, of a landmark's at that distance
// Pixels that must tell the unit: where maps overlap by an edge alone, what is beside it says little.
constexpr std::size_t kMinRatios = 30;

// A pixel of the image, and how far from the camera what it shows is.
struct PixelDistance {
  Eigen::Vector2d pixel;
  double distance;
};

// The logarithm of the distance at a pixel, from the nearest of those that are known: of the plane through them, over
// the image, the nearer the more, as the wall is seen aslant. Nothing where there are none.
std::optional<double> LogDistanceAt(const Eigen::Vector2d& pixel, std::vector<PixelDistance>& known, double radius_px) {
  const auto nearer = [&](const PixelDistance& a, const PixelDistance& b) {
    return (a.pixel - pixel).squaredNorm() < (b.pixel - pixel).squaredNorm();
  };
  if (known.size() < kNearest) return std::nullopt;
  std::partial_sort(known.begin(), known.begin() + kNearest, known.end(), nearer);
  Eigen::Matrix3d normal = Eigen::Vector3d(0, kFlat, kFlat).asDiagonal();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < kNearest; ++k) {
    const Eigen::Vector2d offset = (known[k].pixel - pixel) / radius_px;
    if (offset.squaredNorm() > 1) return std::nullopt;
    const Eigen::Vector3d row(1, offset.x(), offset.y());
    const double weight = 1 / (kNear + offset.squaredNorm());
    normal += weight * row * row.transpose();
    right += weight * std::log(known[k].distance) * row;
  }
  return normal.ldlt().solve(right).x();
}

// How many of the first one's units one of the second's is: the median over the first one's pixels. Nothing where too
// few pixels tell it, or where they differ too much.
std::optional<double> UnitRatio(const std::vector<PixelDistance>& first, std::vector<PixelDistance> second,
                                double radius_px, double max_spread) {
  std::vector<double> logs;
  for (const PixelDistance& point : first)
    if (const auto log_distance = LogDistanceAt(point.pixel, second, radius_px))
      logs.push_back(std::log(point.distance) - *log_distance);
  if (logs.size() < kMinRatios) return std::nullopt;
  const double median = Median(logs);
  for (double& log : logs) log = std::abs(log - median);
  if (Median(std::move(logs)) > max_spread) return std::nullopt;
  return std::exp(median);
}

}  // namespace

// Where the points of a map that was left are found in the image like lost ones.
bool Tracker::JoinsMaps() const {
  return options_.relocalization.join == Switch::kOn && options_.relocalization.relocalize == Switch::kOn &&
         options_.find_lost == Switch::kOn && options_.point_tracker.patch_policy == PatchPolicy::kAdaptive &&
         !options_.oracle.Any();
}

// A map that was left, if it is found in the image that the present one has a pose in: inactive_from_current.
std::optional<Sim3> Tracker::SeenWithPresent(const TrackerFrame& frame, std::unique_ptr<Submap>* left) {
  Rigid3 cam_from_left;
  const Followed followed = LookFor(left, frame, &cam_from_left);
  if (followed.size() == 0 || followed.in_blur) return std::nullopt;

  std::vector<PixelDistance> in_left;
  for (std::size_t k = 0; k < followed.size(); ++k)
    in_left.push_back({followed.pixels[k], (cam_from_left * followed.positions[k]).norm()});
  std::vector<PixelDistance> in_now;
  for (const Landmark& landmark : current_->map.landmarks)
    in_now.push_back({landmark.pixel, (current_->last_cam_from_world * landmark.position).norm()});
  const auto unit =
      UnitRatio(in_left, std::move(in_now), kFarthestShare * camera_.width(), options_.relocalization.max_unit_spread);
  if (!unit) return std::nullopt;
  return WorldFromPoses(cam_from_left, current_->last_cam_from_world, *unit);
}

// The older map's world stays. One map that was left is looked for at a time, in turn.
void Tracker::JoinMaps(const TrackerFrame& frame, FrameReport* report) {
  const int every = options_.relocalization.join_every;
  if (!JoinsMaps() || inactive_submaps_.empty() || frame.frame_idx % every != 0) return;
  if (state_ != TrackingState::kTracking || blurred_frames_ > 0) return;
  const StageTimer timer(report, "initialize");
  const auto left =
      inactive_submaps_.begin() + static_cast<std::ptrdiff_t>(frame.frame_idx / every % inactive_submaps_.size());
  const auto inactive_from_current = SeenWithPresent(frame, &*left);
  if (!inactive_from_current) return;
  const bool left_is_older = (*left)->idx < current_->idx;
  Submap& younger = left_is_older ? *current_ : **left;
  const int older_idx = std::min((*left)->idx, current_->idx);
  report->join = {younger.idx, older_idx, left_is_older ? *inactive_from_current : inactive_from_current->Inverse()};
  younger.MoveInto(report->join->into_from_submap);
  current_->idx = older_idx;
  current_->TakeOver(std::move(**left));
  inactive_submaps_.erase(left);
  report->note = WithFault(report->note, "map " + std::to_string(report->join->submap) + " is now part of map " +
                                             std::to_string(older_idx) + ", which this image shows too");
}

}  // namespace pliant
