// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/board_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "pliant/base/random.h"
#include "pliant/board/board.h"
#include "pliant/camera/camera.h"

namespace pliant::simulation {
namespace {

constexpr double kTremorMargin = 0.02;  // of the image's width
constexpr double kNearestMm = 5.0;      // of a point before the camera

// A spacing around the points: around all squares, and well around circles. Points at the edge of the image are found
// less well.
std::vector<Eigen::Vector3d> Outline(const CalibrationBoard& board) {
  const double rim_mm = board.spacing_mm;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : board.Points()) last = last.cwiseMax(point);
  std::vector<Eigen::Vector3d> outline;
  constexpr int kSteps = 8;  // of a side: a lens bends it
  for (int i = 0; i <= kSteps; ++i) {
    const double x = -rim_mm + (last.x() + 2 * rim_mm) * i / kSteps;
    const double y = -rim_mm + (last.y() + 2 * rim_mm) * i / kSteps;
    outline.insert(outline.end(),
                   {{x, -rim_mm, 0}, {x, last.y() + rim_mm, 0}, {-rim_mm, y, 0}, {last.x() + rim_mm, y, 0}});
  }
  return outline;
}

class Photographer {
 public:
  Photographer(const SimulationOptions& options, const CalibrationBoard& board, const Camera& camera)
      : camera_(camera),
        baseline_mm_(options.camera.baseline_mm),
        outline_(Outline(board)),
        center_(0.5 * (outline_.front() + outline_.back())),
        width_mm_((outline_.back() - outline_.front()).cwiseAbs().maxCoeff()),
        random_(Random(static_cast<std::uint64_t>(options.scene.seed)).Child("board")) {}

  // cam_from_board of a view at random; nothing where it does not show all of the board.
  std::optional<Rigid3> Draw() {
    const Eigen::Vector2d pixel(random_.Uniform(0.0, camera_.width()), random_.Uniform(0.0, camera_.height()));
    const double direction = random_.Uniform(0.0, 2.0 * std::numbers::pi);
    const double tilt_rad = random_.Uniform(5.0, 40.0) * std::numbers::pi / 180.0;
    const double distance_mm = random_.Uniform(0.7, 1.5) * width_mm_ * camera_.MeanFocalLengthPx() / camera_.width();
    const auto ray = camera_.Unproject(pixel);
    if (!ray) return std::nullopt;
    const Eigen::Quaterniond turn =
        RotationExp(tilt_rad * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0.0));
    const Rigid3 cam_from_board(turn, distance_mm * *ray - turn * center_);
    for (const Eigen::Vector3d& point : outline_) {
      const Eigen::Vector3d in_cam = cam_from_board * point;
      if (!IsSeen(in_cam) || (baseline_mm_ > 0 && !IsSeen(in_cam - Eigen::Vector3d(baseline_mm_, 0, 0))))
        return std::nullopt;
    }
    return cam_from_board;
  }

 private:
  bool IsSeen(const Eigen::Vector3d& in_cam) const {
    if (in_cam.z() < kNearestMm) return false;
    const auto pixel = camera_.Project(in_cam);
    return pixel && camera_.Contains(*pixel, kTremorMargin * camera_.width());
  }

  const Camera& camera_;
  double baseline_mm_;
  std::vector<Eigen::Vector3d> outline_;
  Eigen::Vector3d center_;
  double width_mm_;
  Random random_;
};

}  // namespace

Result<std::vector<Rigid3>> BoardViews(const SimulationOptions& options) {
  if (options.scene.kind != SceneKind::kBoard)
    return {ErrorCode::kInvalidArgument, "Trajectory.kind board shows a board from all sides; give Scene.kind board"};
  const auto board = ParseBoard(options.scene.board);
  if (!board.ok()) return board.status();
  const auto camera = SimulatedCamera(options);
  if (!camera.ok()) return camera.status();
  const double last_s = options.trajectory.frames / options.trajectory.fps;  // to the end of the last frame
  const auto count = static_cast<std::size_t>(std::ceil(last_s / options.trajectory.view_s)) + 1;
  constexpr int kTries = 20000;
  Photographer photographer(options, *board, *camera);
  std::vector<Rigid3> views;
  for (int tried = 0; views.size() < count;) {
    if (const auto cam_from_board = photographer.Draw()) {
      views.push_back(cam_from_board->Inverse());
      tried = 0;
    } else if (++tried == kTries) {
      return {ErrorCode::kInvalidArgument, "the camera does not see all of the " + board->Title() +
                                               " from anywhere; give Scene.board fewer points or a larger spacing, or "
                                               "the camera a wider field of view"};
    }
  }
  return views;
}

}  // namespace pliant::simulation
