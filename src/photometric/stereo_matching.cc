// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/photometric/stereo_matching.h"

#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "pliant/base/parallel.h"
#include "pliant/base/statistics.h"
#include "pliant/photometric/lucas_kanade.h"

namespace pliant {
namespace {

constexpr int kRows = 1;     // above and below that are searched as well
constexpr int kPeak_px = 2;  // positions so near to the best one are that one

int MaxDisparity(const StereoMatchingOptions& options, int width) {
  return std::max(1, static_cast<int>(options.max_disparity_share * width));
}

// (B1) Where along its row a patch of the left image resembles the right one most, whole pixels; nothing where too
// little, or where another position does nearly as much.
std::optional<double> SearchRow(const cv::Mat& left, const cv::Mat& right, const Eigen::Vector2d& pixel, int patch_size,
                                const StereoMatchingOptions& options) {
  const int half = patch_size / 2;
  const cv::Point center(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  const cv::Rect patch(center.x - half, center.y - half, 2 * half + 1, 2 * half + 1);
  const int farthest = std::min(MaxDisparity(options, left.cols), patch.x);
  const int nearest = static_cast<int>(std::floor(options.min_disparity_px));
  const cv::Rect strip(patch.x - farthest, patch.y - kRows, farthest - nearest + patch.width, patch.height + 2 * kRows);
  const cv::Rect image(0, 0, left.cols, left.rows);
  if (farthest < nearest || (patch & image) != patch || (strip & image) != strip) return std::nullopt;
  cv::Mat correlation;  // rows: -kRows to kRows; columns: disparities from `farthest` to `nearest`
  cv::matchTemplate(right(strip), left(patch), correlation, cv::TM_CCOEFF_NORMED);
  cv::Mat best_of_column;
  cv::reduce(correlation, best_of_column, 0, cv::REDUCE_MAX);
  double best = 0;
  cv::Point peak;
  cv::minMaxLoc(best_of_column, nullptr, &best, nullptr, &peak);
  if (!(best >= options.min_correlation)) return std::nullopt;
  double second = -1;
  for (int column = 0; column < best_of_column.cols; ++column)
    if (std::abs(column - peak.x) > kPeak_px)
      second = std::max(second, static_cast<double>(best_of_column.at<float>(0, column)));
  if (1.0 - best >= options.max_ambiguity * (1.0 - second)) return std::nullopt;
  return farthest - peak.x;
}

struct Side {
  const ImagePyramid& pyramid;
  const SupportMask& mask;
};

std::optional<Pixel> Align(const Side& from, Pixel pixel, const Side& to, Pixel start,
                           const LucasKanadeOptions& options) {
  ReferencePatch patch;
  if (CutReferencePatch(from.pyramid, from.mask, pixel, options, AffineSolution::kWith, &patch) != PatchFailure::kNone)
    return std::nullopt;
  const PatchMatch match = AlignPatch(patch, to.pyramid, to.mask, start, {}, AlignmentModel::kAffine, options);
  if (match.failure != PatchFailure::kNone) return std::nullopt;
  return match.pixel;
}

// (B2) to (B4)
std::optional<RowMatch> Refine(const Side& left, const Side& right, const Eigen::Vector2d& pixel, double disparity_px,
                               const StereoMatchingOptions& options, const LucasKanadeOptions& lucas_kanade) {
  const Pixel from{pixel.x(), pixel.y()};
  const auto found = Align(left, from, right, {from.x - disparity_px, from.y}, lucas_kanade);
  if (!found || std::abs(found->y - from.y) > options.max_row_px) return std::nullopt;
  const auto back = Align(right, *found, left, from, lucas_kanade);
  if (!back) return std::nullopt;
  const RowMatch match{from.x - found->x, from.y - found->y, std::hypot(back->x - from.x, back->y - from.y)};
  if (match.left_right_px > options.max_left_right_px || match.disparity_px < options.min_disparity_px)
    return std::nullopt;
  return match;
}

// Semi-global matching's disparity between four pixels; nothing where one of them has none, they differ, or it is too
// small.
std::optional<RowMatch> Between(const cv::Mat& disparities, const Eigen::Vector2d& pixel, double min_disparity_px) {
  constexpr float kStep = 1.0F / 16;
  constexpr float kMaxDifference_px = 1;
  const int u = static_cast<int>(std::floor(pixel.x()));
  const int v = static_cast<int>(std::floor(pixel.y()));
  if (u < 0 || v < 0 || u + 1 >= disparities.cols || v + 1 >= disparities.rows) return std::nullopt;
  cv::Mat four;
  disparities(cv::Rect(u, v, 2, 2)).convertTo(four, CV_32F, kStep);
  double low = 0;
  double high = 0;
  cv::minMaxLoc(four, &low, &high);
  if (low <= 0 || high - low > kMaxDifference_px) return std::nullopt;
  const auto disparity_px = SampleBilinear(four, pixel.x() - u, pixel.y() - v);
  if (!disparity_px || *disparity_px < min_disparity_px) return std::nullopt;
  return RowMatch{.disparity_px = *disparity_px};
}

cv::Mat SemiGlobalDisparities(const cv::Mat& left, const cv::Mat& right, const StereoMatchingOptions& options) {
  constexpr int kBlock = 5;
  constexpr int kSmall = 8 * kBlock * kBlock;   // of a change by one, as OpenCV advises
  constexpr int kLarge = 32 * kBlock * kBlock;  // of a larger one
  constexpr int kUnique_percent = 10;
  constexpr int kSpeckle = 100;
  const int count = (MaxDisparity(options, left.cols) + 15) / 16 * 16;
  const auto matcher = cv::StereoSGBM::create(0, count, kBlock, kSmall, kLarge, /*disp12MaxDiff=*/1,
                                              /*preFilterCap=*/31, kUnique_percent, kSpeckle, /*speckleRange=*/2);
  cv::Mat disparities;
  matcher->compute(left, right, disparities);
  return disparities;
}

}  // namespace

void StereoMatchingOptions::List(OptionTable& table) {
  table.AddChoice("stereo_matcher", &matcher,
                  "stereo: photometric: correlation along the row, then the tracker's alignment; sgbm: OpenCV's "
                  "semi-global matching");
  table.Add("stereo_min_disparity_px", &min_disparity_px, "px", "stereo: minimum disparity", 0.1, 1e4);
  table.Add("stereo_max_disparity_share", &max_disparity_share, "-",
            "stereo: maximum disparity divided by the width of the image", 0.001, 1);
  table.Add("stereo_max_row_px", &max_row_px, "px", "stereo: maximum difference of the rows of a match", 0.01, 100);
  table.Add("stereo_max_left_right_px", &max_left_right_px, "px", "stereo: maximum left-right consistency error", 0.01,
            100);
  table.Add("stereo_min_correlation", &min_correlation, "-",
            "stereo: minimum correlation at the best position along the row", 0, 1);
  table.Add("stereo_max_ambiguity", &max_ambiguity, "-",
            "stereo: maximum of 1 - correlation at the best position divided by 1 - correlation at the second "
            "best; 1 accepts all",
            0, 1);
}

Status CheckPairs(const std::string& what, const Camera& camera, std::optional<double> baseline_mm) {
  if (!baseline_mm)
    return {ErrorCode::kMismatch, what +
                                      " needs pairs of images: there are no right images with a baseline; give the "
                                      "calibration of both cameras, or do without pairs"};
  const CameraModelId model = camera.model_id();
  if (*baseline_mm > 0 && (model == CameraModelId::kPinhole || model == CameraModelId::kSimplePinhole))
    return Status::Ok();
  return {ErrorCode::kMismatch, what +
                                    " needs rectified pairs of images, a PINHOLE camera and a baseline above 0: the "
                                    "camera is " +
                                    std::string(camera.model_name()) + ", the baseline " + FormatDouble(*baseline_mm) +
                                    " mm"};
}

std::vector<std::optional<RowMatch>> MatchAlongRows(const ImagePyramid& left, const SupportMask& left_mask,
                                                    const ImagePyramid& right, const SupportMask& right_mask,
                                                    std::span<const Eigen::Vector2d> pixels,
                                                    const StereoMatchingOptions& options,
                                                    const LucasKanadeOptions& lucas_kanade, int threads) {
  const cv::Mat left_image = left.Level(0);
  const cv::Mat right_image = right.Level(0);
  std::vector<std::optional<RowMatch>> matches(pixels.size());
  if (options.matcher == StereoMatcher::kSgbm) {
    const cv::Mat dense = SemiGlobalDisparities(left_image, right_image, options);
    std::transform(pixels.begin(), pixels.end(), matches.begin(),
                   [&](const Eigen::Vector2d& pixel) { return Between(dense, pixel, options.min_disparity_px); });
    return matches;
  }
  ParallelFor(static_cast<int>(pixels.size()), threads, [&](int i) {
    const Eigen::Vector2d& pixel = pixels[static_cast<std::size_t>(i)];
    const auto whole = SearchRow(left_image, right_image, pixel, lucas_kanade.patch_size, options);
    if (whole)
      matches[static_cast<std::size_t>(i)] =
          Refine({left, left_mask}, {right, right_mask}, pixel, *whole, options, lucas_kanade);
  });
  return matches;
}

std::vector<DepthAtPixel> DepthsOfPair(const Camera& camera, double baseline_mm, const cv::Mat& left,
                                       const cv::Mat& left_mask, const cv::Mat& right,
                                       std::span<const Eigen::Vector2d> pixels, int threads) {
  const LucasKanadeOptions lucas_kanade;
  const auto pyramid = [&](const cv::Mat& image) { return ImagePyramid(ToGray(image), lucas_kanade.levels); };
  const auto matches = MatchAlongRows(pyramid(left), SupportMask(ValidMask(left, left_mask, {})), pyramid(right),
                                      SupportMask(ValidMask(right, {}, {})), pixels, {}, lucas_kanade, threads);
  std::vector<double> rows_px;
  for (const auto& match : matches)
    if (match) rows_px.push_back(std::abs(match->row_px));
  const double sigma_row_px = rows_px.empty() ? 0.0 : kMedianToSigma * Median(std::move(rows_px));
  const double focal_baseline = camera.HorizontalFocalLengthPx() * baseline_mm;
  std::vector<DepthAtPixel> depths(pixels.size(), {DepthLookup::kNoDepth});
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!matches[i]) continue;
    const double depth_mm = focal_baseline / matches[i]->disparity_px;
    const double sigma_px = std::hypot(sigma_row_px, matches[i]->left_right_px);
    depths[i] = {DepthLookup::kOk, depth_mm, depth_mm * depth_mm / focal_baseline * sigma_px};
  }
  return depths;
}

}  // namespace pliant
