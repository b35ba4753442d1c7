// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/dense_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "pliant/datasets/png_file.h"
#include "pliant/evaluation/report.h"
#include "pliant/io/camera_file.h"
#include "pliant/io/ply.h"
#include "support/rendered_sequence.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

constexpr double kDenseDepthScale = 0.005;

class DenseErrorTest : public testing::Test {
 protected:
  // A surface of frames 2 and 5: the true depth, changed. Sigma is 2 %, in the left half 1 %.
  SurfaceFolder WriteSurface(const std::function<void(cv::Mat*)>& change) {
    for (const char* kind : {"depth", "confidence"}) std::filesystem::create_directories(folder_.Path(kind));
    EXPECT_TRUE(
        WriteCameraFile(folder_.Path("camera.yaml"), {.camera = Rendered().camera, .depth_scale = kDenseDepthScale})
            .ok());
    std::string frames;
    for (const int k : {2, 5}) {
      cv::Mat depth = Rendered().frames[static_cast<std::size_t>(k)].depth.clone();
      cv::Mat sigma(depth.size(), CV_32F, cv::Scalar(0.02));
      sigma(cv::Rect(0, 0, depth.cols / 2, depth.rows)).setTo(0.01);
      change(&depth);
      const std::string name = std::to_string(k) + ".png";
      EXPECT_TRUE(WritePng(folder_.Path("depth/" + name), QuantizeDepth(depth, kDenseDepthScale)).ok());
      EXPECT_TRUE(WritePng(folder_.Path("confidence/" + name), QuantizeDepth(sigma, surface::kConfidenceUnit)).ok());
      frames += (frames.empty() ? "" : ", ") + std::string("{\"frame\": ") + std::to_string(k) + ", \"name\": \"" +
                name + "\", \"note\": \"\"}";
    }
    folder_.Write("surface.json", "{\"status\": \"completed\", \"frames\": [" + frames + "]}");
    auto read = ReadSurfaceFolder(folder_.Path("."));
    EXPECT_TRUE(read.ok()) << read.status().message();
    return *std::move(read);
  }

  TestFolder folder_;
  RenderedSequence sequence_;
};

TEST_F(DenseErrorTest, TheTruthInAnotherUnitHasNone) {
  const SurfaceFolder surface = WriteSurface([](cv::Mat* depth) { *depth *= 0.8; });
  const auto error = ComputeDenseError(surface, {}, sequence_, ErrorScale::kPerFrame);
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_EQ(error->frames, 2);
  EXPECT_GT(error->known_share, 0.99);
  EXPECT_LT(error->estimate.abs_rel, 1e-3);
  EXPECT_LT(error->estimate.rmse_mm, 0.02);
  EXPECT_EQ(error->estimate.below[0], 1.0);
  EXPECT_EQ(error->within_1_sigma, 1.0);
  EXPECT_GT(error->null.abs_rel, 0.02);
}

TEST_F(DenseErrorTest, WithoutAScaleTheUnitCounts) {
  const SurfaceFolder surface = WriteSurface([](cv::Mat* depth) { *depth *= 0.75; });
  const auto error = ComputeDenseError(surface, {}, sequence_, ErrorScale::kNone);
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->estimate.abs_rel, 0.25, 1e-3);
  EXPECT_NEAR(error->estimate.rmse_log, -std::log(0.75), 1e-3);
  EXPECT_EQ(error->estimate.below[0], 0.0);
  EXPECT_EQ(error->within_2_sigma, 0.0);
}

TEST_F(DenseErrorTest, SharesAreAtMostOne) {
  constexpr std::size_t kFrames = 9;  // 1 / 9, added 9 times, is more than 1 in floating point
  SurfaceFolder surface = WriteSurface([](cv::Mat*) {});
  const SurfaceFolder::Frame frame = surface.frames[0];
  surface.frames.assign(kFrames, frame);
  const auto error = ComputeDenseError(surface, {}, sequence_, ErrorScale::kPerFrame);
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_EQ(error->frames, static_cast<int>(kFrames));
  EXPECT_EQ(error->estimate.below[0], 1.0);
  EXPECT_EQ(error->estimate.within_mm[2], 1.0);
  EXPECT_EQ(error->within_2_sigma, 1.0);
  EXPECT_LE(error->known_share, 1.0);
  EXPECT_LE(error->complete_mm[2], 1.0);
}

