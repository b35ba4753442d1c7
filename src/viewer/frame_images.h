// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A view's images one after the other, at the frames that are asked for.
#pragma once

#include <memory>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/viewer/view.h"

namespace pliant {

class FrameImages {
 public:
  // Of no images where the view has none. Fails as OpenSequence does.
  static Result<FrameImages> Open(const View& view, int first_frame_idx);

  // In ascending order of frames. Empty where there is none. Fails as Sequence::Next does.
  Result<cv::Mat> At(int frame_idx);

 private:
  std::unique_ptr<Sequence> sequence_;  // null: no images
  int last_idx_ = -1;
};

}  // namespace pliant
