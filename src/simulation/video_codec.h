// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a video codec leaves of images, as H.264 does it without its refinements: chroma at half the resolution; blocks
// of 16 x 16 pixels predicted from the decoded frame before, moved by whole and half pixels; the difference in 8 x 8
// cosine transforms, quantized with a dead zone (ITU-T H.264, 8.5: a step of 0.625 * 2^(qp / 6) gray levels; rounding
// offsets of the reference encoder, 1/3 of a step in key frames and 1/6 in others). Left out: prediction within an
// image, the deblocking filter, frames predicted from later ones, a bit rate that is kept. What cannot be told from
// noise stays as it was in the frame before; fine, weak texture is smoothed and then carried along.
#pragma once

#include <array>

#include <opencv2/core/mat.hpp>

namespace pliant::simulation {

class VideoCodec {
 public:
  // `qp` 1 to 51; every `key_frame_every`-th frame is coded by itself, from the first on.
  VideoCodec(int qp, int key_frame_every);

  // The next frame after coding and decoding; CV_8UC3, BGR, all of one size. Single-threaded and exact: the same frames
  // give the same pixels.
  cv::Mat Decode(const cv::Mat& image);

 private:
  using Planes = std::array<cv::Mat, 3>;  // Y, Cr, Cb: CV_8UC1; the latter at half the size

  cv::Point2f FindMotion(const cv::Mat& block, const cv::Point& corner, const cv::Point2f& neighbor) const;
  void CodeMacroblock(const Planes& planes, const cv::Point& corner, const cv::Point2f& motion, Planes* decoded) const;

  double step_;
  int key_frame_every_;
  int frames_ = 0;
  Planes previous_;  // decoded
};

}  // namespace pliant::simulation
