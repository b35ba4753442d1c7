// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/first_map.h"

#include <array>

#include <gmock/gmock.h>

#include "tracking/frame/oracle_poses.h"

namespace pliant {
namespace {

constexpr double kFirstMapRounding = 1e-9;
const std::array<double, 3> kParams = {100, 31.5, 23.5};

// Three frames of a scene that deforms: point k starts at (5 k - 5, 0, 50) and moves by (k, 0, 1) a frame, the camera
// by 1 mm to the right; point 1 is lost before the last frame, and point 3 never got into the map.
constexpr double kLogSigma = 0.02;  // of every distance

struct DeformingStart {
  Camera camera = Camera::Create(CameraModelId::kSimplePinhole, 64, 48, kParams).value();
  FirstMap map;
  std::vector<InitFrame>& frames = map.frames;
  InitOutcome& outcome = map.outcome;

  static Eigen::Vector3d Position(int k, int frame) { return {5.0 * k - 5 + k * frame, 0, 50.0 + frame}; }

  DeformingStart() {
    outcome.decision = InitDecision::kMap;
    for (int t = 0; t < 3; ++t) {
      const Rigid3 cam_from_world(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-t, 0, 0));
      InitFrame frame{20 + t, {}};
      InitFrameState state{20 + t, cam_from_world, {}};
      for (int k = 0; k < 4; ++k) {
        if (k == 1 && t == 2) continue;
        const Eigen::Vector3d position = Position(k, t);
        frame.observations.push_back({PointId{k}, *camera.Project(cam_from_world * position), 1 - 0.1 * t});
        if (k != 3) state.positions.push_back({PointId{k}, position});
      }
      frames.push_back(frame);
      outcome.frames.push_back(state);
    }
    for (int k = 0; k < 3; ++k)
      outcome.points.push_back({PointId{k}, Position(k, 0), kLogSigma * Position(k, 0).norm()});
  }
};

TEST(FirstMap, IsThatOfTheLastFrameWithTheMotionIntoIt) {
  const DeformingStart start;
  const Map map = MakeFirstMap(start.map);
  ASSERT_EQ(map.landmarks.size(), 2U);  // point 1 was lost on the way
  for (const Landmark& landmark : map.landmarks) {
    const int k = static_cast<int>(landmark.id.value);
    EXPECT_NE(k, 1);
    EXPECT_EQ(landmark.rest_position, DeformingStart::Position(k, 0));
    EXPECT_EQ(landmark.position, DeformingStart::Position(k, 2));
    EXPECT_EQ(landmark.last_motion, Eigen::Vector3d(k, 0, 1));
    EXPECT_NEAR(landmark.log_distance_sigma, kLogSigma, kFirstMapRounding);
    EXPECT_EQ(landmark.determined_at, landmark.position);
    EXPECT_EQ(landmark.pixel, start.frames[2].observations[k == 0 ? 0 : 1].pixel);
  }
}

TEST(FirstMap, OfOneFrameHasNoMotion) {
  DeformingStart start;
  start.frames.resize(1);
  start.outcome.frames.resize(1);
  const Map map = MakeFirstMap(start.map);
  ASSERT_EQ(map.landmarks.size(), 3U);
  for (const Landmark& landmark : map.landmarks) {
    EXPECT_EQ(landmark.position, landmark.rest_position);
    EXPECT_EQ(landmark.last_motion, Eigen::Vector3d::Zero());
  }
}

TEST(FirstMap, GivesEveryFrameItsOwnPositions) {
  DeformingStart start;
  start.frames[0].observations[0].rgb = {30, 20, 10};
  start.frames[1].observations[2].rgb = {60, 50, 40};
  // Point 2 is first seen in the second frame.
  start.frames[0].observations.erase(start.frames[0].observations.begin() + 2);
  start.outcome.frames[0].positions.erase(start.outcome.frames[0].positions.begin() + 2);
  std::vector<FrameReport> reports(3);
  for (int t = 0; t < 3; ++t) reports[t].frame_idx = start.frames[t].frame_idx;
  reports.back().name = "last.png";
  reports.back().note = "how the map was made";
  reports = CompletedReports(start.camera, start.map, std::move(reports));
  for (int t = 0; t < 3; ++t) {
    const FrameReport& report = reports[t];
    EXPECT_EQ(report.state, TrackingState::kTracking);
    if (t < 2)
      EXPECT_THAT(report.note, testing::HasSubstr("made in frame last.png"));
    else
      EXPECT_EQ(report.note, "how the map was made");
    ASSERT_TRUE(report.cam_from_world && report.first_map);
    EXPECT_EQ(report.first_map->reference_frame_idx, start.frames.front().frame_idx);
    EXPECT_EQ(report.first_map->declared_frame_idx, start.frames.back().frame_idx);
    EXPECT_EQ(report.optimized, t == 1 ? 3 : 2);
    ASSERT_EQ(static_cast<int>(report.observations.size()), report.optimized);
    EXPECT_LT(report.median_reprojection_error_px, kFirstMapRounding);
    for (const PointObservation& seen : report.observations) {
      EXPECT_EQ(seen.position, DeformingStart::Position(static_cast<int>(seen.id.value), t));
      EXPECT_EQ(seen.ssim, 1 - 0.1 * t);
      EXPECT_NEAR(seen.sigma, kLogSigma * (*report.cam_from_world * seen.position).norm(), kFirstMapRounding);
      EXPECT_LT((*start.camera.Project(*report.cam_from_world * seen.position) - seen.pixel).norm(), kFirstMapRounding);
    }
    EXPECT_EQ(report.added, 2 - t);
    ASSERT_EQ(static_cast<int>(report.new_points.size()), report.added);
  }
  const NewPoint& first = reports[0].new_points[0];
  const NewPoint& later = reports[1].new_points[0];
  EXPECT_EQ(first.id, PointId{0});
  EXPECT_EQ(later.id, PointId{2});
  EXPECT_THAT(first.rgb, testing::ElementsAre(30, 20, 10));
  EXPECT_THAT(later.rgb, testing::ElementsAre(60, 50, 40));
  EXPECT_EQ(first.position, DeformingStart::Position(0, 0));
  EXPECT_EQ(later.position, DeformingStart::Position(2, 0));  // undeformed: as in the reference
}

// Every pixel shows a surface 40 mm away, from a camera that goes 1 mm to the right a frame.
class FlatTruth final : public TrackingTruth {
 public:
  Rigid3 WorldFromCamera(int frame_idx) const override {
    return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(frame_idx, 0, 0)};
  }
  std::vector<std::optional<double>> DepthsAt(int, std::span<const Eigen::Vector2d> pixels) override {
    return std::vector<std::optional<double>>(pixels.size(), 40.0);
  }
  std::vector<char> Follow(int, std::span<const InitObservation> points) override {
    return std::vector<char>(points.size(), 1);
  }
  std::vector<TrueTrack> Locate(int, std::span<const PointId> ids) override {
    return std::vector<TrueTrack>(ids.size());
  }
};

