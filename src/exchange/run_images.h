// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The images of a run's frames with their masks and dense depths, for the exports that hold them.
#pragma once

#include <memory>
#include <string>

#include <opencv2/core/mat.hpp>

#include "exchange/run_source.h"
#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/io/run_map.h"

namespace pliant {

struct RunImage {
  cv::Mat image;  // 8-bit BGR, the size of the run's camera
  cv::Mat mask;   // 8-bit, 0 = ignore; empty: the sequence has no masks
  cv::Mat depth;  // CV_32FC1, measured z along the optical axis, map units, 0 = none; empty: the source has no surface
};

class RunImages {
 public:
  // `source` has to outlive the result. Fails with kNotFound where nothing says which images the run is of, or as
  // OpenSequence does.
  static Result<RunImages> Open(const RunSource& source);

  // Of a frame of the source; frames are asked for in its order. Fails with kMismatch where the images are not those
  // of the run, kUnreadable for an image or a depth that cannot be read.
  Result<RunImage> Read(const SourceFrame& frame);

 private:
  RunImages(const RunSource& source, std::unique_ptr<Sequence> sequence)
      : source_(&source), sequence_(std::move(sequence)) {}

  const RunSource* source_;
  std::unique_ptr<Sequence> sequence_;
};

// The surface folder at `path`, which has to be one of the run at `run_path` that has this camera and these images.
// Fails as ReadSurfaceFolder does, and with kMismatch where it is not.
Result<SurfaceFolder> ReadSurfaceOfRun(const std::string& path, const std::string& run_path, const RunMap& known);

// The entry of the frame, or null where the surface has no depth of it.
const SurfaceFolder::Frame* FindFrame(const SurfaceFolder& surface, int frame_idx);

}  // namespace pliant
