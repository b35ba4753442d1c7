// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs that follow a file of tracks, on a small simulated sequence whose true tracks are known.
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "pliant/image/corners.h"
#include "pliant/io/run_reader.h"
#include "pliant/io/run_summary.h"
#include "pliant/io/track_file.h"
#include "pliant/pipeline/track.h"
#include "pliant/simulation/simulator.h"
#include "pliant/simulation/write_sequence.h"
#include "simulation/small_scene.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr int kTrackedFrames = 24;
constexpr double kAsGoodAsOracle = 1.02;  // two per cent for the points that one run has and the other has not
constexpr double kRounding = 0.51e-4;     // px: a file has four decimals
constexpr int kMinPoints = 100;

class GivenTracksRun : public testing::Test {
 protected:
  void SetUp() override {
    scene_ = simulation_test::SmallScene(TrajectoryKind::kSway, kTrackedFrames);
    scene_.camera.width = 320;
    scene_.camera.height = 240;
    scene_.deformation.amplitude_mm = 2.5;
    scene_.trajectory.sway_period_s = 2.0;
    const Status written = WriteSequence(scene_, folder_.Path("sequence"));
    ASSERT_TRUE(written.ok()) << written.message();
  }

  // The true tracks of the corners of frame 0.
  std::vector<PixelTrack> TrueTracks() const {
    Simulator simulator = Simulator::Create(scene_).value();
    const cv::Mat image = simulator.Render(0).image;
    const PreparedFrame first = PrepareFrame(0, "", 0, image, {}, {});
    std::vector<Eigen::Vector2d> pixels;
    for (const Corner& corner : DetectCorners(first.gray, first.mask.valid(), {}, {})) pixels.push_back(corner.pixel);
    std::vector<MaterialPoint> points;
    for (const auto& hit : simulator.HitsAt(0, pixels))
      if (hit) points.push_back(hit->point);
    std::vector<PixelTrack> tracks(points.size());
    for (int frame_idx = 0; frame_idx < kTrackedFrames; ++frame_idx) {
      const auto seen = simulator.Observe(frame_idx, points);
      for (std::size_t k = 0; k < seen.size(); ++k) {
        tracks[k].id.value = static_cast<std::int64_t>(k);
        if (seen[k].visibility == Visibility::kVisible) tracks[k].pixels.push_back({frame_idx, seen[k].pixel});
      }
    }
    return tracks;
  }
  TrackOptions Options() const {
    TrackOptions options;
    options.tracker.init.method = InitMethod::kGated;
    options.tracker.growth.grow = Switch::kOff;
    return options;
  }
  Result<RunSummary> Track(const TrackOptions& options, const std::string& run = "run") const {
    RunRequest request;
    request.input.image_path = folder_.Path("sequence");
    request.output_path = folder_.Path(run);
    return RunTrack(request, options, {});
  }
  RunSummary TrackFile(const std::vector<PixelTrack>& tracks, TrackOptions options) const {
    options.track_file.path = folder_.Path("tracks.csv");
    EXPECT_TRUE(WriteTrackCsv(options.track_file.path, tracks).ok());
    const auto summary = Track(options);
    EXPECT_TRUE(summary.ok()) << summary.status().message();
    return summary.ok() ? *summary : RunSummary();
  }
  // Root mean square error of all depths in a run's frames, after one scale a frame.
  double DepthErrorMm(const std::string& run) const {
    Simulator simulator = Simulator::Create(scene_).value();
    const auto read = ReadRun(folder_.Path(run));
    EXPECT_TRUE(read.ok()) << read.status().message();
    std::map<int, Rigid3> poses;
    for (const RunPose& pose : read->poses) poses[*pose.frame_idx] = pose.world_from_cam.Inverse();
    auto reader = ObservationReader::Open(folder_.Path(run)).value();
    double squares = 0;
    int count = 0;
    for (auto rows = reader.Next(); rows.ok() && rows->has_value(); rows = reader.Next()) {
      std::vector<Eigen::Vector2d> pixels;
      for (const PointObservation& seen : (*rows)->observations) pixels.push_back(seen.pixel);
      const auto hits = simulator.HitsAt((*rows)->frame_idx, pixels);
      double dot = 0;
      double square = 0;
      std::vector<std::pair<double, double>> depths;
      for (std::size_t k = 0; k < hits.size(); ++k) {
        if (!hits[k]) continue;
        const double depth = (poses.at((*rows)->frame_idx) * (*rows)->observations[k].position).z();
        depths.emplace_back(depth, hits[k]->depth_mm);
        dot += depth * hits[k]->depth_mm;
        square += depth * depth;
      }
      for (const auto& [depth, truth] : depths) squares += std::pow(dot / square * depth - truth, 2);
      count += static_cast<int>(depths.size());
    }
    return std::sqrt(squares / count);
  }

