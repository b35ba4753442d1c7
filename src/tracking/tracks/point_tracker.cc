// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracks/point_tracker.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "pliant/base/parallel.h"
#include "pliant/photometric/serialize.h"
#include "pliant/scene/serialize.h"
#include "tracking/tracks/nearest_in_plane.h"

namespace pliant {
namespace {

constexpr double kMaxAffineJump = 0.25;  // a refined neighborhood farther from the expected one is a wrong fit
constexpr double kOtherStart_px = 1;     // starts closer than this are one and the same

Pixel ToPixel(const Eigen::Vector2d& p) { return {p.x(), p.y()}; }
Eigen::Vector2d ToVector(Pixel p) { return {p.x, p.y}; }
Affine2 ToAffine2(const Eigen::Matrix2d& m) { return {m(0, 0), m(0, 1), m(1, 0), m(1, 1)}; }
Eigen::Matrix2d ToMatrix(const Affine2& a) {
  Eigen::Matrix2d m;
  m << a.xx, a.xy, a.yx, a.yy;
  return m;
}

bool WithinScale(const Eigen::Matrix2d& affine, double max_scale) {
  const Eigen::Vector2d s = affine.jacobiSvd().singularValues();
  return s[0] <= max_scale && s[1] * max_scale >= 1;
}

}  // namespace

struct PointTracker::Images {
  const ImagePyramid& previous;
  const SupportMask& previous_mask;
  const ImagePyramid& current;
  const SupportMask& current_mask;
};

void PointTrackerOptions::List(OptionTable& table) {
  lucas_kanade.List(table);
  table.BeginGroup("PointTracker", "what a point is compared with from image to image");
  table.AddChoice("patch_policy", &patch_policy,
                  "periodic: cut new reference patches every few images; adaptive: only when they no longer match");
  table.Add("refresh_period", &refresh_period, "images", "periodic: how long a reference patch is kept", 1, 1000000);
  table.Add("refresh_ssim", &refresh_ssim, "-",
            "adaptive: a new first patch is cut when similarity to the first falls below", -1, 1);
  table.AddChoice("realignment", &realignment, "adaptive: what is refined against the first patch");
  table.Add("max_realignment_px", &max_realignment_px, "px",
            "adaptive: a re-alignment that jumps farther from the latest patch's track is refused", 0, 100);
  table.Add("max_scale", &max_scale, "-", "adaptive: a neighborhood stretched or shrunk by more gets a new first patch",
            1, 4);
  table.AddChoice("forward_backward", &forward_backward,
                  "follow each track back to the previous image; it must return to its start");
  table.Add("max_forward_backward_px", &max_forward_backward_px, "px", "maximum distance from its start", 0, 100);
}

PatchFailure PointTracker::Add(PointId id, const Eigen::Vector2d& pixel, const ImagePyramid& pyramid,
                               const SupportMask& mask) {
  Point point;
  const AffineSolution affine =
      options_.patch_policy == PatchPolicy::kAdaptive ? AffineSolution::kWith : AffineSolution::kWithout;
  const PatchFailure failure =
      CutReferencePatch(pyramid, mask, ToPixel(pixel), options_.lucas_kanade, affine, &point.latest);
  if (failure != PatchFailure::kNone) {
    points_.erase(id);
    return failure;
  }
  point.TakeReference(options_.patch_policy);
  point.pixel = pixel;
  points_[id] = std::move(point);
  return PatchFailure::kNone;
}

// From the predicted pixel; should that fail, from where the point was.
PatchMatch PointTracker::FollowLatest(const Point& point, const PointPrediction& prediction, const Images& images,
                                      Eigen::Vector2d* expected_motion) const {
  const ReferencePatch& patch = options_.patch_policy == PatchPolicy::kAdaptive ? point.latest : point.reference;
  const auto from = [&](const Eigen::Vector2d& start) {
    return TrackPatch(patch, images.current, images.current_mask, ToPixel(start), options_.lucas_kanade);
  };
  *expected_motion = prediction.pixel - point.pixel;
  const PatchMatch match = from(prediction.pixel);
  if (match.failure == PatchFailure::kNone || expected_motion->norm() < kOtherStart_px) return match;
  const PatchMatch again = from(point.pixel);
  if (again.failure != PatchFailure::kNone) return match;
  expected_motion->setZero();
  return again;
}

// The point against its first patch. Its failure says that the first patch no longer finds it.
PatchMatch PointTracker::Realign(const Point& point, const PatchMatch& found, const Eigen::Matrix2d& affine,
                                 const Images& images) const {
  const auto align = [&](Pixel start, AlignmentModel model) {
    PatchMatch match = AlignPatch(point.reference, images.current, images.current_mask, start, ToAffine2(affine), model,
                                  options_.lucas_kanade);
    const bool jumps = (ToVector(match.pixel) - ToVector(found.pixel)).norm() > options_.max_realignment_px;
    const bool bends = (ToMatrix(match.affine) - affine).norm() > kMaxAffineJump;
    if (match.failure == PatchFailure::kNone && (jumps || bends)) match.failure = PatchFailure::kDiverged;
    return match;
  };
  PatchMatch shifted = align(found.pixel, AlignmentModel::kTranslation);
  if (options_.realignment == AlignmentModel::kTranslation) return shifted;
  const PatchMatch warped =
      align(shifted.failure == PatchFailure::kNone ? shifted.pixel : found.pixel, AlignmentModel::kAffine);
  return warped.failure == PatchFailure::kNone &&
                 !(shifted.failure == PatchFailure::kNone && shifted.ssim > warped.ssim)
             ? warped
             : shifted;
}

bool PointTracker::Returns(const ReferencePatch& patch, const Eigen::Vector2d& expected_motion,
                           const Eigen::Vector2d& origin, const Images& images) const {
  const Eigen::Vector2d start = ToVector(patch.center) - expected_motion;
  const PatchMatch back =
      TrackPatch(patch, images.previous, images.previous_mask, ToPixel(start), options_.lucas_kanade);
  return back.failure == PatchFailure::kNone &&
         (ToVector(back.pixel) - origin).norm() <= options_.max_forward_backward_px;
}

void PointTracker::TakeMatch(const PatchMatch& match, const Point& point, PointTrack* track) {
  track->pixel = ToVector(match.pixel);
  track->ssim = match.ssim;
  track->gain = match.gain;
  track->bias = match.bias;
  track->affine_from_first = ToMatrix(match.affine) * point.reference_affine_from_first;
}

PointTrack PointTracker::TrackOne(const PointPrediction& prediction, const Images& images, Point* point) const {
  point->next.attempt = 0;
  const bool adaptive = options_.patch_policy == PatchPolicy::kAdaptive;
  const Eigen::Matrix2d expected = prediction.affine_from_latest * point->affine_from_reference;
  PointTrack track;
  track.id = prediction.id;
  track.affine_from_first = expected * point->reference_affine_from_first;
  Eigen::Vector2d expected_motion;
  PatchMatch match = FollowLatest(*point, prediction, images, &expected_motion);
  match.affine = ToAffine2(expected);
  track.failure = match.failure;
  const Pixel by_latest = match.pixel;
  bool refresh = !adaptive && point->age + 1 >= options_.refresh_period;
  if (adaptive && track.failure == PatchFailure::kNone) {
    const PatchMatch aligned = Realign(*point, match, expected, images);
    const bool found = aligned.failure == PatchFailure::kNone;
    if (found) match = aligned;
    refresh = !found || match.ssim < options_.refresh_ssim || !WithinScale(ToMatrix(match.affine), options_.max_scale);
  }
  TakeMatch(match, *point, &track);
  if (track.failure != PatchFailure::kNone) return track;

  thread_local ReferencePatch cut;  // takes over the memory of the patch that it replaces
  if (adaptive || refresh || options_.forward_backward == Switch::kOn) {
    const AffineSolution affine = adaptive && refresh ? AffineSolution::kWith : AffineSolution::kWithout;
    track.failure =
        CutReferencePatch(images.current, images.current_mask, match.pixel, options_.lucas_kanade, affine, &cut);
    // The way back is that of the latest patch: what re-alignment corrected is not held against the point.
    const Eigen::Vector2d origin = point->pixel + track.pixel - ToVector(by_latest);
    if (track.failure == PatchFailure::kNone && options_.forward_backward == Switch::kOn &&
        !Returns(cut, expected_motion, origin, images))
      track.failure = PatchFailure::kForwardBackward;
    if (track.failure != PatchFailure::kNone) return track;
    std::swap(cut, point->next.latest);
    PrepareStep(track, match, refresh ? Step::Patch::kReference : Step::Patch::kLatest, point);
  } else {
    PrepareStep(track, match, Step::Patch::kKept, point);
  }
  track.refreshed = refresh ? Refreshed::kYes : Refreshed::kNo;
  return track;
}

void PointTracker::PrepareStep(const PointTrack& track, const PatchMatch& match, Step::Patch patch,
                               Point* point) const {
  point->next.patch = patch;
  point->next.pixel = track.pixel;
  point->next.affine_from_reference = ToMatrix(match.affine);
  point->next.affine_from_first = track.affine_from_first;
  point->next.attempt = attempt_;
}

PointTrack PointTracker::FindOne(const PointPrediction& prediction, const Images& images, Point* point) const {
  point->next.attempt = 0;
  const Eigen::Matrix2d expected = prediction.affine_from_latest * point->affine_from_reference;
  PointTrack track;
  track.id = prediction.id;
  track.pixel = prediction.pixel;
  track.failure = PatchFailure::kLowSimilarity;
  if (options_.patch_policy != PatchPolicy::kAdaptive) return track;
  PatchMatch match =
      TrackPatch(point->latest, images.current, images.current_mask, ToPixel(prediction.pixel), options_.lucas_kanade);
  track.failure = match.failure;
  if (track.failure != PatchFailure::kNone) return track;
  match = Realign(*point, match, expected, images);
  track.failure = match.failure;
  TakeMatch(match, *point, &track);
  if (track.failure != PatchFailure::kNone) return track;
  track.failure = CutReferencePatch(images.current, images.current_mask, match.pixel, options_.lucas_kanade,
                                    AffineSolution::kWithout, &point->next.latest);
  if (track.failure == PatchFailure::kNone) PrepareStep(track, match, Step::Patch::kLatest, point);
  return track;
}

void PointTracker::Point::TakeReference(PatchPolicy policy) {
  reference = policy == PatchPolicy::kAdaptive ? latest.TakeForAlignment() : latest;
}

void PointTracker::Point::TakeStep(PatchPolicy policy) {
  next.attempt = 0;
  pixel = next.pixel;
  affine_from_reference = next.affine_from_reference;
  ++age;
  if (next.patch == Step::Patch::kKept) return;
  std::swap(latest, next.latest);
  if (next.patch == Step::Patch::kLatest) return;
  TakeReference(policy);
  reference_affine_from_first = next.affine_from_first;
  affine_from_reference.setIdentity();
  age = 0;
}

void PointTracker::Keep(std::span<const PointId> ids) {
  for (const PointId id : ids)
    if (const auto found = points_.find(id); found != points_.end() && found->second.next.attempt == attempt_)
      found->second.TakeStep(options_.patch_policy);
}

std::vector<PointTrack> PointTracker::Track(const ImagePyramid& previous, const SupportMask& previous_mask,
                                            const ImagePyramid& current, const SupportMask& current_mask,
                                            std::span<const PointPrediction> predictions, int threads) {
  ++attempt_;
  const Images images{previous, previous_mask, current, current_mask};
  return ForEach(predictions, threads,
                 [&](const PointPrediction& prediction, Point* point) { return TrackOne(prediction, images, point); });
}

std::vector<PointTrack> PointTracker::Find(const ImagePyramid& current, const SupportMask& current_mask,
                                           std::span<const PointPrediction> predictions, int threads) {
  const Images images{current, current_mask, current, current_mask};
  return ForEach(predictions, threads,
                 [&](const PointPrediction& prediction, Point* point) { return FindOne(prediction, images, point); });
}

template <class Function>
std::vector<PointTrack> PointTracker::ForEach(std::span<const PointPrediction> predictions, int threads,
                                              const Function& function) {
  std::vector<Point*> points;
  points.reserve(predictions.size());
  for (const PointPrediction& prediction : predictions) {
    const auto it = points_.find(prediction.id);
    points.push_back(it == points_.end() ? nullptr : &it->second);
  }
  std::vector<PointTrack> tracks(predictions.size());
  ParallelFor(static_cast<int>(predictions.size()), threads, [&](int i) {
    const auto idx = static_cast<std::size_t>(i);
    if (points[idx] != nullptr) {
      tracks[idx] = function(predictions[idx], points[idx]);
      return;
    }
    tracks[idx].id = predictions[idx].id;
    tracks[idx].pixel = predictions[idx].pixel;
    tracks[idx].failure = PatchFailure::kUnknownPoint;
  });
  return tracks;
}

namespace {

Eigen::Matrix2d FitAffine(std::span<const Eigen::Vector2d> from, std::span<const Eigen::Vector2d> to,
                          const std::vector<double>& weights, double damping_px) {
  Eigen::Matrix2d normal = damping_px * damping_px * Eigen::Matrix2d::Identity();
  Eigen::Matrix2d mixed = normal;
  for (std::size_t j = 0; j < from.size(); ++j) {
    normal += weights[j] * from[j] * from[j].transpose();
    mixed += weights[j] * to[j] * from[j].transpose();
  }
  return mixed * normal.inverse();
}

}  // namespace

std::vector<Eigen::Matrix2d> NeighborhoodAffines(std::span<const Eigen::Vector2d> from,
                                                 std::span<const Eigen::Vector2d> to, int neighbors,
                                                 double damping_px) {
  assert(from.size() == to.size() && neighbors >= 1 && damping_px > 0);
  constexpr double kAgreement_px = 0.5;  // a neighbor nearer to the fit than this agrees
  std::vector<Eigen::Matrix2d> affines;
  affines.reserve(from.size());
  const NearestInPlane nearest(from);
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::vector<Eigen::Vector2d> before;
    std::vector<Eigen::Vector2d> after;
    for (const auto& [squared_px, j] : nearest.ToPoint(i, static_cast<std::size_t>(neighbors))) {
      before.push_back(from[j] - from[i]);
      after.push_back(to[j] - to[i]);
    }
    std::vector<double> weights(before.size(), 1.0);
    Eigen::Matrix2d affine = FitAffine(before, after, weights, damping_px);
    for (std::size_t j = 0; j < before.size(); ++j) {
      const double ratio = (affine * before[j] - after[j]).squaredNorm() / (kAgreement_px * kAgreement_px);
      weights[j] = 1 / (1 + ratio);
    }
    affines.push_back(FitAffine(before, after, weights, damping_px));
  }
  return affines;
}

void PointTracker::Serialize(StateArchive& archive) {
  std::vector<PointId> ids;
  for (const auto& [id, point] : points_) ids.push_back(id);
  archive(ids, attempt_);
  if (archive.reads()) points_.clear();
  for (const PointId id : ids) {
    Point& point = points_[id];
    for (ReferencePatch* patch : {&point.reference, &point.latest})
      pliant::Serialize(archive, options_.lucas_kanade, *patch);
    archive(point.pixel, point.affine_from_reference, point.reference_affine_from_first, point.age);
  }
}

}  // namespace pliant
