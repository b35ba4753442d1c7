// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What makes a simulated sequence as hard as a real one: noise of the light, sharpening, rows that are exposed at
// different times, compression, lost frames; and the presets that set them.
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pliant/simulation/simulator.h"
#include "simulation/recorded_frames.h"
#include "simulation/recorder.h"
#include "simulation/sensor.h"
#include "simulation/small_scene.h"
#include "simulation/video_codec.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using simulation_test::Make;
using simulation_test::SamePixels;
using simulation_test::SmallScene;

constexpr double kDeviation = 0.03;         // relative: 60,000 samples fix a deviation to 0.3 %, correlated ones to 1 %
constexpr double kCorrelation = 0.03;       // of neighbors, from as many samples
constexpr double kOwnPixels = 0.02;         // shares of lost frames in 20,000, in runs
constexpr double kSharpEdge_levels = 10.0;  // a step of 100 overshoots by half the amount times the detail at its foot
constexpr double kOtherCompiler_levels = 1.0;  // rounding; with one compiler they are the same
constexpr double kRigidRow_levels = 0.1;       // in the mean: rounding of times and normals
constexpr double kSameRow_levels = 1.0;        // the same where the material moves: linear in time; no vertical blur

// A plain gray field of linear light, developed with gamma 1: levels are 255 times light, without rounding's help.
cv::Mat DevelopField(const SimulationOptions::Sensor& sensor, double light) {
  const cv::Mat radiance(240, 256, CV_32FC3, cv::Scalar::all(light));
  cv::Mat levels;
  simulation::Develop(sensor, radiance, 1.0, 7).convertTo(levels, CV_32FC3);
  cv::extractChannel(levels, levels, 1);
  return levels;
}

SimulationOptions::Sensor PlainSensor() {
  SimulationOptions::Sensor sensor;
  sensor.gamma = 1.0;
  sensor.noise_levels = 0;
  sensor.blur_px = 0;
  sensor.vignetting = 0;
  return sensor;
}

double Deviation(const cv::Mat& levels) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(levels, mean, deviation);
  return deviation[0];
}

// Of pixels that many columns apart.
double Correlation(const cv::Mat& levels, int apart) {
  const cv::Mat centered = levels - cv::mean(levels)[0];
  const cv::Mat left = centered.colRange(0, centered.cols - apart);
  const cv::Mat right = centered.colRange(apart, centered.cols);
  return cv::mean(left.mul(right))[0] / cv::mean(centered.mul(centered))[0];
}

TEST(LightNoise, GrowsWithTheSquareRootOfTheLight) {
  SimulationOptions::Sensor sensor = PlainSensor();
  sensor.read_noise = 0.02;
  sensor.shot_noise = 0.06;
  for (const double light : {0.2, 0.5, 0.7}) {
    const double expected = 255 * std::sqrt(0.02 * 0.02 + 0.06 * 0.06 * light);
    EXPECT_NEAR(Deviation(DevelopField(sensor, light)) / expected, 1.0, kDeviation) << light;
  }
}

TEST(LightNoise, IsCorrelatedAsAskedAtTheSameDeviation) {
  SimulationOptions::Sensor sensor = PlainSensor();
  sensor.read_noise = 0.04;
  const cv::Mat white = DevelopField(sensor, 0.5);
  EXPECT_NEAR(Correlation(white, 1), 0.0, kCorrelation);
  sensor.noise_correlation_px = 1.0;
  const cv::Mat smooth = DevelopField(sensor, 0.5);
  EXPECT_NEAR(Deviation(smooth) / Deviation(white), 1.0, kDeviation);
  // White noise after a Gaussian of deviation s: correlation exp(-d^2 / (4 s^2)).
  EXPECT_NEAR(Correlation(smooth, 1), std::exp(-0.25), kCorrelation);
  EXPECT_NEAR(Correlation(smooth, 2), std::exp(-1.0), kCorrelation);
}