  TestFolder folder_;
  SimulationOptions scene_;
};

TEST_F(GivenTracksRun, TrueTracksFromAFileAreAsGoodAsTheOracle) {
  TrackOptions oracle = Options();
  oracle.tracker.oracle.tracks = Switch::kOn;
  const auto with_oracle = Track(oracle, "oracle");
  ASSERT_TRUE(with_oracle.ok()) << with_oracle.status().message();
  const RunSummary summary = TrackFile(TrueTracks(), Options());
  EXPECT_EQ(summary.status, RunStatus::kCompleted);
  EXPECT_EQ(summary.frames_tracked, kTrackedFrames);
  EXPECT_GE(summary.frames_tracked, with_oracle->frames_tracked);
  EXPECT_LT(DepthErrorMm("run"), kAsGoodAsOracle * DepthErrorMm("oracle"));
  EXPECT_EQ(summary.description.tracks, folder_.Path("tracks.csv"));
  EXPECT_EQ(ReadRunSummary(folder_.Path("run/run.json"))->description.tracks, folder_.Path("tracks.csv"));
}

TEST_F(GivenTracksRun, PointsHaveTheIdsAndPixelsOfTheirTracks) {
  const std::vector<PixelTrack> tracks = TrueTracks();
  TrackFile(tracks, Options());
  auto reader = ObservationReader::Open(folder_.Path("run")).value();
  int count = 0;
  for (auto rows = reader.Next(); rows.ok() && rows->has_value(); rows = reader.Next())
    for (const PointObservation& seen : (*rows)->observations) {
      const PixelTrack* track = FindById(tracks, seen.id);
      ASSERT_NE(track, nullptr) << seen.id.value;
      const TrackPixel* pixel = PixelIn(*track, (*rows)->frame_idx);
      ASSERT_NE(pixel, nullptr);
      EXPECT_LT((seen.pixel - pixel->pixel).cwiseAbs().maxCoeff(), 2 * kRounding);
      ++count;
    }
  EXPECT_GT(count, kTrackedFrames * kMinPoints);
}

TEST_F(GivenTracksRun, TracksThatBeginLaterAreCandidatesOfTheMap) {
  std::vector<PixelTrack> tracks = TrueTracks();
  constexpr int kLater = 10;
  for (std::size_t k = 0; k < tracks.size(); k += 2)
    std::erase_if(tracks[k].pixels, [](const TrackPixel& seen) { return seen.frame_idx < kLater; });
  TrackOptions options = Options();
  options.tracker.growth.grow = Switch::kOn;
  options.tracker.growth.every = 1;
  options.tracker.growth.min_views = 4;
  TrackFile(tracks, options);
  auto reader = ObservationReader::Open(folder_.Path("run")).value();
  int grown = 0;
  for (auto rows = reader.Next(); rows.ok() && rows->has_value(); rows = reader.Next())
    for (const PointObservation& seen : (*rows)->observations)
      if (seen.id.value % 2 == 0 && (*rows)->frame_idx == kTrackedFrames - 1) ++grown;
  EXPECT_GT(grown, 0);
}

