// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Flat boards with a pattern whose points are known, for calibration. Frame of a board: x along its columns, y along
// its rows, z = 0, the first point at the origin, mm.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"
#include "pliant/base/status.h"

namespace pliant {

enum class BoardKind { kChessboard, kCharuco, kCircles, kAsymmetricCircles };
template <>
struct EnumNames<BoardKind> {
  static constexpr std::array kNames = {std::pair{BoardKind::kChessboard, std::string_view("chessboard")},
                                        std::pair{BoardKind::kCharuco, std::string_view("charuco")},
                                        std::pair{BoardKind::kCircles, std::string_view("circles")},
                                        std::pair{BoardKind::kAsymmetricCircles, std::string_view("acircles")}};
};

struct CalibrationBoard {
  BoardKind kind = BoardKind::kChessboard;
  // Points along x and y. Of a chessboard and a ChArUco board: inner corners, where four squares meet. Of asymmetric
  // circles: circles of a row, and rows, each of which is shifted by half of a row's spacing against the one before.
  int columns = 0;
  int rows = 0;
  // Side of a square; distance of the centers of neighboring circles, of asymmetric ones along x and y of the diagonal.
  double spacing_mm = 0;
  double marker_mm = 0;         // side of a ChArUco board's markers
  std::string dictionary = {};  // of its markers: "4X4_50", "6X6_250", ...

  int NumPoints() const { return columns * rows; }
  // The points by their number: row by row.
  std::vector<Eigen::Vector3d> Points() const;
  // "chessboard of 9x6 inner corners (2 mm apart)".
  std::string Title() const;
  // As ParseBoard reads it: "chessboard:9x6:2".
  std::string Text() const;
};

// Reads "chessboard:9x6:2.0" (inner corners, square in mm), "charuco:8x5:10:7:5X5_100" (squares, square and marker in
// mm, dictionary), "circles:7x6:5" or "acircles:4x11:5". Fails with kInvalidArgument: the sentence shows the form.
Result<CalibrationBoard> ParseBoard(std::string_view text);

}  // namespace pliant
