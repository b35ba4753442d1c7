// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/material_error.h"

#include <algorithm>

#include "pliant/base/statistics.h"
#include "pliant/image/depth_lookup.h"

namespace pliant {
namespace {

constexpr double kHigh = 0.95;      // the quantile that is reported
constexpr double kSamePointPx = 2;  // two tracks this near show the same point

}  // namespace

void MaterialErrorCollector::Drift::Append(const Drift& other) {
  px.insert(px.end(), other.px.begin(), other.px.end());
  mm.insert(mm.end(), other.mm.begin(), other.mm.end());
  still_px.insert(still_px.end(), other.still_px.begin(), other.still_px.end());
}

DriftFigures MaterialErrorCollector::Drift::Figures() const {
  DriftFigures figures;
  figures.points_px = static_cast<int>(px.size());
  figures.rmse_px = Rms(px);
  figures.median_px = Median(px);
  figures.p95_px = Quantile(px, kHigh);
  figures.still_median_px = Median(still_px);
  figures.points_mm = static_cast<int>(mm.size());
  figures.rmse_mm = Rms(mm);
  figures.median_mm = Median(mm);
  figures.p95_mm = Quantile(mm, kHigh);
  return figures;
}

Status MaterialErrorCollector::StartTracks(int frame_idx, std::span<const TrackedPoint> points) {
  std::vector<PointId> ids;
  std::vector<Eigen::Vector2d> pixels;
  for (const TrackedPoint& point : points) {
    if (tracks_.contains(point.id)) continue;
    Track& track = tracks_[point.id];
    track.first_pixel = point.pixel;
    track.first_frame_idx = frame_idx;
    if (!camera_.Contains(point.pixel)) {
      track.start = Start::kOutsideImage;
    } else if (point.surface.lookup == DepthLookup::kDepthStep) {
      track.start = Start::kDepthStep;
    } else {
      ids.push_back(point.id);
      pixels.push_back(point.pixel);
    }
  }
  if (ids.empty()) return Status::Ok();
  const auto materials = truth_.PointsAt(frame_idx, pixels);
  if (!materials.ok()) return materials.status();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if ((*materials)[i])
      tracks_[ids[i]].material = *(*materials)[i];
    else
      tracks_[ids[i]].start = Start::kNothing;
  }
  return Status::Ok();
}

void MaterialErrorCollector::AddPoint(const TrackedPoint& point, const Track& track, const MaterialState& state,
                                      const std::optional<Eigen::Vector3d>& ray, Frame* frame) const {
  if (!ray || !(ray->z() > 0)) {
    ++frame->paired.left_out.no_ray;
    return;
  }
  if (!point.point_in_cam.allFinite()) {
    ++frame->paired.left_out.not_finite;
    return;
  }
  const Eigen::Vector3d unit_depth_ray = *ray / ray->z();
  frame->paired.pairs.push_back({point.point_in_cam, state.point_in_cam, unit_depth_ray});
  if (state.visibility == MaterialVisibility::kOccluded) frame->occluded.insert(point.id);
  if (state.visibility == MaterialVisibility::kOutsideImage) frame->outside_image.insert(point.id);
  if (state.pixel) {
    frame->drift.px.push_back((point.pixel - *state.pixel).norm());
    frame->drift.still_px.push_back((track.first_pixel - *state.pixel).norm());
  }
  if (point.surface.lookup == DepthLookup::kOk)
    frame->drift.mm.push_back((point.surface.depth_mm * unit_depth_ray - state.point_in_cam).norm());
}