TEST_F(DenseErrorTest, TheTableNamesItsScale) {
  const SurfaceFolder surface = WriteSurface([](cv::Mat*) {});
  for (const ErrorScale scale : {ErrorScale::kPerFrame, ErrorScale::kGlobal, ErrorScale::kNone}) {
    Evaluation evaluation;
    evaluation.dense = *ComputeDenseError(surface, {}, sequence_, scale);
    const std::string name(EnumName(scale));
    EXPECT_THAT(EvaluationTable(evaluation), testing::HasSubstr("dense depth (scale " + name + "; 2 frames"));
    const auto json = nlohmann::json::parse(EvaluationJson(evaluation));
    EXPECT_EQ(json.at("dense").at("scale"), name);
  }
}

TEST_F(DenseErrorTest, WhatWasNotMeasuredIsNull) {
  Evaluation evaluation;
  evaluation.dense = *ComputeDenseError(WriteSurface([](cv::Mat*) {}), {}, sequence_, ErrorScale::kPerFrame);
  const auto dense = nlohmann::json::parse(EvaluationJson(evaluation)).at("dense");
  for (const char* name : {"filled", "mesh", "mesh_alone", "mesh_alone_share", "interpolation"})
    EXPECT_TRUE(dense.at(name).is_null()) << name;
  for (const char* name : {"filled_share", "mesh_vertices"}) EXPECT_EQ(dense.at(name), 0.0) << name;
  for (const char* name : {"filled holes", "mesh", "interpolated"})
    EXPECT_THAT(EvaluationTable(evaluation), testing::Not(testing::HasSubstr(name)));
}

TEST_F(DenseErrorTest, TheMeshIsComparedWhereTheFrameHasADepthAndElsewhere) {
  const SurfaceFolder surface =
      WriteSurface([](cv::Mat* depth) { (*depth)(cv::Rect(0, 0, depth->cols / 4, depth->rows)).setTo(0.0F); });
  EXPECT_EQ(ComputeDenseError(surface, {}, sequence_, ErrorScale::kPerFrame)->mesh_vertices, 0);
  std::filesystem::create_directories(folder_.Path("mesh"));
  for (const int k : {2, 5}) {
    std::vector<NewPoint> vertices;
    std::vector<double> sigmas;
    const cv::Mat& depth = Rendered().frames[static_cast<std::size_t>(k)].depth;
    for (int x = 0; x < depth.cols; x += 8) {
      const Eigen::Vector3d ray = *Rendered().camera.Unproject({x, 40});
      const double wrong = x < depth.cols / 4 ? 1.1 : 1.02;
      vertices.push_back({PointId{x}, wrong * depth.at<float>(40, x) / ray.z() * ray});
      // Errors of 0.02 / 1.02 and 0.1 / 1.1 of the distance are 0.65 and 1.5 sigma.
      sigmas.push_back((x < depth.cols / 4 ? 0.06 : 0.03) * vertices.back().position.norm());
    }
    ASSERT_TRUE(WritePly(folder_.Path("mesh/" + std::to_string(k) + ".ply"), vertices, sigmas).ok());
  }
  const auto error = ComputeDenseError(surface, {}, sequence_, ErrorScale::kPerFrame);
  ASSERT_TRUE(error.ok()) << error.status().message();
  ASSERT_TRUE(error->mesh && error->mesh_alone);
  EXPECT_NEAR(error->mesh->depth.abs_rel, 0.02, 1e-3);
  EXPECT_NEAR(error->mesh_alone->depth.abs_rel, 0.1, 1e-3);
  ASSERT_TRUE(error->mesh->within_sigma && error->mesh_alone->within_sigma);
  EXPECT_NEAR((*error->mesh->within_sigma)[0], 1.0, 1e-9);
  EXPECT_EQ((*error->mesh_alone->within_sigma)[0], 0.0);
  EXPECT_NEAR((*error->mesh_alone->within_sigma)[1], 1.0, 1e-9);
  EXPECT_NEAR(error->mesh_alone_share.value(), 0.25, 0.02);
  EXPECT_NEAR(error->mesh_vertices, Rendered().camera.width() / 8.0, 1);
}

