// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "board/grid_order.h"

#include <algorithm>
#include <cstddef>

namespace pliant {
namespace {

constexpr double kLargestChange = 0.5;  // of the longer one of two steps

bool ChangesLittle(const cv::Point2f& a, const cv::Point2f& b, const cv::Point2f& c) {
  const cv::Point2f first = b - a;
  const cv::Point2f second = c - b;
  return cv::norm(second - first) <= kLargestChange * std::max(cv::norm(first), cv::norm(second));
}

}  // namespace

bool AreInOrder(const CalibrationBoard& board, const std::vector<cv::Point2f>& points) {
  const auto at = [&](int column, int row) { return points[static_cast<std::size_t>(row * board.columns + column)]; };
  // Every second row of asymmetric circles is shifted.
  const int down = board.kind == BoardKind::kAsymmetricCircles ? 2 : 1;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      if (column + 2 < board.columns && !ChangesLittle(at(column, row), at(column + 1, row), at(column + 2, row)))
        return false;
      if (row + 2 * down < board.rows &&
          !ChangesLittle(at(column, row), at(column, row + down), at(column, row + 2 * down)))
        return false;
    }
  }
  return true;
}

}  // namespace pliant
