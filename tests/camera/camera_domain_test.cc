// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The edges of the domains, and what Create refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "camera/camera_cases.h"
#include "camera/roots.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;

// A bound found by bisection to the last bit, through a square root.
constexpr double kBound = 1e-14;
constexpr double kPixel_px = 1e-9;        // round-off of coordinates of about 1000
constexpr double kNearlySingular = 1e-3;  // determinant of the Jacobian at the edge, relative to the focal length's

TEST(FisheyeCamera, SeesBeyond90Degrees) {
  const Camera camera =
      Camera::Create("OPENCV_FISHEYE", 800, 800, std::vector<double>{250, 250, 400, 400, 0, 0, 0, 0}).value();
  const double theta = 2.0;  // 115 degrees
  const Eigen::Vector3d ray(std::sin(theta), 0, std::cos(theta));
  ASSERT_LT(ray.z(), 0);
  const auto pixel = camera.Project(ray);
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 400 + 250 * theta, kPixel_px);
  const auto again = camera.Unproject(*pixel);
  ASSERT_TRUE(again);
  EXPECT_LT((*again - ray).norm(), kRoundOff);
  EXPECT_TRUE(camera.ProjectWithJacobian(Eigen::Vector3d(3, 4, 0)));  // beside it
}

TEST(FisheyeCamera, EndsWhereTheAngleStopsGrowing) {
  // theta_d = theta - 0.1 theta^3 stops growing at theta^2 = 1 / 0.3.
  const OpenCvFisheye model({250, 250, 400, 400, -0.1, 0, 0, 0});
  const double edge = std::sqrt(1 / 0.3);
  EXPECT_NEAR(model.max_theta(), edge, kBound);
  double pixel[2];
  const double inside[3] = {std::sin(edge - 1e-9), 0, std::cos(edge - 1e-9)};
  const double outside[3] = {std::sin(edge + 1e-9), 0, std::cos(edge + 1e-9)};
  EXPECT_TRUE(model.Project(inside, pixel));
  EXPECT_FALSE(model.Project(outside, pixel));
  double ray[3];
  const double theta_d = edge * (1 - 0.1 * edge * edge);
  const double last[2] = {400 + 250 * theta_d * (1 - 1e-12), 400};
  const double beyond[2] = {400 + 250 * theta_d * (1 + 1e-12), 400};
  EXPECT_TRUE(model.Unproject(last, ray));
  EXPECT_FALSE(model.Unproject(beyond, ray));
}

TEST(FisheyeCamera, StopsShortOfTheRayBehindIt) {
  const OpenCvFisheye model({250, 250, 400, 400, 0, 0, 0, 0});
  EXPECT_NEAR(model.max_theta(), std::numbers::pi - 1e-3, kBound);
}

TEST(RadialCamera, EndsWhereTheDistortionStopsGrowing) {
  // r - 0.3 r^3 stops growing at r^2 = 1 / 0.9.
  const SimpleRadial model({500, 320, 240, -0.3});
  const double edge = std::sqrt(1 / 0.9);
  EXPECT_NEAR(model.max_radius(), edge, kBound);
  double pixel[2];
  const double inside[3] = {0, edge - 1e-9, 1};
  const double outside[3] = {0, edge + 1e-9, 1};
  EXPECT_TRUE(model.Project(inside, pixel));
  EXPECT_FALSE(model.Project(outside, pixel));
  double ray[3];
  const double distorted = edge * (1 - 0.3 * edge * edge);
  const double last[2] = {320, 240 + 500 * distorted * (1 - 1e-12)};
  const double beyond[2] = {320, 240 + 500 * distorted * (1 + 1e-12)};
  EXPECT_TRUE(model.Unproject(last, ray));
  EXPECT_FALSE(model.Unproject(beyond, ray));
}

TEST(RadialCamera, EndsAtTheFirstFoldThoughTheDistortionGrowsAgain) {
  // The slope 1 - 3 r^2 + 1.25 r^4 is negative between its two roots.
  const Radial model({500, 320, 240, -1.0, 0.25});
  EXPECT_NEAR(model.max_radius(), std::sqrt((3 - std::sqrt(4.0)) / 2.5), kBound);
  double pixel[2];
  const double far_out[3] = {3, 0, 1};
  EXPECT_FALSE(model.Project(far_out, pixel));
}

TEST(OpenCvCamera, HasAPositiveDefiniteJacobianUpToItsEdge) {
  const OpenCv model({500, 500, 320, 240, -0.2, 0.01, 0.02, -0.03});
  const double edge = model.max_radius();
  double smallest = 1e9;
  for (int i = 0; i < 3600; ++i) {
    const double azimuth = i * std::numbers::pi / 1800;
    for (const double part : {0.1, 0.5, 0.9, 0.99, 1 - 1e-12}) {
      const double point[3] = {part * edge * std::cos(azimuth), part * edge * std::sin(azimuth), 1};
      double pixel[2];
      double j[6];
      ASSERT_TRUE(model.ProjectWithJacobian(point, pixel, j));
      EXPECT_GT(j[0] * j[4] - j[1] * j[3], 0.0);
      EXPECT_GT(j[0] + j[4], 0.0);
      smallest = std::min(smallest, (j[0] * j[4] - j[1] * j[3]) / (500 * 500));
    }
  }
  EXPECT_LT(smallest, kNearlySingular) << "the domain ends before it has to";
}

