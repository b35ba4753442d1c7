// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What every data set looks like to the rest of the program: a sequence of frames read in order, with a camera, and
// with truth where there is truth. A frame keeps its number in the source whatever part of it is read.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/camera/photometric_calibration.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

struct SequenceFrame {
  int frame_idx = 0;  // position in the source (its image number), before `start` and `stride` are applied
  std::string name;   // the image's file name, or NNNNNN.png for a video's frame
  double timestamp_s = 0;
  cv::Mat image;  // 8-bit, 1 (gray) or 3 (BGR) channels, the camera's size
  cv::Mat mask;   // 8-bit, 0 = ignore; empty: no mask
  // Of another program (SequenceRequest::depth_prior_path): CV_32FC1 of any size, over the whole image, values as the
  // file has them, 0 or less and NaN = none; empty: there is none.
  cv::Mat depth_prior = {};
  // When the source itself says that the image was taken (times.txt, a video's time stamp); timestamp_s of a video is
  // counted at its rate instead.
  std::optional<double> recorded_s = std::nullopt;
};

class Sequence {
 public:
  virtual ~Sequence() = default;

  virtual const Camera& camera() const = 0;
  // Number of frames; for a video the container's word, which may be off: trust the end that Next reports.
  virtual int size() const = 0;

  // The next frame, nothing at the end. Fails with kUnreadable (a truncated file), kMismatch (another size).
  // After a failure the sequence may be asked for the frame after it.
  virtual Result<std::optional<SequenceFrame>> Next() = 0;

  // Whether the files of the images (of pairs: both) and masks of all frames are images, and have one size each. Only
  // files are decoded whose head and end do not tell. Fails with kUnreadable and kMismatch.
  virtual Status CheckFiles() const { return Status::Ok(); }

  // Truth by the frame's own index, where the sequence has it; nothing where not.
  // These do not depend on how far Next has come. Depth: CV_32FC1, z along the optical axis in mm, 0 = none; it may be
  // asked for while another thread is in Next.
  virtual Result<std::optional<cv::Mat>> Depth(int frame_idx) const = 0;
  virtual std::optional<Rigid3> WorldFromCamera(int frame_idx) const = 0;

  // Response, vignetting and light, where the source's calibration says them.
  virtual std::optional<PhotometricCalibration> Photometric() const { return std::nullopt; }

  // The distance of the cameras of a rectified pair, the right one at +x of the left one, whose images Next gives;
  // nothing where the source has no pairs.
  virtual std::optional<double> BaselineMm() const { return std::nullopt; }
  // Images a second, where the video or the calibration says it.
  virtual std::optional<double> Fps() const { return std::nullopt; }
  // The right image of the frame that Next gave last, rectified like it, of its size; nothing where there is none.
  // Fails as Next.
  virtual Result<std::optional<cv::Mat>> Right() { return std::optional<cv::Mat>(); }

  // When the source's frame of this index was taken, seconds; nothing where the source has no such frame or cannot say
  // without reading it. It tells whether a run belongs to this sequence.
  virtual std::optional<double> TimestampS(int /*frame_idx*/) const { return std::nullopt; }

  // The name that Next gives the source's frame of this index; nothing where the source has no such frame or cannot say
  // without reading it.
  virtual std::optional<std::string> Name(int /*frame_idx*/) const { return std::nullopt; }

  // What is odd about the source, one sentence each, and was read all the same.
  virtual std::vector<std::string> Warnings() const { return {}; }
};

}  // namespace pliant
