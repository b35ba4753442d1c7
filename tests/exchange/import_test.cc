// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/exchange/import.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "pliant/colmap/convert.h"
#include "pliant/colmap/model.h"
#include "pliant/exchange/export.h"
#include "pliant/io/camera_file.h"
#include "pliant/io/run_reader.h"
#include "pliant/io/trajectory.h"
#include "support/small_run.h"
#include "support/test_folder.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr double kFps = 1e-6;                // of times with six decimals
constexpr double kSingleDecimals_mm = 1e-3;  // meters with six decimals
constexpr int kImages = 20;                  // 0.png to 19.png at 25 frames/s; the run has 10, 12, ... 18

class ImportTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_.Path("images"));
    const cv::Mat image(TestCamera().height(), TestCamera().width(), CV_8UC1, cv::Scalar(90));
    for (int i = 0; i < kImages; ++i)
      ASSERT_TRUE(cv::imwrite(folder_.Path("images/" + std::to_string(i) + ".png"), image));
    CameraFile camera{TestCamera()};
    camera.fps = 25;
    ASSERT_TRUE(WriteCameraFile(folder_.Path("camera.yaml"), camera).ok());
  }

  // The run of small_run.h as COLMAP's model in `folder`/model.
  void WriteModel() {
    WriteRun(folder_);
    ExportRequest request{folder_.Path("run"), "", "canonical", folder_.Path("model")};
    ASSERT_TRUE(ExportRun(request, {}).ok());
  }
  // The same; the sequence has its images alone.
  void WriteModelOfEveryImage() {
    std::filesystem::remove_all(folder_.Path("images"));
    std::filesystem::create_directories(folder_.Path("images"));
    const cv::Mat image(TestCamera().height(), TestCamera().width(), CV_8UC1, cv::Scalar(90));
    for (int frame = 0; frame < kRunFrames; ++frame)
      ASSERT_TRUE(cv::imwrite(folder_.Path("images/" + Report(frame).name), image));
    WriteModel();
  }
  void ChangeModel(const std::function<void(colmap::Model*)>& change) {
    WriteModel();
    auto model = colmap::ReadModel(folder_.Path("model"));
    ASSERT_TRUE(model.ok());
    change(&*model);
    ASSERT_TRUE(colmap::WriteModel(folder_.Path("model"), *model, colmap::Format::kBinary).ok());
  }

  Result<ImportSummary> ImportModel(const ImportOptions& options = {}, ImportAs as = ImportAs::kRun) const {
    return ImportFrom("model", ImportFormat::kColmap, options, as);
  }
  Result<ImportSummary> ImportFrom(const std::string& input, ImportFormat format, const ImportOptions& options = {},
                                   ImportAs as = ImportAs::kRun) const {
    return Import({folder_.Path(input), folder_.Path(""), "", format, as, folder_.Path("out"), {"pliant"}}, options);
  }
  pliant::Run ReadOut() const {
    const auto run = ReadRun(folder_.Path("out"));
    EXPECT_TRUE(run.ok()) << run.status().message();
    return run.ok() ? *run : pliant::Run{};
  }

  TestFolder folder_;
};

