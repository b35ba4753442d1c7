// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/board/board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pliant {
namespace {

TEST(Board, ReadsEveryKind) {
  const auto chessboard = ParseBoard("chessboard:9x6:2.5");
  ASSERT_TRUE(chessboard.ok());
  EXPECT_EQ(chessboard->kind, BoardKind::kChessboard);
  EXPECT_EQ(chessboard->columns, 9);
  EXPECT_EQ(chessboard->rows, 6);
  EXPECT_EQ(chessboard->spacing_mm, 2.5);
  const auto charuco = ParseBoard("charuco:8x5:10:7:5X5_100");
  ASSERT_TRUE(charuco.ok());
  EXPECT_EQ(charuco->NumPoints(), 7 * 4);
  EXPECT_EQ(charuco->marker_mm, 7);
  EXPECT_EQ(charuco->dictionary, "5X5_100");
  EXPECT_TRUE(ParseBoard("circles:7x6:5").ok());
  EXPECT_TRUE(ParseBoard("acircles:4x11:5").ok());
}

TEST(Board, IsNamedByItsKindItsPointsAndTheirSpacing) {
  for (const auto& [text, title] :
       {std::pair("chessboard:9x6:2.5", "chessboard of 9x6 inner corners (2.5 mm apart)"),
        std::pair("charuco:8x5:10:7:5X5_100", "ChArUco board of 7x4 inner corners (10 mm apart)"),
        std::pair("circles:7x6:5", "grid of 7x6 circles (5 mm apart)"),
        std::pair("acircles:4x11:5", "asymmetric grid of 4x11 circles (5 mm apart)")})
    EXPECT_EQ(ParseBoard(text)->Title(), title);
}

TEST(Board, NumbersPointsRowByRow) {
  const auto board = ParseBoard("chessboard:4x3:2");
  EXPECT_EQ(board->Points()[0], Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(board->Points()[3], Eigen::Vector3d(6, 0, 0));
  EXPECT_EQ(board->Points()[4], Eigen::Vector3d(0, 2, 0));
  EXPECT_EQ(board->Points().size(), 12u);
}

TEST(Board, ShiftsEverySecondRowOfAsymmetricCircles) {
  const auto board = ParseBoard("acircles:4x11:5");
  EXPECT_EQ(board->Points()[1], Eigen::Vector3d(10, 0, 0));
  EXPECT_EQ(board->Points()[4], Eigen::Vector3d(5, 5, 0));
}

TEST(Board, SaysWhatItWasReadFrom) {
  for (const char* text : {"chessboard:9x6:2.5", "charuco:8x5:10:7:5X5_100", "circles:7x6:5", "acircles:4x11:5"})
    EXPECT_EQ(ParseBoard(text)->Text(), text);
}

TEST(Board, RefusesWhatIsNoBoardInASentence) {
  for (const char* text :
       {"", "chessboard", "chessboard:9x6", "chessboard:9:2", "chessboard:9x6:0", "chessboard:9x6:-1",
        "chessboard:9x6:nan", "chessboard:2x2:1", "chessboard:9x6:2:3", "square:9x6:2", "charuco:8x5:10:12:5X5_100",
        "charuco:8x5:10:7", "chessboard:1000x6:2", "circles:x:2"}) {
    const auto board = ParseBoard(text);
    ASSERT_FALSE(board.ok()) << text;
    EXPECT_EQ(board.status().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(board.status().message(), testing::HasSubstr("chessboard:9x6:2.0"));
  }
}

}  // namespace
}  // namespace pliant
