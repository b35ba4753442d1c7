// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The points' pixels alone, as `pliant track --tracks` reads them.

#include <algorithm>
#include <map>
#include <utility>

#include "exchange/exports.h"
#include "pliant/io/track_file.h"

namespace pliant {
namespace {

Result<std::vector<PixelTrack>> TracksOf(const RunSource& source) {
  std::map<PointId, PixelTrack> by_id;
  const Status status = ForEachFrame(source, [&](const SourceFrame& frame, const auto& observations) {
    for (const PointObservation& seen : observations) by_id[seen.id].pixels.push_back({frame.frame_idx, seen.pixel});
    return Status::Ok();
  });
  if (!status.ok()) return status;
  std::vector<PixelTrack> tracks;
  for (auto& [id, track] : by_id) tracks.push_back({id, std::move(track.pixels)});
  return tracks;
}

// Of the images, where they are there; else what the run read of them.
int NumFrames(const RunSource& source) {
  int frames = source.frames.back().frame_idx + 1;
  if (!source.run->frames.empty()) frames = std::max(frames, source.run->frames.back().frame_idx + 1);
  if (source.images.image_path.empty()) return frames;
  const auto sequence = OpenSequence(source.images.Whole());
  return sequence.ok() ? std::max(frames, (*sequence)->size()) : frames;
}

}  // namespace

Status ExportTracksCsv(const RunSource& source, const ExportOptions& /*options*/, const ExportFolder& folder) {
  const auto tracks = TracksOf(source);
  return tracks.ok() ? WriteTrackCsv(folder.Path("tracks.csv"), *tracks) : tracks.status();
}

Status ExportTracksNpz(const RunSource& source, const ExportOptions& /*options*/, const ExportFolder& folder) {
  const auto tracks = TracksOf(source);
  return tracks.ok() ? WriteTrackNpz(folder.Path("tracks.npz"), *tracks, NumFrames(source)) : tracks.status();
}

}  // namespace pliant