TEST_F(ImportTest, AModelBecomesARunOfItsImagesFrames) {
  WriteModel();
  const auto summary = ImportModel();
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->frames, kRunFrames);
  EXPECT_EQ(summary->sequence_frames, kImages);
  EXPECT_EQ(summary->points, kRunPoints);
  EXPECT_TRUE(summary->notes.empty());
  const pliant::Run run = ReadOut();
  ASSERT_EQ(run.frames.size(), static_cast<std::size_t>(kImages));
  EXPECT_EQ(run.frames[0].state, TrackingState::kInitializing);
  EXPECT_EQ(run.frames[10].state, TrackingState::kTracking);
  EXPECT_EQ(run.frames[11].state, TrackingState::kLost);
  EXPECT_LT(run.frames[10].median_reprojection_error_px, kExactReprojection_px);
  EXPECT_DOUBLE_EQ(run.frames[10].timestamp_s, 0.4);
  ASSERT_EQ(run.poses.size(), static_cast<std::size_t>(kRunFrames));
  EXPECT_LT((run.poses[3].world_from_cam.translation - PoseAt(3).Inverse().translation).norm(), kFileLength_mm);

  auto reader = ObservationReader::Open(folder_.Path("out"));
  ASSERT_TRUE(reader.ok());
  auto rows = reader->Next();
  ASSERT_TRUE(rows.ok() && rows->has_value());
  EXPECT_EQ((*rows)->frame_idx, 10);
  ASSERT_EQ((*rows)->observations.size(), static_cast<std::size_t>(kRunPoints));
  for (int i = 0; i < kRunPoints; ++i) {  // ids are the model's; pixel (0, 0) is the first one's center again
    const PointObservation& observation = (*rows)->observations[static_cast<std::size_t>(i)];
    EXPECT_EQ(observation.id, PointId{3 * i});
    EXPECT_LT((observation.position - Undeformed(i)).norm(), 3 * kFileLength_mm);
    EXPECT_LT((observation.pixel - Report(0).observations[static_cast<std::size_t>(i)].pixel).norm(),
              2 * kFilePixel_px);
  }
}

TEST_F(ImportTest, StoppedOnRequestItWritesNothing) {
  WriteModel();
  const ImportRequest request{folder_.Path("model"), folder_.Path(""),    "",        ImportFormat::kColmap,
                              ImportAs::kRun,        folder_.Path("out"), {"pliant"}};
  for (const int stop_at : {1, 2}) {
    int times = 0;
    const auto summary =
        Import(request, {}, [&](std::string_view /*task*/, int /*done*/, int /*total*/) { return ++times < stop_at; });
    EXPECT_EQ(summary.status().code(), ErrorCode::kInterrupted) << stop_at;
    EXPECT_FALSE(std::filesystem::exists(folder_.Path("out"))) << stop_at;
    EXPECT_EQ(times, stop_at);
  }
}

TEST_F(ImportTest, WhatWasImportedIsExportedAsTheSameModel) {
  WriteModel();
  ASSERT_TRUE(ImportModel().ok());
  ExportRequest request{folder_.Path("out"), "", "canonical", folder_.Path("again")};
  ASSERT_TRUE(ExportRun(request, {}).ok());
  const auto first = colmap::ReadModel(folder_.Path("model"));
  const auto again = colmap::ReadModel(folder_.Path("again"));
  ASSERT_TRUE(first.ok() && again.ok());
  ASSERT_EQ(first->points3D.size(), again->points3D.size());
  for (std::size_t i = 0; i < first->points3D.size(); ++i) {
    EXPECT_EQ(first->points3D[i].id, again->points3D[i].id);
    EXPECT_EQ(first->points3D[i].rgb, again->points3D[i].rgb);
    EXPECT_EQ(first->points3D[i].track.size(), again->points3D[i].track.size());
  }
  ASSERT_EQ(first->images.size(), again->images.size());
  for (std::size_t i = 0; i < first->images.size(); ++i) EXPECT_EQ(first->images[i].name, again->images[i].name);
}

