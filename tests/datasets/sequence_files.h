// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Sequences on disk for the readers' tests: a folder of one test alone, images whose content names their frame.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

namespace pliant {

inline constexpr int kWidth = 64;
inline constexpr int kHeight = 48;

class SequenceFiles : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    root_ = std::filesystem::temp_directory_path() /
            (std::string("pliant_") + info->test_suite_name() + "_" + info->name());
    std::filesystem::remove_all(root_);
    std::filesystem::create_directories(root_);
    ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 1);  // damaged videos are meant here: FFmpeg need not say so
  }
  void TearDown() override { std::filesystem::remove_all(root_); }

  static std::string Name(int idx, const char* extension = ".png") {
    char name[32];
    std::snprintf(name, sizeof name, "%06d%s", idx, extension);
    return name;
  }
  // Every frame has its own brightness: 10 * (idx + 1).
  static double Brightness(int idx) { return 10.0 * (idx + 1); }
  static cv::Mat Image(int idx, int width = kWidth, int height = kHeight) {
    return cv::Mat(height, width, CV_8UC3, cv::Scalar::all(Brightness(idx)));
  }
  // An image that no codec makes small, so that half of its file is half of the image.
  static cv::Mat Noise() {
    cv::Mat image(kHeight, kWidth, CV_8UC3);
    cv::RNG random(7);
    random.fill(image, cv::RNG::UNIFORM, 0, 256);
    return image;
  }

  std::filesystem::path Path(const std::string& name) const { return root_ / name; }
  void Text(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(Path(name).parent_path());
    std::ofstream(Path(name)) << text;
  }
  void Write(const std::string& name, const cv::Mat& image) const {
    std::filesystem::create_directories(Path(name).parent_path());
    ASSERT_TRUE(cv::imwrite(Path(name).string(), image));
  }
  void WriteCamera(const std::string& name = "camera.yaml", int width = kWidth, int height = kHeight) const {
    Text(name, "model: PINHOLE\nwidth: " + std::to_string(width) + "\nheight: " + std::to_string(height) +
                   "\nparams: [60, 60, 31.5, 23.5]\nfps: 20\ndepth_scale: 0.5\nunit: mm\n");
  }
  void WriteImages(int count, const std::string& folder = "images") const {
    for (int idx = 0; idx < count; ++idx) Write(folder + "/" + Name(idx), Image(idx));
  }
  void WriteNative(int count) const {
    WriteCamera();
    WriteImages(count);
  }
  void WriteVideo(const std::string& name, int count) const {
    cv::VideoWriter writer(Path(name).string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25,
                           {kWidth, kHeight});
    ASSERT_TRUE(writer.isOpened());
    for (int idx = 0; idx < count; ++idx) writer.write(Image(idx));
  }
  // Cuts a file to a part of its length.
  void Truncate(const std::string& name, double part) const {
    std::filesystem::resize_file(
        Path(name), static_cast<std::uintmax_t>(part * static_cast<double>(std::filesystem::file_size(Path(name)))));
  }

  std::filesystem::path root_;
};

}  // namespace pliant
