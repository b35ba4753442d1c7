// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Images that the program has already, in memory or from a camera, as a sequence: SequenceRequest::given.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/camera/photometric_calibration.h"

namespace pliant {

class ImageSource {
 public:
  virtual ~ImageSource() = default;

  // How many images there are; 0: that is not known before the last one was read.
  virtual int count() const = 0;
  // Image `idx` from 0, 8-bit with one or three (BGR) channels, which is not written to any more; nothing beyond the
  // end. Images are asked for in any order, more than once (tracking goes back), and by several threads at a time.
  // Fails with kUnreadable.
  virtual Result<std::optional<cv::Mat>> Read(int idx) = 0;

  // When image `idx`, which was read, was taken, seconds; nothing: GivenImages says it.
  virtual std::optional<double> TimestampS(int /*idx*/) const { return std::nullopt; }
  // Whether images arrive while they are tracked: one at most is read ahead, since newer ones come.
  virtual bool IsLive() const { return false; }
  // How many images were read that newer ones will follow: what is read before tracking begins is old by then.
  virtual int Passed() const { return 0; }
  // When image `idx`, which was read, was there; nothing: it was all the time.
  virtual std::optional<std::chrono::steady_clock::time_point> Arrived(int /*idx*/) const { return std::nullopt; }
};

struct GivenImages {
  Camera camera;                                                     // of all images
  std::optional<PhotometricCalibration> photometric = std::nullopt;  // of the camera, where it is known
  double fps = 30.0;                                                 // where there are no times
  std::vector<double> timestamps_s = {};                             // one an image; empty: number / fps
  std::shared_ptr<ImageSource> images;
  std::vector<std::string> warnings = {};  // what is odd about them, a sentence each
};

}  // namespace pliant
