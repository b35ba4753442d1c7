// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "board/charuco.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string_view>
#include <utility>

#ifdef PLIANT_HAS_ARUCO
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>
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

// Several: a tool or a rig may have one of its own.
bool HasUnknownMarkers(const CalibrationBoard& board, const std::vector<int>& marker_ids) {
  constexpr int kSeveral = 3;
  const int markers = (board.columns + 1) * (board.rows + 1) / 2;
  return std::count_if(marker_ids.begin(), marker_ids.end(), [&](int id) { return id >= markers; }) >= kSeveral;
}

// Moves corners to where the gradients around them agree, within the white that is left around the markers: those of
// OpenCV 4.6 are half a pixel off.
void RefineCharuco(const cv::Mat& gray, const CalibrationBoard& board, const std::vector<int>& ids,
                   std::vector<cv::Point2f>* corners) {
  double step_px = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < ids.size(); ++i)
    for (std::size_t j = i + 1; j < ids.size(); ++j) {
      const int apart = std::abs(ids[i] / board.columns - ids[j] / board.columns) +
                        std::abs(ids[i] % board.columns - ids[j] % board.columns);
      if (apart == 1) step_px = std::min(step_px, cv::norm((*corners)[i] - (*corners)[j]));
    }
  if (!std::isfinite(step_px)) return;
  const double margin_px = 0.5 * (1.0 - board.marker_mm / board.spacing_mm) * step_px;
  const int reach = std::clamp(static_cast<int>(0.8 * margin_px), 2, 15);
  cv::cornerSubPix(gray, *corners, {reach, reach}, {-1, -1},
                   {cv::TermCriteria::EPS + cv::TermCriteria::MAX_ITER, 50, 1e-3});
}

using Corners = std::vector<cv::Point2f>;

// Where `there` of the board is in the image, by one marker and its axes.
cv::Point2f Beside(const std::vector<cv::Point3f>& marker_on_board, const Corners& marker, const cv::Point2f& there) {
  const cv::Point3f& origin = marker_on_board[0];
  const double side = cv::norm(marker_on_board[1] - origin);
  const double along = (there - cv::Point2f(origin.x, origin.y))
                           .dot(cv::Point2f(marker_on_board[1].x - origin.x, marker_on_board[1].y - origin.y)) /
                       side;
  const double across = (there - cv::Point2f(origin.x, origin.y))
                            .dot(cv::Point2f(marker_on_board[3].x - origin.x, marker_on_board[3].y - origin.y)) /
                        side;
  const cv::Point2f u = 0.5F * (marker[1] - marker[0] + marker[2] - marker[3]);
  const cv::Point2f v = 0.5F * (marker[3] - marker[0] + marker[2] - marker[1]);
  return marker[0] + u * static_cast<float>(along / side) + v * static_cast<float>(across / side);
}

// Of the markers that a board has beside each other.
struct LayoutFit {
  int beside = 0;
  int fitting = 0;  // those of them that are beside each other in the image, too, whatever the lens

  bool IsGood() const { return 4 * fitting >= 3 * beside; }
};

LayoutFit FitLayout(const CalibrationBoard& board, const cv::aruco::CharucoBoard& pattern,
                    const std::vector<Corners>& markers, const std::vector<int>& marker_ids) {
  std::map<int, std::size_t> place;  // in the pattern
  for (std::size_t k = 0; k < pattern.ids.size(); ++k) place[pattern.ids[k]] = k;
  LayoutFit fit;
  for (std::size_t i = 0; i < markers.size(); ++i)
    for (std::size_t j = 0; j < markers.size(); ++j) {
      const auto one = place.find(marker_ids[i]);
      const auto other = place.find(marker_ids[j]);
      if (i == j || one == place.end() || other == place.end()) continue;
      const auto& on_board = pattern.objPoints[one->second];
      const cv::Point3f& there = pattern.objPoints[other->second][0];
      if (cv::norm(there - on_board[0]) > 1.5 * board.spacing_mm) continue;
      ++fit.beside;
      const double side_px = cv::norm(markers[i][1] - markers[i][0]);
      const cv::Point2f expected = Beside(on_board, markers[i], {there.x, there.y});
      fit.fitting += cv::norm(expected - markers[j][0]) < side_px ? 1 : 0;
    }
  return fit;
}