TEST(Sharpening, OvershootsAtAnEdgeAndLeavesPlainAreas) {
  SimulationOptions::Sensor sensor = PlainSensor();
  cv::Mat radiance(40, 40, CV_32FC3, cv::Scalar::all(0.3));
  radiance.colRange(20, 40).setTo(cv::Scalar::all(0.7));
  const cv::Mat plain = simulation::Develop(sensor, radiance, 1.0, 1);
  sensor.sharpening = 0.8;
  const cv::Mat sharp = simulation::Develop(sensor, radiance, 1.0, 1);
  EXPECT_EQ(sharp.at<cv::Vec3b>(20, 5), plain.at<cv::Vec3b>(20, 5));
  EXPECT_EQ(sharp.at<cv::Vec3b>(20, 35), plain.at<cv::Vec3b>(20, 35));
  EXPECT_GT(sharp.at<cv::Vec3b>(20, 20)[1], plain.at<cv::Vec3b>(20, 20)[1] + kSharpEdge_levels);
  EXPECT_LT(sharp.at<cv::Vec3b>(20, 19)[1], plain.at<cv::Vec3b>(20, 19)[1] - kSharpEdge_levels);
}

// Mean absolute difference of the rows of one parity, or of all.
double RowsDifference(const cv::Mat& a, const cv::Mat& b, int first, int step) {
  double sum = 0;
  int rows = 0;
  for (int y = first; y < a.rows; y += step, ++rows) sum += cv::norm(a.row(y), b.row(y), cv::NORM_L1);
  return sum / (3.0 * a.cols * rows);
}

SimulationOptions MovingScene() {
  SimulationOptions options = SmallScene(TrajectoryKind::kInsert, 9);
  options.sensor.noise_levels = 0;
  options.sensor.gain_jitter = 0;
  options.sensor.exposure_time_s = 1000;
  options.trajectory.speed_mm_s = 200;
  options.trajectory.tremor_mm = 0;
  options.trajectory.tremor_deg = 0;
  options.scene.length_mm = 250;
  options.deformation.amplitude_mm = 8;
  options.deformation.omega_rad_s = 10;
  options.deformation.wavelength_mm = 400;
  return options;
}

// Frame 4 at 30 Hz is frame 16 at 120 Hz: the even rows show frame 15, the odd ones frame 17.
TEST(RowTimes, InterlacedRowsAreAQuarterOfAFrameBeforeAndAfterTheTruth) {
  SimulationOptions options = MovingScene();
  const SimulatedFrame at_once = Make(options).Render(4);
  options.sensor.interlaced = Switch::kOn;
  const SimulatedFrame interlaced = Make(options).Render(4);
  EXPECT_TRUE(SamePixels(interlaced.depth, at_once.depth));
  options.sensor.interlaced = Switch::kOff;
  options.trajectory.fps = 120;
  options.trajectory.frames = 33;
  Simulator fine = Make(options);
  const cv::Mat before = fine.Render(15).image;
  const cv::Mat after = fine.Render(17).image;
  EXPECT_LT(RowsDifference(interlaced.image, before, 0, 2), kSameRow_levels);
  EXPECT_LT(RowsDifference(interlaced.image, after, 1, 2), kSameRow_levels);
  EXPECT_GT(RowsDifference(interlaced.image, after, 0, 2), 2 * RowsDifference(interlaced.image, before, 0, 2));
  EXPECT_GT(RowsDifference(interlaced.image, before, 1, 2), 2 * RowsDifference(interlaced.image, after, 1, 2));
}

// Nothing but the camera moves, and no row is blurred into the next one: the rows are those of the other moments.
TEST(RowTimes, InterlacedRowsOfARigidSceneAreThoseOfTheOtherMoments) {
  SimulationOptions options = MovingScene();
  options.deformation.amplitude_mm = 0;
  options.sensor.blur_px = 0;
  options.sensor.interlaced = Switch::kOn;
  const cv::Mat interlaced = Make(options).Render(4).image;
  options.sensor.interlaced = Switch::kOff;
  options.trajectory.fps = 120;
  options.trajectory.frames = 33;
  Simulator fine = Make(options);
  EXPECT_LT(RowsDifference(interlaced, fine.Render(15).image, 0, 2), kRigidRow_levels);
  EXPECT_LT(RowsDifference(interlaced, fine.Render(17).image, 1, 2), kRigidRow_levels);
}