TEST_F(ImportTest, AUnitThatLeavesZerosIsRefused) {
  WriteModel();
  ImportOptions options;
  options.unit_mm = 1e-9;
  const auto imported = ImportModel(options);
  EXPECT_EQ(imported.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(imported.status().message(), testing::HasSubstr("give another --Import.unit_mm"));
}

TEST_F(ImportTest, TheUnitIsMultiplied) {
  WriteModel();
  ImportOptions options;
  options.unit_mm = 10;
  options.seconds = 42;
  ASSERT_TRUE(ImportModel(options).ok());
  const pliant::Run run = ReadOut();
  EXPECT_LT((run.poses[3].world_from_cam.translation - options.unit_mm * PoseAt(3).Inverse().translation).norm(),
            options.unit_mm * kFileLength_mm);
  EXPECT_LT(run.frames[10].median_reprojection_error_px, kExactReprojection_px);  // points with it
  ASSERT_TRUE(run.summary.has_value());
  EXPECT_EQ(run.summary->total_s, 42);
}

TEST_F(ImportTest, ImagesAreFoundByFileNameOrStemWhateverTheirFolder) {
  ChangeModel([](colmap::Model* model) {
    model->images[0].name = "left/10.png";
    model->images[1].name = "12.jpg";
    model->images[4].name = "portrait.png";
  });
  const auto summary = ImportModel();
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->frames, kRunFrames - 1);
  EXPECT_THAT(summary->notes, testing::ElementsAre("1 images of the model are not in the sequence"));
}

TEST_F(ImportTest, AKeypointThatSeesWhatAnotherOfItsImageSeesIsLeftOut) {
  ChangeModel([](colmap::Model* model) {
    colmap::Image& image = model->images[0];
    image.points2D.push_back({1, 2, 0});
    model->points3D[0].track.push_back({image.id, static_cast<std::uint32_t>(image.points2D.size() - 1)});
  });
  const auto summary = ImportModel();
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->notes.size(), 1U);
  EXPECT_EQ(summary->observations, kRunObservations);
}

TEST_F(ImportTest, ModelsThatAreNoRunOfThisSequenceAreRefusedInOneSentence) {
  const auto refused = [&](const std::function<void(colmap::Model*)>& change, ErrorCode code, const char* what) {
    std::filesystem::remove_all(folder_.Path("model"));
    ChangeModel(change);
    const Status status = ImportModel().status();
    EXPECT_EQ(status.code(), code) << what;
    EXPECT_THAT(status.message(), HasSubstr(what));
    EXPECT_FALSE(std::filesystem::exists(folder_.Path("out")));
  };
  refused([](auto* m) { m->cameras.push_back(m->cameras[0]), m->cameras[1].id = 2; }, ErrorCode::kInvalidArgument,
          "has 2 cameras");
  refused([](auto* m) { m->images[0].points2D[0].point3D_id = 77; }, ErrorCode::kUnreadable, "is damaged");
  refused([](auto* m) { m->images[1].name = "a/10.png"; }, ErrorCode::kMismatch, "are both frame 10");
  refused([](auto* m) { m->cameras[0].model_id = 7, m->cameras[0].params.resize(5); }, ErrorCode::kInvalidArgument,
          "is not one of Pliant's");
  refused(
      [](auto* m) {
        for (auto& image : m->images) image.name = "x" + image.name;
      },
      ErrorCode::kMismatch, "no image of the model");
  EXPECT_EQ(ImportFrom("nowhere", ImportFormat::kColmap).status().code(), ErrorCode::kNotFound);
}

TEST_F(ImportTest, AModelWithACameraAnImageIsRefusedWithWhatToDo) {
  ChangeModel([](auto* m) { m->cameras.push_back(m->cameras[0]), m->cameras[1].id = 2; });
  std::filesystem::remove(folder_.Path("camera.yaml"));
  EXPECT_THAT(ImportModel().status().message(), HasSubstr("--ImageReader.single_camera 1"));
}

TEST_F(ImportTest, ImagesWithoutACalibrationTakeTheModels) {
  WriteModel();
  std::filesystem::remove(folder_.Path("camera.yaml"));
  EXPECT_TRUE(ImportModel().ok());
}