// The board of this dictionary whose markers they are: as many rows as the largest number needs, and the columns with
// which most markers are beside each other.
std::optional<CalibrationBoard> BoardOfMarkers(const CalibrationBoard& of_dictionary, const cv::Mat& gray) {
  constexpr int kFewestSquares = 4;  // along a side, as a board has them
  constexpr int kMostSquares = 20;
  constexpr int kFewestFitting = 6;  // fewer may be spots that look like markers
  const cv::Ptr<cv::aruco::CharucoBoard> pattern = OpenCvBoard(of_dictionary);
  if (!pattern) return std::nullopt;
  std::vector<Corners> markers;
  std::vector<int> marker_ids;
  cv::aruco::detectMarkers(gray, pattern->dictionary, markers, marker_ids);
  if (marker_ids.empty()) return std::nullopt;
  const int count = *std::max_element(marker_ids.begin(), marker_ids.end()) + 1;
  int fitting = kFewestFitting - 1;
  std::optional<CalibrationBoard> seen;
  for (int columns = kFewestSquares; columns <= kMostSquares; ++columns) {
    const int rows = (2 * count + columns - 1) / columns;
    if (rows < kFewestSquares || rows > kMostSquares) continue;
    CalibrationBoard board = of_dictionary;
    board.columns = columns - 1;
    board.rows = rows - 1;
    const LayoutFit fit = FitLayout(board, *OpenCvBoard(board), markers, marker_ids);
    if (!fit.IsGood() || fit.fitting <= fitting) continue;
    fitting = fit.fitting;
    seen = board;
  }
  return seen;
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

}  // namespace

Status CheckCharucoIsSupported(const CalibrationBoard& board) {
  for (const auto& [name, dictionary] : kDictionaries)
    if (name == board.dictionary) return Status::Ok();
  std::vector<std::string> names;
  for (const auto& [name, dictionary] : kDictionaries) names.emplace_back(name);
  const std::string similar = SimilarName(board.dictionary, names);
  return {ErrorCode::kInvalidArgument,
          "there is no dictionary of markers " + Quoted(board.dictionary) +
              (similar.empty() ? "; give one of " + CommaSeparated(names) : "; did you mean " + similar + "?")};
}

std::optional<BoardView> FindCharuco(const cv::Mat& gray, const CalibrationBoard& board) {
  const cv::Ptr<cv::aruco::CharucoBoard> pattern = OpenCvBoard(board);
  if (!pattern) return std::nullopt;
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> marker_ids;
  cv::aruco::detectMarkers(gray, pattern->dictionary, markers, marker_ids);
  if (marker_ids.empty() || !FitLayout(board, *pattern, markers, marker_ids).IsGood()) return std::nullopt;
  std::vector<cv::Point2f> corners;
  std::vector<int> ids;
  cv::aruco::interpolateCornersCharuco(markers, marker_ids, gray, pattern, corners, ids);
  if (!DeterminePose(ids, board)) return std::nullopt;
  RefineCharuco(gray, board, ids, &corners);
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

bool ShowsOtherCharuco(const cv::Mat& gray, const CalibrationBoard& board) {
  const cv::Ptr<cv::aruco::CharucoBoard> pattern = OpenCvBoard(board);
  if (!pattern) return false;
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> marker_ids;
  cv::aruco::detectMarkers(gray, pattern->dictionary, markers, marker_ids);
  constexpr std::size_t kFewestMarkers = 4;
  return marker_ids.size() >= kFewestMarkers &&
         (HasUnknownMarkers(board, marker_ids) || !FitLayout(board, *pattern, markers, marker_ids).IsGood());
}

std::optional<CalibrationBoard> SeenCharuco(const cv::Mat& gray, const CalibrationBoard& board) {
  if (auto seen = BoardOfMarkers(board, gray)) return seen;
  for (const auto& [name, dictionary] : kDictionaries) {
    CalibrationBoard other = board;
    other.dictionary = name;
    if (auto seen = BoardOfMarkers(other, gray)) return seen;
  }
  return std::nullopt;
}

cv::Mat DrawCharuco(const CalibrationBoard& board, int px) {
  cv::Mat image;
  OpenCvBoard(board)->draw({(board.columns + 1) * px, (board.rows + 1) * px}, image);
  return image;
}

#else

cv::Mat DrawCharuco(const CalibrationBoard& /*board*/, int /*px*/) { return {}; }

bool ShowsOtherCharuco(const cv::Mat& /*gray*/, const CalibrationBoard& /*board*/) { return false; }

std::optional<CalibrationBoard> SeenCharuco(const cv::Mat& /*gray*/, const CalibrationBoard& /*board*/) {
  return std::nullopt;
}

Status CheckCharucoIsSupported(const CalibrationBoard& /*board*/) {
  return {ErrorCode::kInvalidArgument,
          "this build cannot find ChArUco boards, because it was made without OpenCV's contributed module aruco; use a "
          "chessboard, or build with it (on Debian: libopencv-contrib-dev)"};
}

std::optional<BoardView> FindCharuco(const cv::Mat& /*gray*/, const CalibrationBoard& /*board*/) {
  return std::nullopt;
}

#endif

}  // namespace pliant