TEST(RowTimes, ARollingShutterShowsTheFirstRowsBeforeAndTheLastOnesAfterTheTruth) {
  SimulationOptions options = MovingScene();
  options.sensor.readout_s = 1.0 / 60;
  const cv::Mat rolling = Make(options).Render(4).image;
  options.sensor.readout_s = 0;
  options.trajectory.fps = 120;
  options.trajectory.frames = 33;
  Simulator fine = Make(options);
  const cv::Mat before = fine.Render(15).image;
  const cv::Mat after = fine.Render(17).image;
  const auto difference = [&](const cv::Mat& other, int y) {
    return RowsDifference(rolling.rowRange(y, y + 10), other.rowRange(y, y + 10), 0, 1);
  };
  EXPECT_GT(difference(after, 0), 2 * difference(before, 0));
  EXPECT_GT(difference(before, 110), 2 * difference(after, 110));
}

TEST(RowTimes, RefusesAReadoutThatIsLongerThanAFrame) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 1);
  options.sensor.readout_s = 0.05;
  EXPECT_THAT(Simulator::Create(options).status().message(), testing::HasSubstr("readout_s"));
}

double MeanDifference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / (3.0 * static_cast<double>(a.total()));
}

std::vector<cv::Mat> Images(TrajectoryKind kind, int frames) {
  Simulator simulator = Make(SmallScene(kind, frames));
  std::vector<cv::Mat> images;
  for (int k = 0; k < frames; ++k) images.push_back(simulator.Render(k).image);
  return images;
}

// The mean error of a quantization step grows with it and stays below it; a sequence is coded the same way twice.
TEST(VideoCodec, ChangesImagesByLessThanItsStepAndMoreWhereItIsCoarser) {
  const std::vector<cv::Mat> images = Images(TrajectoryKind::kInsert, 4);
  double finer = 0;
  for (const int qp : {18, 26, 34}) {
    simulation::VideoCodec codec(qp, 30);
    simulation::VideoCodec again(qp, 30);
    double difference = 0;
    for (const cv::Mat& image : images) {
      const cv::Mat decoded = codec.Decode(image);
      EXPECT_TRUE(SamePixels(decoded, again.Decode(image)));
      ASSERT_EQ(decoded.size(), image.size());
      difference += MeanDifference(decoded, image) / static_cast<double>(images.size());
    }
    EXPECT_LT(difference, 0.625 * std::pow(2.0, qp / 6.0)) << qp;
    EXPECT_GT(difference, finer) << qp;
    finer = difference;
  }
}

// Noise of less than a step is coded once and then kept; a key frame codes it anew.
TEST(VideoCodec, KeepsAStillSceneUntilTheNextKeyFrame) {
  cv::Mat scene(64, 80, CV_8UC3, cv::Scalar(90, 110, 150));
  cv::circle(scene, {40, 30}, 14, cv::Scalar(40, 60, 120), cv::FILLED);
  simulation::VideoCodec codec(28, 3);
  const auto noisy = [&](int seed) {
    cv::Mat noise(scene.size(), CV_16SC3);
    cv::RNG(static_cast<std::uint64_t>(seed)).fill(noise, cv::RNG::NORMAL, 0, 1.5);
    cv::Mat image;
    cv::add(scene, noise, image, cv::noArray(), CV_8UC3);
    return image;
  };
  const cv::Mat key = codec.Decode(noisy(1));
  const cv::Mat second = codec.Decode(noisy(2));
  EXPECT_LT(MeanDifference(second, key), 0.5 * MeanDifference(noisy(1), noisy(2)));
  EXPECT_LT(MeanDifference(codec.Decode(noisy(3)), second), 0.5 * MeanDifference(noisy(1), noisy(2)));
}

