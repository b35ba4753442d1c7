// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Another program's reconstruction or camera path, brought to a sequence's frames: as a run folder, which evaluate,
// compare and export read like Pliant's own, or as the sequence's truth.
//   colmap   a sparse model (cameras, images, points3D): poses, keypoints with a point, points. Images are frames by
//            name: the file's name, or where there is none its stem. A model is rigid: a point is where it is in every
//            frame.
//   result   trajectory.txt (TUM) and observations.csv, as docs/formats.md describes them
//   tum, kitti, euroc   a camera path alone (pliant/io/trajectory.h). Poses are given to frames by time, KITTI's by
//            their line, so that there has to be one a frame.
// The world stays the other program's; only its unit is multiplied.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/options.h"
#include "pliant/base/status.h"

namespace pliant {

enum class ImportFormat { kColmap, kResult, kTum, kKitti, kEuroc };
template <>
struct EnumNames<ImportFormat> {
  static constexpr std::array kNames = {std::pair{ImportFormat::kColmap, std::string_view("colmap")},
                                        std::pair{ImportFormat::kResult, std::string_view("result")},
                                        std::pair{ImportFormat::kTum, std::string_view("tum")},
                                        std::pair{ImportFormat::kKitti, std::string_view("kitti")},
                                        std::pair{ImportFormat::kEuroc, std::string_view("euroc")}};
};

enum class ImportAs {
  kRun,    // a run folder
  kTruth,  // groundtruth.txt of a native sequence, and camera.yaml where the folder has none
};
template <>
struct EnumNames<ImportAs> {
  static constexpr std::array kNames = {std::pair{ImportAs::kRun, std::string_view("run")},
                                        std::pair{ImportAs::kTruth, std::string_view("truth")}};
};

struct ImportOptions {
  double unit_mm = 1;                   // size of a unit of the input
  double max_time_difference_s = 0.01;  // of a pose and its frame
  double seconds = 0;                   // that the other program took; for run.json

  void List(OptionTable& table);  // group "Import"
};

struct ImportRequest {
  std::string input_path;     // a model's folder, a result's folder, or a file with a camera path
  std::string sequence_path;  // the images that it was made of: a native sequence, a folder of images, a video
  std::string camera_path;    // calibration of images that have none; of a model its own, where it is empty
  ImportFormat format = ImportFormat::kColmap;
  ImportAs as = ImportAs::kRun;
  std::string output_path;                // a folder, made if need be
  std::vector<std::string> command_line;  // for run.json
};

struct ImportSummary {
  int frames = 0;           // with a pose
  int sequence_frames = 0;  // that there are
  int points = 0;
  std::int64_t observations = 0;
  std::vector<std::string> notes;  // what was left out, a sentence each
};

// Fails with kNotFound, kUnreadable or kMismatch for what cannot be read or does not belong together; with
// kInvalidArgument for a model that Pliant has no camera for, one with several cameras, or an output folder that holds
// something else; with kInsufficient where no frame has a pose (of truth: where one has none); with kUnwritable.
// `progress` is told of a model's files (task "read"); kInterrupted where it asks to stop before anything is written.
Result<ImportSummary> Import(const ImportRequest& request, const ImportOptions& options,
                             const JobProgress& progress = {});

}  // namespace pliant
