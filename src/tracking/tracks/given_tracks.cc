// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/tracks/given_tracks.h"

#include <cmath>

#include "geometry/nearest_pixels.h"
#include "pliant/scene/serialize.h"

namespace pliant {
namespace {

constexpr double kSamePoint_px = 0.5;
constexpr std::size_t kFewTracks =
    40;  // in an image, as for Tracking.min_corners: then those on contours are taken, too

// In how many frames from this one on a track is seen.
std::ptrdiff_t LengthFrom(const PixelTrack& track, int frame_idx) {
  return std::ranges::count_if(track.pixels,
                               [&](const TrackPixel& seen) { return seen.visible && seen.frame_idx >= frame_idx; });
}

const TrackPixel* SeenIn(const PixelTrack& track, int frame_idx) {
  const TrackPixel* pixel = PixelIn(track, frame_idx);
  return pixel != nullptr && pixel->visible ? pixel : nullptr;
}

bool IsUsable(const PreparedFrame& frame, const Eigen::Vector2d& pixel) {
  return frame.mask.unrestricted() ||
         frame.mask.Valid(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
}

}  // namespace

GivenTracks::GivenTracks(std::span<const PixelTrack> tracks)
    : tracks_(tracks), next_id_(tracks.empty() ? 0 : tracks.back().id.value + 1) {}

std::vector<NewTrack> GivenTracks::AddNew(const PreparedFrame& frame, std::span<const Eigen::Vector2d> existing,
                                          const CornerOptions& corners) {
  struct Offer {
    const PixelTrack* track;
    Eigen::Vector2d pixel;
    std::ptrdiff_t length;
  };
  const NearestPixels known({existing.begin(), existing.end()}, kSamePoint_px);
  std::vector<Offer> offers;
  for (const PixelTrack& track : tracks_)
    if (const TrackPixel* seen = SeenIn(track, frame.frame_idx);
        seen != nullptr && IsUsable(frame, seen->pixel) && known.Find(seen->pixel, 1).empty())
      offers.push_back({&track, seen->pixel, LengthFrom(track, frame.frame_idx)});
  if (offers.empty()) return {};
  std::ranges::stable_sort(offers, std::ranges::greater(), &Offer::length);
  if (corners.contour_filter == Switch::kOn) {
    const ContourMeasure contours(frame.gray, corners.contour_radius_px);
    std::vector<Offer> off_contours;
    for (const Offer& offer : offers)
      if (contours.At(offer.pixel) <= corners.contour_threshold) off_contours.push_back(offer);
    if (existing.size() + off_contours.size() >= kFewTracks) offers = std::move(off_contours);
  }
  std::vector<Eigen::Vector2d> pixels;
  for (const Offer& offer : offers) pixels.push_back(offer.pixel);
  const cv::Mat valid =
      frame.mask.unrestricted() ? cv::Mat(frame.gray.size(), CV_8UC1, cv::Scalar(255)) : frame.mask.valid();
  std::vector<NewTrack> added;
  for (const std::size_t i : SpreadPoints(pixels, valid, existing, corners))
    added.push_back({Begin(*offers[i].track), pixels[i]});
  std::ranges::sort(added, {}, &NewTrack::id);
  return added;
}

const PixelTrack* GivenTracks::Nearest(const Eigen::Vector2d& pixel, int frame_idx) const {
  const PixelTrack* nearest = nullptr;
  double distance = kSamePoint_px;
  for (const PixelTrack& track : tracks_)
    if (const TrackPixel* seen = SeenIn(track, frame_idx);
        seen != nullptr && (seen->pixel - pixel).norm() <= distance) {
      if (nearest != nullptr && (seen->pixel - pixel).norm() == distance) continue;
      nearest = &track;
      distance = (seen->pixel - pixel).norm();
    }
  return nearest;
}

PointId GivenTracks::Begin(const PixelTrack& track) {
  const bool takes_its_id = takes_ids_of_tracks_ && !followed_.contains(track.id);
  const PointId id = takes_its_id ? track.id : PointId{next_id_++};
  followed_[id] = &track;
  return id;
}

std::optional<PointId> GivenTracks::Add(const Eigen::Vector2d& pixel, const PreparedFrame& frame) {
  const PixelTrack* track = Nearest(pixel, frame.frame_idx);
  if (track == nullptr || !IsUsable(frame, pixel)) return std::nullopt;
  return Begin(*track);
}

bool GivenTracks::Resume(PointId id, const Eigen::Vector2d& pixel, const PreparedFrame& frame) {
  const auto known = followed_.find(id);
  const PixelTrack* track = known != followed_.end() ? known->second : Nearest(pixel, frame.frame_idx);
  if (track == nullptr || SeenIn(*track, frame.frame_idx) == nullptr) return false;
  if (known == followed_.end()) takes_ids_of_tracks_ = false;
  followed_[id] = track;
  next_id_ = std::max(next_id_, id.value + 1);
  return true;
}

std::vector<PointTrack> GivenTracks::Locate(int frame_idx, std::span<const PointPrediction> predictions) const {
  std::vector<PointTrack> located;
  for (const PointPrediction& prediction : predictions) {
    PointTrack& point = located.emplace_back(PointTrack{.id = prediction.id, .pixel = prediction.pixel});
    const auto followed = followed_.find(prediction.id);
    const TrackPixel* seen = followed == followed_.end() ? nullptr : SeenIn(*followed->second, frame_idx);
    point.failure = seen == nullptr ? PatchFailure::kOccluded : PatchFailure::kNone;
    if (seen == nullptr) continue;
    point.pixel = seen->pixel;
    point.ssim = 1;
  }
  return located;
}

std::vector<PointTrack> GivenTracks::Track(const PreparedFrame&, const PreparedFrame& current,
                                           std::span<const PointPrediction> predictions) {
  return Locate(current.frame_idx, predictions);
}

std::vector<PointTrack> GivenTracks::Find(const PreparedFrame& current, std::span<const PointPrediction> predictions) {
  return Locate(current.frame_idx, predictions);
}

std::vector<PointTrack> GivenTracks::TrackIntoBlur(const PreparedFrame&, const PreparedFrame& blurred,
                                                   std::span<const PointPrediction> predictions) const {
  return Locate(blurred.frame_idx, predictions);
}

void GivenTracks::Serialize(StateArchive& archive) {
  std::map<PointId, PointId> tracks_of_points;
  for (const auto& [id, track] : followed_) tracks_of_points[id] = track->id;
  archive(tracks_of_points, next_id_, takes_ids_of_tracks_);
  if (!archive.reads()) return;
  followed_.clear();
  for (const auto& [id, track] : tracks_of_points) {
    followed_[id] = FindById(tracks_, track);
    if (followed_[id] == nullptr) return archive.Fail();
  }
}

}  // namespace pliant
