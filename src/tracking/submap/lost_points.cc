// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/lost_points.h"

#include <algorithm>

#include <Eigen/LU>

#include "pliant/deformation/graph.h"
#include "pliant/scene/serialize.h"

namespace pliant {
namespace {

constexpr int kLostNeighbors = 8;
constexpr int kVainSearches = 10;  // of a point that should be in sight: it is hidden, or changed, and may stay so

// How the neighborhood of a point changes in the image between two poses that see it at these positions, if it faces
// both of them: it lies across the ray to the point. Nothing where a camera cannot see it.
std::optional<Eigen::Matrix2d> FacingAffine(const Camera& camera, const Rigid3& before,
                                            const Eigen::Vector3d& position_before, const Rigid3& now,
                                            const Eigen::Vector3d& position_now) {
  const auto seen_before = camera.ProjectWithJacobian(before * position_before);
  const auto seen_now = camera.ProjectWithJacobian(now * position_now);
  if (!seen_before || !seen_now) return std::nullopt;
  const Eigen::Vector3d ray = (before * position_before).normalized();
  Eigen::Matrix<double, 3, 2> across;
  across.col(0) = ray.unitOrthogonal();
  across.col(1) = ray.cross(across.col(0));
  const Eigen::Quaterniond turn = now.rotation * before.rotation.conjugate();
  const Eigen::Quaterniond refacing = Eigen::Quaterniond::FromTwoVectors(turn * ray, now * position_now);
  return seen_now->d_pixel_d_point * (refacing * turn).toRotationMatrix() * across *
         (seen_before->d_pixel_d_point * across).inverse();
}

// The pixel of a point in the camera's frame, when the image shows it.
std::optional<Eigen::Vector2d> PixelOf(const Camera& camera, const Eigen::Vector3d& in_cam) {
  const auto pixel = camera.Project(in_cam);
  return pixel && camera.Contains(*pixel) ? pixel : std::nullopt;
}

}  // namespace

std::vector<Eigen::Vector3d> DisplacementsAt(const std::vector<Landmark>& landmarks,
                                             const std::vector<Eigen::Vector3d>& anchors,
                                             const std::vector<Eigen::Vector3d>& positions) {
  std::vector<Eigen::Vector3d> displacements(positions.size(), Eigen::Vector3d::Zero());
  if (landmarks.empty()) return displacements;
  const NeighborLists nearest = NearestNeighbors(anchors, positions, kLostNeighbors);
  for (std::size_t k = 0; k < positions.size(); ++k) {
    // Inverse-distance weights: at an anchor the displacement is that landmark's.
    double sum = 0;
    for (const int j : nearest[k]) {
      const double weight = 1.0 / (1e-6 + (anchors[j] - positions[k]).squaredNorm());
      displacements[k] += weight * (landmarks[j].position - landmarks[j].rest_position);
      sum += weight;
    }
    if (sum > 0) displacements[k] /= sum;
  }
  return displacements;
}

void TakeRestFrom(const std::vector<Landmark>& seen, std::vector<Landmark>* others) {
  std::vector<Eigen::Vector3d> anchors;
  std::vector<Eigen::Vector3d> positions;
  for (const Landmark& landmark : seen) anchors.push_back(landmark.position);
  for (const Landmark& landmark : *others) positions.push_back(landmark.position);
  const std::vector<Eigen::Vector3d> displacements = DisplacementsAt(seen, anchors, positions);
  for (std::size_t k = 0; k < others->size(); ++k)
    (*others)[k].rest_position = (*others)[k].position - displacements[k];
}

void LostPoints::Add(const Landmark& landmark, const Rigid3& cam_from_world) {
  points_[landmark.id] = {landmark, cam_from_world, landmark.position, {}, 0, next_order_++};
}

void LostPoints::MoveInto(const Sim3& other_from_world) {
  for (auto& [id, point] : points_) {
    point.landmark = Moved(other_from_world, point.landmark);
    point.cam_from_world = PoseInWorld(other_from_world, point.cam_from_world);
    point.seen_at = other_from_world * point.seen_at;
    if (point.own_share) point.own_share = other_from_world.Turn(*point.own_share);
  }
}

void LostPoints::MoveAllButRest(const Rigid3& motion) {
  const Rigid3 back = motion.Inverse();
  for (auto& [id, point] : points_) {
    point.landmark.position = motion * point.landmark.position;
    point.landmark.determined_at = motion * point.landmark.determined_at;
    point.cam_from_world = point.cam_from_world * back;
    point.seen_at = motion * point.seen_at;
    if (point.own_share) point.own_share = motion.rotation * *point.own_share;
  }
}

void LostPoints::ScaleSigmas(double factor) {
  for (auto& [id, point] : points_) point.landmark.log_distance_sigma *= factor;
}

void LostPoints::TakeOver(LostPoints&& other, const std::vector<Landmark>& seen) {
  for (auto& [id, point] : points_) point.order += other.next_order_;
  next_order_ += other.next_order_;
  std::vector<Landmark> others = other.landmarks();
  TakeRestFrom(seen, &others);
  for (const Landmark& landmark : others) {
    Point& point = other.points_.at(landmark.id);
    point.landmark = landmark;
    point.own_share.reset();  // it was told by its own map's points
  }
  points_.merge(other.points_);
}

PointId LostPoints::Oldest() const {
  return std::min_element(points_.begin(), points_.end(),
                          [](const auto& a, const auto& b) { return a.second.order < b.second.order; })
      ->first;
}

void LostPoints::Move(const std::vector<Landmark>& seen) {
  if (points_.empty() || seen.empty()) return;
  std::vector<Eigen::Vector3d> anchors;
  std::vector<Eigen::Vector3d> wanted;
  for (const Landmark& landmark : seen) anchors.push_back(landmark.rest_position);
  for (const auto& [id, point] : points_) wanted.push_back(point.landmark.rest_position);
  const std::vector<Eigen::Vector3d> displacements = DisplacementsAt(seen, anchors, wanted);
  auto displacement = displacements.begin();
  for (auto& [id, point] : points_) {
    if (!point.own_share) point.own_share = point.landmark.position - point.landmark.rest_position - *displacement;
    point.landmark.position = point.landmark.rest_position + *displacement + *point.own_share;
    ++displacement;
  }
}

std::vector<Eigen::Vector2d> LostPoints::Pixels(const Camera& camera, const Rigid3& cam_from_world) const {
  std::vector<Eigen::Vector2d> pixels;
  for (const auto& [id, point] : points_) {
    if (point.searches >= kVainSearches) continue;
    if (const auto pixel = PixelOf(camera, cam_from_world * point.landmark.position)) pixels.push_back(*pixel);
  }
  return pixels;
}

std::vector<PointPrediction> LostPoints::Expected(const Camera& camera, const Rigid3& cam_from_world,
                                                  std::size_t count) const {
  std::vector<std::pair<int, PointPrediction>> expected;  // by how often it was searched
  for (const auto& [id, point] : points_) {
    const Eigen::Vector3d& position = point.landmark.position;
    const auto pixel = PixelOf(camera, cam_from_world * position);
    const auto affine = FacingAffine(camera, point.cam_from_world, point.seen_at, cam_from_world, position);
    if (pixel && affine) expected.push_back({point.searches, {id, *pixel, *affine}});
  }
  const auto rarest = [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second.id < b.second.id;
  };
  std::sort(expected.begin(), expected.end(), rarest);
  expected.resize(std::min(expected.size(), count));
  std::vector<PointPrediction> predictions;
  for (const auto& [searches, prediction] : expected) predictions.push_back(prediction);
  return predictions;
}

void LostPoints::CountSearches(const std::vector<PointId>& ids) {
  for (const PointId id : ids)
    if (const auto found = points_.find(id); found != points_.end()) ++found->second.searches;
}

std::vector<Landmark> LostPoints::landmarks() const {
  std::vector<Landmark> landmarks;
  for (const auto& [id, point] : points_) landmarks.push_back(point.landmark);
  return landmarks;
}

const Landmark* LostPoints::Find(PointId id) const {
  const auto found = points_.find(id);
  return found == points_.end() ? nullptr : &found->second.landmark;
}

void LostPoints::Serialize(StateArchive& archive) { archive(points_, next_order_); }
void LostPoints::Point::Serialize(StateArchive& archive) { archive.Members<6>(*this); }

}  // namespace pliant