TEST(Recorder, JpegChangesAnImageByABoundedAmount) {
  const std::vector<cv::Mat> images = Images(TrajectoryKind::kHold, 1);
  SimulationOptions::Recording recording;
  EXPECT_TRUE(SamePixels(simulation::Recorder(recording).Record(images[0]), images[0]));
  constexpr double kGood_levels = 3.0;  // in the mean; chroma is at half the resolution
  recording.jpeg_quality = 90;
  const double good = MeanDifference(simulation::Recorder(recording).Record(images[0]), images[0]);
  recording.jpeg_quality = 30;
  const double poor = MeanDifference(simulation::Recorder(recording).Record(images[0]), images[0]);
  EXPECT_GT(good, 0.0);
  EXPECT_LT(good, kGood_levels);
  EXPECT_GT(poor, good);
}

TEST(RecordedFrames, AreAllOfTheCamerasWhereNoneIsLost) {
  SimulationOptions options;
  const auto recorded = simulation::RecordedFrames(options);
  ASSERT_EQ(std::ssize(recorded), options.trajectory.frames);
  for (int k = 0; k < options.trajectory.frames; ++k) {
    EXPECT_EQ(recorded[k].shown_idx, k);
    EXPECT_EQ(recorded[k].clock_idx, k);
  }
}

TEST(RecordedFrames, LoseTheShareAskedForInRunsOfTheLengthAskedFor) {
  SimulationOptions options;
  options.trajectory.frames = 20000;
  options.recording.lost_share = 0.2;
  options.recording.lost_run = 3;
  options.recording.repeated_share = 0;
  const auto recorded = simulation::RecordedFrames(options);
  EXPECT_NEAR(1.0 - static_cast<double>(recorded.size()) / options.trajectory.frames, 0.2, kOwnPixels);
  int gaps = 0;
  for (std::size_t k = 1; k < recorded.size(); ++k) {
    EXPECT_GT(recorded[k].clock_idx, recorded[k - 1].clock_idx);
    gaps += recorded[k].clock_idx > recorded[k - 1].clock_idx + 1 ? 1 : 0;
  }
  EXPECT_NEAR((options.trajectory.frames - static_cast<double>(recorded.size())) / gaps, 3.0, 0.2);

  options.recording.repeated_share = 1;
  const auto repeated = simulation::RecordedFrames(options);
  EXPECT_EQ(std::ssize(repeated), options.trajectory.frames);
  int copies = 0;
  for (const auto& frame : repeated) copies += frame.shown_idx < frame.clock_idx ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(copies) / options.trajectory.frames, 0.2, kOwnPixels);
}

// Each frame of a recording with gaps and copies is the frame of the whole one that it shows: image, depth, pose, and
// where material points are.
void ExpectTruthOfShownFrames(Simulator& recording, Simulator& whole) {
  const auto hit = whole.HitsAt(0, std::vector<Eigen::Vector2d>{{40, 60}})[0];
  ASSERT_TRUE(hit.has_value());
  double last_s = -1;
  for (int k = 0; k < recording.frame_count(); ++k) {
    EXPECT_GT(recording.TimeOf(k), last_s);
    last_s = recording.TimeOf(k);
    const int shown = static_cast<int>(std::lround(recording.ShownTimeOf(k) * whole.options().trajectory.fps));
    const SimulatedFrame frame = recording.Render(k);
    const SimulatedFrame expected = whole.Render(shown);
    EXPECT_TRUE(SamePixels(frame.image, expected.image)) << k;
    EXPECT_TRUE(SamePixels(frame.depth, expected.depth)) << k;
    EXPECT_EQ(recording.WorldFromCamera(k).translation, whole.WorldFromCamera(shown).translation);
    const auto seen = recording.Observe(k, std::vector{hit->point})[0];
    const auto truth = whole.Observe(shown, std::vector{hit->point})[0];
    EXPECT_EQ(seen.point_in_world, truth.point_in_world);
    EXPECT_EQ(seen.pixel, truth.pixel);
  }
}

