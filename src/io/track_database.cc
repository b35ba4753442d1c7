// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <numeric>
#include <utility>
#include <vector>

#include "io/track_arrays.h"
#include "pliant/base/text.h"
#include "pliant/colmap/database.h"

namespace pliant {
namespace {

// Sets of keypoints, joined two at a time.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }

  std::size_t Find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // The smaller number stays, so that the result does not depend on the order.
  void Join(std::size_t a, std::size_t b) {
    a = Find(a);
    b = Find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace

Result<TrackFile> ReadTrackDatabase(const std::string& path) {
  const auto database = colmap::ReadDatabase(path);
  if (!database.ok()) return database.status();
  if (database->matches.empty())
    return Status(ErrorCode::kInsufficient, "the database " + Quoted(path) +
                                                " has no verified matches; run a matcher of COLMAP on it, for example "
                                                "colmap sequential_matcher --database_path");
  std::vector<std::size_t> first;  // of each image, among all keypoints
  std::size_t count = 0;
  TrackFile file;
  for (const colmap::DatabaseImage& image : database->images) {
    first.push_back(count);
    count += image.keypoints.size();
    file.images.push_back({image.name, image.width, image.height});
  }
  DisjointSets sets(count);
  for (const colmap::DatabaseMatches& matches : database->matches)
    for (const auto& [a, b] : matches.keypoints) sets.Join(first[matches.image_a] + a, first[matches.image_b] + b);
  std::vector<PixelTrack> tracks(count);  // at its first keypoint
  std::vector<char> ambiguous(count, 0);
  for (std::size_t k = 0; k < database->images.size(); ++k)
    for (std::size_t i = 0; i < database->images[k].keypoints.size(); ++i) {
      const Eigen::Vector2d& pixel = database->images[k].keypoints[i];
      const std::size_t of = sets.Find(first[k] + i);
      const auto frame = static_cast<int>(k);
      if (!pixel.allFinite())
        return Status(ErrorCode::kUnreadable, Quoted(path) + " has a keypoint that is not a number");
      if (!tracks[of].pixels.empty() && tracks[of].pixels.back().frame_idx == frame) ambiguous[of] = 1;
      tracks[of].pixels.push_back({frame, pixel});
    }
  for (std::size_t of = 0; of < count; ++of)
    if (ambiguous[of] == 0 && tracks[of].pixels.size() > 1) {
      tracks[of].id.value = static_cast<std::int64_t>(file.tracks.size());
      file.tracks.push_back(std::move(tracks[of]));
    }
  if (const auto left_out = std::count(ambiguous.begin(), ambiguous.end(), 1); left_out > 0)
    file.notes.push_back(std::to_string(left_out) + " tracks of the database " + Quoted(path) +
                         " have two keypoints in an image and are left out");
  return file;
}

}  // namespace pliant
