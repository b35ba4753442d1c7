// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/check_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "support/rendered_sequence.h"

namespace pliant {
namespace {

constexpr double kRightPoses = 0.6;          // correlation; poses that are wrong have one of about none
constexpr int kMinMatches = 100;             // of some hundred corners a frame
constexpr double kRenderedRow_px = 0.1;      // rendered rectified: what matching leaves
constexpr double kMatchesOnTheirRow = 0.99;  // share; a match may be wrong
constexpr double kDepthRatio = 0.01;         // of disparities of some 25 px, right to a fifth of one in the median

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

SequenceCheck Checked(RenderedSequence& sequence) {
  const auto check = CheckSequence(sequence);
  EXPECT_TRUE(check.ok()) << check.status().message();
  return check.ok() ? *check : SequenceCheck();
}

TEST(CheckSequence, FindsNothingWrongWithTheTruth) {
  RenderedSequence sequence;
  sequence.mono = false;
  const SequenceCheck check = Checked(sequence);
  EXPECT_THAT(check.wrong, IsEmpty());
  ASSERT_TRUE(check.poses && check.stereo);
  EXPECT_EQ(check.poses->pairs, 15);
  EXPECT_EQ(check.poses->right, true);
  EXPECT_GT(check.poses->as_given.correlation, kRightPoses);
  EXPECT_GT(check.stereo->matches, kMinMatches);
  EXPECT_LT(check.stereo->median_row_error_px, kRenderedRow_px);
  EXPECT_GT(check.stereo->share_right_way, kMatchesOnTheirRow);
  EXPECT_NEAR(check.stereo->depth_ratio.value(), 1.0, kDepthRatio);
}

struct Misreading {
  const char* what;
  Rigid3 (*write)(const Rigid3& truth);
  const char* said;
  double scale;
};

Rigid3 Mirrored(const Rigid3& pose, const Eigen::Vector3d& mirror) {
  return {Eigen::Matrix3d(mirror.asDiagonal() * pose.RotationMatrix() * mirror.asDiagonal()),
          mirror.cwiseProduct(pose.translation)};
}

class MisreadPoses : public testing::TestWithParam<Misreading> {};

TEST_P(MisreadPoses, AreToldApart) {
  RenderedSequence sequence;
  sequence.pose = GetParam().write;
  const SequenceCheck check = Checked(sequence);
  ASSERT_TRUE(check.poses.has_value());
  EXPECT_EQ(check.poses->right, false);
  EXPECT_THAT(check.poses->best.name, HasSubstr(GetParam().said));
  EXPECT_DOUBLE_EQ(check.poses->best.scale, GetParam().scale);
  ASSERT_EQ(check.wrong.size(), 1U);
  EXPECT_THAT(check.wrong[0], HasSubstr(GetParam().said));
}

INSTANTIATE_TEST_SUITE_P(
    Every, MisreadPoses,
    testing::Values(
        Misreading{"inverse", [](const Rigid3& truth) { return truth.Inverse(); }, "camera from world", 1.0},
        Misreading{"transposed",
                   [](const Rigid3& truth) { return Rigid3(truth.rotation.conjugate(), truth.translation); },
                   "rotations are transposed", 1.0},
        Misreading{"w_first",
                   [](const Rigid3& truth) {
                     const auto& q = truth.rotation;
                     return Rigid3(Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()), truth.translation);
                   },
                   "their quaternions are w x y z", 1.0},
        Misreading{"w_first_of_the_inverse",
                   [](const Rigid3& truth) {
                     const Rigid3 inverse = truth.Inverse();
                     const auto& q = inverse.rotation;
                     return Rigid3(Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()), inverse.translation);
                   },
                   "camera from world, and their quaternions w x y z", 1.0},
        Misreading{"unity",
                   [](const Rigid3& truth) {
                     return Mirrored(truth, {1, -1, 1});
                   },
                   "y is flipped", 1.0},
        Misreading{"meters", [](const Rigid3& truth) { return Rigid3(truth.rotation, 1e-3 * truth.translation); }, "",
                   1000.0},
        Misreading{"decimeters", [](const Rigid3& truth) { return Rigid3(truth.rotation, 0.01 * truth.translation); },
                   "", 100.0},
        Misreading{"opengl",
                   [](const Rigid3& truth) {
                     return Rigid3(Eigen::Matrix3d(truth.RotationMatrix() * Eigen::Vector3d(1, -1, -1).asDiagonal()),
                                   truth.translation);
                   },
                   "OpenGL", 1.0},
        Misreading{"unity_in_meters",
                   [](const Rigid3& truth) {
                     Rigid3 pose = Mirrored(truth, {1, -1, 1});
                     pose.translation *= 1e-3;
                     return pose;
                   },
                   "y is flipped", 1000.0}),
    [](const auto& test) { return std::string(test.param.what); });

TEST(CheckSequence, SaysThatACameraThatStandsStillTellsNothing) {
  RenderedSequence sequence;
  sequence.pose = [](const Rigid3&) { return Rigid3(); };
  const SequenceCheck check = Checked(sequence);
  ASSERT_TRUE(check.poses.has_value());
  EXPECT_FALSE(check.poses->right.has_value());
  EXPECT_THAT(check.wrong, IsEmpty());
}

TEST(CheckSequence, TellsSwappedImages) {
  RenderedSequence sequence;
  sequence.mono = false;
  sequence.swapped = true;
  sequence.pose = [](const Rigid3&) { return Rigid3(); };
  const SequenceCheck check = Checked(sequence);
  EXPECT_THAT(check.wrong, ElementsAre(HasSubstr("left and right are swapped")));
}

TEST(CheckSequence, TellsPairsThatAreNotRectified) {
  RenderedSequence sequence;
  sequence.mono = false;
  sequence.right = [](const cv::Mat& image) {
    cv::Mat turned;
    cv::warpAffine(image, turned, cv::Matx23d(1, 0.01, 0, -0.01, 1, 4), image.size());
    return turned;
  };
  const SequenceCheck check = Checked(sequence);
  EXPECT_THAT(check.wrong, ElementsAre(HasSubstr("not rectified")));
}

TEST(CheckSequence, BlamesTheDepthWherePosesAndBaselineAgree) {
  RenderedSequence sequence;
  sequence.mono = false;
  sequence.depth_unit = 10;
  const SequenceCheck check = Checked(sequence);
  EXPECT_THAT(check.wrong, ElementsAre(HasSubstr("the depth images say 10 times what poses and baseline agree on")));
}

TEST(CheckSequence, TellsDepthInAnotherUnitByTheBaseline) {
  RenderedSequence sequence;
  sequence.mono = false;
  sequence.depth_unit = 0.1;
  sequence.pose = [](const Rigid3& truth) { return Rigid3(truth.rotation, 0.1 * truth.translation); };
  const SequenceCheck check = Checked(sequence);
  ASSERT_TRUE(check.poses.has_value());
  EXPECT_EQ(check.poses->right, true) << "they are in the unit of the depth";
  EXPECT_THAT(check.wrong, ElementsAre(HasSubstr("depth images say 0.")));
}

}  // namespace
}  // namespace pliant
