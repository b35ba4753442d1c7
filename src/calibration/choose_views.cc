// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/calibration/choose_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include <opencv2/calib3d.hpp>

#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr double kAlikeShare = 0.01;  // of the image's diagonal
constexpr int kCells = 12;

// What advice is given below, or above.
constexpr int kFewViews = 8;
constexpr double kSmallTilt_deg = 25;
constexpr double kLargeFocalLengthSigma = 0.01;
constexpr double kManyOutliers = 0.2;
constexpr double kLargeRms = 0.002;  // of the longer side of the image
// Of the image's diagonal: 1 px of 640x480. Good images determine its corners to 0.1 to 0.6 px.
constexpr double kLargeBorderError = 0.00125;
// Of the way from the principal point to the farthest corner. What the points hide of a distortion's term of fifth
// order is six times as large in the corner as at the outermost point.
constexpr double kShortReach = 0.7;
// A focal length that differs between the halves of the images by so many standard deviations, by those of their
// points, which know nothing of what the points of a view share, and by those of the views, and by more than matters to
// a reconstruction. The views' are found without one of eight groups after the other, and a change is a part of them:
// of two values, each in four of the groups, the difference is 2.6 times what they give.
constexpr double kChangePointSigmas = 9;
constexpr double kChangeViewSigmas = 2;
constexpr double kLargeChange = 0.005;

using Outline = std::array<Eigen::Vector2d, 4>;

// Where the board's outermost points are in the image, by the homography to those that are seen.
Outline OutlineOf(const CalibrationBoard& board, const std::vector<Eigen::Vector3d>& points, const BoardView& view) {
  std::vector<cv::Point2d> on_board;
  std::vector<cv::Point2d> in_image;
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    const Eigen::Vector3d& point = points[static_cast<std::size_t>(view.point_ids[i])];
    on_board.emplace_back(point.x(), point.y());
    in_image.emplace_back(view.pixels[i].x(), view.pixels[i].y());
  }
  const cv::Mat homography = cv::findHomography(on_board, in_image);
  const int last = board.NumPoints() - 1;
  const std::array<int, 4> corners = {0, board.columns - 1, last, last - board.columns + 1};
  Outline outline;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d& corner = points[static_cast<std::size_t>(corners[i])];
    const auto seen = std::find(view.point_ids.begin(), view.point_ids.end(), corners[i]);
    if (seen != view.point_ids.end()) {
      outline[i] = view.pixels[static_cast<std::size_t>(seen - view.point_ids.begin())];
    } else if (homography.empty()) {
      outline[i] = view.pixels.front();
    } else {
      std::vector<cv::Point2d> projected;
      cv::perspectiveTransform(std::vector<cv::Point2d>{{corner.x(), corner.y()}}, projected, homography);
      outline[i] = {projected[0].x, projected[0].y};
    }
  }
  return outline;
}

double AreaOf(const Outline& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
    twice += a.x() * b.y() - b.x() * a.y();
  }
  return 0.5 * std::abs(twice);
}

