// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/colmap/check.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "colmap/sample_model.h"

namespace pliant::colmap {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// The findings but the image without keypoints, which the sample has.
std::vector<Finding> FindingsOf(const Model& model) {
  std::vector<Finding> findings = CheckModel(model);
  std::erase_if(findings, [](const Finding& finding) { return finding.what == "images have no keypoints"; });
  return findings;
}

TEST(CheckModel, FindsNothingInAValidModel) {
  EXPECT_TRUE(FindingsOf(SampleModel()).empty());
  EXPECT_TRUE(FindingsOf(SampleModelWithRigs()).empty());
  const std::vector<Finding> findings = CheckModel(SampleModel());
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, Severity::kWarning);
  EXPECT_EQ(findings[0].example, "image 2 (000002.png)");
  EXPECT_TRUE(IsValid(findings));
}

struct Damage {
  const char* name;
  std::function<void(Model&)> make;
  Severity severity;
  const char* what;
};

class DamagedModel : public testing::TestWithParam<Damage> {};

TEST_P(DamagedModel, IsFound) {
  Model model = SampleModelWithRigs();
  GetParam().make(model);
  const std::vector<Finding> findings = FindingsOf(model);
  const auto found = std::find_if(findings.begin(), findings.end(),
                                  [](const Finding& finding) { return finding.what == GetParam().what; });
  ASSERT_NE(found, findings.end()) << (findings.empty() ? "nothing" : findings[0].what);
  EXPECT_EQ(found->severity, GetParam().severity);
  EXPECT_GT(found->count, 0);
  EXPECT_FALSE(found->example.empty());
  EXPECT_EQ(IsValid({*found}), GetParam().severity == Severity::kWarning);
}

constexpr Severity kError = Severity::kError;
constexpr Severity kWarning = Severity::kWarning;

INSTANTIATE_TEST_SUITE_P(
    Of, DamagedModel,
    testing::Values(
        Damage{"Param", [](Model& m) { m.cameras[0].params[2] = kNaN; }, kError,
               "cameras have parameters that are not numbers"},
        Damage{"Size", [](Model& m) { m.cameras[0].width = std::uint64_t{1} << 60; }, kError,
               "cameras have image sizes that are not possible"},
        Damage{"Focal", [](Model& m) { m.cameras[0].params[0] = -1; }, kError,
               "cameras have focal lengths that are not positive"},
        Damage{"SecondFocal", [](Model& m) { m.cameras[0].params[1] = 0; }, kError,
               "cameras have focal lengths that are not positive"},
        Damage{"Fov", [](Model& m) { m.cameras[1].model_id = 7; }, kWarning,
               "cameras have a model that Pliant does not have"},
        Damage{"Pose", [](Model& m) { m.images[0].cam_from_world.tvec[1] = kNaN; }, kError,
               "images have poses that are not numbers"},
        Damage{"Zero", [](Model& m) { m.images[0].cam_from_world.qvec = {}; }, kError,
               "images have quaternions that are zero"},
        Damage{"Unit",
               [](Model& m) {
                 m.images[0].cam_from_world.qvec = {2, 0, 0, 0};
               },
               kWarning, "images have quaternions that are not of unit length"},
        Damage{"Camera", [](Model& m) { m.images[0].camera_id = 2; }, kError, "images have a camera that is not there"},
        Damage{"Name", [](Model& m) { m.images[0].name = m.images[1].name; }, kError,
               "images have a name that another has"},
        Damage{"NoName", [](Model& m) { m.images[0].name.clear(); }, kError, "images have no name"},
        Damage{"Blank", [](Model& m) { m.images[0].name = "a b"; }, kWarning,
               "images have names with blanks, which COLMAP cuts off in text"},
        Damage{"Keypoint", [](Model& m) { m.images[0].points2D[0].x = kNaN; }, kError, "keypoints are not numbers"},
        Damage{"Outside", [](Model& m) { m.images[0].points2D[0].x = 641; }, kWarning,
               "keypoints are outside of their image"},
        Damage{"Dangling", [](Model& m) { m.images[1].points2D[1].point3D_id = 8; }, kError,
               "keypoints have a point that is not there"},
        Damage{"OneWay", [](Model& m) { m.images[1].points2D[1].point3D_id = 7; }, kError,
               "keypoints have a point whose track does not have them"},
        Damage{"Point", [](Model& m) { m.points3D[0].xyz[0] = kNaN; }, kError,
               "points have positions that are not numbers"},
        Damage{"Error", [](Model& m) { m.points3D[0].error = kNaN; }, kError,
               "points have errors that are not numbers"},
        Damage{"Short", [](Model& m) { m.points3D[0].track.resize(1); }, kWarning,
               "points are seen in fewer than two images"},
        Damage{"Twice",
               [](Model& m) {
                 m.points3D[0].track.push_back({1, 1});
               },
               kError, "tracks have a keypoint twice"},
        Damage{"NoImage",
               [](Model& m) {
                 m.points3D[0].track.push_back({5, 1});
               },
               kError, "tracks have an image that is not there"},
        Damage{"NoKeypoint",
               [](Model& m) {
                 m.points3D[0].track.push_back({1, 2});
               },
               kError, "tracks have a keypoint that is not there"},
        Damage{"OtherPoint",
               [](Model& m) {
                 m.points3D[0].track.push_back({1, 0});
               },
               kError, "tracks have a keypoint that belongs to another point, or to none"},
        Damage{"Behind", [](Model& m) { m.points3D[0].xyz[2] = -9; }, kWarning,
               "points are behind a camera that sees them"},
        Damage{"RigCamera", [](Model& m) { m.rigs[0].ref_sensor->id = 9; }, kError,
               "rigs and frames have a camera that is not there"},
        Damage{"NoSensor", [](Model& m) { m.rigs[0].ref_sensor.reset(); }, kError, "rigs have no sensor"},
        Damage{"FrameRig", [](Model& m) { m.frames[0].rig_id = 9; }, kError, "frames have a rig that is not there"},
        Damage{"FrameImage", [](Model& m) { m.frames[0].data[0].data_id = 9; }, kError,
               "frames have an image that is not there"},
        Damage{"NoPoints", [](Model& m) { m.points3D.clear(); }, kWarning, "there are no points"},
        Damage{"NoCameras", [](Model& m) { m.cameras.clear(); }, kError, "there are no cameras"},
        Damage{"NoImages", [](Model& m) { m.images.clear(); }, kError, "there are no images"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(CheckModel, CountsWhatHasTheSameFault) {
  Model model = SampleModel();
  for (Image& image : model.images) image.camera_id = 77;
  const std::vector<Finding> findings = FindingsOf(model);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].count, 3);
  EXPECT_EQ(findings[0].example, "image 1 (a/000001.png)");
}

}  // namespace
}  // namespace pliant::colmap
