// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The written files are read as the other programs read them, and a run's points projected with their conventions.

#include <cmath>
#include <cstring>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "exchange/neural_run.h"
#include "pliant/exchange/export.h"
#include "pliant/io/run_summary.h"
#include "support/test_folder.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

// The centroid of a sampled spot, whose levels are whole numbers, whose tail is cut off, and which was resampled.
constexpr double kSpot_px = 0.15;
constexpr double kNerfstudioDepthStep = 1e-3;  // nerfstudio's default of depth_unit_scale_factor

Result<ExportSummary> ExportNeural(const TestFolder& folder, const std::string& format,
                                   const ExportRequest& extra = {}) {
  ExportRequest request = extra;
  request.run_path = folder.Path("run");
  request.format = format;
  request.output_path = folder.Path("out");
  return ExportRun(request, {});
}

std::string ExportError(const TestFolder& folder, const std::string& format, ErrorCode code,
                        const ExportRequest& extra = {}) {
  const Status status = ExportNeural(folder, format, extra).status();
  EXPECT_EQ(status.code(), code) << status.message();
  EXPECT_TRUE(!std::filesystem::exists(folder.Path("out")) || std::filesystem::is_empty(folder.Path("out")))
      << "something was left behind";
  return status.message();
}

ExportRequest WithSurface(const TestFolder& folder) {
  ExportRequest request;
  request.surface_path = folder.Path("surface");
  return request;
}

cv::Mat ReadPng(const std::string& path) { return cv::imread(path, cv::IMREAD_UNCHANGED); }

// Where the spot is that lies within a few pixels of `near`.
Eigen::Vector2d FindSpot(const cv::Mat& bgr, const Eigen::Vector2d& near) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0;
  for (int y = static_cast<int>(near.y()) - 4; y <= near.y() + 5; ++y)
    for (int x = static_cast<int>(near.x()) - 4; x <= near.x() + 5; ++x) {
      const double level = bgr.at<cv::Vec3b>(y, x)[0];
      sum += level * Eigen::Vector2d(x, y);
      weight += level;
    }
  return sum / weight;
}

// A point of the world in a camera whose axes are those of OpenGL, turned into OpenCV's.
Eigen::Vector3d InOpenCvCamera(const Eigen::Matrix<double, 3, 4>& world_from_cam, const Eigen::Vector3d& point) {
  const Eigen::Vector3d x = world_from_cam.leftCols<3>().transpose() * (point - world_from_cam.col(3));
  return {x.x(), -x.y(), -x.z()};
}

double Number(const Json& json, const char* key) { return json.contains(key) ? json[key].get<double>() : 0.0; }

// nerfstudio's pixel, which counts from the corner of the image.
Eigen::Vector2d NerfstudioProject(const Json& json, const Eigen::Vector3d& point_in_cam) {
  double x = point_in_cam.x() / point_in_cam.z();
  double y = point_in_cam.y() / point_in_cam.z();
  const double k1 = Number(json, "k1"), k2 = Number(json, "k2");
  double r2 = x * x + y * y;
  if (json["camera_model"] == "OPENCV_FISHEYE") {
    const double r = std::sqrt(r2);
    const double theta = std::atan(r);
    const double t2 = theta * theta;
    const double scale = theta / r * (1 + t2 * (k1 + t2 * (k2 + t2 * (Number(json, "k3") + t2 * Number(json, "k4")))));
    x *= scale;
    y *= scale;
  } else {
    const double p1 = Number(json, "p1"), p2 = Number(json, "p2");
    const double radial = 1 + r2 * (k1 + r2 * k2);
    const double xd = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
    y = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
    x = xd;
  }
  return {json["fl_x"].get<double>() * x + json["cx"].get<double>(),
          json["fl_y"].get<double>() * y + json["cy"].get<double>()};
}

Eigen::Matrix<double, 3, 4> PoseOf(const Json& frame) {
  Eigen::Matrix<double, 3, 4> pose;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) pose(r, c) = frame["transform_matrix"][r][c];
  EXPECT_NEAR(pose.leftCols<3>().determinant(), 1.0, kRoundOff);
  return pose;
}

Json ReadTransforms(const TestFolder& folder) {
  return Json::parse(folder.Read("out/transforms.json"), nullptr, false);
}

