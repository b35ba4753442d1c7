// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a depth prior says of distances.
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tracking/depth_prior/prior_agreement.h"
#include "tracking/depth_prior/prior_distances.h"

namespace pliant {
namespace {

constexpr int kSide = 240;
constexpr double kAligned = 0.01;  // of log distance: of scale and shift found from points with wrong ones among them
constexpr double kFloat = 1e-5;    // values of images are floats

const Camera& TheCamera() {
  static const Camera camera =
      Camera::Create(CameraModelId::kSimplePinhole, kSide, kSide, std::array{200.0, 119.5, 119.5}).value();
  return camera;
}

// z along the optical axis at a pixel.
using Depth = std::function<double(double u, double v)>;
double Hilly(double u, double v) { return 60.0 + 15.0 * std::sin(u / 30.0) + 10.0 * std::cos(v / 25.0); }

PreparedFrame FrameWith(int frame_idx, const Depth& value) {
  PreparedFrame frame;
  frame.frame_idx = frame_idx;
  frame.depth_prior.create(kSide, kSide, CV_32FC1);
  for (int v = 0; v < kSide; ++v)
    for (int u = 0; u < kSide; ++u) frame.depth_prior.at<float>(v, u) = static_cast<float>(value(u, v));
  return frame;
}

// A point every 20 pixels, at the depth there.
Map MapOn(const Depth& depth) {
  Map map;
  for (int v = 10; v < kSide; v += 20)
    for (int u = 10; u < kSide; u += 20) {
      const Eigen::Vector2d pixel(u, v);
      const Eigen::Vector3d ray = *TheCamera().Unproject(pixel);
      const Eigen::Vector3d position = ray * (depth(u, v) / ray.z());
      map.landmarks.push_back({.id = PointId{static_cast<int>(map.landmarks.size())},
                               .rest_position = position,
                               .position = position,
                               .pixel = pixel});
    }
  return map;
}

TEST(PriorDistances, ScaleAndShiftAreFoundAmongWrongPoints) {
  for (const DepthPriorKind kind : {DepthPriorKind::kInverseDepth, DepthPriorKind::kDepth}) {
    DepthPriorOptions options;
    options.kind = kind;
    const PreparedFrame frame = FrameWith(0, [&](double u, double v) {
      const double z = Hilly(u, v);
      return kind == DepthPriorKind::kDepth ? 30.0 * z + 400.0 : 90000.0 / z + 500.0;
    });
    Map map = MapOn(Hilly);
    for (std::size_t k = 0; k < map.landmarks.size(); k += 5) map.landmarks[k].position *= 1.6;
    PriorDistances prior(frame, TheCamera(), options);
    ASSERT_TRUE(prior.AlignTo(map, Rigid3()));
    for (const Landmark& landmark : MapOn(Hilly).landmarks)
      EXPECT_NEAR(prior.LogAt(landmark.pixel), std::log(landmark.position.norm()), kAligned);
  }
}

TEST(PriorDistances, BeforeItIsAlignedItSaysDistancesUpToAScale) {
  const DepthPriorOptions options;
  const PreparedFrame frame = FrameWith(0, [](double u, double v) { return 7.0 / Hilly(u, v); });
  const PriorDistances prior(frame, TheCamera(), options);
  for (const Landmark& landmark : MapOn(Hilly).landmarks)
    EXPECT_NEAR(prior.LogAt(landmark.pixel), std::log(landmark.position.norm() / 7.0), kFloat);
}

TEST(PriorDistances, SaysNothingAtContoursHolesAndOutside) {
  DepthPriorOptions options;
  options.kind = DepthPriorKind::kDepth;
  const PreparedFrame frame = FrameWith(0, [](double u, double v) {
    if (v > 200) return 0.0;
    if (v > 180) return std::numeric_limits<double>::quiet_NaN();
    return u < 100 ? 50.0 : 80.0;
  });
  const PriorDistances prior(frame, TheCamera(), options);
  EXPECT_TRUE(std::isfinite(prior.LogAt({50.5, 50.5})));
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(99.5, 50), Eigen::Vector2d(50, 190), Eigen::Vector2d(50, 220),
                                       Eigen::Vector2d(-3, 50), Eigen::Vector2d(50, 500)})
    EXPECT_TRUE(std::isnan(prior.LogAt(pixel))) << pixel.transpose();
  const PreparedFrame without;
  EXPECT_TRUE(std::isnan(PriorDistances(without, TheCamera(), options).LogAt({50, 50})));
}

