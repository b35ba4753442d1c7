// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The run of support/small_run.h by any camera, with images that show its points as spots, and a surface folder of it.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "pliant/datasets/png_file.h"
#include "pliant/io/camera_file.h"
#include "support/small_run.h"

namespace pliant {

inline Camera NeuralCamera(const std::string& model, const std::vector<double>& params) {
  return Camera::Create(model, 640, 480, params).value();
}

inline std::vector<Camera> NeuralCameras() {
  return {TestCamera(),
          NeuralCamera("SIMPLE_PINHOLE", {510, 331, 228}),
          NeuralCamera("SIMPLE_RADIAL", {490, 300.5, 250, -0.1}),
          NeuralCamera("RADIAL", {490, 300.5, 250, -0.1, 0.03}),
          NeuralCamera("OPENCV", {490, 505, 312, 251, -0.15, 0.05, 0.002, -0.003}),
          NeuralCamera("OPENCV_FISHEYE", {400, 410, 330, 236, 0.05, -0.01, 0.002, 0.0003})};
}

// Report() as this camera sees it.
inline FrameReport ReportBy(const Camera& camera, FrameReport report) {
  for (PointObservation& o : report.observations) o.pixel = *camera.Project(*report.cam_from_world * o.position);
  return report;
}

inline void DrawSpot(const Eigen::Vector2d& center, cv::Mat* image) {
  constexpr double kSigma_px = 1.2;
  for (int y = static_cast<int>(center.y()) - 5; y <= center.y() + 6; ++y)
    for (int x = static_cast<int>(center.x()) - 5; x <= center.x() + 6; ++x) {
      const double distance = (Eigen::Vector2d(x, y) - center).norm();
      const auto level =
          static_cast<std::uint8_t>(200.0 * std::exp(-0.5 * distance * distance / kSigma_px / kSigma_px));
      if (level > image->at<std::uint8_t>(y, x)) image->at<std::uint8_t>(y, x) = level;
    }
}

// Images 0.png to `last`.png in `folder`/sequence, those of the reports with spots.
inline void WriteImages(const TestFolder& folder, const Camera& camera, const std::vector<FrameReport>& reports,
                        int last) {
  std::filesystem::create_directories(folder.Path("sequence/images"));
  ASSERT_TRUE(WriteCameraFile(folder.Path("sequence/camera.yaml"), {.camera = camera}).ok());
  for (int i = 0; i <= last; ++i) {
    cv::Mat image(camera.height(), camera.width(), CV_8UC1, cv::Scalar(0));
    for (const FrameReport& report : reports)
      if (report.frame_idx == i)
        for (const PointObservation& o : report.observations) DrawSpot(o.pixel, &image);
    ASSERT_TRUE(WritePng(folder.Path("sequence/images/" + std::to_string(i) + ".png"), image).ok());
  }
}

// A run in `folder`/run of images in `folder`/sequence.
inline void WriteNeuralRun(const TestFolder& folder, const Camera& camera, int submaps = 1) {
  std::vector<FrameReport> reports;
  for (int submap = 0; submap < submaps; ++submap)
    for (int frame = 0; frame < kRunFrames; ++frame)
      reports.push_back(ReportBy(camera, submap == 0 ? Report(frame) : ReportOfSecondSubmap(frame)));
  auto writer = RunWriter::Create(folder.Path("run"), camera, {"0.1.0", {"pliant"}, 7, folder.Path("sequence"), {}},
                                  "Track:\n", {});
  ASSERT_TRUE(writer.ok()) << writer.status().message();
  for (const FrameReport& report : reports) ASSERT_TRUE(writer->Write(report).ok());
  ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
  WriteImages(folder, camera, reports, reports.back().frame_idx);
}

inline constexpr double kSurfaceStep = 0.002;  // map units

// A plane that is not parallel to the image, with a hole.
inline double SurfaceDepthAt(int x, int y) { return x >= 100 && x < 150 && y < 80 ? 0.0 : 40.0 + 0.03 * x + 0.01 * y; }

// `folder`/surface, of these frames of the run that surface.json names.
inline void WriteSurface(const TestFolder& folder, const Camera& camera, const std::vector<int>& frames,
                         const std::string& run_path) {
  for (const char* kind : {"depth", "confidence"})
    std::filesystem::create_directories(folder.Path("surface") + "/" + kind);
  ASSERT_TRUE(
      WriteCameraFile(folder.Path("surface/camera.yaml"), {.camera = camera, .depth_scale = kSurfaceStep}).ok());
  cv::Mat depth(camera.height(), camera.width(), CV_32FC1);
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) depth.at<float>(y, x) = static_cast<float>(SurfaceDepthAt(x, y));
  std::string entries;
  for (const int frame : frames) {
    const std::string name = std::to_string(frame) + ".png";
    ASSERT_TRUE(WritePng(folder.Path("surface/depth/" + name), QuantizeDepth(depth, kSurfaceStep)).ok());
    ASSERT_TRUE(WritePng(folder.Path("surface/confidence/" + name), QuantizeDepth(depth, 0.01)).ok());
    entries += (entries.empty() ? "" : ", ") + std::string("{\"frame\": ") + std::to_string(frame) + ", \"name\": \"" +
               name + "\", \"note\": \"\"}";
  }
  folder.Write("surface/surface.json",
               "{\"status\": \"completed\", \"run\": \"" + run_path + "\", \"frames\": [" + entries + "]}");
}

}  // namespace pliant