// poses_bounds.npy, a row a frame.
std::vector<std::array<double, 17>> ReadPoses(const TestFolder& folder) {
  const std::string bytes = folder.Read("out/poses_bounds.npy");
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t begin = 10 + static_cast<unsigned char>(bytes[8]) + 256U * static_cast<unsigned char>(bytes[9]);
  EXPECT_EQ(begin % 64, 0U);
  const std::size_t count = (bytes.size() - begin) / sizeof(double);
  EXPECT_THAT(bytes.substr(0, begin), HasSubstr("'shape': (" + std::to_string(count / 17) + ", 17)"));
  std::vector<std::array<double, 17>> rows(count / 17);
  std::memcpy(rows.data(), bytes.data() + begin, rows.size() * sizeof(rows[0]));
  return rows;
}

Eigen::Matrix<double, 3, 4> PoseOf(const std::array<double, 17>& row) {
  Eigen::Matrix<double, 3, 4> pose;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) pose(r, c) = row[static_cast<std::size_t>(5 * r + c)];
  EXPECT_NEAR(pose.leftCols<3>().determinant(), 1.0, kRoundOff);
  return pose;
}

// EndoNeRF's pixel: the center of pixel (0, 0) is at (0.5, 0.5), the optical axis at (width / 2, height / 2).
Eigen::Vector2d EndoNerfProject(const std::array<double, 17>& row, const Eigen::Vector3d& point_in_cam) {
  return row[14] * point_in_cam.head<2>() / point_in_cam.z() + 0.5 * Eigen::Vector2d(row[9], row[4]);
}

TEST(NerfstudioExport, ProjectsPointsToTheirPixelsWithEveryCamera) {
  for (const Camera& camera : NeuralCameras()) {
    const TestFolder folder;
    WriteNeuralRun(folder, camera);
    const auto summary = ExportNeural(folder, "nerfstudio");
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    const Json json = ReadTransforms(folder);
    ASSERT_EQ(json["frames"].size(), static_cast<std::size_t>(kRunFrames));
    const double unit = json["unit"];
    EXPECT_EQ(unit, 10.0);  // the points are about 50 away
    for (int f = 0; f < kRunFrames; ++f) {
      const Json& frame = json["frames"][static_cast<std::size_t>(f)];
      EXPECT_NEAR(frame["time"].get<double>(), f / (kRunFrames - 1.0), kRoundOff);
      EXPECT_FALSE(frame.contains("depth_file_path") || frame.contains("mask_path"));
      const cv::Mat image = ReadPng(folder.Path("out/" + frame["file_path"].get<std::string>()));
      ASSERT_EQ(image.type(), CV_8UC3);
      for (const PointObservation& o : ReportBy(camera, Report(f)).observations) {
        const Eigen::Vector2d pixel = NerfstudioProject(json, InOpenCvCamera(PoseOf(frame), o.position / unit));
        EXPECT_LT((pixel - Eigen::Vector2d(0.5, 0.5) - o.pixel).norm(), kExactReprojection_px) << camera.model_name();
        EXPECT_LT((FindSpot(image, o.pixel) - o.pixel).norm(), kSpot_px);
      }
    }
  }
}

TEST(NerfstudioExport, HasTheUndeformedPointsInTheUnitOfThePoses) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  ASSERT_TRUE(ExportNeural(folder, "nerfstudio").ok());
  EXPECT_EQ(ReadTransforms(folder)["ply_file_path"], "sparse_pc.ply");
  const std::string ply = folder.Read("out/sparse_pc.ply");
  EXPECT_THAT(ply, HasSubstr("element vertex " + std::to_string(kRunPoints) + "\n"));
  constexpr std::size_t kRow = 3 * 4 + 3;
  const std::size_t begin = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size(), begin + kRunPoints * kRow);
  for (int i = 0; i < kRunPoints; ++i) {
    std::array<float, 3> x{};
    std::memcpy(x.data(), ply.data() + begin + static_cast<std::size_t>(i) * kRow, sizeof(x));
    EXPECT_LT((Eigen::Vector3d(x[0], x[1], x[2]) - Undeformed(i) / 10.0).norm(), kFloatRoundOff_mm);
  }
}