TEST(OpenCvCamera, FindsTheRayOfEveryPixelOrSaysThatThereIsNone) {
  // Far outside of the image too: an answer must project back, and a pixel that is known to have a ray must get one.
  const OpenCv model({500, 500, 320, 240, -0.2, 0.01, 0.02, -0.03});
  Random random(3);
  int answered = 0;
  for (int i = 0; i < 20000; ++i) {
    const double pixel[2] = {random.Uniform(-2000, 3000), random.Uniform(-2000, 3000)};
    double ray[3];
    if (!model.Unproject(pixel, ray)) continue;
    ++answered;
    double again[2];
    ASSERT_TRUE(model.Project(ray, again));
    EXPECT_LT(std::hypot(again[0] - pixel[0], again[1] - pixel[1]), kPixel_px);
  }
  EXPECT_GT(answered, 0);
  for (int i = 0; i < 20000; ++i) {
    const double radius = model.max_radius() * std::sqrt(random.Uniform()) * (1 - 1e-6);
    const double azimuth = random.Uniform(0, 2 * std::numbers::pi);
    const double point[3] = {radius * std::cos(azimuth), radius * std::sin(azimuth), 1};
    double pixel[2];
    double ray[3];
    ASSERT_TRUE(model.Project(point, pixel));
    ASSERT_TRUE(model.Unproject(pixel, ray)) << radius / model.max_radius();
  }
}

TEST(FirstRoot, IsTheSmallestOfSeveral) {
  // (1 - x)(2 - x)(3 - x) = 6 - 11 x + 6 x^2 - x^3
  const std::vector<double> cubic = {6, -11, 6, -1};
  ASSERT_TRUE(FirstRoot(cubic, 1e8));
  EXPECT_NEAR(*FirstRoot(cubic, 1e8), 1.0, kBound);
  EXPECT_FALSE(FirstRoot(cubic, 0.5));
  EXPECT_FALSE(FirstRoot(std::vector<double>{1, 0, 1}, 1e8));
}

struct Refusal {
  std::string label;
  std::string model;
  int width;
  int height;
  std::vector<double> params;
  std::string says;
};
void PrintTo(const Refusal& refusal, std::ostream* out) { *out << refusal.label; }

std::string RefusalName(const testing::TestParamInfo<Refusal>& info) { return info.param.label; }

class CameraCreate : public testing::TestWithParam<Refusal> {};

TEST_P(CameraCreate, RefusesAndSaysWhy) {
  const auto camera = Camera::Create(GetParam().model, GetParam().width, GetParam().height, GetParam().params);
  ASSERT_FALSE(camera.ok());
  EXPECT_EQ(camera.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(camera.status().message(), HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    BadInput, CameraCreate,
    testing::Values(
        Refusal{"UnknownModel", "OPENCV_FISHEY", 64, 48, {1, 2, 3}, "did you mean 'OPENCV_FISHEYE'?"},
        Refusal{"TooFew", "PINHOLE", 64, 48, {1, 2, 3}, "takes 4 parameters (fx,fy,cx,cy) and got 3"},
        Refusal{"TooMany", "SIMPLE_PINHOLE", 64, 48, {1, 2, 3, 4}, "takes 3 parameters"},
        Refusal{
            "FocalLengthInMeters", "PINHOLE", 64, 48, {0.004, 0.004, 32, 24}, "focal length of 0.004 px for an image"},
        Refusal{"FocalLengthAbsurd", "PINHOLE", 64, 48, {1e300, 1e300, 32, 24}, "check the parameters' order"},
        Refusal{"CenterFarOutside", "PINHOLE", 64, 48, {50, 50, 1e9, 24}, "principal point at (1e+09, 24)"},
        Refusal{"NotANumber", "PINHOLE", 64, 48, {50, 50, std::nan(""), 24}, "number 3 of fx,fy,cx,cy"},
        Refusal{"Infinite", "OPENCV", 64, 48, {50, 50, 32, 24, 0, INFINITY, 0, 0}, "not a finite number"},
        Refusal{"NoWidth", "PINHOLE", 0, 48, {50, 50, 32, 24}, "image size of 0x48"},
        Refusal{"NegativeHeight", "PINHOLE", 64, -48, {50, 50, 32, 24}, "image size of 64x-48"},
        Refusal{"NegativeFocal", "PINHOLE", 64, 48, {50, -50, 32, 24}, "focal length of -50"},
        Refusal{"ZeroFocal", "OPENCV_FISHEYE", 64, 48, {0, 50, 32, 24, 0, 0, 0, 0}, "focal length of 0"},
        Refusal{"FoldsInside", "SIMPLE_RADIAL", 640, 480, {300, 320, 240, -2}, "folds over inside the image"},
        Refusal{"FisheyeFolds", "OPENCV_FISHEYE", 640, 480, {300, 300, 320, 240, -2, 0, 0, 0}, "folds over"}),
    RefusalName);

TEST(Camera, ContainsThePixelsOfItsImage) {
  const Camera camera = Camera::Create("PINHOLE", 64, 48, std::vector<double>{50, 50, 32, 24}).value();
  EXPECT_TRUE(camera.Contains({0, 0}));
  EXPECT_TRUE(camera.Contains({63, 47}));
  EXPECT_FALSE(camera.Contains({63.01, 47}));
  EXPECT_FALSE(camera.Contains({-0.01, 0}));
  EXPECT_FALSE(camera.Contains({1, 10}, 2.0));
  EXPECT_FALSE(camera.Contains({std::nan(""), 10}));
  EXPECT_DOUBLE_EQ(camera.MeanFocalLengthPx(), 50);
}

}  // namespace
}  // namespace pliant