TEST_F(GivenTracksRun, TheEndNamesWhyTheLastReferenceOfTracksWasGivenUp) {
  constexpr std::size_t kTracks = 45;
  constexpr int kDieIn = 5;
  TrackOptions options;
  options.tracker.masks.highlights = Switch::kOff;  // all of them are begun with
  options.tracker.corners.contour_filter = Switch::kOff;
  options.tracker.corners.min_distance_px = 1;
  std::vector<PixelTrack> tracks = TrueTracks();
  std::erase_if(tracks, [](const PixelTrack& track) { return track.pixels.size() < kTrackedFrames; });
  ASSERT_GT(tracks.size(), kTracks);
  tracks.resize(kTracks);
  for (const auto& [left, note] : {std::pair(11,
                                             "only 11 points are still followed (at least 22 must be); no reference "
                                             "since then: 11 tracks, of at least 12"),
                                   std::pair(0,
                                             "all points were lost; no reference since then: 0 tracks, of at least "
                                             "12")}) {
    for (std::size_t k = static_cast<std::size_t>(left); k < kTracks; ++k)
      std::erase_if(tracks[k].pixels, [](const TrackPixel& seen) { return seen.frame_idx >= kDieIn; });
    const RunSummary summary = TrackFile(tracks, options);
    EXPECT_EQ(summary.status, RunStatus::kFailed);
    EXPECT_THAT(summary.note, HasSubstr(std::string("the sequence ended without a first map: ") + note));
  }
}

TEST_F(GivenTracksRun, WhatContradictsAFileOfTracksIsRefusedInOneSentence) {
  TrackOptions options = Options();
  options.track_file.path = folder_.Path("nowhere.csv");
  EXPECT_THAT(Track(options).status().message(), HasSubstr("there is no file of tracks"));
  ASSERT_TRUE(WriteTrackCsv(folder_.Path("tracks.csv"), TrueTracks()).ok());
  options.track_file.path = folder_.Path("tracks.csv");
  options.image = {.working = WorkingImageMode::kFixed, .scale = 0.5};
  EXPECT_THAT(Track(options).status().message(), HasSubstr("leave Image.scale at 1"));
  options.image = {.scale = 0.5};
  EXPECT_THAT(Track(options).status().message(), HasSubstr("leave Image.scale at 1"));
  options.image = {.interlaced = Interlacing::kOn};
  EXPECT_THAT(Track(options).status().message(), HasSubstr("do not give Image.interlaced on"));
  options.image = {};
  options.tracker.oracle.tracks = Switch::kOn;
  EXPECT_THAT(Track(options).status().message(), HasSubstr("both say where points are"));
}

// Noise of true tracks has the size that was asked for, and is that of its point and frame alone.
TEST_F(GivenTracksRun, TheNoiseOfTheOracleIsOfTheSizeThatWasAskedFor) {
  TrackOptions options = Options();
  options.tracker.oracle.tracks = Switch::kOn;
  options.tracker.oracle.track_noise_px = 0.3;
  ASSERT_TRUE(Track(options).ok());
  const std::vector<PixelTrack> truth = TrueTracks();
  auto reader = ObservationReader::Open(folder_.Path("run")).value();
  std::map<PointId, const PixelTrack*> track_of;
  double squares = 0;
  int count = 0;
  for (auto rows = reader.Next(); rows.ok() && rows->has_value(); rows = reader.Next())
    for (const PointObservation& seen : (*rows)->observations) {
      if ((*rows)->frame_idx == 0)
        for (const PixelTrack& track : truth)
          if (!track.pixels.empty() && (track.pixels[0].pixel - seen.pixel).norm() < 1e-3) track_of[seen.id] = &track;
      const auto track = track_of.find(seen.id);
      if ((*rows)->frame_idx == 0 || track == track_of.end()) continue;
      squares += (seen.pixel - PixelIn(*track->second, (*rows)->frame_idx)->pixel).squaredNorm();
      count += 2;
    }
  ASSERT_GT(count, kTrackedFrames * kMinPoints);
  EXPECT_NEAR(std::sqrt(squares / count), 0.3, 0.03);  // points that are far off are rejected
}

}  // namespace
}  // namespace pliant