TEST(NerfstudioExport, DepthsAreInTheUnitOfThePosesAndFramesWithoutAreLeftOut) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  WriteSurface(folder, TestCamera(), {10, 14, 16}, folder.Path("run"));
  const auto summary = ExportNeural(folder, "nerfstudio", WithSurface(folder));
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->frames, 3);
  ASSERT_EQ(summary->notes.size(), 1U);
  EXPECT_THAT(summary->notes[0], HasSubstr("2 tracked frames have no depth"));
  const Json json = ReadTransforms(folder);
  ASSERT_EQ(json["frames"].size(), 3U);
  EXPECT_EQ(json["frames"][1]["file_path"], "images/000014.png");
  const double unit = json["unit"];
  for (const Json& frame : json["frames"]) {
    const cv::Mat depth = ReadPng(folder.Path("out/" + frame["depth_file_path"].get<std::string>()));
    ASSERT_EQ(depth.type(), CV_16UC1);
    for (const cv::Point& p : {cv::Point(0, 0), cv::Point(639, 479), cv::Point(320, 17)})
      EXPECT_NEAR(depth.at<std::uint16_t>(p) * kNerfstudioDepthStep * unit, SurfaceDepthAt(p.x, p.y),
                  0.5 * kNerfstudioDepthStep * unit + kSurfaceStep);
    EXPECT_EQ(depth.at<std::uint16_t>(cv::Point(120, 40)), 0);
  }
}

// mask.png, in which a corner is not to be used.
cv::Mat WriteMask(const TestFolder& folder) {
  cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(255));
  mask(cv::Rect(0, 0, 100, 50)) = 0;
  EXPECT_TRUE(WritePng(folder.Path("mask.png"), mask).ok());
  return mask;
}

TEST(NerfstudioExport, MasksKeepWhatIsUsed) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  const cv::Mat mask = WriteMask(folder);
  ExportRequest request;
  request.mask_path = folder.Path("mask.png");
  ASSERT_TRUE(ExportNeural(folder, "nerfstudio", request).ok());
  const Json transforms = ReadTransforms(folder);
  for (const Json& frame : transforms["frames"]) {
    const cv::Mat written = ReadPng(folder.Path("out/" + frame["mask_path"].get<std::string>()));
    EXPECT_EQ(cv::countNonZero(written != mask), 0);
  }
}

TEST(NerfstudioExport, RefusesToLeaveOutTheMasksOfTheRun) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  auto summary = ReadRunSummary(folder.Path("run/run.json"));
  ASSERT_TRUE(summary.ok());
  summary->description.mask = folder.Path("moved.png");
  ASSERT_TRUE(WriteRunSummary(folder.Path("run/run.json"), *summary).ok());
  const Status status = ExportNeural(folder, "nerfstudio").status();
  EXPECT_EQ(status.code(), ErrorCode::kNotFound);
  EXPECT_THAT(status.message(), testing::HasSubstr("--mask_path"));
}

TEST(EndoNerfExport, ImagesOfEveryCameraAreThoseOfACenteredPinhole) {
  for (const Camera& camera : NeuralCameras()) {
    const TestFolder folder;
    WriteNeuralRun(folder, camera);
    const auto summary = ExportNeural(folder, "endonerf");
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    EXPECT_FALSE(std::filesystem::exists(folder.Path("out/depth")));
    const auto rows = ReadPoses(folder);
    ASSERT_EQ(rows.size(), static_cast<std::size_t>(kRunFrames));
    const auto file = ReadCameraFile(folder.Path("out/pinhole.yaml"));
    ASSERT_TRUE(file.ok()) << file.status().message();
    EXPECT_THAT(folder.Read("out/pinhole.yaml"), HasSubstr("# map units per step"));
    const double unit = *file->depth_scale;
    EXPECT_DOUBLE_EQ(unit, 0.1);  // the points are about 50 away
    for (int f = 0; f < kRunFrames; ++f) {
      const auto& row = rows[static_cast<std::size_t>(f)];
      EXPECT_EQ(row[4], 480);
      EXPECT_EQ(row[9], 640);
      EXPECT_GT(row[15] * unit, 50.0);  // the points are 50.5 away in the first frame, and it turns a little
      EXPECT_LE(row[15], row[16]);
      EXPECT_LT(row[16] * unit, 51.0);
      const cv::Mat image =
          ReadPng(folder.Path("out/images/" + std::string("0000") + std::to_string(10 + 2 * f) + ".png"));
      ASSERT_EQ(image.type(), CV_8UC3);
      for (const PointObservation& o : Report(f).observations) {
        const Eigen::Vector3d x = InOpenCvCamera(PoseOf(row), o.position / unit);
        const Eigen::Vector2d center = EndoNerfProject(row, x) - Eigen::Vector2d(0.5, 0.5);
        EXPECT_LT((*file->camera.Project(x) - center).norm(), kExactReprojection_px);
        EXPECT_LT((FindSpot(image, center) - center).norm(), kSpot_px) << camera.model_name();
      }
    }
  }
}