double Distance(const Outline& a, const Outline& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

// Calls `function(x, y)` with the place in the image, 0 to 1 along each side, of every point that was used.
template <class Function>
void ForEachUsedPoint(std::span<const BoardView> views, const CameraCalibration& calibration, Function&& function) {
  for (std::size_t view = 0; view < views.size(); ++view) {
    if (calibration.views[view].is_outlier) continue;
    for (const Eigen::Vector2d& pixel : views[view].pixels)
      function(std::clamp((pixel.x() + 0.5) / calibration.camera.width(), 0.0, 1.0 - 1e-9),
               std::clamp((pixel.y() + 0.5) / calibration.camera.height(), 0.0, 1.0 - 1e-9));
  }
}

// Three by three, row by row.
constexpr std::array<std::string_view, 9> kPartNames = {
    "upper left", "top", "upper right", "left", "center", "right", "lower left", "bottom", "lower right"};

// Parts of the image without a point: "the upper left, the right".
std::string EmptyParts(std::span<const BoardView> views, const CameraCalibration& calibration) {
  std::array<bool, 9> seen{};
  ForEachUsedPoint(views, calibration, [&](double x, double y) {
    seen[3 * static_cast<std::size_t>(3 * y) + static_cast<std::size_t>(3 * x)] = true;
  });
  std::string parts;
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (!seen[i]) parts += (parts.empty() ? "the " : ", the ") + std::string(kPartNames[i]);
  return parts;
}

// A pixel of the border in words.
std::string BorderName(const Camera& camera, const Eigen::Vector2d& pixel) {
  const auto third = [](double at, int size) {
    return static_cast<std::size_t>(std::lround(2 * at / std::max(1, size - 1)));
  };
  return "the " + std::string(kPartNames[3 * third(pixel.y(), camera.height()) + third(pixel.x(), camera.width())]);
}

// How far from the principal point the outermost point lies, by the farthest pixel of the border.
double Reach(std::span<const BoardView> views, const CameraCalibration& calibration) {
  const Camera& camera = calibration.camera;
  const auto center = camera.Project(Eigen::Vector3d::UnitZ());
  double farthest = 0;
  for (const PixelAccuracy& place : calibration.border) farthest = std::max(farthest, (place.pixel - *center).norm());
  double outermost = 0;
  ForEachUsedPoint(views, calibration, [&](double x, double y) {
    const Eigen::Vector2d pixel(x * camera.width() - 0.5, y * camera.height() - 0.5);
    outermost = std::max(outermost, (pixel - *center).norm());
  });
  return farthest > 0 ? outermost / farthest : 1;
}

// Where the image's border is not known well.
std::vector<std::string> BorderAdvice(std::span<const BoardView> views, const CameraCalibration& calibration) {
  const Camera& camera = calibration.camera;
  const double large_px = kLargeBorderError * std::hypot(camera.width(), camera.height());
  std::vector<std::string> advice;
  if (const double reach = Reach(views, calibration); reach < kShortReach)
    advice.push_back("the outermost point of the board is at " + Percent(reach) +
                     " of the way from the center of the image to its corners, and beyond it the distortion is "
                     "extrapolated; take images with the board in the corners");
  if (calibration.border.empty()) return advice;
  const auto& least_known = *std::ranges::max_element(calibration.border, {}, &PixelAccuracy::sigma_px);
  if (const std::string where = BorderName(camera, least_known.pixel); std::isinf(least_known.sigma_px)) {
    advice.push_back("at " + where +
                     " of the image the distortion folds over, and no ray is seen; take images with the board there");
  } else if (least_known.sigma_px > large_px) {
    advice.push_back("at " + where + " of the image the camera is known to " + Digits(least_known.sigma_px, 1) +
                     " px only (standard deviation); take images with the board there");
  }
  const auto& ambiguous = *std::ranges::max_element(calibration.border, {}, &PixelAccuracy::model_gap_px);
  if (ambiguous.model_gap_px > large_px)
    advice.push_back("the model " + std::string(EnumName(ambiguous.gap_model)) +
                     " explains the images as well, and differs by " + Digits(ambiguous.model_gap_px, 1) + " px at " +
                     BorderName(camera, ambiguous.pixel) + " of the image; take images with the board there");
  return advice;
}

// Nothing, or how the focal length changed from the first half of the images to the second.
std::string ZoomAdvice(const CameraCalibration& calibration) {
  if (calibration.half_focal_lengths.size() != 2) return "";
  const FocalLengthEstimate& first = calibration.half_focal_lengths[0];
  const FocalLengthEstimate& second = calibration.half_focal_lengths[1];
  const double change_px = std::abs(second.px - first.px);
  // Halves of images that determine a focal length to s determine their difference to 2 s.
  const double sigma_px = 2 * calibration.FocalLengthSigmaPx();
  const double least_px =
      std::max({kChangePointSigmas * std::hypot(first.sigma_px, second.sigma_px), kChangeViewSigmas * sigma_px,
                kLargeChange * calibration.camera.MeanFocalLengthPx()});
  if (change_px < least_px) return "";
  return "the focal length is " + Digits(first.px, 1) + " px in the first half of the images and " +
         Digits(second.px, 1) + " px in the second (+- " + Digits(sigma_px, 1) +
         "); calibrate every zoom and focus by itself";
}

}  // namespace

