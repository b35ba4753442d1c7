// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/track_arrays.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include "io/npy.h"
#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr std::array<std::string_view, 4> kArrayNames = {"tracks", "visibility", "sigma_px", "track_id"};
constexpr std::size_t kMaxAxis = std::numeric_limits<std::int32_t>::max();

// The arrays of a file; null: it has none of this name.
struct TrackArrays {
  const NpyArray* tracks = nullptr;
  const NpyArray* visibility = nullptr;
  const NpyArray* sigma_px = nullptr;
  const NpyArray* track_id = nullptr;
};

// The axes without a first one of length 1, where there is one more than `count`: a batch of one video.
std::span<const std::size_t> AxesOf(const NpyArray& array, std::size_t count) {
  std::span<const std::size_t> axes = array.shape;
  if (axes.size() == count + 1 && axes.front() == 1) axes = axes.subspan(1);
  return axes;
}

Status CheckTracks(const std::string& path, const NpyArray& tracks) {
  const auto wrong = [&](const std::string& what) {
    return Status(ErrorCode::kUnreadable, "the tracks in " + path + " " + what);
  };
  const auto axes = AxesOf(tracks, 3);
  if (axes.size() != 3 || axes[2] != 2)
    return wrong("have the shape " + ShapeText(tracks.shape) + "; it has to be (frames, points, 2) with x before y");
  if (axes[0] == 0) return wrong("have no frame");
  if (axes[0] > kMaxAxis || axes[1] > kMaxAxis) return wrong("have more than 2^31 frames or points");
  if (tracks.kind == NpyArray::Kind::kBool) return wrong("are bools; save pixels as np.float32");
  return Status::Ok();
}

// An array beside the tracks that has a value a frame and point.
Status CheckBeside(const std::string& path, const std::string& name, const NpyArray& tracks, const NpyArray& array) {
  const auto expected = AxesOf(tracks, 3).first(2);
  const auto is_expected = [&](std::span<const std::size_t> axes) {
    const bool has_last = axes.size() == 3 && axes.back() == 1;  // (T, N, 1), as some trackers give it
    return std::ranges::equal(axes, expected) || (has_last && std::ranges::equal(axes.first(2), expected));
  };
  const std::span<const std::size_t> shape = array.shape;
  if (is_expected(shape) || (!shape.empty() && shape.front() == 1 && is_expected(shape.subspan(1))))
    return Status::Ok();
  return {ErrorCode::kUnreadable, name + " in " + path + " has the shape " + ShapeText(array.shape) +
                                      ", and the tracks have " + ShapeText(tracks.shape) +
                                      "; it has to be (frames, points)"};
}

// Of scores nobody says from which value on a point is seen, and of codes, as 255, 2 and -1, which ones mean it.
Status CheckVisibility(const std::string& path, const NpyArray& visibility) {
  if (visibility.kind == NpyArray::Kind::kBool) return Status::Ok();
  for (std::size_t i = 0; i < visibility.size(); ++i)
    if (const double value = visibility.At(i); value != 0.0 && value != 1.0)
      return {ErrorCode::kUnreadable, "visibility in " + path + " has the value " + FormatDouble(value) +
                                          ", which is neither 0 nor 1; save bools, for example visibility > 0.5"};
  return Status::Ok();
}

Status CheckArrays(const std::string& path, const TrackArrays& arrays) {
  if (Status status = CheckTracks(path, *arrays.tracks); !status.ok()) return status;
  if (arrays.visibility != nullptr) {
    if (Status status = CheckBeside(path, "visibility", *arrays.tracks, *arrays.visibility); !status.ok())
      return status;
    if (Status status = CheckVisibility(path, *arrays.visibility); !status.ok()) return status;
  }
  if (arrays.sigma_px != nullptr)
    if (Status status = CheckBeside(path, "sigma_px", *arrays.tracks, *arrays.sigma_px); !status.ok()) return status;
  if (arrays.track_id != nullptr &&
      (arrays.track_id->kind != NpyArray::Kind::kInteger || arrays.track_id->shape.size() != 1 ||
       arrays.track_id->shape[0] != AxesOf(*arrays.tracks, 3)[1]))
    return {ErrorCode::kUnreadable, "track_id in " + path + " has to be one whole number a point"};
  return Status::Ok();
}

// Adds what the arrays say of a frame and point; a hidden point whose pixel is not a number is left out.
Status AddPixel(const std::string& path, const TrackArrays& arrays, std::size_t frame, std::size_t i,
                PixelTrack* track) {
  TrackPixel seen{static_cast<int>(frame), {arrays.tracks->At(2 * i), arrays.tracks->At(2 * i + 1)}};
  seen.visible = arrays.visibility == nullptr || arrays.visibility->At(i) != 0;
  if (arrays.sigma_px != nullptr) seen.sigma_px = arrays.sigma_px->At(i);
  const bool is_sigma = std::isfinite(seen.sigma_px) && seen.sigma_px >= 0;
  if (!seen.visible && (!seen.pixel.allFinite() || !is_sigma)) return Status::Ok();
  const std::string where = " in frame " + std::to_string(frame) + " of " + path;
  if (!seen.pixel.allFinite())
    return {ErrorCode::kUnreadable, "the pixel of track " + std::to_string(track->id.value) + where +
                                        " is not a finite number, but it is visible; set its visibility to False"};
  if (!is_sigma)
    return {ErrorCode::kUnreadable, "sigma_px of track " + std::to_string(track->id.value) + where +
                                        " is not a standard deviation; write 0 where it is not known"};
  track->pixels.push_back(seen);
  return Status::Ok();
}