TEST(RecordedFrames, KeepTheirTruth) {
  SimulationOptions options = SmallScene(TrajectoryKind::kInsert, 16);
  options.deformation.amplitude_mm = 4;
  Simulator whole = Make(options);
  options.recording.lost_share = 0.4;
  options.recording.lost_run = 1.5;
  options.recording.repeated_share = 0;
  Simulator gaps = Make(options);
  EXPECT_LT(gaps.frame_count(), whole.frame_count());
  EXPECT_GT(gaps.TimeOf(gaps.frame_count() - 1), gaps.frame_count() / options.trajectory.fps);
  ExpectTruthOfShownFrames(gaps, whole);
  options.recording.repeated_share = 1;
  Simulator copies = Make(options);
  EXPECT_EQ(copies.frame_count(), whole.frame_count());
  int copied = 0;
  for (int k = 0; k < copies.frame_count(); ++k) copied += copies.ShownTimeOf(k) < copies.TimeOf(k) ? 1 : 0;
  EXPECT_GT(copied, 0);
  ExpectTruthOfShownFrames(copies, whole);
}

TEST(Realism, CleanIsWhatTheOptionsAreByThemselves) {
  EXPECT_TRUE(ToYaml(MakeSimulationOptions(Realism::kClean)) == ToYaml(SimulationOptions()));
  EXPECT_FALSE(ToYaml(MakeSimulationOptions(Realism::kEndoscope)) == ToYaml(SimulationOptions()));
}

TEST(Realism, EndoscopeChangesTextureSensorAndRecordingAlone) {
  SimulationOptions endoscope = MakeSimulationOptions(Realism::kEndoscope);
  const SimulationOptions clean;
  endoscope.texture = clean.texture;
  endoscope.sensor = clean.sensor;
  endoscope.recording = clean.recording;
  EXPECT_EQ(ToYaml(endoscope), ToYaml(clean));
}

// Pixels of an image that was rendered before any of these options was there.
TEST(Realism, CleanPixelsAreWhatTheyWereBefore) {
  struct Pixel {
    int x, y;
    cv::Vec3i level;
  };
  const std::vector<Pixel> before = {
      {20, 20, {116, 128, 198}},  {60, 20, {72, 79, 134}},  {100, 20, {75, 82, 133}},    {140, 20, {132, 144, 223}},
      {20, 60, {108, 119, 198}},  {60, 60, {66, 73, 122}},  {100, 60, {74, 83, 128}},    {140, 60, {114, 127, 197}},
      {20, 100, {102, 109, 192}}, {60, 100, {86, 92, 190}}, {100, 100, {129, 142, 218}}, {140, 100, {116, 128, 224}}};
  const cv::Mat image = Make(SmallScene(TrajectoryKind::kInsert, 2)).Render(1).image;
  for (const Pixel& pixel : before)
    EXPECT_LE(cv::norm(cv::Vec3i(image.at<cv::Vec3b>(pixel.y, pixel.x)) - pixel.level, cv::NORM_INF),
              kOtherCompiler_levels)
        << pixel.x << ", " << pixel.y;
}

// Options that are set to nothing take the way that the clean camera takes.
TEST(Realism, OptionsAtNothingLeaveTheCleanPixels) {
  const SimulationOptions clean = SmallScene(TrajectoryKind::kInsert, 2);
  SimulationOptions nothing = clean;
  nothing.sensor.noise_correlation_px = 2;  // of no noise
  nothing.sensor.sharpening_px = 3;         // of no sharpening
  nothing.recording.lost_run = 5;           // of no frame
  const SimulatedFrame a = Make(clean).Render(1);
  const SimulatedFrame b = Make(nothing).Render(1);
  EXPECT_TRUE(SamePixels(a.image, b.image));
}

TEST(Realism, GivesTheSamePixelsOnAnyNumberOfThreads) {
  SimulationOptions options = SmallScene(TrajectoryKind::kInsert, 3);
  const SimulationOptions endoscope = MakeSimulationOptions(Realism::kEndoscope);
  options.sensor = endoscope.sensor;
  options.deformation.amplitude_mm = 2;
  simulation_test::ExpectSameBytesOnFourThreads(options, {0, 2});
}

}  // namespace
}  // namespace pliant
