// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Real recordings, where they are at hand: the tests are skipped where they are not.
#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "e2e/e2e_support.h"
#include "pliant/base/statistics.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/image/pyramid.h"
#include "pliant/io/camera_file.h"
#include "pliant/io/point_cloud.h"
#include "pliant/pipeline/surface_run.h"

namespace pliant {
namespace {

constexpr std::int64_t kMinNasalFrames = 33;  // of 35
constexpr double kNasalWidth_px = 1920;
constexpr std::size_t kMinPorcine = 200;  // map points that the published disparities cover
constexpr double kDisparity = 0.01;       // median, relative: half a step of 8-bit disparities of some 50
constexpr double kMinPorcineKnown = 0.7;  // of the pixels with a published disparity
constexpr std::size_t kMinCloth = 300;    // map points of the first image, most of which are followed to the last
constexpr double kCloud = 0.02;           // median, relative: steps between the cloud's points, and the motion itself

std::string RecordingOrSkip(const std::string& name) {
  const std::filesystem::path path = std::filesystem::path(PLIANT_TEST_RECORDINGS) / name;
  return std::filesystem::exists(path) ? path.string() : "";
}

RunRequest LaparoscopyRequest(const std::string& folder_path, const std::string& output_path) {
  RunRequest request;
  request.input.image_path = folder_path + "/endo.mp4";
  request.input.camera_path = folder_path + "/camera.yaml";
  request.output_path = output_path;
  return request;
}

TEST(Recordings, TheLaparoscopyVideoIsReadDirectlyAndTrackedThroughAllItsFrames) {
  const std::string folder_path = RecordingOrSkip("laparoscopy");
  if (folder_path.empty()) GTEST_SKIP() << "no recordings at " << PLIANT_TEST_RECORDINGS;
  const TestFolder folder;
  const RunRequest request = LaparoscopyRequest(folder_path, folder.Path("run"));
  const auto summary = RunTrack(request, TrackOptions(), {});
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->frames_tracked, 250);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(static_cast<std::int64_t>(run->poses.size()), summary->frames_tracked);
}

// Coefficients explain the parallax of so few frames away; the rigid window's map is provisional (W19).
TEST(Recordings, TheLaparoscopyAtAThirdOfItsFrameRateHasAProvisionalMap) {
  const std::string folder_path = RecordingOrSkip("laparoscopy");
  if (folder_path.empty()) GTEST_SKIP() << "no recordings at " << PLIANT_TEST_RECORDINGS;
  const TestFolder folder;
  RunRequest request = LaparoscopyRequest(folder_path, folder.Path("run"));
  request.input.stride = 3;
  const auto summary = RunTrack(request, TrackOptions(), {});
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->frames_tracked, 84);
  ASSERT_FALSE(summary->first_maps.empty());
  EXPECT_TRUE(summary->first_maps.front().evidence.provisional);
}

TEST(Recordings, NoisyFullHdIsTrackedInSmallerImagesAndReportedInItsOwnPixels) {
  const std::string folder_path = RecordingOrSkip("nasal");
  if (folder_path.empty()) GTEST_SKIP() << "no recordings at " << PLIANT_TEST_RECORDINGS;
  const TestFolder folder;
  RunRequest request;
  request.input.image_path = folder_path;
  request.input.mask_path = folder_path + "/mask.png";
  request.output_path = folder.Path("run");
  const auto summary = RunTrack(request, TrackOptions(), {});
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_GE(summary->frames_tracked, kMinNasalFrames);
  EXPECT_LT(summary->description.image_scale, 1);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  ASSERT_FALSE(run->frames.empty());
  auto reader = ObservationReader::Open(folder.Path("run"));
  ASSERT_TRUE(reader.ok()) << reader.status().message();
  double right_px = 0;
  for (auto rows = reader->Next(); rows.ok() && rows->has_value(); rows = reader->Next())
    for (const PointObservation& seen : (*rows)->observations) right_px = std::max(right_px, seen.pixel.x());
  EXPECT_GT(right_px, 0.5 * kNasalWidth_px);
}