TEST_F(ImportTest, AModelOfEveryImageIsTheSequencesTruth) {
  WriteModelOfEveryImage();
  const auto summary = ImportModel({}, ImportAs::kTruth);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  const auto poses = ReadTumTrajectory(folder_.Path("out/groundtruth.txt"));
  ASSERT_TRUE(poses.ok());
  ASSERT_EQ(poses->size(), static_cast<std::size_t>(kRunFrames));
  EXPECT_LT(((*poses)[4].world_from_cam.translation - PoseAt(4).Inverse().translation).norm(), kFileLength_mm);
  const auto camera = ReadCameraFile(folder_.Path("out/camera.yaml"));
  ASSERT_TRUE(camera.ok());
  EXPECT_NEAR(camera->camera.params()[2], 319.5, kLengthRoundOff_mm);
  EXPECT_NEAR(*camera->fps, 25, kFps);

  const Status again = ImportModel({}, ImportAs::kTruth).status();
  EXPECT_EQ(again.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(again.message(), HasSubstr("already"));
}

TEST_F(ImportTest, ATruthHasTheUnitOfTheCalibrationBesideIt) {
  WriteModelOfEveryImage();
  std::filesystem::create_directories(folder_.Path("out"));
  folder_.Write("out/camera.yaml",
                "model: PINHOLE\nwidth: 640\nheight: 480\nparams: [500, 500, 319.5, 239.5]\nunit: m\n");
  ASSERT_TRUE(ImportModel({}, ImportAs::kTruth).ok());
  const auto poses = ReadTumTrajectory(folder_.Path("out/groundtruth.txt"));
  ASSERT_TRUE(poses.ok());
  EXPECT_LT((1000 * (*poses)[4].world_from_cam.translation - PoseAt(4).Inverse().translation).norm(),
            1000 * kFileLength_mm);
}

TEST_F(ImportTest, ATruthNeedsAPoseForEveryImage) {
  WriteModel();
  const Status status = ImportModel({}, ImportAs::kTruth).status();
  EXPECT_EQ(status.code(), ErrorCode::kInsufficient);
  EXPECT_THAT(status.message(), HasSubstr("frame 0 (0.png) has no pose"));
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("out")));
}

TEST_F(ImportTest, CameraPathsOfOtherSystemsComeToTheirFrames) {
  folder_.Write("tum.txt", "# a comment\n0.0404 1 2 3 0 0 0 1\n0.118 4 5 6 0 0 0 1\n9 0 0 0 0 0 0 1\n");
  folder_.Write("euroc.csv", "#timestamp [ns], p, q\n40400000, 1, 2, 3, 1, 0, 0, 0, 9\n118000000,4,5,6,1,0,0,0,9\n");
  std::string kitti = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  for (int i = 1; i < kImages; ++i) kitti += "0 -1 0 1 1 0 0 2 0 0 1 3\n";
  folder_.Write("kitti.txt", kitti);
  ImportOptions none;
  none.unit_mm = 1e-9;
  EXPECT_EQ(ImportFrom("tum.txt", ImportFormat::kTum, none).status().code(), ErrorCode::kMismatch);
  ImportOptions meters;
  meters.unit_mm = 1000;
  for (const auto& [file, format, frame] :
       {std::tuple{"tum.txt", ImportFormat::kTum, 1}, std::tuple{"euroc.csv", ImportFormat::kEuroc, 1},
        std::tuple{"kitti.txt", ImportFormat::kKitti, 1}}) {
    std::filesystem::remove_all(folder_.Path("out"));
    const auto summary = ImportFrom(file, format, meters);
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    EXPECT_EQ(summary->frames, format == ImportFormat::kKitti ? kImages : 2) << file;
    EXPECT_EQ(summary->points, 0);
    EXPECT_EQ(summary->notes.size(), format == ImportFormat::kTum ? 1U : 0U);
    const pliant::Run run = ReadOut();
    EXPECT_EQ(run.frames[1].state, TrackingState::kTracking);
    const auto pose =
        std::find_if(run.poses.begin(), run.poses.end(), [f = frame](const RunPose& p) { return p.frame_idx == f; });
    ASSERT_NE(pose, run.poses.end());
    EXPECT_LT((pose->world_from_cam.translation - Eigen::Vector3d(1000, 2000, 3000)).norm(), kSingleDecimals_mm)
        << file;
  }
  EXPECT_EQ(ReadOut().poses[1].world_from_cam.rotation.angularDistance(
                Eigen::Quaterniond(Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitZ()))) < 1e-6,
            true);
}