TEST(EndoNerfExport, ImagesOfSuchACameraStayAsTheyAre) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  ASSERT_TRUE(ExportNeural(folder, "endonerf").ok());
  const cv::Mat before = cv::imread(folder.Path("sequence/images/10.png"), cv::IMREAD_COLOR);
  const cv::Mat after = ReadPng(folder.Path("out/images/000010.png"));
  EXPECT_EQ(cv::norm(before, after, cv::NORM_INF), 0);
  EXPECT_EQ(cv::countNonZero(ReadPng(folder.Path("out/masks/000010.png"))), 0);  // all of it is tissue
}

TEST(EndoNerfExport, DepthsHaveTheUnitOfThePosesAndMasksTheirHoles) {
  const Camera camera = NeuralCamera("OPENCV", {490, 490, 300, 251, 0.15, 0, 0, 0});
  const TestFolder folder;
  WriteNeuralRun(folder, camera);
  WriteSurface(folder, camera, {10, 12, 14, 16, 18}, folder.Path("run"));
  ASSERT_TRUE(ExportNeural(folder, "endonerf", WithSurface(folder)).ok());
  const auto rows = ReadPoses(folder);
  ASSERT_EQ(rows.size(), 5U);
  const auto file = ReadCameraFile(folder.Path("out/pinhole.yaml"));
  ASSERT_TRUE(file.ok());
  const cv::Mat depth = ReadPng(folder.Path("out/depth/000010.png"));
  const cv::Mat mask = ReadPng(folder.Path("out/masks/000010.png"));
  ASSERT_EQ(depth.type(), CV_16UC1);
  ASSERT_EQ(mask.type(), CV_8UC1);
  EXPECT_EQ(cv::countNonZero((depth == 0) & (mask != 255)), 0);
  int known = 0;
  for (int y = 0; y < depth.rows; y += 7)
    for (int x = 0; x < depth.cols; x += 7) {
      const Eigen::Vector2d pixel = *camera.Project(*file->camera.Unproject(Eigen::Vector2d(x, y)));
      const auto u = static_cast<int>(std::lround(pixel.x()));
      const auto v = static_cast<int>(std::lround(pixel.y()));
      if (depth.at<std::uint16_t>(y, x) == 0 || !camera.Contains(pixel, 1.0)) continue;
      ++known;  // a pixel's slope is 0.04, and the nearest pixel may be another by rounding
      EXPECT_NEAR(depth.at<std::uint16_t>(y, x) * *file->depth_scale, SurfaceDepthAt(u, v),
                  0.5 * *file->depth_scale + kSurfaceStep + 0.04);
    }
  EXPECT_GT(known, 4000);
  EXPECT_EQ(mask.at<std::uint8_t>(240, 5), 255);  // to the left of what the image shows
  EXPECT_NEAR(rows[0][15] * *file->depth_scale, 42.5, 2.0);
  EXPECT_NEAR(rows[0][16] * *file->depth_scale, 62.5, 2.0);
}

TEST(EndoNerfExport, PixelsWithoutADepthAreUsedOnRequest) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  WriteSurface(folder, TestCamera(), {10}, folder.Path("run"));
  ExportRequest request = WithSurface(folder);
  request.run_path = folder.Path("run");
  request.format = "endonerf";
  ExportOptions options;
  for (const Switch masked : {Switch::kOn, Switch::kOff}) {
    request.output_path = folder.Path(masked == Switch::kOn ? "masked" : "used");
    options.mask_unknown_depth = masked;
    ASSERT_TRUE(ExportRun(request, options).ok());
    const cv::Mat mask = ReadPng(request.output_path + "/masks/000010.png");
    EXPECT_EQ(cv::countNonZero(mask), masked == Switch::kOn ? 50 * 80 : 0);
  }
}

