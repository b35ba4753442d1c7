// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What data sets say of cameras, and what is wrong with some.
#include <filesystem>
#include <string>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "datasets/data_set_files.h"

namespace pliant {
namespace {

using namespace data_set_files;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kPublished_px = 1e-3;  // focal lengths as they are published

TEST_F(DataSets, BrokenCalibrationsAreRefused) {
  const auto refused = [&](const char* folder, const std::string& what) {
    const auto sequence = OpenSequence({.image_path = Path(folder)});
    ASSERT_FALSE(sequence.ok()) << what;
    EXPECT_THAT(sequence.status().message(), HasSubstr(what));
  };
  std::filesystem::create_directories(Path("Seq_001"));
  cv::VideoWriter writer(Path("Seq_001/Seq_001.mov").string(), cv::CAP_FFMPEG,
                         cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 30, {kWidth, kHeight});
  writer.write(Image(0));
  writer.release();
  const auto calibu = [&](const std::string& type, const std::string& width) {
    Text("Seq_001/a_geometrical.xml", "<rig><camera><camera_model type=\"" + type + "\"><width> " + width +
                                          " </width><height> 48 </height><params> [ 60; 60; 31.5; 23.5 ] </params>"
                                          "</camera_model></camera></rig>");
  };
  Text("Seq_001/a_geometrical.xml", "<rig><camera>");
  refused("Seq_001", "is no XML");
  calibu("calibu_fu_fv_u0_v0", "1e300");
  refused("Seq_001", "no width and height");
  calibu("calibu_fu_fv_u0_v0_w", "64");
  refused("Seq_001", "'calibu_fu_fv_u0_v0_w', which is not known");
  calibu("calibu_fu_fv_u0_v0", "64");
  Text("Seq_001/a_photometrical.xml",
       "<rig><camera><camera_model><gamma> [ -1 ] </gamma></camera_model></camera></rig>");
  refused("Seq_001", "gamma must be");

  Text("mav0/cam0/data.csv", "#\n1,1.png\n");
  Write("mav0/cam0/data/1.png", Image(0));
  const auto euroc = [&](const std::string& model, const std::string& size) {
    Text("mav0/cam0/sensor.yaml", "T_BS:\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nresolution: " +
                                      size + "\nintrinsics: [60, 60, 32, 24]\ndistortion_model: " + model +
                                      "\ndistortion_coefficients: [0, 0, 0, 0]\n");
  };
  euroc("fov", "[64, 48]");
  refused(".", "the distortion_model 'fov', which is not known");
  euroc("radtan", "[1e300, 48]");
  refused(".", "is not EuRoC's description of a camera");
}

TEST_F(DataSets, APoseThatIsNotTransposedIsRefused) {
  Write("c3vd/0_color.png", Image(0));
  WriteCamera("c3vd/camera.yaml");
  Text("c3vd/pose.txt", "1,0,0,5,0,1,0,6,0,0,1,7,0,0,0,1\n");
  const auto sequence = OpenSequence({.image_path = Path("c3vd")});
  ASSERT_FALSE(sequence.ok());
  EXPECT_THAT(sequence.status().message(), HasSubstr("last row is not 0 0 0 1"));
}

TEST_F(DataSets, FramesMissingInTheMiddleAreSaid) {
  for (int k = 0; k < 10; ++k)
    if (k != 4 && k != 5) Write("seq/" + Numbered("FrameBuffer_%04d.png", k), Image(k));
  for (int k = 0; k < 9; ++k)
    Write("seq/" + Numbered("Depth_%04d.png", k), cv::Mat(kHeight, kWidth, CV_16U, cv::Scalar(100)));
  WriteCamera("seq/camera.yaml");
  const auto sequence = OpenSequence({.image_path = Path("seq")});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  EXPECT_EQ((*sequence)->size(), 8);
  EXPECT_THAT((*sequence)->Warnings(),
              ElementsAre(HasSubstr("2 images are missing, the first is number 4"),
                          HasSubstr("1 of 8 images have no depth image, the first is FrameBuffer_0009.png")));
}

TEST_F(DataSets, ImagesWithoutACalibrationGetThePublishedCamera) {
  Write("simcol/FrameBuffer_0000.png", Image(0, 475, 475));
  Write("c3vd/0_color.png", Image(0, 1350, 1080));
  Write("c3vd_pinhole/0_color.png", Image(0, 675, 540));
  Write("endomapper/rgb/image_0000.png", Image(0, 960, 720));
  Write("endoslam/Frames/image_0000.png", Image(0, 320, 320));
  std::filesystem::create_directories(Path("endoslam/Pixelwise Depths"));
  for (const auto& [folder, model, focal] :
       {std::tuple("simcol", "PINHOLE", 227.604), std::tuple("c3vd", "OPENCV_FISHEYE", 767.386),
        std::tuple("c3vd_pinhole", "PINHOLE", 401.16), std::tuple("endomapper", "PINHOLE", 472.6496),
        std::tuple("endoslam", "PINHOLE", 156.0418)}) {
    const auto sequence = OpenSequence({.image_path = Path(folder)});
    ASSERT_TRUE(sequence.ok()) << sequence.status().message();
    EXPECT_EQ((*sequence)->camera().model_name(), model);
    EXPECT_NEAR((*sequence)->camera().params()[0], focal, kPublished_px);
  }
  Write("wrong/FrameBuffer_0000.png", Image(0, 640, 480));
  const auto wrong = OpenSequence({.image_path = Path("wrong")});
  ASSERT_FALSE(wrong.ok());
  EXPECT_EQ(wrong.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(wrong.status().message(), HasSubstr("published with SimCol3D is for images of 475x475"));
}

TEST_F(DataSets, WhatIsGarbledIsNamed) {
  for (int k = 0; k < 2; ++k) {
    Write("c3vd/" + std::to_string(k) + "_color.png", Image(k));
    Write("mav/cam0/data/" + std::to_string(k) + ".png", Image(k));
    Write("tum/rgb/" + std::to_string(k) + ".png", Image(k));
  }
  WriteCamera("c3vd/camera.yaml");
  WriteCamera("tum/camera.yaml");
  Text("c3vd/pose.txt", "1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1\n1,0,0,0,0,1,0,0,0,0\n");
  Text("mav/cam0/data.csv", "#timestamp [ns],filename\n0,0.png\nx,1.png\n");
  Text("tum/rgb.txt", "0.0 rgb/0.png\n0.1\n");
  Write("scared/data/x.png", Image(0));
  Text("scared/data/rgb.mp4", "no video");
  Text("scared/endoscope_calibration.yaml", "M1: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n");
  for (const auto& [folder, said] :
       {std::pair("c3vd", "pose.txt:2: a line needs 16 numbers"),
        std::pair("mav", "data.csv:3: a line has a time in ns"),
        std::pair("tum", "rgb.txt:2: a line has a time and a file"), std::pair("scared", "rgb.mp4 as a video")}) {
    const auto sequence = OpenSequence({.image_path = Path(folder)});
    ASSERT_FALSE(sequence.ok()) << folder;
    EXPECT_EQ(sequence.status().code(), ErrorCode::kUnreadable) << sequence.status().message();
    EXPECT_THAT(sequence.status().message(), HasSubstr(said));
  }
  Text("c3vd/pose.txt", "2,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1\n1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1\n");
  const auto scaled = OpenSequence({.image_path = Path("c3vd")});
  ASSERT_FALSE(scaled.ok());
  EXPECT_THAT(scaled.status().message(), HasSubstr("the matrix is not a pose"));
}

}  // namespace
}  // namespace pliant
