// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the reader of a data set finds: where its images come from, what becomes of them, and the truth. One file a data
// set fills it; one sequence reads it, whatever it is of.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "datasets/image_stream.h"
#include "datasets/pair_streams.h"
#include "datasets/rectify.h"
#include "datasets/set_files.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

// What a calibration file says of a sequence besides the camera.
struct SourceCalibration {
  Camera camera;
  std::filesystem::path path;                        // for messages
  std::optional<double> fps = std::nullopt;          // of sources that carry no time of their own
  std::optional<double> depth_scale = std::nullopt;  // mm a unit of the depth images
  std::optional<double> baseline_mm = std::nullopt;  // of rectified pairs
  double unit_mm = 1.0;                              // of the poses beside the file
  std::optional<PhotometricCalibration> photometric = std::nullopt;

  double Fps() const { return fps.value_or(30.0); }
};

struct DataSet {
  SourceCalibration calibration;  // of the images as they are given
  std::unique_ptr<ImageStream> images;
  std::unique_ptr<ImageStream> right = nullptr;            // of rectified pairs; null: none
  cv::Mat inside = {};                                     // 0 where no image has anything; empty: none
  std::filesystem::path mask_path = {};                    // a folder, or one image; empty: no masks
  std::map<int, std::filesystem::path> raw_masks = {};     // of the raw images; frames without: no mask
  std::optional<ImageWarp> warp = std::nullopt;            // from the raw left images, where they are
  Rigid3 raw_from_given = {};                              // the camera of the raw images, likewise
  std::vector<double> timestamps_s = {};                   // one an image; empty: number / fps
  std::vector<std::optional<Rigid3>> world_from_cam = {};  // one an image, mm; empty: no truth
  std::vector<std::filesystem::path> depth_files = {};     // one an image, "": none; empty: no truth
  ReadDepth read_depth = nullptr;                          // of such a file
  std::vector<std::string> warnings = {};                  // a sentence each
};

// These images with the calibration that belongs to them: the request's file, else camera.yaml in the folder or beside
// the file. One that does not say its images' size takes that of the stream; one of two cameras rectifies the pairs
// that the images hold (a StereoMIS .ini is of nothing else: kMismatch). Calibu's XML is read too. Where there is no
// file, `published` is taken, the data set's own. The request's masks are of the images as they are, before they are
// rectified.
Result<DataSet> Calibrated(const SequenceRequest& request, std::unique_ptr<ImageStream> images,
                           const std::optional<SourceCalibration>& published = {});

// Pairs that each of the images holds, split and rectified.
Result<DataSet> RectifiedHalves(const StereoCalibration& calibration, const std::filesystem::path& calibration_path,
                                PairLayout layout, std::unique_ptr<ImageStream> images);

// Raw pairs, rectified; `image` is the size of the images that held them.
Result<DataSet> RectifiedPairs(const StereoCalibration& calibration, const std::filesystem::path& calibration_path,
                               cv::Size image, PairLayout layout, EyeStreams eyes);

// Masks belong to images by file stem, or by order where no stem agrees; where the number of images is exact every one
// must have its own. Errors as OpenSequence.
Result<std::unique_ptr<Sequence>> ReadDataSet(DataSet data_set, const SequenceRequest& request);

}  // namespace pliant
