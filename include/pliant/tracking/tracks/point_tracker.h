// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Follows points from image to image and decides what each is compared with. Two policies, by name:
//   periodic  a new reference patch is cut every few images (Gomez Rodriguez et al., IROS 2022). Each cut adds the
//             error of the moment for good, so a track drifts.
//   adaptive  keeps the first patch. The latest image's patch finds the point, then the point is re-aligned to the
//             first patch seen through the affine change since, so errors do not add up. Only when the first patch no
//             longer resembles what is seen is a new one cut (one error is committed), and not before.
// Pixels: (0, 0) is the center of the first pixel. Memory grows with the points only. docs/method.md, eq. P7 to P9.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/ids.h"
#include "pliant/image/masks.h"
#include "pliant/image/pyramid.h"
#include "pliant/photometric/lucas_kanade.h"

namespace pliant {

class StateArchive;

enum class PatchPolicy { kPeriodic, kAdaptive };
template <>
struct EnumNames<PatchPolicy> {
  static constexpr std::array kNames = {std::pair{PatchPolicy::kPeriodic, std::string_view("periodic")},
                                        std::pair{PatchPolicy::kAdaptive, std::string_view("adaptive")}};
};

struct PointTrackerOptions {
  LucasKanadeOptions lucas_kanade;
  PatchPolicy patch_policy = PatchPolicy::kAdaptive;
  int refresh_period = 5;      // images; periodic only
  double refresh_ssim = 0.85;  // adaptive: a new first patch is cut when similarity to the first falls below
  AlignmentModel realignment = AlignmentModel::kAffine;  // adaptive: what is refined against the first patch
  double max_realignment_px = 1.5;  // adaptive: a re-alignment that jumps farther from the latest patch is refused
  double max_scale = 2;             // adaptive: a neighborhood stretched or shrunk by more gets a new first patch
  Switch forward_backward = Switch::kOn;
  double max_forward_backward_px = 0.75;

  void List(OptionTable& table);  // groups "LucasKanade" and "PointTracker"
};

// Where a point is expected in the next image.
struct PointPrediction {
  PointId id;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  // How the neighborhood in the latest image is expected to map to the next (identity: as it was).
  Eigen::Matrix2d affine_from_latest = Eigen::Matrix2d::Identity();
};

enum class Refreshed { kNo, kYes };

struct PointTrack {
  PointId id;
  PatchFailure failure = PatchFailure::kNone;  // anything else: the point is not in this image; `pixel` is a guess
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double ssim = 0;  // to the reference patch
  double gain = 1;  // brightness from this image to the reference patch's: alpha, beta
  double bias = 0;
  // How the neighborhood in the image where the point was added maps to this one.
  Eigen::Matrix2d affine_from_first = Eigen::Matrix2d::Identity();
  Refreshed refreshed = Refreshed::kNo;  // a new reference patch was cut in this image
};

class PointTracker {
 public:
  explicit PointTracker(const PointTrackerOptions& options) : options_(options) {}

  // Starts to follow the point seen at `pixel`; kNone, or why its patch cannot be followed (then nothing is kept).
  // An id that is known is replaced.
  PatchFailure Add(PointId id, const Eigen::Vector2d& pixel, const ImagePyramid& pyramid, const SupportMask& mask);
  void Remove(PointId id) { points_.erase(id); }
  void Clear() { points_.clear(); }
  std::size_t size() const { return points_.size(); }
  bool Contains(PointId id) const { return points_.contains(id); }
  // Where a known point was last seen, as far as it is kept.
  const Eigen::Vector2d& PixelOf(PointId id) const { return points_.at(id).pixel; }

  // Follows the predicted points from the image they were last seen in (`previous`; every predicted point must have
  // been added or tracked there) into `current`. One result a prediction, in their order, whatever the number of
  // threads. A point that fails stays known, at its last good place; the caller removes it.
  std::vector<PointTrack> Track(const ImagePyramid& previous, const SupportMask& previous_mask,
                                const ImagePyramid& current, const SupportMask& current_mask,
                                std::span<const PointPrediction> predictions, int threads);

  // Searches points that are known but were not seen in the latest image around the predicted pixels, each as it was
  // when it was last seen, changed by `affine_from_latest`; part of the attempt. Only what resembles a point's
  // reference patch is that point again. Periodic patches find nothing.
  std::vector<PointTrack> Find(const ImagePyramid& current, const SupportMask& current_mask,
                               std::span<const PointPrediction> predictions, int threads);

  // What the attempt found of these points is right: they are now where it found them. Of others it is forgotten with
  // the next attempt. Ids that are not known, or were not found, have no effect.
  void Keep(std::span<const PointId> ids);

  // Between two attempts.
  void Serialize(StateArchive& archive);

 private:
  // What an attempt found of a point; it becomes the point's own with Keep.
  struct Step {
    enum class Patch { kKept, kLatest, kReference };  // what was cut: nothing, the latest, the reference as well
    std::int64_t attempt = 0;                         // that found it; 0: none
    Patch patch = Patch::kKept;
    ReferencePatch latest;
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    Eigen::Matrix2d affine_from_reference = Eigen::Matrix2d::Identity();
    Eigen::Matrix2d affine_from_first = Eigen::Matrix2d::Identity();
  };
  struct Point {
    ReferencePatch reference;                         // adaptive: the first, for alignment; periodic: the last one cut
    ReferencePatch latest;                            // adaptive: cut in the latest image
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // in the latest image
    Eigen::Matrix2d affine_from_reference = Eigen::Matrix2d::Identity();
    Eigen::Matrix2d reference_affine_from_first = Eigen::Matrix2d::Identity();
    int age = 0;  // images since the reference was cut
    Step next;

    void TakeStep(PatchPolicy policy);
    void TakeReference(PatchPolicy policy);  // the latest patch
  };
  struct Images;

  PatchMatch FollowLatest(const Point& point, const PointPrediction& prediction, const Images& images,
                          Eigen::Vector2d* expected_motion) const;
  PatchMatch Realign(const Point& point, const PatchMatch& found, const Eigen::Matrix2d& affine,
                     const Images& images) const;
  bool Returns(const ReferencePatch& patch, const Eigen::Vector2d& expected_motion, const Eigen::Vector2d& origin,
               const Images& images) const;
  PointTrack TrackOne(const PointPrediction& prediction, const Images& images, Point* point) const;
  PointTrack FindOne(const PointPrediction& prediction, const Images& images, Point* point) const;
  template <class Function>
  std::vector<PointTrack> ForEach(std::span<const PointPrediction> predictions, int threads, const Function& function);
  static void TakeMatch(const PatchMatch& match, const Point& point, PointTrack* track);
  void PrepareStep(const PointTrack& track, const PatchMatch& match, Step::Patch patch, Point* point) const;

  PointTrackerOptions options_;
  std::map<PointId, Point> points_;
  std::int64_t attempt_ = 1;  // the present one
};

// The 2x2 affine change of every point's neighborhood between two images, from how its `neighbors` nearest points
// moved relative to it: least squares, pulled towards the identity by `damping_px` (noise of a relative motion over the
// change expected between two images: 0.3 px / 0.05), so that few, near or collinear neighbors change little.
// Neighbors that disagree with the rest are down-weighted (one reweighting). `from`, `to` and the result are of equal
// length.
std::vector<Eigen::Matrix2d> NeighborhoodAffines(std::span<const Eigen::Vector2d> from,
                                                 std::span<const Eigen::Vector2d> to, int neighbors = 8,
                                                 double damping_px = 6);

}  // namespace pliant