TEST(EndoNerfExport, MasksAreWhiteWhereTheSequencesAreBlack) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  const cv::Mat mask = WriteMask(folder);
  ExportRequest request;
  request.mask_path = folder.Path("mask.png");
  ASSERT_TRUE(ExportNeural(folder, "endonerf", request).ok());
  EXPECT_EQ(cv::countNonZero(ReadPng(folder.Path("out/masks/000018.png")) != 255 - mask), 0);
}

TEST(NeuralExport, DepthsThatWereFilledAreNone) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  WriteSurface(folder, TestCamera(), {10}, folder.Path("run"));
  const cv::Rect hole(300, 200, 20, 10);
  cv::Mat filled(480, 640, CV_8UC1, cv::Scalar(0));
  filled(hole).setTo(255);
  std::filesystem::create_directories(folder.Path("surface/filled"));
  ASSERT_TRUE(WritePng(folder.Path("surface/filled/10.png"), filled).ok());
  for (const std::string format : {"nerfstudio", "endonerf"}) {
    ExportRequest request = WithSurface(folder);
    request.run_path = folder.Path("run");
    request.format = format;
    request.output_path = folder.Path(format);
    const auto summary = ExportRun(request, {});
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    const cv::Mat depth = ReadPng(request.output_path + "/depth/000010.png");
    ASSERT_EQ(depth.size(), filled.size()) << format;
    EXPECT_EQ(cv::countNonZero(depth(hole)), 0) << format;
    EXPECT_GT(depth.at<std::uint16_t>(hole.y - 1, hole.x), 0) << format;
  }
}

TEST(NeuralExport, EverySubmapHasAFolder) {
  for (const auto& [format, file] :
       {std::pair("nerfstudio", "transforms.json"), std::pair("endonerf", "poses_bounds.npy")}) {
    const TestFolder folder;
    WriteNeuralRun(folder, TestCamera(), 2);
    const auto summary = ExportNeural(folder, format);
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    EXPECT_EQ(summary->frames, 2 * kRunFrames);
    for (const std::string submap : {"0", "1"}) {
      EXPECT_TRUE(std::filesystem::exists(folder.Path("out/" + submap + "/" + file)));
      EXPECT_FALSE(std::filesystem::exists(folder.Path("out/" + submap + "/.unfinished")));
    }
    EXPECT_TRUE(std::filesystem::exists(folder.Path("out/1/images/000020.png")));
  }
}

TEST(NeuralExport, DoesNotMixWithAnEarlierExport) {
  for (const std::string format : {"nerfstudio", "endonerf"}) {
    const TestFolder folder;
    WriteNeuralRun(folder, TestCamera());
    ASSERT_TRUE(ExportNeural(folder, format).ok());
    const Status again = ExportNeural(folder, format).status();
    EXPECT_EQ(again.code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(again.message(), HasSubstr("is there already; delete it or give another --output_path"));
  }
}

TEST(NeuralExport, SaysThatTheImagesAreMissingOrNotTheRuns) {
  for (const std::string format : {"nerfstudio", "endonerf"}) {
    const TestFolder folder;
    WriteNeuralRun(folder, TestCamera());
    std::filesystem::remove(folder.Path("sequence/images/0.png"));  // the numbers of all frames shift
    EXPECT_THAT(ExportError(folder, format, ErrorCode::kMismatch), HasSubstr("frame 10 of the run is image 10.png"));
    for (int i = 1; i < 15; ++i) std::filesystem::remove(folder.Path("sequence/images/" + std::to_string(i) + ".png"));
    EXPECT_THAT(ExportError(folder, format, ErrorCode::kMismatch), HasSubstr("the images end before frame 10"));
    std::filesystem::remove_all(folder.Path("sequence"));
    EXPECT_THAT(ExportError(folder, format, ErrorCode::kNotFound), HasSubstr("the images of the run are not at"));
  }
}

TEST(NeuralExport, SaysThatAnImageHasAnotherSize) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  const Camera small = Camera::Create("PINHOLE", 320, 240, std::vector<double>{250, 250, 160, 120}).value();
  WriteImages(folder, small, {}, 18);
  EXPECT_THAT(ExportError(folder, "endonerf", ErrorCode::kMismatch),
              HasSubstr("image 10.png has 320x240 pixels, and the run's camera has 640x480"));
}