std::vector<int> ChooseVariedViews(const CalibrationBoard& board, std::span<const BoardView> views, int width,
                                   int height, int max_views) {
  if (views.empty()) return {};
  const std::vector<Eigen::Vector3d> points = board.Points();
  std::vector<Outline> outlines;
  for (const BoardView& view : views) outlines.push_back(OutlineOf(board, points, view));
  const double alike_px = kAlikeShare * std::hypot(width, height);
  std::vector<double> nearest(views.size(), std::numeric_limits<double>::infinity());
  std::vector<int> chosen;
  std::size_t next = 0;
  for (std::size_t i = 1; i < views.size(); ++i)
    if (AreaOf(outlines[i]) > AreaOf(outlines[next])) next = i;
  while (static_cast<int>(chosen.size()) < max_views && nearest[next] > alike_px) {
    chosen.push_back(static_cast<int>(next));
    for (std::size_t i = 0; i < views.size(); ++i)
      nearest[i] = std::min(nearest[i], Distance(outlines[i], outlines[next]));
    next = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

double CoveredShare(std::span<const BoardView> views, const CameraCalibration& calibration) {
  const Camera& camera = calibration.camera;
  const double cell_px = static_cast<double>(std::max(camera.width(), camera.height())) / kCells;
  const int columns = std::max(1, static_cast<int>(std::lround(camera.width() / cell_px)));
  const int rows = std::max(1, static_cast<int>(std::lround(camera.height() / cell_px)));
  std::vector<bool> seen(static_cast<std::size_t>(columns * rows), false);
  ForEachUsedPoint(views, calibration, [&](double x, double y) {
    seen[static_cast<std::size_t>(static_cast<int>(rows * y) * columns + static_cast<int>(columns * x))] = true;
  });
  return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / static_cast<double>(seen.size());
}

std::vector<std::string> CalibrationAdvice(std::span<const BoardView> views, const CameraCalibration& calibration) {
  std::vector<std::string> advice;
  int used = 0;
  double tilt_deg = 0;
  for (const FittedView& view : calibration.views) {
    if (view.is_outlier) continue;
    ++used;
    tilt_deg = std::max(tilt_deg, view.tilt_deg);
  }
  const int outliers = static_cast<int>(calibration.views.size()) - used;
  const double sigma = calibration.FocalLengthSigmaPx() / calibration.camera.MeanFocalLengthPx();
  if (used < kFewViews)
    advice.push_back("only " + std::to_string(used) + " images were used; take 15 or more, from different sides");
  if (tilt_deg < kSmallTilt_deg)
    advice.push_back("the board is tilted by " + Digits(tilt_deg, 0) +
                     " degrees at most; tilt it by 30 to 45, in several directions");
  if (const std::string parts = EmptyParts(views, calibration); !parts.empty())
    advice.push_back("no point of the board lies in these parts of the image: " + parts +
                     "; the distortion is not known there");
  const std::vector<std::string> of_border = BorderAdvice(views, calibration);
  advice.insert(advice.end(), of_border.begin(), of_border.end());
  if (const std::string of_zoom = ZoomAdvice(calibration); !of_zoom.empty()) advice.push_back(of_zoom);
  if (sigma > kLargeFocalLengthSigma)
    advice.push_back("the focal length is known to " + Percent(sigma, 1) +
                     " only; take images in which the board is larger and tilted more");
  const double rms = calibration.rms_px / std::max(calibration.camera.width(), calibration.camera.height());
  if (rms > kLargeRms)
    advice.push_back("an error of " + Digits(calibration.rms_px, 2) +
                     " px is large for images of this size; look for blur, for a board that is not flat, for zoom that "
                     "changed, and whether --board and the model are those of the images");
  if (outliers > kManyOutliers * static_cast<double>(calibration.views.size()))
    advice.push_back(std::to_string(outliers) + " of " + std::to_string(calibration.views.size()) +
                     " images fit badly; look for blur, and whether the board is flat");
  return advice;
}

}  // namespace pliant
