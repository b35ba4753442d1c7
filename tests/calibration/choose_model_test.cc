// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "calibration/choose_model.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace pliant {
namespace {

ModelCandidate MakeCandidate(CameraModelId model, std::vector<double> params, const std::vector<double>& sigmas) {
  const Camera camera = Camera::Create(EnumName(model), 480, 360, params).value();
  const auto size = static_cast<Eigen::Index>(params.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  covariance.diagonal() = Eigen::Map<const Eigen::VectorXd>(sigmas.data(), size).cwiseAbs2();
  const auto num_free = static_cast<int>(params.size());
  return {{model, std::move(params), num_free, {}}, camera, {covariance, covariance}, {0.07, 0.08, 0.06, 0.07}};
}

// Two models that agree in the middle of the image and differ by 15 px in its corners.
std::vector<ModelCandidate> TwoModels(double k2_sigma) {
  return {MakeCandidate(CameraModelId::kSimpleRadial, {330, 243, 176, -0.18}, {0.1, 0.1, 0.1, 0.001}),
          MakeCandidate(CameraModelId::kRadial, {330, 243, 176, -0.2, 0.03}, {0.1, 0.1, 0.1, 0.001, k2_sigma})};
}

double LargestModelGap(const std::vector<ModelCandidate>& candidates) {
  const auto border = BorderAccuracy(candidates, ChooseModel(candidates));
  return std::ranges::max_element(border, {}, &PixelAccuracy::model_gap_px)->model_gap_px;
}

TEST(ChooseModel, TakesTheLargerModelWhereBothDifferClearlyAtTheBorder) {
  EXPECT_EQ(ChooseModel(TwoModels(0.001)).chosen, 1u);
}

TEST(ChooseModel, TakesTheSmallerModelWhereTheLargerOneIsNotKnownThere) {
  EXPECT_EQ(ChooseModel(TwoModels(0.5)).chosen, 0u);
  EXPECT_EQ(LargestModelGap(TwoModels(0.5)), 0);
}

TEST(ChooseModel, TakesTheSmallerModelWhereBothDifferLittle) {
  std::vector<ModelCandidate> candidates = TwoModels(1e-6);
  candidates[1] = MakeCandidate(CameraModelId::kRadial, {330, 243, 176, -0.18, 1e-4}, {1e-4, 1e-4, 1e-4, 1e-6, 1e-6});
  EXPECT_EQ(ChooseModel(candidates).chosen, 0u);
}

TEST(ChooseModel, TellsOfAModelOfAnotherKindThatPredictsAsWell) {
  std::vector<ModelCandidate> candidates = TwoModels(0.001);
  candidates[0] = MakeCandidate(CameraModelId::kOpenCvFisheye, {330, 330, 243, 176, 0.1, 0, 0, 0},
                                {0.1, 0.1, 0.1, 0.1, 0.001, 0.001, 0.001, 0.001});
  EXPECT_EQ(ChooseModel(candidates).chosen, 1u);  // of fewer parameters
  EXPECT_GT(LargestModelGap(candidates), 1);
}

TEST(ChooseModel, TakesTheModelThatPredictsClearlyBetter) {
  std::vector<ModelCandidate> candidates = TwoModels(0.5);
  candidates[0].prediction_errors_px = {0.27, 0.28, 0.26, 0.27};
  EXPECT_EQ(ChooseModel(candidates).chosen, 1u);
}

}  // namespace
}  // namespace pliant