TEST_F(ImportTest, TimesInOtherUnitsThanSecondsAreRecognizedAndSaid) {
  folder_.Write("orbslam3.txt", "40400000.000000 1 2 3 0 0 0 1\n118000000.000000 4 5 6 0 0 0 1\n");
  folder_.Write("milliseconds.txt", "40.4 1 2 3 0 0 0 1\n118 4 5 6 0 0 0 1\n");
  for (const char* unit : {"nanoseconds", "milliseconds"}) {
    std::filesystem::remove_all(folder_.Path("out"));
    const std::string file = unit == std::string("nanoseconds") ? "orbslam3.txt" : "milliseconds.txt";
    const auto summary = ImportFrom(file, ImportFormat::kTum);
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    EXPECT_EQ(summary->frames, 2) << file;
    ASSERT_EQ(summary->notes.size(), 1U);
    EXPECT_THAT(summary->notes.front(), HasSubstr(unit));
  }
}

TEST_F(ImportTest, OnePoseOfSeveralThatIsNearAFrameIsThereByChance) {
  folder_.Write("path", "0 1 2 3 0 0 0 1\n5e20 4 5 6 0 0 0 1\n6e20 4 5 6 0 0 0 1\n");
  const Status status = ImportFrom("path", ImportFormat::kTum).status();
  EXPECT_EQ(status.code(), ErrorCode::kMismatch);
  EXPECT_THAT(status.message(), HasSubstr("only 1 of the 3 poses of"));
  EXPECT_THAT(status.message(), HasSubstr("sequence's clock"));
}

TEST_F(ImportTest, ACameraPathAtAnotherRateThanTheFramesIsRefused) {
  std::string path;
  for (int i = 0; i < kImages; ++i) path += std::to_string(i / 30.0) + " 1 2 3 0 0 0 1\n";
  folder_.Write("path", path);
  const Status status = ImportFrom("path", ImportFormat::kTum).status();
  EXPECT_EQ(status.code(), ErrorCode::kMismatch);
  EXPECT_THAT(status.message(), HasSubstr(" come 30.00 times a second and the frames 25.00 times"));
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("out")));
}

TEST_F(ImportTest, TimesOfAnotherClockAreRefusedWithTheirUnit) {
  folder_.Write("euroc.txt",
                "1403636579763555584 1 2 3 0 0 0 1\n1403636579813555456 4 5 6 0 0 0 1\n"
                "1403636579863555584 4 5 6 0 0 0 1\n");
  const Status status = ImportFrom("euroc.txt", ImportFormat::kTum).status();
  EXPECT_EQ(status.code(), ErrorCode::kMismatch);
  EXPECT_THAT(status.message(), HasSubstr(" s, as nanoseconds would, the sequence's from"));
}

TEST_F(ImportTest, DamagedCameraPathsAreNamedByLine) {
  const std::vector<std::tuple<const char*, ImportFormat, const char*>> cases = {
      {"1 0 0 0 0 1 0 0 0 0 1\n", ImportFormat::kKitti, "12 numbers"},
      {"1 0 0 0 0 1 0 0 0 0 2 0\n", ImportFormat::kKitti, "not a rotation"},
      {"1 0 0 0 0 1 0 0 0 0 -1 0\n", ImportFormat::kKitti, "not a rotation"},
      {"1 0 0 0 0 1 nan 0 0 0 1 0\n", ImportFormat::kKitti, "'nan'"},
      {"40400000,1,2,3,1,0,0\n", ImportFormat::kEuroc, "8 numbers"},
      {"0.0404,1,2,3,1,0,0,0\n", ImportFormat::kEuroc, "times of EuRoC are nanoseconds"},
      {"40400000,1,2,3,1,1,0,0\n", ImportFormat::kEuroc, "length"},
      {"40400000,1,2 2,3,1,0,0,0\n", ImportFormat::kEuroc, "not a finite number"},
      {"0.04 1 2 3 0 0 0\n", ImportFormat::kTum, "8 numbers"},
  };
  for (const auto& [text, format, what] : cases) {
    folder_.Write("path", text);
    const Status status = ImportFrom("path", format).status();
    EXPECT_EQ(status.code(), ErrorCode::kUnreadable) << text;
    EXPECT_THAT(status.message(), HasSubstr(what));
    EXPECT_THAT(status.message(), HasSubstr("path:1:"));
  }
  folder_.Write("path", "");
  EXPECT_EQ(ImportFrom("path", ImportFormat::kTum).status().code(), ErrorCode::kInsufficient);
}

