// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Views of a board through a known camera, for tests: its points, and images of it.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

#include "pliant/base/random.h"
#include "pliant/board/board.h"
#include "pliant/board/find_board.h"
#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

inline const CalibrationBoard kChessboard9x6 = {BoardKind::kChessboard, 9, 6, 2.0};

// Of a board whose center is at `center_in_cam`, tilted about an axis in its plane.
inline Rigid3 BoardPoseAt(const CalibrationBoard& board, const Eigen::Vector3d& center_in_cam, double tilt_rad,
                          double axis_rad) {
  const std::vector<Eigen::Vector3d> points = board.Points();
  const Eigen::Vector3d center = 0.5 * (points.front() + points.back());
  const Eigen::Quaterniond rotation =
      RotationExp(tilt_rad * Eigen::Vector3d(std::cos(axis_rad), std::sin(axis_rad), 0));
  return {rotation, center_in_cam - rotation * center};
}

// Poses all over the image, tilted by up to 40 degrees; the board takes about a half of the image's width.
inline std::vector<Rigid3> VariedBoardPoses(const CalibrationBoard& board, const Camera& camera, int count,
                                            std::uint64_t seed) {
  Random random(seed);
  std::vector<Rigid3> poses;
  while (static_cast<int>(poses.size()) < count) {
    const Eigen::Vector2d pixel(random.Uniform(0.2, 0.8) * camera.width(), random.Uniform(0.2, 0.8) * camera.height());
    const auto ray = camera.Unproject(pixel);
    if (!ray) continue;
    const double width_mm = board.spacing_mm * board.columns;
    const double distance_mm = random.Uniform(1.2, 2.0) * width_mm * camera.MeanFocalLengthPx() / camera.width();
    const Rigid3 pose = BoardPoseAt(board, distance_mm * *ray, random.Uniform(0.1, 0.7), random.Uniform(0.0, 6.28));
    bool is_seen = true;
    for (const Eigen::Vector3d& point : board.Points()) {
      const auto seen = camera.Project(pose * point);
      is_seen = is_seen && seen && camera.Contains(*seen, 8);
    }
    if (is_seen) poses.push_back(pose);
  }
  return poses;
}

// All points, with normal noise of this standard deviation in each direction.
inline BoardView ViewOf(const CalibrationBoard& board, const Camera& camera, const Rigid3& cam_from_board,
                        double noise_px, Random* random) {
  BoardView view;
  int id = 0;
  for (const Eigen::Vector3d& point : board.Points()) {
    const auto pixel = camera.Project(cam_from_board * point);
    view.point_ids.push_back(id++);
    view.pixels.push_back(*pixel + Eigen::Vector2d(random->Normal(noise_px), random->Normal(noise_px)));
  }
  return view;
}

inline std::vector<BoardView> ViewsOf(const CalibrationBoard& board, const Camera& camera,
                                      const std::vector<Rigid3>& poses, double noise_px, std::uint64_t seed) {
  Random random(seed);
  std::vector<BoardView> views;
  for (const Rigid3& pose : poses) views.push_back(ViewOf(board, camera, pose, noise_px, &random));
  return views;
}

// An image of a chessboard, 8x8 rays a pixel, white around its squares and gray beyond.
inline cv::Mat ImageOf(const CalibrationBoard& board, const Camera& camera, const Rigid3& cam_from_board) {
  constexpr int kRays = 8;
  const Rigid3 board_from_cam = cam_from_board.Inverse();
  const auto level_at = [&](const Eigen::Vector2d& pixel) {
    const auto ray = camera.Unproject(pixel);
    if (!ray) return 0.0;
    const Eigen::Vector3d direction = board_from_cam.rotation * *ray;
    const double distance = -board_from_cam.translation.z() / direction.z();
    if (!(distance > 0)) return 90.0;
    const Eigen::Vector3d at = board_from_cam.translation + distance * direction;
    const int column = static_cast<int>(std::floor(at.x() / board.spacing_mm)) + 1;  // 0: the first square
    const int row = static_cast<int>(std::floor(at.y() / board.spacing_mm)) + 1;
    if (column < -1 || row < -1 || column > board.columns + 1 || row > board.rows + 1) return 90.0;
    const bool is_square = column >= 0 && row >= 0 && column <= board.columns && row <= board.rows;
    return is_square && (column + row) % 2 == 0 ? 30.0 : 220.0;
  };
  cv::Mat image(camera.height(), camera.width(), CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      double sum = 0;
      for (int i = 0; i < kRays * kRays; ++i)
        sum += level_at({x - 0.5 + (i % kRays + 0.5) / kRays, y - 0.5 + (i / kRays + 0.5) / kRays});
      image.at<unsigned char>(y, x) = static_cast<unsigned char>(std::lround(sum / (kRays * kRays)));
    }
  }
  cv::Mat blurred;
  cv::GaussianBlur(image, blurred, {}, 0.7);
  return blurred;
}

}  // namespace pliant
