// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Point tracks out of a run, and into another one.
#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "e2e/e2e_support.h"
#include "pliant/evaluation/evaluate_run.h"
#include "pliant/io/track_file.h"

namespace pliant {
namespace {

constexpr double kMaxTracksRmse_mm = 1.0;   // plain, untrimmed, scale per frame, as with our own tracks
constexpr double kTracksShareOfNull = 0.1;  // a map that says more than that all is at one depth
constexpr double kMinWithin = 0.9;          // delta_avg of our own tracks of a rigid scene
constexpr std::size_t kFewPoints = 60;      // that are seen at a time

std::vector<PixelTrack> TracksOfDefaultRun() {
  std::map<PointId, PixelTrack> tracks;
  auto reader = ObservationReader::Open(kDefaultRun).value();
  for (auto rows = reader.Next(); rows.ok() && rows->has_value(); rows = reader.Next())
    for (const PointObservation& seen : (*rows)->observations)
      tracks[seen.id].pixels.push_back({(*rows)->frame_idx, seen.pixel});
  std::vector<PixelTrack> result;
  for (auto& [id, track] : tracks) result.push_back({id, track.pixels});
  return result;
}

// A track is kept where fewer than kFewPoints of those that are kept are seen in its first frame.
std::vector<PixelTrack> Thinned(const std::vector<PixelTrack>& tracks) {
  std::map<int, std::size_t> seen;
  std::vector<PixelTrack> kept;
  for (const PixelTrack& track : tracks) {
    if (seen[track.pixels.front().frame_idx] >= kFewPoints) continue;
    for (const TrackPixel& pixel : track.pixels) ++seen[pixel.frame_idx];
    kept.push_back(track);
  }
  std::ranges::sort(kept, {}, &PixelTrack::id);
  return kept;
}

std::vector<PixelTrack> LongestFirst(std::vector<PixelTrack> tracks) {
  std::ranges::stable_sort(tracks, std::ranges::greater(), [](const PixelTrack& track) {
    return std::pair(-track.pixels.front().frame_idx, track.pixels.size());
  });
  return tracks;
}

Evaluation Evaluated(const TestFolder& folder, const std::vector<PixelTrack>& tracks, int least_frames = 60,
                     TrackOptions options = {}) {
  options.track_file.path = folder.Path("tracks.npz");
  EXPECT_TRUE(WriteTrackNpz(options.track_file.path, tracks, 60).ok());
  const RunSummary summary = TrackSequenceAt(kSequence, folder.Path("run"), options);
  EXPECT_EQ(summary.status, RunStatus::kCompleted) << summary.note;
  EXPECT_GE(summary.frames_tracked, least_frames);
  return EvaluateRun(folder.Path("run"), kSequence, ErrorScale::kPerFrame);
}

TEST(RigidScene, TracksOfARunFromAFileGiveAMapAsOurOwnTracksDo) {
  const TestFolder folder;
  const Evaluation evaluation = Evaluated(folder, TracksOfDefaultRun());
  EXPECT_LT(evaluation.surface->plain.estimate.mean_rmse_mm, kMaxTracksRmse_mm);
}

TEST(RigidScene, TracksFromAFileGiveAMapThatIsHandedOverLater) {
  const TestFolder folder;
  TrackOptions options;
  options.tracker.handover_frames = 6;
  const Evaluation evaluation = Evaluated(folder, TracksOfDefaultRun(), 60, options);
  EXPECT_LT(evaluation.surface->plain.estimate.mean_rmse_mm, kMaxTracksRmse_mm);
}

TEST(RigidScene, SixtyTracksAtATimeGiveAMap) {
  const TestFolder folder;
  const PointError error = *Evaluated(folder, Thinned(LongestFirst(TracksOfDefaultRun()))).surface;
  EXPECT_LT(error.plain.estimate.mean_rmse_mm, kTracksShareOfNull * error.plain.null.mean_rmse_mm);
}

// Of the 60 that begin in the first frame only 12 are left in frame 22.
TEST(RigidScene, TracksThatEndBeforeOthersBeginGiveAMapToo) {
  const TestFolder folder;
  const PointError error = *Evaluated(folder, Thinned(TracksOfDefaultRun()), 50).surface;
  EXPECT_LT(error.plain.estimate.mean_rmse_mm, kTracksShareOfNull * error.plain.null.mean_rmse_mm);
}

// The points of a model come in another order than the tracks that are seen there.
TEST(RigidScene, TracksFromAFileCarryAMapThatBeginsWithTheModelOfAnotherRun) {
  const TestFolder folder;
  TrackOptions options;
  options.tracker.init.method = InitMethod::kColmapModel;
  options.tracker.init.model.path = kDefaultRun + "/sparse";
  std::vector<PixelTrack> tracks = TracksOfDefaultRun();
  std::ranges::reverse(tracks);
  for (std::size_t k = 0; k < tracks.size(); ++k) tracks[k].id = PointId{static_cast<std::int64_t>(k)};
  const Evaluation evaluation = Evaluated(folder, tracks, 60, options);
  EXPECT_LT(evaluation.surface->plain.estimate.mean_rmse_mm, kMaxTracksRmse_mm);
}

TEST(RigidScene, OurTracksAreScoredAgainstTheTruth) {
  const TestFolder folder;
  EvaluationOptions options;
  options.parts = {EvaluationPart::kTracks};
  const auto truth = OpenTruth({.image_path = kSequence}, options);
  ASSERT_TRUE(truth.ok()) << truth.status().message();
  const auto run = EvaluateRun(kDefaultRun, *truth, options);
  ASSERT_TRUE(run.ok()) << run.status().message();
  ASSERT_TRUE(run->tracks);
  EXPECT_FALSE(run->surface);
  EXPECT_GT(run->tracks->average_within, kMinWithin);
  EXPECT_LE(run->tracks->average_jaccard, run->tracks->average_within);
  ASSERT_TRUE(run->tracks_3d);
  EXPECT_GT(run->tracks_3d->average_within, run->tracks_3d->null.average_within);
  EXPECT_GT(run->tracks_3d->average_jaccard, run->tracks_3d->null.average_jaccard);
  ASSERT_TRUE(WriteTrackNpz(folder.Path("tracks.npz"), TracksOfDefaultRun(), 60).ok());
  const auto file = EvaluateTrackFile({.path = folder.Path("tracks.npz")}, *truth);
  ASSERT_TRUE(file.ok()) << file.status().message();
  EXPECT_NEAR(file->tracks->average_within, run->tracks->average_within, 1e-3);  // a file has floats
  EXPECT_EQ(file->survival.tracks, run->survival.tracks);
  EXPECT_FALSE(file->tracks_3d);
}

}  // namespace
}  // namespace pliant