TEST(Recordings, TenNearlyStillImagesSayWhyTheyCarryNoMap) {
  const std::string folder_path = RecordingOrSkip("porcine_stereo");
  if (folder_path.empty()) GTEST_SKIP() << "no recordings at " << PLIANT_TEST_RECORDINGS;
  const TestFolder folder;
  const RunSummary summary = TrackSequenceAt(folder_path, folder.Path("run"), TrackOptions());
  EXPECT_EQ(summary.frames_read, 10);
  EXPECT_EQ(summary.frames_tracked, 0);
  EXPECT_EQ(summary.status, RunStatus::kFailed);
  EXPECT_THAT(summary.note, testing::HasSubstr("without a first map"));
  EXPECT_THAT(summary.note, testing::HasSubstr("parallax"));
  EXPECT_TRUE(ReadRun(folder.Path("run")).ok());
}

// What a run has of one frame.
std::vector<PointObservation> ObservationsOf(const std::string& run, int frame_idx) {
  auto reader = ObservationReader::Open(run);
  EXPECT_TRUE(reader.ok()) << reader.status().message();
  while (reader.ok()) {
    const auto frame = reader->Next();
    EXPECT_TRUE(frame.ok()) << frame.status().message();
    if (!frame.ok() || !frame->has_value()) break;
    if ((*frame)->frame_idx == frame_idx) return (*frame)->observations;
  }
  return {};
}

// Between four pixels of an 8-bit disparity map; nothing where one has none.
std::optional<double> DisparityAt(const cv::Mat& disparities, const Eigen::Vector2d& pixel) {
  const int u = static_cast<int>(pixel.x());
  const int v = static_cast<int>(pixel.y());
  if (u < 0 || v < 0 || u + 1 >= disparities.cols || v + 1 >= disparities.rows) return std::nullopt;
  double least = 0;
  cv::minMaxLoc(disparities(cv::Rect(u, v, 2, 2)), &least);
  if (least <= 0) return std::nullopt;
  return SampleBilinear(disparities, pixel.x(), pixel.y());
}

constexpr double kFocalBaseline = 1120.2260379 * 4.1434591;  // of the porcine pairs, px mm

TEST(Recordings, TheStereoMapOfThePorcinePairIsThatOfItsDisparities) {
  const std::string folder_path = RecordingOrSkip("porcine_stereo");
  if (folder_path.empty()) GTEST_SKIP() << "no recordings at " << PLIANT_TEST_RECORDINGS;
  const cv::Mat disparities = cv::imread(folder_path + "/disparity_0000.png", cv::IMREAD_GRAYSCALE);
  ASSERT_FALSE(disparities.empty());
  const TestFolder folder;
  TrackOptions options;
  options.tracker.init.method = InitMethod::kStereo;
  const RunSummary summary = TrackSequenceAt(folder_path, folder.Path("run"), options);
  EXPECT_EQ(summary.frames_tracked, 10) << summary.note;
  std::vector<double> errors;
  for (const PointObservation& seen : ObservationsOf(folder.Path("run"), 0)) {
    if (const auto disparity = DisparityAt(disparities, seen.pixel))
      errors.push_back(std::abs(seen.position.z() * *disparity / kFocalBaseline - 1.0));
  }
  ASSERT_GT(errors.size(), kMinPorcine);
  EXPECT_LT(Median(errors), kDisparity);
}