TEST_F(ImportTest, ACameraPathWithoutTimesHasALineForEveryFrame) {
  for (const int poses : {kImages - 1, kImages + 1}) {
    std::string path;
    for (int i = 0; i < poses; ++i) path += "1 0 0 0 0 1 0 0 0 0 1 0\n";
    folder_.Write("path", path);
    const Status status = ImportFrom("path", ImportFormat::kKitti).status();
    EXPECT_EQ(status.code(), ErrorCode::kMismatch);
    EXPECT_THAT(status.message(), HasSubstr("has " + std::to_string(poses) + " poses, a line a frame"));
    EXPECT_THAT(status.message(), HasSubstr("give a camera path with times (--format tum)"));
  }
}

TEST_F(ImportTest, AnotherSystemsResultBecomesARunThatIsExported) {
  std::filesystem::create_directories(folder_.Path("result"));
  folder_.Write("result/trajectory.txt", "0.04 0 0 0 0 0 0 1\n0.08 1 0 0 0 0 0 1\n");
  folder_.Write(
      "result/observations.csv",
      "frame,point_id,u_px,v_px,x,y,z\n1,5,319.5,239.5,0,0,50\n1,7,329.5,239.5,1,0,50\n2,5,309.5,239.5,0,0,50\n");
  ExportRequest request{folder_.Path("result"), folder_.Path(""), "canonical", folder_.Path("model")};
  const Status status = ExportRun(request, {}).status();
  EXPECT_EQ(status.code(), ErrorCode::kMismatch);
  EXPECT_THAT(status.message(), HasSubstr("pliant import"));

  const auto summary = ImportFrom("result", ImportFormat::kResult);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->points, 2);
  EXPECT_EQ(summary->observations, 3);
  request.run_path = folder_.Path("out");
  const auto exported = ExportRun(request, {});
  ASSERT_TRUE(exported.ok()) << exported.status().message();
  EXPECT_EQ(exported->points, 2);
}

TEST_F(ImportTest, TheUnitIsThatOfStandardDeviationsToo) {
  std::filesystem::create_directories(folder_.Path("result"));
  folder_.Write("result/trajectory.txt", "0.04 0 0 0 0 0 0 1\n0.08 1 0 0 0 0 0 1\n");
  folder_.Write("result/observations.csv",
                "frame,point_id,u_px,v_px,x,y,z,ssim,sigma_mm\n1,5,319.5,239.5,0,0,5,0.9,0.2\n"
                "2,5,309.5,239.5,0,0,5,0.9,0.2\n");
  ImportOptions options;
  options.unit_mm = 10;
  ASSERT_TRUE(ImportFrom("result", ImportFormat::kResult, options).ok());
  auto reader = ObservationReader::Open(folder_.Path("out"));
  ASSERT_TRUE(reader.ok());
  const auto seen = reader->Of(1);
  ASSERT_TRUE(seen.ok());
  ASSERT_EQ(seen->size(), 1U);
  EXPECT_NEAR(seen->front().position.z(), 50, kFileLength_mm);
  EXPECT_NEAR(seen->front().sigma, 2, kFileLength_mm);
}

}  // namespace
}  // namespace pliant
