// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// usage: pliant_opencv_tracks SEQUENCE TRACKS.csv
//
// Point tracks of a sequence by nothing but OpenCV: goodFeaturesToTrack and calcOpticalFlowPyrLK with their usual
// settings, from image to image, followed forward and back. It stands for a tracker from outside.
#include <cstdio>
#include <map>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "pliant/datasets/open_sequence.h"
#include "pliant/io/track_file.h"

namespace {

using namespace pliant;  // NOLINT(google-build-using-namespace): a program that is one file

constexpr int kMaxPoints = 500;
constexpr double kQuality = 0.01;
constexpr double kMinDistance_px = 8;
constexpr int kRefillEvery = 10;       // frames
constexpr float kMaxReturn_px = 0.75;  // a point that is followed back comes this near to where it was

struct Followed {
  std::vector<PointId> ids;
  std::vector<cv::Point2f> pixels;
};

class OpenCvTracks {
 public:
  void Process(int frame_idx, const cv::Mat& image) {
    cv::Mat gray = image;
    if (image.channels() == 3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
    if (!present_.ids.empty()) Follow(gray);
    if (count_ % kRefillEvery == 0) Refill(gray);
    for (std::size_t k = 0; k < present_.ids.size(); ++k)
      tracks_[present_.ids[k]].pixels.push_back({frame_idx, {present_.pixels[k].x, present_.pixels[k].y}});
    previous_ = gray.clone();
    ++count_;
  }

  std::vector<PixelTrack> Tracks() const {
    std::vector<PixelTrack> tracks;
    for (const auto& [id, track] : tracks_) tracks.push_back({id, track.pixels});
    return tracks;
  }

 private:
  void Follow(const cv::Mat& gray) {
    std::vector<cv::Point2f> ahead;
    std::vector<cv::Point2f> back;
    std::vector<unsigned char> found;
    std::vector<unsigned char> returned;
    std::vector<float> error;
    cv::calcOpticalFlowPyrLK(previous_, gray, present_.pixels, ahead, found, error);
    cv::calcOpticalFlowPyrLK(gray, previous_, ahead, back, returned, error);
    const cv::Rect2f inside(0, 0, static_cast<float>(gray.cols - 1), static_cast<float>(gray.rows - 1));
    Followed next;
    for (std::size_t k = 0; k < ahead.size(); ++k) {
      const bool good = found[k] != 0 && returned[k] != 0 && inside.contains(ahead[k]) &&
                        cv::norm(back[k] - present_.pixels[k]) <= kMaxReturn_px;
      if (!good) continue;
      next.ids.push_back(present_.ids[k]);
      next.pixels.push_back(ahead[k]);
    }
    present_ = std::move(next);
  }

  void Refill(const cv::Mat& gray) {
    const int wanted = kMaxPoints - static_cast<int>(present_.ids.size());
    if (wanted <= 0) return;
    cv::Mat free(gray.size(), CV_8UC1, cv::Scalar(255));
    for (const cv::Point2f& pixel : present_.pixels)
      cv::circle(free, pixel, static_cast<int>(kMinDistance_px), cv::Scalar(0), cv::FILLED);
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(gray, corners, wanted, kQuality, kMinDistance_px, free);
    for (const cv::Point2f& corner : corners) {
      present_.ids.push_back(PointId{next_id_++});
      present_.pixels.push_back(corner);
    }
  }

  cv::Mat previous_;
  Followed present_;
  std::map<PointId, PixelTrack> tracks_;
  std::int64_t next_id_ = 0;
  int count_ = 0;
};

int Fail(const Status& status) {
  std::fprintf(stderr, "pliant_opencv_tracks: %s\n", status.message().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: pliant_opencv_tracks SEQUENCE TRACKS.csv\n");
    return 2;
  }
  const auto sequence = OpenSequence({.image_path = argv[1]});
  if (!sequence.ok()) return Fail(sequence.status());
  OpenCvTracks tracker;
  while (true) {
    const auto frame = (*sequence)->Next();
    if (!frame.ok()) return Fail(frame.status());
    if (!frame->has_value()) break;
    tracker.Process((*frame)->frame_idx, (*frame)->image);
  }
  const std::vector<PixelTrack> tracks = tracker.Tracks();
  if (const Status written = WriteTrackCsv(argv[2], tracks); !written.ok()) return Fail(written);
  std::printf("%zu tracks in %s\n", tracks.size(), argv[2]);
  return 0;
}
