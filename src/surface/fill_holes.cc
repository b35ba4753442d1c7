// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/fill_holes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <opencv2/imgproc.hpp>

#include "pliant/base/statistics.h"
#include "surface/depth_holes.h"

namespace pliant {
namespace {

constexpr int kMinRadiusPx = 3;  // of what counts as around a hole

struct KnownPixel {
  cv::Point at;
  double inverse_depth = 0;
  double sigma = 0;  // relative
};

// Inverse depth over the pixels around a middle.
struct Plane {
  Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();
  cv::Point2d middle;

  double At(cv::Point pixel) const { return coefficients.dot(Row(pixel)); }
  Eigen::Vector3d Row(cv::Point pixel) const { return {pixel.x - middle.x, pixel.y - middle.y, 1.0}; }
};

Plane FitPlane(const std::vector<KnownPixel>& known, cv::Point2d middle) {
  Plane plane{Eigen::Vector3d::Zero(), middle};
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sums = Eigen::Vector3d::Zero();
  for (const KnownPixel& pixel : known) {
    const Eigen::Vector3d row = plane.Row(pixel.at);
    products += row * row.transpose();
    sums += row * pixel.inverse_depth;
  }
  plane.coefficients = products.ldlt().solve(sums);
  return plane;
}

// A hole, and what is known around it.
struct Hole {
  std::vector<cv::Point> pixels;
  std::vector<KnownPixel> around;  // as far as the hole is wide
  std::vector<KnownPixel> rim;     // of these, the neighbors of the hole
};

// Nothing where the hole is not all tissue. `box`: of the hole, inside of the image by a pixel.
std::optional<Hole> HoleIn(const cv::Mat& labels, int label, const cv::Rect& box, const cv::Mat& tissue,
                           const DenseDepth& dense, int area) {
  const int radius = std::max(kMinRadiusPx, static_cast<int>(std::ceil(std::sqrt(area / std::numbers::pi))));
  const cv::Rect wide = cv::Rect(box.x - radius, box.y - radius, box.width + 2 * radius, box.height + 2 * radius) &
                        cv::Rect({0, 0}, labels.size());
  const cv::Mat inside = labels(wide) == label;
  cv::Mat near;
  cv::Mat beside;
  cv::dilate(inside, near, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1}));
  cv::dilate(inside, beside, cv::Mat::ones(3, 3, CV_8U));
  Hole hole;
  for (int y = 0; y < wide.height; ++y)
    for (int x = 0; x < wide.width; ++x) {
      const cv::Point at(wide.x + x, wide.y + y);
      if (inside.at<std::uint8_t>(y, x) != 0) {
        if (tissue.at<std::uint8_t>(at) == 0) return std::nullopt;
        hole.pixels.push_back(at);
      } else if (near.at<std::uint8_t>(y, x) != 0 && dense.depth.at<float>(at) > 0.0F) {
        hole.around.push_back({at, 1.0 / dense.depth.at<float>(at), dense.sigma.at<float>(at)});
        if (beside.at<std::uint8_t>(y, x) != 0) hole.rim.push_back(hole.around.back());
      }
    }
  return hole;
}

// The standard deviation of what a hole is filled with, relative; nothing where the pixels around are not a surface's.
std::optional<double> SigmaOfFilling(const Hole& hole, const Plane& plane, double largest_step) {
  std::vector<double> sigmas;
  double squares = 0.0;
  for (const KnownPixel& pixel : hole.around) {
    sigmas.push_back(pixel.sigma);
    squares += std::pow(1.0 - plane.At(pixel.at) / pixel.inverse_depth, 2);
  }
  const double sigma = Median(std::move(sigmas));
  const double off_plane = std::sqrt(squares / static_cast<double>(hole.around.size()));
  const double slope = plane.coefficients.head<2>().norm();
  if (!(plane.coefficients.z() > 0.0) || slope > largest_step * plane.coefficients.z() || off_plane > sigma)
    return std::nullopt;
  return std::hypot(sigma, off_plane);
}

// What the rim is off the plane, as far as each of its pixels is near.
double BendAt(const Hole& hole, const Plane& plane, cv::Point pixel) {
  double sum = 0.0;
  double weights = 0.0;
  for (const KnownPixel& known : hole.rim) {
    const cv::Point offset = known.at - pixel;
    const double weight = 1.0 / offset.dot(offset);
    sum += weight * (known.inverse_depth - plane.At(known.at));
    weights += weight;
  }
  return sum / weights;
}

}  // namespace

cv::Mat FillHoles(const Camera& camera, const cv::Mat& tissue, int max_area_px, DenseDepth* dense) {
  cv::Mat filled(dense->depth.size(), CV_8U, cv::Scalar(0));
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centers;
  const int count = cv::connectedComponentsWithStats(dense->depth == 0.0F, labels, stats, centers, 8, CV_32S);
  const double largest_step = LargestStepOfASurface(camera.MeanFocalLengthPx());
  const cv::Rect inner(1, 1, labels.cols - 2, labels.rows - 2);
  const DenseDepth measured{dense->depth.clone(), dense->sigma.clone()};
  for (int label = 1; label < count; ++label) {
    const cv::Rect box(stats.at<int>(label, cv::CC_STAT_LEFT), stats.at<int>(label, cv::CC_STAT_TOP),
                       stats.at<int>(label, cv::CC_STAT_WIDTH), stats.at<int>(label, cv::CC_STAT_HEIGHT));
    const int area = stats.at<int>(label, cv::CC_STAT_AREA);
    if (area > max_area_px || (box & inner) != box) continue;
    const auto hole = HoleIn(labels, label, box, tissue, measured, area);
    if (!hole) continue;
    const Plane plane = FitPlane(hole->around, {centers.at<double>(label, 0), centers.at<double>(label, 1)});
    const auto sigma = SigmaOfFilling(*hole, plane, largest_step);
    if (!sigma) continue;
    for (const cv::Point& pixel : hole->pixels) {
      const double inverse_depth = plane.At(pixel) + BendAt(*hole, plane, pixel);
      if (!(inverse_depth > 0.0)) continue;
      dense->depth.at<float>(pixel) = static_cast<float>(1.0 / inverse_depth);
      dense->sigma.at<float>(pixel) = static_cast<float>(*sigma);
      filled.at<std::uint8_t>(pixel) = 255;
    }
  }
  return filled;
}

}  // namespace pliant
