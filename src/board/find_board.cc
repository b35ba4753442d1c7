// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/board/find_board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "board/charuco.h"
#include "board/grid_order.h"

namespace pliant {
namespace {

// Longest side at which the search takes some tenths of a second, and below which squares get too small for it.
constexpr double kLargestSearched_px = 960;
constexpr double kSmallestSearched_px = 640;
constexpr double kNoiseSmoothing_px = 1.5;
constexpr std::size_t kMaxBlobs = 500;
constexpr int kChessboardFlags = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY;

cv::Mat Resized(const cv::Mat& gray, double scale) {
  if (scale == 1.0) return gray;
  cv::Mat resized;
  cv::resize(gray, resized, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  return resized;
}

cv::Mat Smoothed(const cv::Mat& gray, double sigma_px) {
  cv::Mat smoothed;  // not in place: `gray` may be the caller's image
  cv::GaussianBlur(gray, smoothed, {}, sigma_px);
  return smoothed;
}

// The scales to search at, the likeliest first.
std::vector<double> SearchScales(const cv::Mat& gray) {
  const double longest = std::max(gray.cols, gray.rows);
  if (longest > kLargestSearched_px)
    return {kLargestSearched_px / longest, std::min(1.0, 2 * kLargestSearched_px / longest)};
  if (longest < kSmallestSearched_px) {
    // Corners of enlarged images are the more exact ones.
    const double larger = std::ceil(kSmallestSearched_px / longest);
    return {larger, 1.0};
  }
  return {1.0};
}

enum class Effort { kFast, kExhaustive };

// How to search: at the likeliest scale as it is, thoroughly, at the others, and without the noise.
struct Search {
  double scale = 1;
  double smoothing_px = 0;
  Effort effort = Effort::kFast;
};

std::vector<Search> Searches(const cv::Mat& gray) {
  const std::vector<double> scales = SearchScales(gray);
  std::vector<Search> searches = {{scales.front()}, {scales.front(), 0, Effort::kExhaustive}};
  for (std::size_t i = 1; i < scales.size(); ++i) searches.push_back({scales[i]});
  searches.push_back({scales.front(), kNoiseSmoothing_px});
  return searches;
}

// In the image that was scaled by `scale`, the centers of whose pixels are at whole numbers, too.
void Unscale(double scale, std::vector<cv::Point2f>* points) {
  for (cv::Point2f& point : *points) {
    point.x = static_cast<float>((point.x + 0.5) / scale - 0.5);
    point.y = static_cast<float>((point.y + 0.5) / scale - 0.5);
  }
}

// Of neighbors in a grid of points, row by row.
double ShortestStep(const std::vector<cv::Point2f>& points, int columns) {
  double shortest = cv::norm(points[1] - points[0]);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto step_to = [&](std::size_t other) { shortest = std::min(shortest, cv::norm(points[other] - points[i])); };
    if ((i + 1) % static_cast<std::size_t>(columns) != 0) step_to(i + 1);
    if (i + static_cast<std::size_t>(columns) < points.size()) step_to(i + static_cast<std::size_t>(columns));
  }
  return shortest;
}

// Moves corners to where the gradients around them agree (Förstner). Those of findChessboardCornersSB are drawn towards
// the image's center by up to 0.1 px and some are off by pixels; these are off by 0.03 px in clean images (RMS).
void Refine(const cv::Mat& gray, int columns, std::vector<cv::Point2f>* corners) {
  const int reach = std::clamp(static_cast<int>(0.3 * ShortestStep(*corners, columns)), 2, 15);
  cv::cornerSubPix(gray, *corners, {reach, reach}, {-1, -1},
                   {cv::TermCriteria::EPS + cv::TermCriteria::MAX_ITER, 50, 1e-3});
}

bool FindChessboard(const cv::Mat& gray, cv::Size size, Effort effort, std::vector<cv::Point2f>* corners) {
  const int exhaustive = effort == Effort::kExhaustive ? cv::CALIB_CB_EXHAUSTIVE : 0;
  return cv::findChessboardCornersSB(gray, size, *corners, kChessboardFlags | exhaustive);
}

// Blobs, or none where there are so many that no board is looked for among them: the search takes the third power of
// their number, hours for a picture of gravel.
class Blobs final : public cv::Feature2D {
 public:
  Blobs(const cv::SimpleBlobDetector::Params& params, std::size_t most)
      : detector_(cv::SimpleBlobDetector::create(params)), most_(most) {}