TEST(PriorDistances, IsNotAlignedToItsContraryNorToTooFewPoints) {
  const DepthPriorOptions options;
  const PreparedFrame contrary = FrameWith(0, [](double u, double v) { return Hilly(u, v); });  // larger where farther
  PriorDistances prior(contrary, TheCamera(), options);
  EXPECT_FALSE(prior.AlignTo(MapOn(Hilly), Rigid3()));
  Map few = MapOn(Hilly);
  few.landmarks.resize(11);
  const PreparedFrame right = FrameWith(0, [](double u, double v) { return 1.0 / Hilly(u, v); });
  PriorDistances of_few(right, TheCamera(), options);
  EXPECT_FALSE(of_few.AlignTo(few, Rigid3()));
}

// One whose kind is mistaken falls.
TEST(PriorAgreement, IsThatOfDepthsByTheMap) {
  const Map map = MapOn(Hilly);
  const PreparedFrame inverse = FrameWith(0, [](double u, double v) { return 7.0 / Hilly(u, v) + 0.05; });
  const PreparedFrame constant = FrameWith(0, [](double, double) { return 7.0; });
  const auto agreement = [&](const PreparedFrame& frame, DepthPriorKind kind, std::size_t points) {
    DepthPriorOptions options;
    options.kind = kind;
    return AgreementWithMap(PriorDistances(frame, TheCamera(), options), TheCamera(),
                            std::span(map.landmarks).first(points), Rigid3());
  };
  const std::size_t all = map.landmarks.size();
  EXPECT_EQ(agreement(inverse, DepthPriorKind::kInverseDepth, all), PriorAgreement::kAgrees);
  EXPECT_EQ(agreement(inverse, DepthPriorKind::kDepth, all), PriorAgreement::kFalls);
  for (const DepthPriorKind kind : {DepthPriorKind::kInverseDepth, DepthPriorKind::kDepth})
    EXPECT_EQ(agreement(constant, kind, all), PriorAgreement::kUnclear) << "the shape of the image is no depth";
  EXPECT_EQ(agreement(inverse, DepthPriorKind::kInverseDepth, 11), std::nullopt);
  EXPECT_EQ(agreement(PreparedFrame(), DepthPriorKind::kInverseDepth, all), std::nullopt);
}

TEST(PriorAgreement, IsThatOfDepthsByBrightness) {
  const PhotometricCalibration light;
  const Map map = MapOn(Hilly);
  const PreparedFrame depth = FrameWith(0, Hilly);
  // What is near is bright; or all is as bright, and only the chance of a texture's colors is left.
  const auto agreement = [&](DepthPriorKind kind, const Depth& brightness) {
    cv::Mat image(kSide, kSide, CV_8UC1);
    for (int v = 0; v < kSide; ++v)
      for (int u = 0; u < kSide; ++u) image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(brightness(u, v));
    DepthPriorOptions options;
    options.kind = kind;
    return AgreementWithBrightness(PriorDistances(depth, TheCamera(), options), TheCamera(), map.landmarks,
                                   LocalBrightness(image, {}), light);
  };
  const Depth of_light = [&](double u, double v) {
    const Eigen::Vector3d ray = *TheCamera().Unproject({u, v});
    const double distance = Hilly(u, v) * ray.norm() / ray.z();
    return 255.0 * std::pow(30.0 / distance, 2.0 / light.gamma);
  };
  EXPECT_EQ(agreement(DepthPriorKind::kDepth, of_light), PriorAgreement::kAgrees);
  EXPECT_EQ(agreement(DepthPriorKind::kInverseDepth, of_light), PriorAgreement::kFalls);
  const Depth of_colors = [&](double u, double v) { return 120.0 + 60.0 * std::sin(u / 9.0) * std::sin(v / 7.0); };
  for (const DepthPriorKind kind : {DepthPriorKind::kInverseDepth, DepthPriorKind::kDepth})
    EXPECT_EQ(agreement(kind, of_colors), PriorAgreement::kUnclear);
}

}  // namespace
}  // namespace pliant
