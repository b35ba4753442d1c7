// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Properties of every camera model.
#include "pliant/camera/camera.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <ceres/jet.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "camera/camera_cases.h"

namespace pliant {
namespace {

constexpr double kUnitLength = 1e-15;    // the last bits of one
constexpr double kWorstRay = 1e-14;      // rad at a gain of one; divided by the gain where the distortion flattens
constexpr double kParallel = 1e-10;      // sine of the angle; rounding, amplified where the distortion flattens
constexpr double kPixelRounding = 1e-9;  // px, of coordinates of about 1000
constexpr double kJacobian = 1e-12;      // relative to the Jacobian's norm: two ways to round the same formula
constexpr double kOracle = 1e-8;         // px; OpenCV computes in double, but in another order and from rotated points

class EveryCamera : public testing::TestWithParam<CameraCase> {
 protected:
  const Camera camera_ = GetParam().Make();
};
INSTANTIATE_TEST_SUITE_P(Model, EveryCamera, testing::ValuesIn(CameraCases()), CaseName);

TEST_P(EveryCamera, KeepsWhatItWasMadeFrom) {
  EXPECT_EQ(camera_.model_name(), GetParam().model);
  EXPECT_EQ(camera_.width(), GetParam().width);
  EXPECT_EQ(camera_.height(), GetParam().height);
  EXPECT_EQ(std::vector<double>(camera_.params().begin(), camera_.params().end()), GetParam().params);
}

TEST_P(EveryCamera, ResizedSeesEveryPointAtTheSamePlaceOfTheImage) {
  const Eigen::Vector3d point(4, -3, 40);
  const auto pixel = camera_.Project(point);
  ASSERT_TRUE(pixel);
  for (const double scale : {0.25, 1.0 / 3.0, 2.0}) {
    const auto resized = camera_.Resized(scale);
    ASSERT_TRUE(resized.ok()) << resized.status().message();
    EXPECT_EQ(resized->width(), std::lround(scale * camera_.width()));
    const Eigen::Vector2d expected = scale * (pixel->array() + 0.5) - 0.5;
    EXPECT_LT((*resized->Project(point) - expected).norm(), kPixelRounding) << scale;
  }
}

TEST_P(EveryCamera, ALongerFocalLengthMagnifiesAboutThePrincipalPoint) {
  constexpr double kFactor = 1.25;
  const auto longer = camera_.WithFocalLengthTimes(kFactor);
  ASSERT_TRUE(longer.ok()) << longer.status().message();
  const Eigen::Vector3d point(4, -3, 40);
  const Eigen::Vector2d center = *camera_.Project(Eigen::Vector3d::UnitZ());
  const Eigen::Vector2d expected = center + kFactor * (*camera_.Project(point) - center);
  EXPECT_LT((*longer->Project(point) - expected).norm(), kPixelRounding);
  EXPECT_FALSE(camera_.WithFocalLengthTimes(0).ok());
}

TEST_P(EveryCamera, ProjectsUnprojectedPixelsOntoThemselves) {
  int seen = 0;
  for (const Eigen::Vector2d& pixel : PixelGrid(camera_)) {
    const auto ray = camera_.Unproject(pixel);
    if (!ray) continue;
    ++seen;
    EXPECT_NEAR(ray->norm(), 1.0, kUnitLength);
    const auto again = camera_.Project(*ray);
    ASSERT_TRUE(again) << pixel.transpose();
    EXPECT_LT((*again - pixel).norm(), kPixelRounding) << pixel.transpose();
  }
  // Only the real fisheye's black corners have no ray.
  const int total = static_cast<int>(PixelGrid(camera_).size());
  if (GetParam().label == "FisheyeEndomapper") {
    EXPECT_GT(seen, total * 9 / 10);
    EXPECT_LT(seen, total);
  } else {
    EXPECT_EQ(seen, total);
  }
}

TEST_P(EveryCamera, UnprojectsProjectedPointsOntoTheirRays) {
  for (const Eigen::Vector3d& point : SeenPoints(camera_, 500)) {
    const auto pixel = camera_.Project(point);
    ASSERT_TRUE(pixel);
    const auto ray = camera_.Unproject(*pixel);
    ASSERT_TRUE(ray);
    // Where the distortion is about to fold, a pixel determines its ray less well than to rounding.
    const double gain = camera_.ProjectWithJacobian(point)->d_pixel_d_point.jacobiSvd().singularValues()[1] *
                        point.norm() / camera_.MeanFocalLengthPx();
    EXPECT_LT(ray->cross(point.normalized()).norm(), std::max(kParallel, kWorstRay / gain)) << point.transpose();
    EXPECT_GT(ray->dot(point), 0.0);
  }
}

TEST_P(EveryCamera, HasTheJacobianOfAutomaticDerivatives) {
  using Jet = ceres::Jet<double, 3>;
  std::vector<Eigen::Vector3d> points = SeenPoints(camera_, 500);
  for (const double offset : {0.0, 1e-9, 1e-5, 4.9e-3, 5.1e-3})  // across the fisheye's series near the axis
    points.emplace_back(offset, -0.3 * offset, 50);
  for (const Eigen::Vector3d& point : points) {
    const auto projection = camera_.ProjectWithJacobian(point);
    ASSERT_TRUE(projection) << point.transpose();
    const Jet jets[3] = {Jet(point.x(), 0), Jet(point.y(), 1), Jet(point.z(), 2)};
    Jet pixel[2];
    ASSERT_TRUE(camera_.Visit([&](const auto& model) { return model.Project(jets, pixel); }));
    Eigen::Matrix<double, 2, 3> expected;
    expected << pixel[0].v.transpose(), pixel[1].v.transpose();
    EXPECT_LT((projection->d_pixel_d_point - expected).norm(), kJacobian * expected.norm()) << point.transpose();
    EXPECT_LT((projection->pixel - *camera_.Project(point)).norm(), kPixelRounding);
  }
}

TEST_P(EveryCamera, AgreesWithOpenCv) {
  const std::vector<double>& p = GetParam().params;
  const bool one_focal = GetParam().model.find("SIMPLE") == 0 || GetParam().model == "RADIAL";
  const std::size_t first_distortion = one_focal ? 3 : 4;
  const cv::Matx33d k(p[0], 0, p[first_distortion - 2], 0, p[one_focal ? 0 : 1], p[first_distortion - 1], 0, 0, 1);
  cv::Vec4d distortion(0, 0, 0, 0);
  for (std::size_t i = first_distortion; i < p.size(); ++i) distortion[static_cast<int>(i - first_distortion)] = p[i];
  std::vector<cv::Point3d> points;
  for (const Eigen::Vector3d& x : SeenPoints(camera_, 200))
    if (x.z() > 0.01 * x.norm()) points.emplace_back(x.x(), x.y(), x.z());  // OpenCV's fisheye divides by z
  ASSERT_FALSE(points.empty());
  std::vector<cv::Point2d> pixels;
  const cv::Vec3d zero(0, 0, 0);
  if (GetParam().model == "OPENCV_FISHEYE") {
    cv::fisheye::projectPoints(points, pixels, zero, zero, k, distortion);
  } else {
    cv::projectPoints(points, zero, zero, k, distortion, pixels);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel = camera_.Project(Eigen::Vector3d(points[i].x, points[i].y, points[i].z));
    ASSERT_TRUE(pixel);
    EXPECT_LT((*pixel - Eigen::Vector2d(pixels[i].x, pixels[i].y)).norm(), kOracle);
  }
}

TEST_P(EveryCamera, GivesBatchesTheSameAnswersAsSinglePoints) {
  std::vector<Eigen::Vector3d> points = SeenPoints(camera_, 20);
  points.emplace_back(0, 0, -1);
  const auto pixels = camera_.Project(points);
  ASSERT_EQ(pixels.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(pixels[i], camera_.Project(points[i]));
  const std::vector<Eigen::Vector2d> grid = PixelGrid(camera_, 5, 5);
  const auto rays = camera_.Unproject(grid);
  ASSERT_EQ(rays.size(), grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) EXPECT_EQ(rays[i], camera_.Unproject(grid[i]));
}

TEST_P(EveryCamera, RefusesWhatIsNotAPointOrAPixel) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(kNan, 0, 1), Eigen::Vector3d(0, kNan, 1), Eigen::Vector3d(0, 0, kNan),
        Eigen::Vector3d(kInfinity, 0, 1), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e300, 1e300, 1)}) {
    EXPECT_FALSE(camera_.Project(point)) << point.transpose();
    EXPECT_FALSE(camera_.ProjectWithJacobian(point)) << point.transpose();
  }
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(kNan, 0), Eigen::Vector2d(0, kNan),
                                       Eigen::Vector2d(kInfinity, 0), Eigen::Vector2d(0, -kInfinity)})
    EXPECT_FALSE(camera_.Unproject(pixel)) << pixel.transpose();
}