Result<TrackFile> TracksOf(const std::string& path, const TrackArrays& arrays) {
  if (Status status = CheckArrays(path, arrays); !status.ok()) return status;
  const auto axes = AxesOf(*arrays.tracks, 3);
  TrackFile file;
  file.frames = static_cast<int>(axes[0]);
  std::map<PointId, PixelTrack> tracks;
  for (std::size_t n = 0; n < axes[1]; ++n) {
    PixelTrack track{PointId{static_cast<std::int64_t>(n)}, {}};
    if (arrays.track_id != nullptr) track.id.value = static_cast<std::int64_t>(arrays.track_id->At(n));
    if (track.id.value < 0 || track.id.value > static_cast<std::int64_t>(kMaxAxis))
      return Status(ErrorCode::kUnreadable, "track_id in " + path + " has to be from 0 to 2147483647");
    for (std::size_t t = 0; t < axes[0]; ++t)
      if (Status status = AddPixel(path, arrays, t, t * axes[1] + n, &track); !status.ok()) return status;
    const PointId id = track.id;
    if (!tracks.emplace(id, std::move(track)).second)
      return Status(ErrorCode::kUnreadable, "track_id in " + path + " has " + std::to_string(id.value) + " twice");
  }
  for (auto& [id, track] : tracks)
    if (!track.pixels.empty()) file.tracks.push_back(std::move(track));
  return file;
}

}  // namespace

Result<TrackFile> ReadTrackArrays(const std::string& path, std::string_view bytes) {
  if (IsNpy(bytes)) {
    const auto tracks = ParseNpy(Quoted(path), bytes);
    if (!tracks.ok()) return tracks.status();
    return TracksOf(Quoted(path), {.tracks = &*tracks});
  }
  const auto names = NpzNames(Quoted(path), bytes);
  if (!names.ok()) return names.status();
  for (const char* name : {"tracks", "visibility"})
    if (!names->contains(name))
      return Status(ErrorCode::kUnreadable, Quoted(path) + " has no array " + name +
                                                "; save it with np.savez(file, tracks=tracks, visibility=visibility)");
  const auto files = ParseNpz(Quoted(path), bytes, kArrayNames);
  if (!files.ok()) return files.status();
  std::map<std::string, NpyArray> arrays;
  for (const auto& [name, content] : *files) {
    auto array = ParseNpy("the array " + Quoted(name) + " in " + Quoted(path), content);
    if (!array.ok()) return array.status();
    arrays[name] = *array;
  }
  const auto find = [&](const char* name) {
    const auto found = arrays.find(name);
    return found == arrays.end() ? nullptr : &found->second;
  };
  return TracksOf(Quoted(path), {find("tracks"), find("visibility"), find("sigma_px"), find("track_id")});
}

Status WriteTrackNpz(const std::string& path, std::span<const PixelTrack> tracks, int frames) {
  const auto too_large = [&] {
    return Status(ErrorCode::kInvalidArgument, "the arrays of " + std::to_string(tracks.size()) + " tracks in " +
                                                   std::to_string(frames) +
                                                   " frames would be larger than 4 GB; write CSV, or fewer frames");
  };
  constexpr std::size_t kMaxNumbers = 400'000'000;  // of eight bytes and one flag each
  const std::size_t points = tracks.size();
  const auto length = static_cast<std::size_t>(frames);
  if (points > 0 && length > kMaxNumbers / points) return too_large();
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> pixels(length * points * 2, kNone);
  std::string visibility(length * points, '\0');
  std::string ids;
  for (std::size_t n = 0; n < points; ++n) {
    AppendBytes(&ids, static_cast<std::uint64_t>(tracks[n].id.value), 8);
    for (const TrackPixel& seen : tracks[n].pixels) {
      const std::size_t i = static_cast<std::size_t>(seen.frame_idx) * points + n;
      pixels[2 * i] = static_cast<float>(seen.pixel.x());
      pixels[2 * i + 1] = static_cast<float>(seen.pixel.y());
      visibility[i] = seen.visible ? '\1' : '\0';
    }
  }
  const std::string_view bytes(reinterpret_cast<const char*>(pixels.data()), pixels.size() * sizeof(float));
  const std::string archive = NpzBytes({{"track_id", NpyBytes("<i8", std::array{points}, ids)},
                                        {"tracks", NpyBytes("<f4", std::array{length, points, std::size_t{2}}, bytes)},
                                        {"visibility", NpyBytes("|b1", std::array{length, points}, visibility)}});
  if (archive.empty()) return too_large();
  return WriteFileAtomically(path, archive);
}

}  // namespace pliant
