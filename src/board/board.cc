// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/board/board.h"

#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr int kFewestPoints = 3;  // along a side: three corners say more than the outline of a quadrilateral
constexpr int kMostPoints = 100;

Status FormError(std::string_view text, const std::string& what) {
  return {ErrorCode::kInvalidArgument,
          "the board " + Quoted(text) + " " + what +
              "; give chessboard:COLUMNSxROWS:SQUARE_MM (inner corners, such as chessboard:9x6:2.0), "
              "charuco:COLUMNSxROWS:SQUARE_MM:MARKER_MM:DICTIONARY (squares), circles:COLUMNSxROWS:SPACING_MM or "
              "acircles:COLUMNSxROWS:SPACING_MM"};
}

bool ParseSize(std::string_view text, int* columns, int* rows) {
  const std::size_t cross = text.find('x');
  return cross != std::string_view::npos && ParseInt(text.substr(0, cross), columns) &&
         ParseInt(text.substr(cross + 1), rows);
}

bool ParseLength(std::string_view text, double* length_mm) { return ParseFinite(text, length_mm) && *length_mm > 0; }

std::string KindName(BoardKind kind) {
  switch (kind) {
    case BoardKind::kCharuco:
      return "ChArUco board";
    case BoardKind::kCircles:
      return "grid";
    case BoardKind::kAsymmetricCircles:
      return "asymmetric grid";
    case BoardKind::kChessboard:
      break;
  }
  return "chessboard";
}

std::string PointName(BoardKind kind) {
  return kind == BoardKind::kChessboard || kind == BoardKind::kCharuco ? "inner corners" : "circles";
}

}  // namespace

std::vector<Eigen::Vector3d> CalibrationBoard::Points() const {
  std::vector<Eigen::Vector3d> points;
  points.reserve(static_cast<std::size_t>(NumPoints()));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int x = kind == BoardKind::kAsymmetricCircles ? 2 * column + row % 2 : column;
      points.emplace_back(spacing_mm * x, spacing_mm * row, 0.0);
    }
  }
  return points;
}

std::string CalibrationBoard::Title() const {
  return KindName(kind) + " of " + std::to_string(columns) + "x" + std::to_string(rows) + " " + PointName(kind) + " (" +
         FormatDouble(spacing_mm) + " mm apart)";
}

std::string CalibrationBoard::Text() const {
  const int more = kind == BoardKind::kCharuco ? 1 : 0;  // squares than inner corners
  std::string text = std::string(EnumName(kind)) + ":" + std::to_string(columns + more) + "x" +
                     std::to_string(rows + more) + ":" + FormatDouble(spacing_mm);
  if (kind == BoardKind::kCharuco) text += ":" + FormatDouble(marker_mm) + ":" + dictionary;
  return text;
}

Result<CalibrationBoard> ParseBoard(std::string_view text) {
  const std::vector<std::string_view> parts = Split(text, ':');
  CalibrationBoard board;
  bool known = false;
  for (const auto& [kind, name] : EnumNames<BoardKind>::kNames) {
    if (name != parts.front()) continue;
    board.kind = kind;
    known = true;
  }
  if (!known) return FormError(text, "is of no known kind");
  const bool has_markers = board.kind == BoardKind::kCharuco;
  if (parts.size() != (has_markers ? 5u : 3u)) return FormError(text, "has not the right number of parts");
  if (!ParseSize(parts[1], &board.columns, &board.rows)) return FormError(text, "has no size such as 9x6");
  if (!ParseLength(parts[2], &board.spacing_mm)) return FormError(text, "has no length in mm behind its size");
  if (has_markers) {
    if (!ParseLength(parts[3], &board.marker_mm) || board.marker_mm >= board.spacing_mm)
      return FormError(text, "needs markers that are smaller than its squares");
    board.dictionary = parts[4];
    --board.columns;
    --board.rows;
  }
  for (const int count : {board.columns, board.rows}) {
    if (count < kFewestPoints || count > kMostPoints)
      return FormError(text, "has fewer than " + std::to_string(kFewestPoints) + " or more than " +
                                 std::to_string(kMostPoints) + " " + PointName(board.kind) + " along a side");
  }
  return board;
}

}  // namespace pliant