  void detect(cv::InputArray image, std::vector<cv::KeyPoint>& keypoints, cv::InputArray mask) override {
    detector_->detect(image, keypoints, mask);
    if (keypoints.size() > most_) keypoints.clear();
  }

 private:
  cv::Ptr<cv::FeatureDetector> detector_;
  std::size_t most_;
};

bool FindCircles(const cv::Mat& gray, const CalibrationBoard& board, std::vector<cv::Point2f>* centers) {
  const int grid = board.kind == BoardKind::kCircles ? cv::CALIB_CB_SYMMETRIC_GRID : cv::CALIB_CB_ASYMMETRIC_GRID;
  cv::SimpleBlobDetector::Params params;
  params.maxArea = static_cast<float>(gray.total()) / static_cast<float>(board.NumPoints());
  params.minDistBetweenBlobs = 4;
  const auto most = std::max<std::size_t>(kMaxBlobs, 4 * static_cast<std::size_t>(board.NumPoints()));
  const cv::Ptr<cv::FeatureDetector> blobs = cv::makePtr<Blobs>(params, most);
  const cv::Size size(board.columns, board.rows);
  // Under a fisheye circles are taken for each other.
  return std::ranges::any_of(std::array{0, static_cast<int>(cv::CALIB_CB_CLUSTERING)}, [&](int clustering) {
    return cv::findCirclesGrid(gray, size, *centers, grid | clustering, blobs) &&
           centers->size() == static_cast<std::size_t>(board.NumPoints()) && AreInOrder(board, *centers);
  });
}

// All points of a board that is seen as a whole; none where it is not.
std::vector<cv::Point2f> FindWholeBoard(const cv::Mat& gray, const CalibrationBoard& board) {
  const bool is_chessboard = board.kind == BoardKind::kChessboard;
  for (const auto& [scale, smoothing_px, effort] : Searches(gray)) {
    if (effort == Effort::kExhaustive && !is_chessboard) continue;
    cv::Mat searched = Resized(gray, scale);
    if (smoothing_px > 0) searched = Smoothed(searched, smoothing_px);
    std::vector<cv::Point2f> points;
    const bool found = is_chessboard ? FindChessboard(searched, {board.columns, board.rows}, effort, &points)
                                     : FindCircles(searched, board, &points);
    if (!found || points.size() != static_cast<std::size_t>(board.NumPoints())) continue;
    Unscale(scale, &points);
    // Squares of images that had to be enlarged are too small for it.
    if (is_chessboard && scale <= 1.0) Refine(gray, board.columns, &points);
    return points;
  }
  return {};
}

// What circles may be that were taken for those of `board`, the likeliest first.
std::vector<CalibrationBoard> SimilarCircles(const CalibrationBoard& board) {
  constexpr int kFewestCircles = 3;  // along a side
  constexpr int kMostOff = 2;
  const BoardKind other_kind = board.kind == BoardKind::kCircles ? BoardKind::kAsymmetricCircles : BoardKind::kCircles;
  std::vector<CalibrationBoard> similar;
  const auto add = [&](BoardKind kind, int columns, int rows) {
    if (columns < kFewestCircles || rows < kFewestCircles) return;
    if (kind == board.kind && columns == board.columns && rows == board.rows) return;
    similar.push_back({kind, columns, rows, board.spacing_mm});
  };
  for (const BoardKind kind : {board.kind, other_kind}) {
    add(kind, board.columns, board.rows);
    add(kind, board.rows, board.columns);
  }
  for (int columns = -kMostOff; columns <= kMostOff; ++columns)
    for (int rows = -kMostOff; rows <= kMostOff; ++rows)
      if (columns != 0 || rows != 0) add(board.kind, board.columns + columns, board.rows + rows);
  return similar;
}

}  // namespace

Status CheckBoardIsSupported(const CalibrationBoard& board) {
  return board.kind == BoardKind::kCharuco ? CheckCharucoIsSupported(board) : Status::Ok();
}

std::optional<BoardView> FindBoard(const cv::Mat& gray, const CalibrationBoard& board) {
  if (board.kind == BoardKind::kCharuco) return FindCharuco(gray, board);
  const std::vector<cv::Point2f> points = FindWholeBoard(gray, board);
  if (points.empty()) return std::nullopt;
  BoardView view;
  view.point_ids.resize(points.size());
  std::iota(view.point_ids.begin(), view.point_ids.end(), 0);
  for (const cv::Point2f& point : points) view.pixels.emplace_back(point.x, point.y);
  return view;
}

cv::Mat AsSearched(const cv::Mat& gray) { return Resized(gray, std::min(1.0, SearchScales(gray).front())); }

std::optional<ChessboardSize> LargestChessboard(const cv::Mat& gray) {
  const cv::Mat searched = Resized(gray, SearchScales(gray).front());
  cv::Mat corners;
  cv::Mat meta;
  if (!cv::findChessboardCornersSB(searched, {3, 3}, corners,
                                   kChessboardFlags | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_LARGER, meta))
    return std::nullopt;
  return ChessboardSize{std::max(meta.cols, meta.rows), std::min(meta.cols, meta.rows)};
}

std::optional<CalibrationBoard> LargerCircles(const cv::Mat& gray, const CalibrationBoard& board) {
  constexpr int kMostMore = 4;
  CalibrationBoard larger = board;
  const auto grows = [&](int CalibrationBoard::*side) {
    for (int more = 0; more < kMostMore; ++more) {
      CalibrationBoard next = larger;
      ++(next.*side);
      if (FindWholeBoard(gray, next).empty()) return;
      larger = next;
    }
  };
  grows(&CalibrationBoard::columns);
  grows(&CalibrationBoard::rows);
  return larger.NumPoints() > board.NumPoints() ? std::optional(larger) : std::nullopt;
}

std::optional<CalibrationBoard> SimilarBoard(const cv::Mat& gray, const CalibrationBoard& board) {
  if (board.kind == BoardKind::kChessboard) return std::nullopt;
  if (board.kind == BoardKind::kCharuco) {
    auto seen = SeenCharuco(gray, board);
    const bool is_other =
        seen && (seen->columns != board.columns || seen->rows != board.rows || seen->dictionary != board.dictionary);
    return is_other ? seen : std::nullopt;
  }
  const bool is_found = !FindWholeBoard(gray, board).empty();
  for (const CalibrationBoard& similar : SimilarCircles(board)) {
    if ((is_found && similar.kind == board.kind) || FindWholeBoard(gray, similar).empty()) continue;
    const CalibrationBoard whole = LargerCircles(gray, similar).value_or(similar);
    if (whole.Text() != board.Text()) return whole;
  }
  return std::nullopt;
}

bool ShowsOtherMarkers(const cv::Mat& gray, const CalibrationBoard& board) {
  return board.kind == BoardKind::kCharuco && ShowsOtherCharuco(gray, board);
}

bool IsMirrored(const cv::Mat& gray, const CalibrationBoard& board) {
  if (board.kind != BoardKind::kCharuco) return false;
  cv::Mat mirrored;
  cv::flip(gray, mirrored, 1);
  return FindCharuco(mirrored, board).has_value();
}

}  // namespace pliant
