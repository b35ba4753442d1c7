// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "calibration/charuco.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <string_view>
#include <utility>

#ifdef PLIANT_HAS_ARUCO
#include <opencv2/aruco/charuco.hpp>
#endif

#include "pliant/base/text.h"

namespace pliant {

#ifdef PLIANT_HAS_ARUCO

namespace {

constexpr double kSmallestSeenShare = 1.0 / 3;

constexpr std::array kDictionaries = {
    std::pair{std::string_view("4X4_50"), cv::aruco::DICT_4X4_50},
    std::pair{std::string_view("4X4_100"), cv::aruco::DICT_4X4_100},
    std::pair{std::string_view("4X4_250"), cv::aruco::DICT_4X4_250},
    std::pair{std::string_view("4X4_1000"), cv::aruco::DICT_4X4_1000},
    std::pair{std::string_view("5X5_50"), cv::aruco::DICT_5X5_50},
    std::pair{std::string_view("5X5_100"), cv::aruco::DICT_5X5_100},
    std::pair{std::string_view("5X5_250"), cv::aruco::DICT_5X5_250},
    std::pair{std::string_view("5X5_1000"), cv::aruco::DICT_5X5_1000},
    std::pair{std::string_view("6X6_50"), cv::aruco::DICT_6X6_50},
    std::pair{std::string_view("6X6_100"), cv::aruco::DICT_6X6_100},
    std::pair{std::string_view("6X6_250"), cv::aruco::DICT_6X6_250},
    std::pair{std::string_view("6X6_1000"), cv::aruco::DICT_6X6_1000},
    std::pair{std::string_view("7X7_50"), cv::aruco::DICT_7X7_50},
    std::pair{std::string_view("7X7_100"), cv::aruco::DICT_7X7_100},
    std::pair{std::string_view("7X7_250"), cv::aruco::DICT_7X7_250},
    std::pair{std::string_view("7X7_1000"), cv::aruco::DICT_7X7_1000},
    std::pair{std::string_view("ARUCO_ORIGINAL"), cv::aruco::DICT_ARUCO_ORIGINAL},
};

// Null: there is no such dictionary.
cv::Ptr<cv::aruco::CharucoBoard> OpenCvBoard(const CalibrationBoard& board) {
  for (const auto& [name, dictionary] : kDictionaries) {
    if (name == board.dictionary)
      return cv::aruco::CharucoBoard::create(board.columns + 1, board.rows + 1, static_cast<float>(board.spacing_mm),
                                             static_cast<float>(board.marker_mm),
                                             cv::aruco::getPredefinedDictionary(dictionary));
  }
  return nullptr;
}

}  // namespace

Status CheckCharucoIsSupported(const CalibrationBoard& board) {
  for (const auto& [name, dictionary] : kDictionaries)
    if (name == board.dictionary) return Status::Ok();
  std::vector<std::string> names;
  for (const auto& [name, dictionary] : kDictionaries) names.emplace_back(name);
  return {ErrorCode::kInvalidArgument, "there is no dictionary of markers " + Quoted(board.dictionary) +
                                           "; did you mean " + NearestName(board.dictionary, names) + "?"};
}

// Enough of the board's inner corners, and not in one row or column.
bool DeterminePose(const std::vector<int>& ids, const CalibrationBoard& board) {
  constexpr int kFewest = 6;
  if (static_cast<double>(ids.size()) < std::max<double>(kFewest, kSmallestSeenShare * board.NumPoints())) return false;
  std::set<int> rows;
  std::set<int> columns;
  for (const int id : ids) {
    rows.insert(id / board.columns);
    columns.insert(id % board.columns);
  }
  return rows.size() > 1 && columns.size() > 1;
}

std::optional<BoardView> FindCharuco(const cv::Mat& gray, const CalibrationBoard& board) {
  const cv::Ptr<cv::aruco::CharucoBoard> pattern = OpenCvBoard(board);
  if (!pattern) return std::nullopt;
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> marker_ids;
  cv::aruco::detectMarkers(gray, pattern->dictionary, markers, marker_ids);
  if (marker_ids.empty()) return std::nullopt;
  std::vector<cv::Point2f> corners;
  std::vector<int> ids;
  cv::aruco::interpolateCornersCharuco(markers, marker_ids, gray, pattern, corners, ids);
  if (!DeterminePose(ids, board)) return std::nullopt;
  std::vector<std::size_t> order(ids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return ids[a] < ids[b]; });
  BoardView view;
  for (const std::size_t i : order) {
    view.point_ids.push_back(ids[i]);
    view.pixels.emplace_back(corners[i].x, corners[i].y);
  }
  return view;
}

#else

Status CheckCharucoIsSupported(const CalibrationBoard& /*board*/) {
  return {ErrorCode::kInvalidArgument,
          "this build cannot find ChArUco boards, because OpenCV came without its module aruco; use a chessboard"};
}

std::optional<BoardView> FindCharuco(const cv::Mat& /*gray*/, const CalibrationBoard& /*board*/) {
  return std::nullopt;
}

#endif

}  // namespace pliant