TEST(Recordings, TheSurfaceOfThePorcinePairIsThatOfItsDisparities) {
  const std::string folder_path = RecordingOrSkip("porcine_stereo");
  if (folder_path.empty()) GTEST_SKIP() << "no recordings at " << PLIANT_TEST_RECORDINGS;
  const cv::Mat disparities = cv::imread(folder_path + "/disparity_0000.png", cv::IMREAD_GRAYSCALE);
  const TestFolder folder;
  TrackOptions options;
  options.tracker.init.method = InitMethod::kStereo;
  TrackSequenceAt(folder_path, folder.Path("run"), options);
  SurfaceRequest request;
  request.run_path = folder.Path("run");
  request.output_path = folder.Path("surface");
  request.frames = {0};
  ASSERT_TRUE(MakeSurface(request, {}, {}).ok());
  const auto surface = ReadSurfaceFolder(request.output_path);
  ASSERT_TRUE(surface.ok()) << surface.status().message();
  const auto dense = ReadSurfaceDepth(*surface, surface->frames.at(0));
  ASSERT_TRUE(dense.ok()) << dense.status().message();
  ASSERT_EQ(dense->depth.size(), disparities.size());
  std::vector<double> errors;
  for (int y = 0; y < disparities.rows; ++y)
    for (int x = 0; x < disparities.cols; ++x) {
      const double disparity = disparities.at<std::uint8_t>(y, x);
      if (disparity > 0 && dense->depth.at<float>(y, x) > 0)
        errors.push_back(std::abs(dense->depth.at<float>(y, x) * disparity / kFocalBaseline - 1.0));
    }
  EXPECT_GT(static_cast<double>(errors.size()), kMinPorcineKnown * cv::countNonZero(disparities));
  EXPECT_LT(Median(errors), kDisparity);
}

TEST(Recordings, AStillCameraBeforeAClothThatDeformsIsAmbiguous) {
  const std::string folder_path = RecordingOrSkip("cloth");
  if (folder_path.empty()) GTEST_SKIP() << "no recordings at " << PLIANT_TEST_RECORDINGS;
  const TestFolder folder;
  const RunSummary summary = TrackSequenceAt(folder_path, folder.Path("run"), TrackOptions());
  EXPECT_EQ(summary.frames_tracked, 0);
  EXPECT_THAT(summary.note, testing::HasSubstr("cannot be told apart"));
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  for (const auto& frame : run->frames) EXPECT_EQ(frame.state, TrackingState::kAmbiguous);
}

TEST(Recordings, TheClothIsTrackedFromItsFirstCloudBeforeACameraThatStandsStill) {
  const std::string folder_path = RecordingOrSkip("cloth");
  if (folder_path.empty()) GTEST_SKIP() << "no recordings at " << PLIANT_TEST_RECORDINGS;
  const TestFolder folder;
  TrackOptions options;
  options.tracker.init.method = InitMethod::kDepth;
  options.tracker.init.depth.cloud_path = folder_path + "/clouds/000000.npy";
  options.tracker.init.depth.cloud_unit_mm = 1000;
  options.tracker.camera_motion = CameraMotion::kNone;
  options.tracker.problem.edge_length = Switch::kOn;
  const RunSummary summary = TrackSequenceAt(folder_path, folder.Path("run"), options);
  EXPECT_EQ(summary.status, RunStatus::kCompleted) << summary.note;
  EXPECT_EQ(summary.frames_tracked, 50);
  const auto camera = ReadCamera(folder_path + "/camera.yaml");
  ASSERT_TRUE(camera.ok()) << camera.status().message();
  const auto cloud = ReadPointCloud(folder_path + "/clouds/000049.npy");
  ASSERT_TRUE(cloud.ok()) << cloud.status().message();
  std::vector<double> errors;  // along the rays, by the point of the cloud that is nearest in the image
  for (const PointObservation& seen : ObservationsOf(folder.Path("run"), 49)) {
    double nearest_px = 3.0;
    double depth_mm = 0;
    for (const Eigen::Vector3d& point : *cloud)
      if (const auto pixel = camera->Project(point); pixel && (*pixel - seen.pixel).norm() < nearest_px) {
        nearest_px = (*pixel - seen.pixel).norm();
        depth_mm = 1000.0 * point.z();
      }
    if (depth_mm > 0) errors.push_back(std::abs(seen.position.z() / depth_mm - 1.0));
  }
  ASSERT_GT(errors.size(), kMinCloth);
  EXPECT_LT(Median(errors), kCloud);
}

}  // namespace
}  // namespace pliant
