// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/sparse_surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "pliant/base/statistics.h"
#include "pliant/deformation/graph.h"

namespace pliant {
namespace {

constexpr double kNodesAcross = 64.0;
constexpr double kSurfaceStiffness = 0.05;  // of inverse distances by their median
constexpr double kMotionStiffness = 0.5;
constexpr double kSigmaStiffness = 5.0;
constexpr std::size_t kHeldOutOf = 4;   // every so many points are held out
constexpr double kUnknownSigma = 0.03;  // relative, of points that do not say theirs

struct Points {
  std::vector<Eigen::Vector3d> in_cam;
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> inverse_distances;
  std::vector<double> log_sigmas;  // relative
};

double Spacing(const Camera& camera) { return camera.width() / kNodesAcross; }
cv::Size SizeOf(const Camera& camera) { return {camera.width(), camera.height()}; }

Points PointsIn(const SurfaceView& view, const Camera& camera) {
  Points points;
  for (const PointObservation& observation : view.observations) {
    const Eigen::Vector3d in_cam = view.cam_from_world * observation.position;
    const auto pixel = camera.Project(in_cam);
    if (!pixel || !camera.Contains(*pixel)) continue;
    const double distance = in_cam.norm();
    points.in_cam.push_back(in_cam);
    points.pixels.push_back(*pixel);
    points.inverse_distances.push_back(1.0 / distance);
    points.log_sigmas.push_back(std::log(observation.sigma > 0.0 ? observation.sigma / distance : kUnknownSigma));
  }
  return points;
}

Eigen::MatrixXd Column(const std::vector<double>& values, double factor) {
  return factor * Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

GridField FitInverseDistances(const Camera& camera, const std::vector<Eigen::Vector2d>& pixels,
                              const std::vector<double>& values) {
  const double median = Median(values);
  GridField field =
      FitThinPlate(SizeOf(camera), Spacing(camera), pixels, Column(values, 1.0 / median), kSurfaceStiffness);
  const auto [least, largest] = std::ranges::minmax(values);
  field.values() = (median * field.values()).cwiseMax(0.5 * least).cwiseMin(2.0 * largest);
  return field;
}

// Without those that are held out: the first of every kHeldOutOf.
template <class T>
std::vector<T> Kept(const std::vector<T>& all) {
  std::vector<T> kept;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (i % kHeldOutOf != 0) kept.push_back(all[i]);
  return kept;
}

std::vector<HeldOutPoint> HoldOut(const Camera& camera, const Points& points) {
  const GridField field = FitInverseDistances(camera, Kept(points.pixels), Kept(points.inverse_distances));
  std::vector<HeldOutPoint> held_out;
  for (std::size_t i = 0; i < points.pixels.size(); i += kHeldOutOf)
    held_out.push_back({points.pixels[i], std::abs(points.inverse_distances[i] / field.At(points.pixels[i])[0] - 1.0)});
  return held_out;
}

Eigen::MatrixXd Rows(const std::vector<Eigen::Vector3d>& vectors) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(vectors.size()), 3);
  for (std::size_t i = 0; i < vectors.size(); ++i) rows.row(static_cast<Eigen::Index>(i)) = vectors[i].transpose();
  return rows;
}

// How far a point's nearest one is by its distance from the camera, in the median.
double Apart(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> apart;
  const NeighborLists nearest = NearestNeighbors(points, 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!nearest[i].empty())
      apart.push_back((points[i] - points[static_cast<std::size_t>(nearest[i].front())]).norm() / points[i].norm());
  return apart.empty() ? 1.0 : Median(apart);
}

double HeldOutMotionError(const Camera& camera, const std::vector<Eigen::Vector2d>& pixels,
                          const std::vector<Eigen::Vector3d>& motions, const std::vector<double>& distances) {
  const GridField field =
      FitThinPlate(SizeOf(camera), Spacing(camera), Kept(pixels), Rows(Kept(motions)), kMotionStiffness);
  std::vector<double> errors;
  for (std::size_t i = 0; i < pixels.size(); i += kHeldOutOf)
    errors.push_back((field.At(pixels[i]) - motions[i]).norm() / distances[i]);
  return Median(errors);
}

}  // namespace

std::optional<SparseSurface> FitSparseSurface(const SurfaceView& view, const Camera& camera) {
  const Points points = PointsIn(view, camera);
  if (points.pixels.size() < kMinPoints) return std::nullopt;
  return SparseSurface{
      FitInverseDistances(camera, points.pixels, points.inverse_distances),
      FitThinPlate(SizeOf(camera), Spacing(camera), points.pixels, Column(points.log_sigmas, 1.0), kSigmaStiffness),
      HoldOut(camera, points), points.in_cam, Apart(points.in_cam)};
}

double SparseSurface::Remoteness(const Eigen::Vector3d& in_cam) const {
  double nearest = std::numeric_limits<double>::max();
  for (const Eigen::Vector3d& point : points) nearest = std::min(nearest, (point - in_cam).squaredNorm());
  return std::max(1.0, std::sqrt(nearest) / (apart * in_cam.norm()));
}

std::optional<SurfaceMotion> FitMotion(const SurfaceView& reference, const SurfaceView& other, const Camera& camera) {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<Eigen::Vector3d> motions;
  std::vector<double> distances;
  auto there = other.observations.begin();
  for (const PointObservation& here : reference.observations) {
    while (there != other.observations.end() && there->id < here.id) ++there;
    if (there == other.observations.end()) break;
    if (there->id != here.id) continue;
    const Eigen::Vector3d in_cam = reference.cam_from_world * here.position;
    const auto pixel = camera.Project(in_cam);
    if (!pixel || !camera.Contains(*pixel)) continue;
    pixels.push_back(*pixel);
    motions.push_back(there->position - here.position);
    distances.push_back(in_cam.norm());
  }
  if (pixels.size() < kMinPoints) return std::nullopt;
  return SurfaceMotion{FitThinPlate(SizeOf(camera), Spacing(camera), pixels, Rows(motions), kMotionStiffness),
                       HeldOutMotionError(camera, pixels, motions, distances)};
}

}  // namespace pliant
