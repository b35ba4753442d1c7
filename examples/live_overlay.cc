// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Tracks a camera, a stream, a pipe or a video, and draws where every point is over each image that has a pose.
//
// usage: live_overlay SOURCE CAMERA RUN PICTURES
//   SOURCE    "device:0", an address, "-", or what `pliant track` reads
//   CAMERA    a calibration
//   RUN       the run folder to make
//   PICTURES  the folder for FRAME.jpg
#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <pliant/pipeline/track.h>

// From near (orange) to far (blue).
cv::Scalar ColorOf(double depth, double near, double far) {
  const double share = std::clamp((depth - near) / std::max(far - near, 1e-9), 0.0, 1.0);
  return (1 - share) * cv::Scalar(40, 180, 255) + share * cv::Scalar(255, 120, 40);
}

class Overlay : public pliant::TrackObserver {
 public:
  explicit Overlay(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void OnStart(int /*frames*/) override {}
  void OnWarning(const std::string& sentence) override { std::cerr << sentence << "\n"; }
  void OnImage(int frame_idx, const cv::Mat& image) override { waiting_[frame_idx] = image; }
  // In order of time; while a first map is looked for, later than its image.
  void OnFrame(const pliant::FrameReport& frame) override {
    const auto image = waiting_.extract(frame.frame_idx);
    if (image.empty() || !frame.cam_from_world) return;
    const Eigen::Vector3d at = frame.cam_from_world->OriginInSource();
    std::cout << frame.frame_idx << ": camera at " << at.transpose() << ", " << frame.observations.size()
              << " points\n";
    Draw(frame, image.mapped());
  }

 private:
  void Draw(const pliant::FrameReport& frame, const cv::Mat& image) const {
    cv::Mat picture;
    if (image.channels() == 1)
      cv::cvtColor(image, picture, cv::COLOR_GRAY2BGR);
    else
      picture = image.clone();
    std::vector<double> depths;
    for (const pliant::PointObservation& point : frame.observations)
      depths.push_back((*frame.cam_from_world * point.position).z());
    const auto [near, far] = std::ranges::minmax_element(depths);
    for (std::size_t i = 0; i < depths.size(); ++i) {
      const Eigen::Vector2d& pixel = frame.observations[i].pixel;
      cv::circle(picture, cv::Point2d(pixel.x(), pixel.y()), 2, ColorOf(depths[i], *near, *far), cv::FILLED);
    }
    cv::imwrite((folder_ / (std::to_string(frame.frame_idx) + ".jpg")).string(), picture);
  }

  std::filesystem::path folder_;
  std::map<int, cv::Mat> waiting_;  // images whose report is still to come
};

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: live_overlay SOURCE CAMERA RUN PICTURES\n";
    return 2;
  }
  pliant::RunRequest request;
  request.input.image_path = argv[1];
  request.input.camera_path = argv[2];
  request.output_path = argv[3];
  std::filesystem::create_directories(argv[4]);
  Overlay overlay(argv[4]);
  const auto run = pliant::RunTrack(request, pliant::MakeTrackOptions(pliant::Preset::kDefault),
                                    std::array<pliant::TrackObserver*, 1>{&overlay});
  std::cout << (run.ok() ? run->note : run.status().message()) << std::endl;
  return run.ok() ? 0 : 1;
}
