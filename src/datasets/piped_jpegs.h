// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Standard input that consists of JPEG images: each is decoded when its last byte has come.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include <opencv2/core/mat.hpp>

#include "datasets/frame_grabber.h"
#include "datasets/jpeg_images.h"
#include "datasets/standard_input.h"

namespace pliant {

class PipedJpegs final : public FrameGrabber {
 public:
  // What `input` gave last belongs to it.
  PipedJpegs(std::unique_ptr<StandardInput> input, std::span<const unsigned char> begin, double timeout_s,
             std::function<bool()> is_stopped);

  std::optional<double> fps() const override { return std::nullopt; }

 private:
  std::optional<cv::Mat> Next() override;
  void Add(std::span<const unsigned char> bytes);
  Status AtEnd() const;

  std::unique_ptr<StandardInput> input_;
  double timeout_s_;
  std::function<bool()> is_stopped_;
  JpegImages jpegs_;
};

}  // namespace pliant