TEST_P(EveryCamera, RefusesPointsOnTheAxisBehindIt) {
  EXPECT_FALSE(camera_.Project(Eigen::Vector3d(0, 0, -1)));
  EXPECT_FALSE(camera_.ProjectWithJacobian(Eigen::Vector3d(0, 0, -1)));
  const bool fisheye = GetParam().model == "OPENCV_FISHEYE";
  if (fisheye) return;
  for (const double z : {-1e-12, 0.0, -5.0}) EXPECT_FALSE(camera_.Project(Eigen::Vector3d(0.1, 0.2, z))) << z;
}

// No two directions share a pixel: along any direction, the distance to the principal point only grows until the edge.
TEST_P(EveryCamera, GrowsFromTheAxisToTheEdgeOfItsDomain) {
  const Eigen::Vector2d center = *camera_.Project(Eigen::Vector3d(0, 0, 1));
  for (int i = 0; i < 12; ++i) {
    const double azimuth = i * std::numbers::pi / 6;
    double last = -1;
    bool ended = false;
    for (double theta = 0; theta < std::numbers::pi; theta += 1e-3) {
      const Eigen::Vector3d ray(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth),
                                std::cos(theta));
      const auto pixel = camera_.Project(ray);
      if (!pixel) ended = true;
      if (!pixel) continue;
      EXPECT_FALSE(ended) << "the domain has a hole before theta = " << theta;
      const double distance = (*pixel - center).norm();
      EXPECT_GT(distance, last) << theta;
      last = distance;
    }
    EXPECT_TRUE(ended);
  }
}

}  // namespace
}  // namespace pliant
