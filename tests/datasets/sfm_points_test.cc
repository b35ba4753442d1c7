// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/sfm_points.h"

#include <tuple>

#include <gmock/gmock.h>

#include "datasets/opened_sequence.h"
#include "pliant/colmap/model.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;

class SfmPointsTest : public OpenSequenceTest {};

TEST_F(SfmPointsTest, AreReadFromANativeSequenceByTheNamesOfTheirColumns) {
  WriteNative(2);
  const auto none = ReadSfmPointsOfSequence(root_);
  ASSERT_TRUE(none.ok());
  EXPECT_TRUE(none->empty());
  Text("sfm_points.csv", "frame,point_id,v_px,u_px,depth\r\n7,0,2.5,1,10\r\n0,1,4,3,20\n7,1,6,5,30\n");
  const auto points = ReadSfmPointsOfSequence(root_);
  ASSERT_TRUE(points.ok()) << points.status().message();
  ASSERT_EQ(points->size(), 2U);
  ASSERT_EQ(points->at(7).size(), 2U);
  EXPECT_EQ(points->at(7)[0].pixel, Eigen::Vector2d(1, 2.5));
  EXPECT_EQ(points->at(7)[0].depth, 10);
  EXPECT_EQ(points->at(0)[0].depth, 20);
}

TEST_F(SfmPointsTest, SayFileAndLineOfWhatCannotBeRead) {
  for (const auto& [text, says] :
       {std::tuple("", "is empty; its first line must be frame,u_px,v_px,depth"),
        std::tuple("frame,u_px,depth\n", ":1: the header has no column v_px"),
        std::tuple("frame,u_px,v_px,depth\n0,1,2\n", ":2: a row has 3 columns and the header has 4"),
        std::tuple("frame,u_px,v_px,depth\n0,1,2,3\n-1,1,2,3\n", ":3: '-1' is not the number of a frame"),
        std::tuple("frame,u_px,v_px,depth\n0,1,nan,3\n", ":2: 'nan' is not a finite number"),
        std::tuple("frame,u_px,v_px,depth\n0,1,2,-3\n", ":2: the depth -3 is not positive")}) {
    Text("sfm.csv", text);
    const auto points = ReadSfmPoints(Path("sfm.csv"));
    EXPECT_EQ(points.status().code(), ErrorCode::kUnreadable);
    EXPECT_THAT(points.status().message(), HasSubstr(says));
    EXPECT_THAT(points.status().message(), HasSubstr("sfm.csv"));
  }
  EXPECT_EQ(ReadSfmPoints(Path("nowhere.csv")).status().code(), ErrorCode::kNotFound);
}

TEST_F(SfmPointsTest, OfAColmapModelBelongToTheImagesOfItsNames) {
  WriteNative(3);
  colmap::Model model;
  model.cameras = {{1, 1, kWidth, kHeight, {60, 60, 32, 24}}};
  model.images = {{1, {{1, 0, 0, 0}, {0, 0, 2}}, 1, "left/000002.png", {{10.5, 20.5, 7}, {1, 1, 8}, {2, 2}}},
                  {2, {{1, 0, 0, 0}, {0, 0, 0}}, 1, "else.png", {{3, 4, 7}}}};
  model.points3D = {{7, {0, 0, 3}, {}, 0.5, {{1, 0}, {2, 0}}}, {8, {0, 0, -3}, {}, 0.5, {{1, 1}}}};
  ASSERT_TRUE(colmap::WriteModel(Path("model").string(), model, colmap::Format::kText).ok());
  const auto sequence = Open(Request());
  const auto points = ReadSfmModel(Path("model"), *sequence);
  ASSERT_TRUE(points.ok()) << points.status().message();
  ASSERT_EQ(points->size(), 1U);
  ASSERT_EQ(points->at(2).size(), 1U) << "one is behind the camera, one has no point";
  EXPECT_NEAR((points->at(2)[0].pixel - Eigen::Vector2d(10, 20)).norm(), 0, kRoundOff);
  EXPECT_NEAR(points->at(2)[0].depth, 5, kRoundOff);

  model.images.erase(model.images.begin());
  ASSERT_TRUE(colmap::WriteModel(Path("model").string(), model, colmap::Format::kText).ok());
  EXPECT_EQ(ReadSfmModel(Path("model"), *sequence).status().code(), ErrorCode::kMismatch);
  model.cameras[0].width = 2 * kWidth;
  ASSERT_TRUE(colmap::WriteModel(Path("model").string(), model, colmap::Format::kText).ok());
  EXPECT_THAT(ReadSfmModel(Path("model"), *sequence).status().message(), HasSubstr("has images of 128x48"));
}

}  // namespace
}  // namespace pliant