Status MaterialErrorCollector::AddFrame(int frame_idx, int submap, std::span<const TrackedPoint> points) {
  if (Status status = StartTracks(frame_idx, points); !status.ok()) return status;
  Frame frame;
  frame.paired.frame_idx = frame_idx;
  frame.paired.submap = submap;
  std::vector<MaterialId> materials;
  std::vector<const TrackedPoint*> followed;
  std::vector<Eigen::Vector2d> pixels;
  for (const TrackedPoint& point : points) {
    Track& track = tracks_.at(point.id);
    track.last_frame_idx = frame_idx;
    if (track.start == Start::kOutsideImage) ++frame.paired.left_out.outside_image;
    if (track.start == Start::kDepthStep) ++frame.paired.left_out.depth_step;
    if (track.start == Start::kNothing) ++frame.paired.left_out.no_depth;
    if (track.start != Start::kOk) continue;
    materials.push_back(track.material);
    followed.push_back(&point);
    pixels.push_back(point.pixel);
  }
  const auto states = truth_.Observe(frame_idx, materials);
  if (!states.ok()) return states.status();
  const std::vector<std::optional<Eigen::Vector3d>> rays = camera_.Unproject(pixels);
  for (std::size_t i = 0; i < followed.size(); ++i) {
    if ((*states)[i])
      AddPoint(*followed[i], tracks_.at(followed[i]->id), *(*states)[i], rays[i], &frame);
    else
      ++frame.paired.left_out.no_depth;
  }
  frames_.push_back(std::move(frame));
  return Status::Ok();
}

Result<int> MaterialErrorCollector::CountContinuingTracks() const {
  std::map<int, std::vector<const Track*>> starting;  // by frame
  std::vector<const Track*> open;                     // whose continuation has not been found
  for (const auto& [id, track] : tracks_) {
    if (track.start != Start::kOk) continue;
    starting[track.first_frame_idx].push_back(&track);
    open.push_back(&track);
  }
  int count = 0;
  for (const auto& [frame_idx, tracks] : starting) {
    std::vector<const Track*> ended;
    std::vector<MaterialId> materials;
    for (const Track* track : open) {
      if (track->last_frame_idx >= frame_idx) continue;
      ended.push_back(track);
      materials.push_back(track->material);
    }
    const auto states = truth_.Observe(frame_idx, materials);
    if (!states.ok()) return states.status();
    std::set<const Track*> continued;
    for (const Track* track : tracks) {
      const Track* nearest = nullptr;
      double least_px = kSamePointPx;
      for (std::size_t i = 0; i < ended.size(); ++i) {
        const auto& state = (*states)[i];
        if (!state || !state->pixel || state->visibility != MaterialVisibility::kVisible) continue;
        const double distance_px = (*state->pixel - track->first_pixel).norm();
        if (distance_px > least_px || continued.contains(ended[i])) continue;
        least_px = distance_px;
        nearest = ended[i];
      }
      if (nearest != nullptr) continued.insert(nearest);
    }
    count += static_cast<int>(continued.size());
    std::erase_if(open, [&](const Track* track) { return continued.contains(track); });
  }
  return count;
}

Result<MaterialError> MaterialErrorCollector::Compute(const PointErrorOptions& options) const {
  std::vector<PairedFrame> paired;
  for (const Frame& frame : frames_) paired.push_back(frame.paired);
  Result<PointError> error = ComputePointError(paired, options);
  if (!error.ok()) return error.status();

  const Result<int> continuing = CountContinuingTracks();
  if (!continuing.ok()) return continuing.status();
  MaterialError result;
  result.continuing_tracks = *continuing;
  result.error = *std::move(error);
  Drift all;
  std::set<PointId> occluded;
  std::set<PointId> outside_image;
  for (const Frame& frame : frames_) {
    if (frame.paired.pairs.empty()) continue;
    result.frames.push_back({frame.paired.frame_idx, frame.drift.Figures(), static_cast<int>(frame.occluded.size()),
                             static_cast<int>(frame.outside_image.size())});
    all.Append(frame.drift);
    occluded.insert(frame.occluded.begin(), frame.occluded.end());
    outside_image.insert(frame.outside_image.begin(), frame.outside_image.end());
    result.occluded += result.frames.back().occluded;
    result.outside_image += result.frames.back().outside_image;
  }
  result.drift = all.Figures();
  result.tracks = static_cast<int>(
      std::count_if(tracks_.begin(), tracks_.end(), [](const auto& t) { return t.second.start == Start::kOk; }));
  result.tracks_occluded = static_cast<int>(occluded.size());
  result.tracks_outside_image = static_cast<int>(outside_image.size());
  return result;
}

}  // namespace pliant