TEST_F(DenseErrorTest, WhatWasFilledIsApart) {
  const auto strip = [](const cv::Mat& image) { return cv::Rect(0, 0, image.cols / 8, image.rows); };
  const SurfaceFolder surface = WriteSurface([&](cv::Mat* depth) { (*depth)(strip(*depth)) *= 1.1; });
  EXPECT_EQ(ComputeDenseError(surface, {}, sequence_, ErrorScale::kPerFrame)->filled_share, 0.0);
  std::filesystem::create_directories(folder_.Path("filled"));
  for (const char* name : {"filled/2.png", "filled/5.png"}) {
    cv::Mat filled(Rendered().camera.height(), Rendered().camera.width(), CV_8U, cv::Scalar(0));
    filled(strip(filled)).setTo(255);
    ASSERT_TRUE(WritePng(folder_.Path(name), filled).ok());
  }
  const auto error = ComputeDenseError(surface, {}, sequence_, ErrorScale::kPerFrame);
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_LT(error->estimate.abs_rel, 1e-3);
  EXPECT_NEAR(error->known_share, 7.0 / 8, 0.02);
  ASSERT_TRUE(error->filled.has_value());
  EXPECT_NEAR(error->filled->abs_rel, 0.1, 1e-3);
  EXPECT_NEAR(error->filled_share, 1.0 / 8, 0.02);
}

TEST_F(DenseErrorTest, HolesAndTheUncertainHalfAreTold) {
  const SurfaceFolder surface = WriteSurface([](cv::Mat* depth) {
    (*depth)(cv::Rect(0, 0, depth->cols, depth->rows / 4)).setTo(0.0F);
    (*depth)(cv::Rect(depth->cols * 3 / 4, 0, depth->cols / 4, depth->rows)) *= 1.1;  // of the less certain half
  });
  const auto error = ComputeDenseError(surface, {}, sequence_, ErrorScale::kPerFrame);
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->known_share, 0.75, 0.02);
  EXPECT_LT(error->certain_half.abs_rel, 1e-3);
  EXPECT_NEAR(error->estimate.abs_rel, 0.1 / 4, 0.003);
  EXPECT_NEAR(error->within_2_sigma, 0.75, 0.03);
  EXPECT_LT(error->complete_mm[1], 0.6);
}

TEST_F(DenseErrorTest, FramesWithoutADepthAreNotKnown) {
  SurfaceFolder surface = WriteSurface([](cv::Mat*) {});
  cv::Mat nothing(Rendered().camera.height(), Rendered().camera.width(), CV_32F, cv::Scalar(0));
  ASSERT_TRUE(WritePng(folder_.Path("depth/5.png"), QuantizeDepth(nothing, kDenseDepthScale)).ok());
  const auto half = ComputeDenseError(surface, {}, sequence_, ErrorScale::kPerFrame);
  ASSERT_TRUE(half.ok()) << half.status().message();
  EXPECT_EQ(half->frames, 1);
  EXPECT_EQ(half->frames_without_depth, 1);
  EXPECT_NEAR(half->known_share, 0.5, 0.01);
  EXPECT_NEAR(half->complete_mm[2], 0.5, 0.01);
  EXPECT_LT(half->estimate.abs_rel, 1e-3) << "errors are of the pixels that have a depth";

  const std::string failed = "{\"frame\": 3, \"name\": \"3.png\", \"note\": \"it was not tracked\"}";
  folder_.Write("surface.json",
                "{\"status\": \"completed\", \"frames\": [{\"frame\": 2, \"name\": \"2.png\", "
                "\"note\": \"\"}, " +
                    failed + "]}");
  surface = *ReadSurfaceFolder(folder_.Path("."));
  ASSERT_EQ(surface.frames_without_depth.size(), 1U);
  EXPECT_EQ(surface.frames_without_depth[0].frame_idx, 3);
  EXPECT_NEAR(ComputeDenseError(surface, {}, sequence_, ErrorScale::kPerFrame)->known_share, 0.5, 0.01);
}

TEST_F(DenseErrorTest, NeedsFramesAndFilesThatFit) {
  SurfaceFolder surface = WriteSurface([](cv::Mat*) {});
  SurfaceFolder none = surface;
  none.frames.clear();
  EXPECT_EQ(ComputeDenseError(none, {}, sequence_, ErrorScale::kPerFrame).status().code(), ErrorCode::kInsufficient);
  EXPECT_TRUE(WritePng(folder_.Path("depth/2.png"), cv::Mat(20, 20, CV_16U, cv::Scalar(900))).ok());
  EXPECT_EQ(ComputeDenseError(surface, {}, sequence_, ErrorScale::kPerFrame).status().code(), ErrorCode::kMismatch);
  EXPECT_EQ(ReadSurfaceFolder(folder_.Path("depth")).status().code(), ErrorCode::kNotFound);
  folder_.Write("surface.json", "{\"status\": \"interrupted\"}");
  EXPECT_THAT(ReadSurfaceFolder(folder_.Path(".")).status().message(), testing::HasSubstr("never finished"));
}

}  // namespace
}  // namespace pliant
