// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/sequence_tracks.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>

#include "datasets/image_file.h"
#include "datasets/track_scale.h"
#include "pliant/base/text.h"
#include "pliant/image/pyramid.h"
#include "pliant/io/track_file.h"

namespace pliant {
namespace {

constexpr double kMaxOutsideShare = 0.05;  // trackers call some points seen that have just left the image
constexpr std::size_t kMinPixels = 100;    // fewer say nothing of the images' size

Status Mismatch(const std::string& sentence) { return {ErrorCode::kMismatch, sentence}; }

// A database's places in its list of images become the sequence's frames.
Status NameFrames(const std::string& path, const Sequence& sequence, int count, TrackFile* file) {
  if (file->images.empty()) return Status::Ok();
  std::map<std::string, int> frames;
  for (int k = 0; k < count; ++k)
    if (const auto name = sequence.Name(k)) frames.emplace(std::filesystem::path(*name).filename().string(), k);
  std::vector<std::optional<int>> frame_of;
  int known = 0;
  for (const TrackFileImage& image : file->images) {
    const auto found = frames.find(std::filesystem::path(image.name).filename().string());
    frame_of.push_back(found == frames.end() ? std::nullopt : std::optional(found->second));
    if (!frame_of.back()) continue;
    ++known;
    if (image.width != static_cast<std::uint64_t>(sequence.camera().width()) ||
        image.height != static_cast<std::uint64_t>(sequence.camera().height()))
      return Mismatch("the database " + Quoted(path) + " has images of " + std::to_string(image.width) + "x" +
                      std::to_string(image.height) + " pixels, and the sequence of " +
                      SizeText(sequence.camera().width(), sequence.camera().height()) +
                      "; match the images of the sequence");
  }
  if (known == 0)
    return Mismatch("none of the " + std::to_string(file->images.size()) + " images of the database " + Quoted(path) +
                    " has the name of an image of the sequence; give the database of its images");
  for (PixelTrack& track : file->tracks) {
    std::erase_if(track.pixels,
                  [&](const TrackPixel& seen) { return !frame_of[static_cast<std::size_t>(seen.frame_idx)]; });
    for (TrackPixel& seen : track.pixels) seen.frame_idx = *frame_of[static_cast<std::size_t>(seen.frame_idx)];
    std::ranges::sort(track.pixels, {}, &TrackPixel::frame_idx);
  }
  return Status::Ok();
}

Status CheckFrames(const std::string& path, int frames, const TrackFile& file) {
  if (file.frames && *file.frames != frames)
    return Mismatch(
        "the arrays in " + Quoted(path) + " have " + std::to_string(*file.frames) + " frames and the images " +
        std::to_string(frames) +
        "; entry t of their first axis is frame t of the images, and (points, frames, 2) is to be transposed");
  for (const PixelTrack& track : file.tracks)
    if (!track.pixels.empty() && track.pixels.back().frame_idx >= frames)
      return Mismatch("track " + std::to_string(track.id.value) + " in " + Quoted(path) + " has frame " +
                      std::to_string(track.pixels.back().frame_idx) + ", and the images are the frames 0 to " +
                      std::to_string(frames - 1));
  return Status::Ok();
}

// By reading all of them.
Result<int> CountFrames(const SequenceRequest& whole) {
  const auto sequence = OpenSequence(whole);
  if (!sequence.ok()) return sequence.status();
  for (int count = 0;; ++count) {
    const auto frame = (*sequence)->Next();
    if (!frame.ok()) return frame.status();
    if (!frame->has_value()) return count;
  }
}

// Leaves pixels out that lie outside the image, and notes it.
Status CheckPixelsInImage(const std::string& path, const Camera& camera, SequenceTracks* tracks) {
  std::size_t seen_pixels = 0;
  std::size_t outside = 0;
  Eigen::Vector2d largest(0, 0);
  std::optional<TrackPixel> example;
  for (PixelTrack& track : tracks->tracks)
    std::erase_if(track.pixels, [&](const TrackPixel& seen) {
      const bool inside = camera.Contains(seen.pixel, -0.5);
      if (!seen.visible) return false;
      ++seen_pixels;
      largest = largest.cwiseMax(seen.pixel);
      if (inside) return false;
      ++outside;
      example = seen;
      return true;
    });
  const std::string size = SizeText(camera.width(), camera.height());
  const std::string advice =
      "; give tracks in pixels of these images, not of smaller or larger ones, and not from 0 to 1";
  if (static_cast<double>(outside) > kMaxOutsideShare * static_cast<double>(seen_pixels))
    return Mismatch(std::to_string(outside) + " of the " + std::to_string(seen_pixels) + " pixels in " + Quoted(path) +
                    " lie outside the images of " + size + " pixels, for example (" + Digits(example->pixel.x(), 1) +
                    ", " + Digits(example->pixel.y(), 1) + ") in frame " + std::to_string(example->frame_idx) + advice);
  if (seen_pixels >= kMinPixels && largest.x() < 0.5 * camera.width() && largest.y() < 0.5 * camera.height())
    return Mismatch("all pixels in " + Quoted(path) + " lie in the upper left " + Digits(largest.x() + 1, 0) + "x" +
                    Digits(largest.y() + 1, 0) + " pixels of the images, which have " + size + advice);
  if (outside > 0)
    tracks->notes.push_back(std::to_string(outside) + " of the " + std::to_string(seen_pixels) + " pixels in " +
                            Quoted(path) + " lie outside the image and count as not seen");
  return Status::Ok();
}

// Gray images of the part that is tracked, from the first one with a track on, up to one that cannot be read.
std::map<int, cv::Mat> ReadImagesForScale(const SequenceRequest& request, const std::vector<PixelTrack>& tracks) {
  constexpr std::size_t kImages = 13;  // over two seconds at 30 images a second, in which a scene moves
  constexpr int kStride = 5;
  SequenceRequest part = request;
  int first = std::numeric_limits<int>::max();
  for (const PixelTrack& track : tracks)
    for (const TrackPixel& seen : track.pixels)
      if (seen.visible && seen.frame_idx >= request.start) first = std::min(first, seen.frame_idx);
  part.start = first;
  part.stride = kStride;
  std::map<int, cv::Mat> images;
  const auto sequence = OpenSequence(part);
  if (!sequence.ok()) return images;
  while (images.size() < kImages) {
    const auto frame = (*sequence)->Next();
    if (!frame.ok() || !frame->has_value()) break;
    images.emplace((*frame)->frame_idx, ToGray((*frame)->image));
  }
  return images;
}

// Whether the tracks follow these images, and not the same in another size.
Status CheckScale(const std::string& path, const SequenceRequest& request, SequenceTracks* tracks) {
  const std::map<int, cv::Mat> images = ReadImagesForScale(request, tracks->tracks);
  const auto other = FindOtherTrackScale(tracks->tracks, images);
  if (!other) return Status::Ok();
  const cv::Mat& image = images.begin()->second;
  const std::string sentence = "the pixels in " + Quoted(path) + (other->is_clear ? " fit" : " seem to fit") +
                               " images of about " + SizeText(other->width, other->height) + " pixels, not these of " +
                               SizeText(image) + ": patches along the tracks correlate by " +
                               Digits(other->correlation, 2) + " then, and by " + Digits(other->given_correlation, 2) +
                               " as they are given; multiply x by about " +
                               Digits(static_cast<double>(image.cols) / other->width, 3) + " and y by " +
                               Digits(static_cast<double>(image.rows) / other->height, 3);
  if (other->is_clear) return Mismatch(sentence);
  tracks->notes.push_back(sentence);
  return Status::Ok();
}

}  // namespace

void TrackFileOptions::List(OptionTable& table) {
  table.BeginGroup("TrackFile", "point tracks of another program, instead of our own");
  table.Add("path", &path, "path", "CSV, .npz, .npy or COLMAP database (docs/tracks.md); empty: our own tracks");
  table.AddChoice("pixel_origin", &pixel_origin,
                  "what (0, 0) is in the file: center of the first pixel (CoTracker, OpenCV) or its upper left corner "
                  "(TAP-Vid, TAPIR); a database is known to have the corner");
  table.Add("max_sigma_px", &max_sigma_px, "px", "a point with a larger sigma_px counts as not seen in that frame",
            0.001, 1e6);
}

Result<SequenceTracks> ReadTracksOfSequence(const TrackFileOptions& options, const SequenceRequest& request) {
  if (request.IsLive())
    return Status(
        ErrorCode::kInvalidArgument,
        "tracks are of images that are there already, and live ones are not; record them, and track the file");
  const SequenceRequest whole = request.Whole();
  const auto sequence = OpenSequence(whole);
  if (!sequence.ok()) return sequence.status();
  auto file = ReadTrackFile(options.path);
  if (!file.ok()) return file.status();
  // How many frames a video has is its container's word, which may be off or missing.
  std::error_code error;
  const bool may_differ = std::filesystem::is_regular_file(request.image_path, error);
  int frames = (*sequence)->size();
  const bool is_unknown = request.given != nullptr && frames == 0;  // images that come one by one
  if (is_unknown && !file->images.empty())
    return Mismatch("the database " + Quoted(options.path) +
                    " has names of images, and images that come one by one have none before; give a list of them, or a "
                    "path");
  const auto count = [&] {
    const auto counted = CountFrames(whole);
    if (counted.ok()) frames = *counted;
    return counted.status();
  };
  if (frames == 0 && may_differ)
    if (Status status = count(); !status.ok()) return status;
  if (Status status = NameFrames(options.path, **sequence, frames, &*file); !status.ok()) return status;
  if (may_differ && !CheckFrames(options.path, frames, *file).ok())
    if (Status status = count(); !status.ok()) return status;
  if (Status status = CheckFrames(options.path, frames, *file); !status.ok() && !is_unknown) return status;
  const bool corner = options.pixel_origin == PixelOrigin::kCorner && file->images.empty();
  for (PixelTrack& track : file->tracks)
    for (TrackPixel& seen : track.pixels) {
      if (corner) seen.pixel -= Eigen::Vector2d(0.5, 0.5);
      if (seen.sigma_px > options.max_sigma_px) seen.visible = false;
    }
  SequenceTracks tracks{std::move(file->tracks), std::move(file->notes)};
  if (Status status = CheckPixelsInImage(options.path, (*sequence)->camera(), &tracks); !status.ok()) return status;
  // Images that come one by one come once.
  if (file->images.empty() && !is_unknown)
    if (Status status = CheckScale(options.path, request, &tracks); !status.ok()) return status;
  std::erase_if(tracks.tracks,
                [](const PixelTrack& track) { return std::ranges::none_of(track.pixels, &TrackPixel::visible); });
  if (tracks.tracks.empty())
    return Status(ErrorCode::kInsufficient, "no pixel of the tracks in " + Quoted(options.path) +
                                                " is in the image with a sigma_px of TrackFile.max_sigma_px (" +
                                                FormatDouble(options.max_sigma_px) + ") or less");
  return tracks;
}

}  // namespace pliant
