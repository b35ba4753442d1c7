// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Following a point, against OpenCV on the same images, points, window and levels, on one thread. Ours includes gain,
// bias and SSIM; OpenCV's has neither. Reported as counters:
//   ns_a_point   time for one point
//   ratio        (on BM_TrackPoints) OpenCV's time with ready pyramids over ours; above 1 ours is faster
#include <algorithm>
#include <cmath>
#include <ctime>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "pliant/base/random.h"
#include "pliant/image/corners.h"
#include "pliant/photometric/lucas_kanade.h"
#include "pliant/tracking/tracks/point_tracker.h"

namespace pliant {
namespace {

constexpr int kPoints = 500;
constexpr int kPatch_px = 21;
constexpr int kLevels = 4;
const cv::Size kSize(640, 480);
// In steps of 1 / 32 px, to which OpenCV rounds a warp.
const cv::Point2d kMotion_px(3.28125, -2.71875);

// Tissue-like: blurred noise of several scales.
cv::Mat Texture() {
  Random random(1);
  cv::Mat sum(kSize.height + 64, kSize.width + 64, CV_32F, cv::Scalar(120));
  for (const double sigma : {1.5, 4.0, 12.0}) {
    cv::Mat noise(sum.size(), CV_32F);
    for (int y = 0; y < noise.rows; ++y)
      for (int x = 0; x < noise.cols; ++x) noise.at<float>(y, x) = static_cast<float>(random.Normal());
    cv::GaussianBlur(noise, noise, cv::Size(), sigma);
    sum += noise * (20 * 2 * std::sqrt(M_PI) * sigma * 0.6);
  }
  return sum;
}

// The texture shifted, brighter and with sensor noise.
cv::Mat View(const cv::Mat& texture, cv::Point2d shift, double gain, std::uint64_t seed) {
  const cv::Mat map = (cv::Mat_<double>(2, 3) << 1, 0, shift.x - 32, 0, 1, shift.y - 32);
  cv::Mat image;
  cv::warpAffine(texture, image, map, kSize, cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  Random random(seed);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<float>(y, x) = static_cast<float>(gain * image.at<float>(y, x) + random.Normal(1.0));
  cv::Mat gray;
  image.convertTo(gray, CV_8U);
  return gray;
}

struct Scene {
  cv::Mat previous, current;
  ImagePyramid previous_pyramid, current_pyramid;
  SupportMask mask{cv::Mat(kSize, CV_8UC1, cv::Scalar(255))};
  std::vector<cv::Mat> previous_cv, current_cv;
  std::vector<cv::Point2f> points;
  LucasKanadeOptions options;
  std::vector<ReferencePatch> patches;
  std::vector<TrackRequest> requests;

  Scene() {
    cv::setNumThreads(1);
    const cv::Mat texture = Texture();
    previous = View(texture, {0, 0}, 1.0, 2);
    current = View(texture, kMotion_px, 1.05, 3);
    options.patch_size = kPatch_px;
    options.levels = kLevels;
    previous_pyramid = ImagePyramid(previous, kLevels);
    current_pyramid = ImagePyramid(current, kLevels);
    cv::buildOpticalFlowPyramid(previous, previous_cv, {kPatch_px, kPatch_px}, kLevels - 1, true);
    cv::buildOpticalFlowPyramid(current, current_cv, {kPatch_px, kPatch_px}, kLevels - 1, true);
    CornerOptions corners;
    corners.max_corners = kPoints;
    corners.contour_filter = Switch::kOff;
    for (const Corner& corner : DetectCorners(previous, {}, {}, corners)) {
      points.emplace_back(static_cast<float>(corner.pixel.x()), static_cast<float>(corner.pixel.y()));
      patches.emplace_back();
      CutReferencePatch(previous_pyramid, mask, {corner.pixel.x(), corner.pixel.y()}, options, AffineSolution::kWithout,
                        &patches.back());
    }
    for (const ReferencePatch& patch : patches) requests.push_back({&patch, patch.center});
  }
};

const Scene& TheScene() {
  static const Scene scene;
  return scene;
}

void TrackOurs(const Scene& scene, std::vector<PatchMatch>* matches) {
  *matches = TrackBatch(scene.requests, scene.current_pyramid, scene.mask, scene.options, 1);
}

template <class Image>
void TrackOpenCv(const Scene& scene, const Image& previous, const Image& current, std::vector<cv::Point2f>* found) {
  std::vector<std::uint8_t> status;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(previous, current, scene.points, *found, status, error, {kPatch_px, kPatch_px}, kLevels - 1);
}

double ErrorOf(double x, double y, const cv::Point2f& from) {
  return std::hypot(x - from.x - kMotion_px.x, y - from.y - kMotion_px.y);
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

template <class Body>
double BestSeconds(const Body& body) {
  double best = 1e9;
  for (int i = 0; i < 15; ++i) {
    const std::clock_t start = std::clock();  // processor time: other programs do not count
    body();
    best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return best;
}

void PerPoint(benchmark::State& state, std::size_t points) {
  state.counters["ns_a_point"] = benchmark::Counter(
      static_cast<double>(points) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void BM_TrackPoints(benchmark::State& state) {
  const Scene& scene = TheScene();
  std::vector<PatchMatch> matches;
  for (auto _ : state) TrackOurs(scene, &matches);
  std::vector<double> errors;
  int iterations = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    errors.push_back(ErrorOf(matches[i].pixel.x, matches[i].pixel.y, scene.points[i]));
    iterations += matches[i].iterations;
  }
  PerPoint(state, matches.size());
  state.counters["median_error_px"] = Median(errors);
  state.counters["iterations"] = static_cast<double>(iterations) / static_cast<double>(matches.size());
  std::vector<cv::Point2f> found;
  const double ours = BestSeconds([&] { TrackOurs(scene, &matches); });
  state.counters["ratio"] =
      BestSeconds([&] { TrackOpenCv(scene, scene.previous_cv, scene.current_cv, &found); }) / ours;
  state.counters["ratio_with_pyramids"] =
      BestSeconds([&] { TrackOpenCv(scene, scene.previous, scene.current, &found); }) /
      (ours + BestSeconds([&] { benchmark::DoNotOptimize(ImagePyramid(scene.current, kLevels)); }));
}
BENCHMARK(BM_TrackPoints)->Unit(benchmark::kMillisecond);

void BM_OpenCvReadyPyramids(benchmark::State& state) {
  const Scene& scene = TheScene();
  std::vector<cv::Point2f> found;
  for (auto _ : state) TrackOpenCv(scene, scene.previous_cv, scene.current_cv, &found);
  std::vector<double> errors;
  for (std::size_t i = 0; i < found.size(); ++i) errors.push_back(ErrorOf(found[i].x, found[i].y, scene.points[i]));
  PerPoint(state, found.size());
  state.counters["median_error_px"] = Median(errors);
}
BENCHMARK(BM_OpenCvReadyPyramids)->Unit(benchmark::kMillisecond);

void BM_OpenCvFromImages(benchmark::State& state) {
  const Scene& scene = TheScene();
  std::vector<cv::Point2f> found;
  for (auto _ : state) TrackOpenCv(scene, scene.previous, scene.current, &found);
  PerPoint(state, found.size());
}
BENCHMARK(BM_OpenCvFromImages)->Unit(benchmark::kMillisecond);

void BM_CutReferencePatches(benchmark::State& state) {
  const Scene& scene = TheScene();
  std::vector<ReferencePatch> patches = scene.patches;
  for (auto _ : state)
    for (ReferencePatch& patch : patches)
      CutReferencePatch(scene.previous_pyramid, scene.mask, patch.center, scene.options, AffineSolution::kWithout,
                        &patch);
  PerPoint(state, patches.size());
}
BENCHMARK(BM_CutReferencePatches)->Unit(benchmark::kMillisecond);

void BM_Pyramid(benchmark::State& state) {
  const Scene& scene = TheScene();
  for (auto _ : state) benchmark::DoNotOptimize(ImagePyramid(scene.current, kLevels));
}
BENCHMARK(BM_Pyramid)->Unit(benchmark::kMillisecond);

void BM_ValidMask(benchmark::State& state) {
  const Scene& scene = TheScene();
  cv::Mat color;
  cv::cvtColor(scene.current, color, cv::COLOR_GRAY2BGR);
  for (auto _ : state) benchmark::DoNotOptimize(SupportMask(ValidMask(color, {}, {})));
}
BENCHMARK(BM_ValidMask)->Unit(benchmark::kMillisecond);

void BM_DetectCorners(benchmark::State& state) {
  const Scene& scene = TheScene();
  for (auto _ : state) benchmark::DoNotOptimize(DetectCorners(scene.current, {}, {}, {}));
}
BENCHMARK(BM_DetectCorners)->Unit(benchmark::kMillisecond);

// The whole of the patch policy: predicted start, latest patch, re-alignment to the first, forward-backward.
void BM_PointTracker(benchmark::State& state) {
  const Scene& scene = TheScene();
  PointTrackerOptions options;
  options.lucas_kanade.patch_size = static_cast<int>(state.range(2));
  options.patch_policy = static_cast<PatchPolicy>(state.range(0));
  PointTracker first(options);
  std::vector<PointPrediction> predictions;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    predictions.push_back(
        {PointId{static_cast<std::int64_t>(i)}, {scene.points[i].x, scene.points[i].y}, Eigen::Matrix2d::Identity()});
    first.Add(predictions.back().id, predictions.back().pixel, scene.previous_pyramid, scene.mask);
  }
  for (auto _ : state) {
    state.PauseTiming();
    PointTracker tracker = first;
    state.ResumeTiming();
    benchmark::DoNotOptimize(tracker.Track(scene.previous_pyramid, scene.mask, scene.current_pyramid, scene.mask,
                                           predictions, static_cast<int>(state.range(1))));
  }
  PerPoint(state, predictions.size());
}
BENCHMARK(BM_PointTracker)
    ->ArgNames({"adaptive", "threads", "patch"})
    ->Args({0, 1, 21})
    ->Args({1, 1, 15})
    ->Args({1, 1, 21})
    ->Args({1, 2, 15})
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pliant
