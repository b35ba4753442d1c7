// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Images or a video of a calibration board in, camera.yaml out; of two cameras that see it at the same time their
// stereo calibration. Of more images than Calibrate.max_images the sharpest one of every stretch is looked at; of those
// that show the board the most different ones are used.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/board/board.h"
#include "pliant/board/find_board.h"
#include "pliant/calibration/calibrate_camera.h"
#include "pliant/calibration/calibrate_stereo.h"
#include "pliant/datasets/pair_layout.h"

namespace pliant {

struct CalibrateOptions {
  ModelChoice model = ModelChoice::kAuto;
  int max_images = 120;  // in which the board is searched for
  int max_views = 40;    // that are used
  int threads = 2;

  void List(OptionTable& table);  // group "Calibrate"
};

enum class ExistingFile { kKeep, kOverwrite };

// Minutes of search are not to end with a file that cannot be written. Fails with kInvalidArgument: a file that is to
// be kept; with kUnwritable: a folder, and one that is not there or not writable.
Status CheckCalibrationOutput(const std::filesystem::path& path, ExistingFile existing);

struct CalibrateRequest {
  std::filesystem::path image_path;  // folder of images, native sequence or video
  CalibrationBoard board;
  std::filesystem::path output_path;  // of camera.yaml, or of the stereo calibration; empty: nothing is written
  // Of two cameras: where the right one's images are, of the same moments in the same order, or how each image holds
  // both (the left one's on the left, or on top).
  std::filesystem::path right_path = {};
  PairLayout pairs = PairLayout::kApart;
  ExistingFile existing = ExistingFile::kKeep;  // what becomes of a file at output_path

  bool HasPairs() const { return !right_path.empty() || pairs != PairLayout::kApart; }
};

// What became of an image in which the board was searched for.
enum class ImageUse { kUsed, kOutlier, kAlike, kNoBoard };
template <>
struct EnumNames<ImageUse> {
  static constexpr std::array kNames = {std::pair{ImageUse::kUsed, std::string_view("used")},
                                        std::pair{ImageUse::kOutlier, std::string_view("fits badly")},
                                        std::pair{ImageUse::kAlike, std::string_view("like another")},
                                        std::pair{ImageUse::kNoBoard, std::string_view("no board")}};
};

struct CalibrationImage {
  std::string name;
  ImageUse use = ImageUse::kNoBoard;
  int view_idx = -1;  // among CalibrateSummary::views; -1: none
};

struct CalibrateSummary {
  CameraCalibration calibration;
  std::vector<BoardView> views = {};          // those of the calibration
  std::vector<CalibrationImage> images = {};  // in order
  int images_read = 0;                        // of which `images` are the sharpest
  double covered_share = 0;                   // of the image, by points of the board
  std::vector<std::string> advice = {};       // what would make it better, a sentence each
};

struct CalibratePairsSummary {
  CalibrateSummary left;  // each camera alone
  CalibrateSummary right;
  StereoCameras stereo;
};

// Fails with kNotFound and kUnreadable for images that cannot be read, kMismatch for images of different sizes,
// kInsufficient where the board is not seen, is larger than was said (the sentence says what is seen) or the images do
// not determine the camera, kInterrupted by `progress`, and kUnwritable. camera.yaml is written at the end only. Tasks
// of `progress`: "search" for the board in images, "size" of what is seen in some of them, then those of
// CalibrateCamera.
Result<CalibrateSummary> CalibrateImages(const CalibrateRequest& request, const CalibrateOptions& options,
                                         const JobProgress& progress);

// Of a request that has pairs. Writes an OpenCV stereo calibration, in millimeters, as SequenceRequest::camera_path
// takes it. The models are perspective ones, since pairs are rectified. Fails as CalibrateImages and CalibrateStereo
// do, and with kMismatch where the two cameras have different numbers of images.
Result<CalibratePairsSummary> CalibratePairs(const CalibrateRequest& request, const CalibrateOptions& options,
                                             const JobProgress& progress);

}  // namespace pliant
