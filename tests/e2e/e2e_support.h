// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs the whole pipeline as the program does, on a sequence rendered once and tracked once with default options (see
// CMakeLists.txt), or on copies of its first frames with something wrong in them.
#pragma once

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "pliant/evaluation/evaluation.h"
#include "pliant/io/run_reader.h"
#include "pliant/pipeline/track.h"
#include "support/test_folder.h"

namespace pliant {

inline const std::string kSequence = PLIANT_TEST_SEQUENCE;
inline const std::string kDefaultRun = PLIANT_TEST_RUN;  // of all of it, with default options; to be read only

// The pipeline with nothing on the terminal; a run that could not begin is a test failure.
inline RunSummary TrackSequenceAt(const std::string& sequence, const std::string& run, const TrackOptions& options,
                                  int end = -1) {
  RunRequest request;
  request.input.image_path = sequence;
  request.input.end = end;
  request.output_path = run;
  request.command_line = {"pliant", "track"};
  auto summary = RunTrack(request, options, {});
  EXPECT_TRUE(summary.ok()) << summary.status().message();
  return summary.ok() ? *summary : RunSummary{};
}

inline TrackOptions DepthStart() {
  TrackOptions options;
  options.tracker.init.method = InitMethod::kDepth;
  return options;
}

inline Evaluation EvaluateRun(const std::string& run, const std::string& sequence, ErrorScale scale) {
  SequenceRequest request;
  request.image_path = sequence;
  const auto truth = OpenSequence(request);
  EXPECT_TRUE(truth.ok()) << truth.status().message();
  EvaluationOptions options;
  options.points.scale = scale;
  const auto input = ReadEvaluationInput(run, **truth, options.matching);
  EXPECT_TRUE(input.ok()) << input.status().message();
  const auto evaluation = Evaluate(*input, **truth, Status(ErrorCode::kNotFound, "not wanted"), options);
  EXPECT_TRUE(evaluation.ok()) << evaluation.status().message();
  return *evaluation;
}

inline std::string FrameName(int idx) {
  std::array<char, 16> name{};
  std::snprintf(name.data(), name.size(), "%06d.png", idx);
  return name.data();
}

// A copy of the sequence's first `frames` frames: images, depth and camera.
class SequenceCopy {
 public:
  SequenceCopy(const TestFolder& folder, int frames) : path_(folder.Path("sequence")) {
    for (const char* part : {"images", "depth"}) {
      std::filesystem::create_directories(path_ / part);
      for (int i = 0; i < frames; ++i)
        std::filesystem::copy_file(std::filesystem::path(kSequence) / part / FrameName(i), path_ / part / FrameName(i));
    }
    std::filesystem::copy_file(std::filesystem::path(kSequence) / "camera.yaml", path_ / "camera.yaml");
  }
  std::string path() const { return path_.string(); }
  std::filesystem::path Image(int idx) const { return path_ / "images" / FrameName(idx); }
  void Replace(int idx, const cv::Mat& image) const { ASSERT_TRUE(cv::imwrite(Image(idx).string(), image)); }
  void Fill(int first, int last, int level) const {
    const cv::Mat image = cv::imread(Image(first).string());
    for (int i = first; i <= last; ++i) Replace(i, cv::Mat(image.size(), CV_8UC3, cv::Scalar::all(level)));
  }
  // Changes a byte in the middle: head and end are as they were, so that nothing tells before the image is read.
  void Damage(int idx) const {
    std::fstream file(Image(idx), std::ios::in | std::ios::out | std::ios::binary);
    const auto middle = static_cast<std::streamoff>(std::filesystem::file_size(Image(idx)) / 2);
    file.seekg(middle);
    const auto byte = static_cast<char>(file.get() ^ 1);
    file.seekp(middle);
    file.put(byte);
  }

 private:
  std::filesystem::path path_;
};

}  // namespace pliant