TEST(NeuralExport, RefusesImagesWithAnotherCalibration) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  std::filesystem::rename(folder.Path("sequence"), folder.Path("moved"));
  ExportRequest request;
  request.sequence_path = folder.Path("moved");
  ASSERT_TRUE(
      WriteCameraFile(folder.Path("moved/camera.yaml"), {.camera = NeuralCamera("PINHOLE", {600, 600, 319.5, 239.5})})
          .ok());
  for (const char* format : {"nerfstudio", "tum"})
    EXPECT_THAT(ExportError(folder, format, ErrorCode::kMismatch, request),
                HasSubstr("is PINHOLE of 640x480 (600 600 319.5 239.5)"))
        << format;
  ASSERT_TRUE(WriteCameraFile(folder.Path("moved/camera.yaml"), {.camera = TestCamera()}).ok());
  EXPECT_TRUE(ExportNeural(folder, "nerfstudio", request).ok());
}

TEST(NeuralExport, RefusesASurfaceThatIsNotTheRuns) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  const ExportRequest request = WithSurface(folder);
  EXPECT_THAT(ExportError(folder, "nerfstudio", ErrorCode::kNotFound, request), HasSubstr("no surface.json"));

  std::filesystem::create_directories(folder.Path("other"));
  folder.Write("other/trajectory.txt", "another path\n");
  WriteSurface(folder, TestCamera(), {10}, folder.Path("other"));
  EXPECT_THAT(ExportError(folder, "nerfstudio", ErrorCode::kMismatch, request), HasSubstr("was made of the run"));

  WriteSurface(folder, TestCamera(), {10}, folder.Path("run"));
  std::string replaced = folder.Read("surface/surface.json");
  folder.Write("surface/surface.json", replaced.insert(1, "\"trajectory_crc32\": \"00000000\", "));
  EXPECT_THAT(ExportError(folder, "nerfstudio", ErrorCode::kMismatch, request), HasSubstr("which was replaced"));

  const Camera small = Camera::Create("PINHOLE", 320, 240, std::vector<double>{250, 250, 160, 120}).value();
  WriteSurface(folder, small, {10}, folder.Path("run"));
  EXPECT_THAT(ExportError(folder, "nerfstudio", ErrorCode::kMismatch, request),
              HasSubstr("has images of 320x240 pixels, and the run of 640x480"));

  WriteSurface(folder, NeuralCamera("PINHOLE", {480, 480, 319.5, 239.5}), {10}, folder.Path("run"));
  EXPECT_THAT(ExportError(folder, "nerfstudio", ErrorCode::kMismatch, request), HasSubstr("another camera"));

  WriteSurface(folder, TestCamera(), {11}, folder.Path("run"));
  EXPECT_THAT(ExportError(folder, "endonerf", ErrorCode::kInsufficient, request),
              HasSubstr("a depth of none of the frames"));

  WriteSurface(folder, TestCamera(), {10}, folder.Path("run"));
  std::filesystem::remove(folder.Path("surface/depth/10.png"));
  EXPECT_THAT(ExportError(folder, "endonerf", ErrorCode::kNotFound, request), HasSubstr("10.png"));
}

TEST(NeuralExport, ASurfaceOfARunThatWasCopiedIsTheRuns) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  for (const std::string of : {"copy", "moved_away"}) {
    if (of == "copy")
      std::filesystem::copy(folder.Path("run"), folder.Path(of), std::filesystem::copy_options::recursive);
    WriteSurface(folder, TestCamera(), {10}, folder.Path(of));
    std::filesystem::remove_all(folder.Path("out"));
    EXPECT_TRUE(ExportNeural(folder, "nerfstudio", WithSurface(folder)).ok()) << of;
  }
}

TEST(NeuralExport, OtherFormatsTakeNoSurfaceAndNoMasks) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  EXPECT_THAT(ExportError(folder, "ply", ErrorCode::kInvalidArgument, WithSurface(folder)),
              HasSubstr("--surface is for the formats nerfstudio and endonerf; the format ply has no images"));
  ExportRequest masked;
  masked.mask_path = folder.Path("mask.png");
  EXPECT_THAT(ExportError(folder, "tum", ErrorCode::kInvalidArgument, masked), HasSubstr("--mask_path is for"));
}

}  // namespace
}  // namespace pliant
