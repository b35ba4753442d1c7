// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The images of a live run, shrunk and coded on a thread of their own, which takes the newest one whenever it is ready
// for one, and not more often than a person sees the difference.
#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace pliant {

class LiveImages {
 public:
  LiveImages(int width_px, int quality, double max_mb);
  ~LiveImages();

  void Add(int frame_idx, const cv::Mat& image);
  // The JPEG of the frame; empty: there is none.
  std::string At(int frame_idx) const;
  // Which there are.
  std::vector<int> Frames() const;
  // Of the coded images in the given ones; 0: none yet.
  double scale() const;

 private:
  void Run();

  const int width_px_;
  const int quality_;
  const double max_mb_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<std::pair<int, cv::Mat>> next_;
  bool ended_ = false;
  std::map<int, std::string> jpeg_;  // by frame
  double mb_ = 0;
  double scale_ = 0;
  std::thread thread_;
};

}  // namespace pliant
