// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/check_poses.h"

#include <cmath>
#include <optional>
#include <string>

#include <opencv2/imgproc.hpp>

#include "datasets/set_files.h"
#include "pliant/image/pyramid.h"

namespace pliant {
namespace {

constexpr double kFine_px = 1.5;
constexpr double kCoarse_px = 8.0;
// Lengths in m, dm and cm that are said to be in mm, and the other way round.
constexpr double kScales[] = {1.0, 10.0, 100.0, 1000.0, 0.1, 0.01, 0.001};

struct Meaning {
  const char* name;
  Rigid3 (*read)(const Rigid3& given);
};

// What was read as x y z w.
Rigid3 WFirst(const Rigid3& given) {
  const Eigen::Vector4d read = given.rotation.coeffs();
  return {Eigen::Quaterniond(read[0], read[1], read[2], read[3]), given.translation};
}

constexpr Meaning kOrders[] = {
    {"", [](const Rigid3& given) { return given; }},
    {"they are camera from world", [](const Rigid3& given) { return given.Inverse(); }},
    {"their rotations are transposed",
     [](const Rigid3& given) { return Rigid3(given.rotation.conjugate(), given.translation); }},
    {"their quaternions are w x y z, not x y z w", WFirst},
    {"they are camera from world, and their quaternions w x y z, not x y z w",
     [](const Rigid3& given) { return WFirst(given).Inverse(); }},
};

constexpr Meaning kAxes[] = {
    {"", [](const Rigid3& given) { return given; }},
    {"x is flipped (a left-handed world)",
     [](const Rigid3& given) {
       return Mirrored(given, {-1, 1, 1});
     }},
    {"y is flipped (a left-handed world)",
     [](const Rigid3& given) {
       return Mirrored(given, {1, -1, 1});
     }},
    {"z is flipped (a left-handed world)",
     [](const Rigid3& given) {
       return Mirrored(given, {1, 1, -1});
     }},
    {"the camera looks along -z, with y up (OpenGL)",
     [](const Rigid3& given) {
       return Rigid3(Eigen::Matrix3d(given.RotationMatrix() * Eigen::Vector3d(1, -1, -1).asDiagonal()),
                     given.translation);
     }},
};

struct SurfacePoint {
  Eigen::Vector3d position;  // in the camera of its image
  float structure = 0;
};

std::vector<SurfacePoint> PointsOf(const PosedImage& image, const Camera& camera, int max_points) {
  const double share = static_cast<double>(image.depth_mm.total()) / std::max(1, max_points);
  const int step = std::max(1, static_cast<int>(std::sqrt(share)));
  std::vector<SurfacePoint> points;
  for (int v = step / 2; v < image.depth_mm.rows; v += step)
    for (int u = step / 2; u < image.depth_mm.cols; u += step) {
      const float depth_mm = image.depth_mm.at<float>(v, u);
      const auto ray = camera.Unproject(Eigen::Vector2d(u, v));
      if (!(depth_mm > 0) || !ray || !(ray->z() > 0)) continue;
      points.push_back({depth_mm / ray->z() * *ray, image.structure.at<float>(v, u)});
    }
  return points;
}

// Of the structure where the points are with that in the other image; those outside of it count, as unrelated.
double Correlation(const std::vector<SurfacePoint>& points, const PosedImage& other, const Rigid3& other_from_cam,
                   const Camera& camera) {
  double squares_a = 0;
  double squares_b = 0;
  double products = 0;
  double all_a = 0;
  for (const SurfacePoint& point : points) {
    all_a += point.structure * point.structure;
    const auto pixel = camera.Project(other_from_cam * point.position);
    const auto there = pixel ? SampleBilinear(other.structure, pixel->x(), pixel->y()) : std::nullopt;
    if (!there) continue;
    squares_a += point.structure * point.structure;
    squares_b += *there * *there;
    products += point.structure * *there;
  }
  if (!(squares_a > 0) || !(squares_b > 0)) return 0;
  return products / std::sqrt(squares_a * squares_b) * (squares_a / all_a);
}

}  // namespace

cv::Mat FineStructure(const cv::Mat& image) {
  cv::Mat fine;
  ToGray(image).convertTo(fine, CV_32F);
  cv::Mat coarse;
  cv::GaussianBlur(fine, coarse, {}, kCoarse_px);
  cv::GaussianBlur(fine, fine, {}, kFine_px);
  fine -= coarse;
  cv::Mat squares;
  cv::GaussianBlur(fine.mul(fine), squares, {}, kCoarse_px);
  cv::sqrt(squares, squares);
  return fine / (squares + 1.0);
}

std::vector<PoseReading> CorrelateReadings(const std::vector<std::pair<const PosedImage*, const PosedImage*>>& pairs,
                                           const Camera& camera, int max_points) {
  std::vector<PoseReading> readings;
  std::vector<std::vector<SurfacePoint>> points;
  for (const auto& [image, other] : pairs) points.push_back(PointsOf(*image, camera, max_points));
  for (const Meaning& order : kOrders)
    for (const Meaning& axes : kAxes)
      for (const double scale : kScales) {
        PoseReading reading;
        reading.name = order.name;
        if (*axes.name != '\0') reading.name += (*order.name == '\0' ? "" : ", and ") + std::string(axes.name);
        reading.scale = scale;
        for (std::size_t k = 0; k < pairs.size(); ++k) {
          const auto read = [&](Rigid3 pose) {
            pose = axes.read(order.read(pose));
            pose.translation *= scale;
            return pose;
          };
          const auto& [image, other] = pairs[k];
          reading.correlation +=
              Correlation(points[k], *other, read(other->world_from_cam).Inverse() * read(image->world_from_cam),
                          camera) /
              static_cast<double>(pairs.size());
        }
        readings.push_back(std::move(reading));
      }
  return readings;
}

}  // namespace pliant