TEST(FirstMap, TakesItsUnitFromTheReferencesPointsAlone) {
  DeformingStart start;
  // Points that came into view later, one of them with an id beyond all of the reference's.
  start.frames[0].observations.resize(2);
  start.outcome.points.push_back({PointId{7}, Eigen::Vector3d(0, 0, 500)});
  FlatTruth truth;
  OraclePoses oracle({.poses = Switch::kOn}, &truth, 50.0);
  oracle.TakeWorld({start.camera, start.frames, {}}, &start.outcome);
  // The map has the surface at 50: so much is a millimeter.
  for (const InitFrameState& frame : start.outcome.frames) {
    const int since = frame.frame_idx - start.outcome.frames.front().frame_idx;
    EXPECT_NEAR(frame.cam_from_world.translation.x(), -since * 50.0 / 40.0, kFirstMapRounding);
  }
  ASSERT_TRUE(oracle.Pose(22));
}

TEST(FirstMap, MakesAFrameThatWasPassedOverLost) {
  DeformingStart start;
  start.frames[2].frame_idx = start.outcome.frames[2].frame_idx = 23;
  std::vector<FrameReport> reports(4);
  for (int t = 0; t < 4; ++t) reports[t].frame_idx = 20 + t;
  reports[2].note = "passed over";
  reports = CompletedReports(start.camera, start.map, std::move(reports));
  for (const int t : {0, 1, 3}) EXPECT_EQ(reports[t].state, TrackingState::kTracking);
  EXPECT_EQ(reports[2].state, TrackingState::kLost);
  EXPECT_EQ(reports[2].note, "passed over");
  EXPECT_FALSE(reports[2].cam_from_world || reports[2].first_map);
  EXPECT_TRUE(reports[2].observations.empty() && reports[2].new_points.empty());
}

}  // namespace
}  // namespace pliant
