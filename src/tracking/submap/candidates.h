// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points that are followed but are not in the map yet. One enters it when its depth is certain: the deformation of its
// surroundings is taken off its motion, and the rest is parallax (docs/method.md, eq. G1 to G4, G7). Patches and pixels
// are the point tracker's; here is what is known of each point besides.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pliant/camera/camera.h"
#include "pliant/estimation/pose/moving_point.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/map_upkeep/growth_options.h"
#include "pliant/tracking/tracks/point_tracker.h"

namespace pliant {

class StateArchive;

// One point in one frame.
struct CandidateTrack {
  PointId id;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double ssim = 1;
  std::array<std::uint8_t, 3> rgb = {128, 128, 128};  // where it was first seen
  bool followed = false;                              // into a frame after that
};

class Candidates {
 public:
  Candidates(const Camera& camera, const GrowthOptions& options) : camera_(camera), options_(options) {}

  void Clear() { points_.clear(); }
  std::size_t size() const { return points_.size(); }
  // Those there are, as they were last seen; sorted by id.
  std::vector<CandidateTrack> tracks() const;

  // There has to be one with this id.
  const CandidateTrack& track(PointId id) const { return points_.at(id).track; }
  // Those that were followed, where they were last seen: not those that are new.
  std::vector<Eigen::Vector2d> FollowedPixels() const;
  // Where one was last seen; null where there is none with this id.
  const Eigen::Vector2d* Pixel(PointId id) const {
    const auto found = points_.find(id);
    return found == points_.end() ? nullptr : &found->second.track.pixel;
  }

  // A new one. False: its pixel has no ray, or the map no points, and it is none.
  bool Add(const CandidateTrack& track, const Rigid3& cam_from_world, const Map& map);
  // Where they are expected by a camera at this pose.
  std::vector<PointPrediction> Predict(const Rigid3& cam_from_world) const;
  // One that was followed into a frame with this pose and map. False: it is too old, and forgotten.
  bool AddView(const PointTrack& track, const Rigid3& cam_from_world, const Map& map);
  void Remove(PointId id) { points_.erase(id); }
  // Everything was moved alike, cameras and points.
  void Move(const Rigid3& motion);
  // The map was corrected: what its points moved by was no motion.
  void TakeCorrection(const Map& before, const Map& after);

  // One whose depth is certain, with its position now.
  struct CertainPoint {
    PointId id;
    Eigen::Vector3d position;
    double log_distance_sigma = 0;  // against the map; 0: not known
    bool from_surface = false;      // certain together with the points around it, and not by its own views
  };
  // Those whose depth is certain by their own views (G4), or, no less than the map's own points, together with the
  // surface around them (G7). `map_depth_sigma`: of the map's points, by their distance.
  std::vector<CertainPoint> Certain(const Rigid3& cam_from_world, const Map& map, double map_depth_sigma);
  // One as a landmark: at rest, and moving, as its surroundings are. Nothing when none of them is left.
  // Its distance is as uncertain as theirs, and as its own views leave it.
  std::optional<Landmark> AsLandmark(const CertainPoint& point, const Rigid3& cam_from_world, const Map& map) const;

  void Serialize(StateArchive& archive);

 private:
  // A landmark that was near when it was chosen, and where it was then.
  struct Anchor {
    PointId id;
    Eigen::Vector3d position;
    void Serialize(StateArchive& archive);
  };
  // Of its surroundings, since the first view (G1, G2).
  struct Displacement {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double sigma = 0;     // how much the anchors differ
    double gradient = 0;  // the same by the distance between them
    void Serialize(StateArchive& archive);
  };
  struct Point {
    CandidateTrack track;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // best guess, now
    std::vector<Rigid3> cams_from_world;                 // one a view
    std::vector<Eigen::Vector3d> rays;
    std::vector<Displacement> displacements;
    std::vector<Anchor> anchors;
    Eigen::Vector3d anchored_at = Eigen::Vector3d::Zero();  // their mean position
    Displacement before;                                    // until they were chosen
    void Serialize(StateArchive& archive);
  };

  void ChooseAnchors(const Map& map, Point* point) const;
  std::optional<Displacement> SinceAnchors(const Point& point, const Map& map) const;
  bool AppendView(const Rigid3& cam_from_world, const Map& map, Point* point) const;
  Result<MovingPoint> Triangulate(const Point& point, const std::optional<DistancePrior>& surface) const;
  MovingPoint MoveGuess(const std::optional<DistancePrior>& surface, Point* point) const;

  Camera camera_;
  GrowthOptions options_;
  std::map<PointId, Point> points_;
};

}  // namespace pliant
