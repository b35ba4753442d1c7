// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/comparison_figure.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "pliant/base/files.h"
#include "support/temporary_folder.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr int kFrames = 40;

// Frames from `lost_from` to before `lost_to` have no map.
Evaluation EvaluationOfRun(const std::string& name, int lost_from = 0, int lost_to = 0) {
  Evaluation evaluation;
  evaluation.run = name;
  evaluation.survival.tracks = 200;
  evaluation.surface.emplace();
  for (int i = 0; i < kFrames; ++i) {
    const bool tracked = i < lost_from || i >= lost_to;
    evaluation.survival.frames.push_back({i, tracked, tracked ? 200 - i : 0, 0});
    if (!tracked) continue;
    PointFrameError error;
    error.frame_idx = i;
    error.estimate.rmse_mm = 1 + 0.1 * std::sin(0.3 * i);
    error.null.rmse_mm = 17;
    evaluation.surface->plain.frames.push_back(error);
  }
  return evaluation;
}

Evaluation WithCamera(Evaluation evaluation) {
  evaluation.trajectory.emplace();
  for (const TrackSurvival::Frame& frame : evaluation.survival.frames) {
    if (!frame.tracked) continue;
    evaluation.trajectory->frame_idx.push_back(frame.frame_idx);
    evaluation.trajectory->ate_mm.push_back(0.5);
  }
  return evaluation;
}

cv::Mat Draw(const std::vector<Evaluation>& evaluations, const std::string& path) {
  const Status status = WriteComparisonFigure(evaluations, path);
  EXPECT_TRUE(status.ok()) << status.message();
  return cv::imread(path);
}

// Of the first run's color.
int CountBlue(const cv::Mat& picture) {
  int count = 0;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const auto& color = picture.at<cv::Vec3b>(y, x);
      count += color[0] > color[2] + 100 ? 1 : 0;
    }
  }
  return count;
}

TEST(ComparisonFigure, IsOneColumnWideAndHasAPanelForEveryFigureThatARunHas) {
  const TemporaryFolder folder("comparison_figure");
  const cv::Mat two = Draw({EvaluationOfRun("a"), EvaluationOfRun("b")}, folder.Path("two.png"));
  const cv::Mat three = Draw({EvaluationOfRun("a"), WithCamera(EvaluationOfRun("b"))}, folder.Path("three.png"));
  ASSERT_FALSE(two.empty());
  EXPECT_EQ(two.cols, 2040);
  EXPECT_EQ(three.cols, 2040);
  EXPECT_GT(three.rows, two.rows + 300);
}

TEST(ComparisonFigure, HasGapsWhereARunHasNoMap) {
  const TemporaryFolder folder("comparison_gaps");
  const int whole = CountBlue(Draw({EvaluationOfRun("a")}, folder.Path("whole.png")));
  const int half = CountBlue(Draw({EvaluationOfRun("a", 10, 30)}, folder.Path("half.png")));
  EXPECT_LT(half, 0.7 * whole);
  EXPECT_GT(half, 0.3 * whole);
  // Another system's result names the frames alone that it has.
  Evaluation named = EvaluationOfRun("a", 10, 30);
  std::erase_if(named.survival.frames, [](const TrackSurvival::Frame& frame) { return !frame.tracked; });
  EXPECT_EQ(CountBlue(Draw({named}, folder.Path("named.png"))), half);
}

TEST(ComparisonFigure, OfOneFrameIsADot) {
  const TemporaryFolder folder("comparison_one_frame");
  EXPECT_GT(CountBlue(Draw({EvaluationOfRun("a", 1, kFrames)}, folder.Path("dot.png"))), 0);
  Evaluation one = EvaluationOfRun("a");
  one.survival.frames.resize(1);
  EXPECT_GT(CountBlue(Draw({one}, folder.Path("one.png"))), 0);
}

TEST(ComparisonFigure, HoldsValuesThatNoScaleFits) {
  const TemporaryFolder folder("comparison_values");
  Evaluation wide = EvaluationOfRun("wide");
  wide.surface->plain.frames[3].estimate.rmse_mm = 0;
  wide.surface->plain.frames[4].estimate.rmse_mm = 1e9;
  wide.surface->plain.frames[5].estimate.rmse_mm = std::nan("");
  Evaluation exact = EvaluationOfRun("exact");
  for (PointFrameError& frame : exact.surface->plain.frames) frame.estimate.rmse_mm = frame.null.rmse_mm = 0;
  EXPECT_FALSE(Draw({wide, exact}, folder.Path("both.png")).empty());
  EXPECT_FALSE(Draw({exact}, folder.Path("exact.png")).empty());
}

TEST(ComparisonFigure, IsTheSameBytesEachTime) {
  const TemporaryFolder folder("comparison_bytes");
  const std::vector<Evaluation> evaluations = {EvaluationOfRun("a"), WithCamera(EvaluationOfRun("b", 5, 8))};
  for (const std::string ending : {".pdf", ".png"}) {
    ASSERT_TRUE(WriteComparisonFigure(evaluations, folder.Path("a" + ending)).ok());
    ASSERT_TRUE(WriteComparisonFigure(evaluations, folder.Path("b" + ending)).ok());
    EXPECT_EQ(ReadFile(folder.Path("a" + ending)).value(), ReadFile(folder.Path("b" + ending)).value()) << ending;
  }
  const std::string pdf = ReadFile(folder.Path("a.pdf")).value();
  EXPECT_THAT(pdf, StartsWith("%PDF"));
  EXPECT_THAT(pdf, Not(HasSubstr("CreationDate")));
  ASSERT_TRUE(WriteComparisonFigure(evaluations, folder.Path("a.svg")).ok());
  EXPECT_THAT(ReadFile(folder.Path("a.svg")).value(), HasSubstr("<svg"));
}

TEST(ComparisonFigure, NamesRunsByTheirFolders) {
  const auto names = [](const std::vector<std::string>& runs) {
    std::vector<Evaluation> evaluations;
    for (const std::string& run : runs) evaluations.emplace_back().run = run;
    return ComparisonNames(evaluations);
  };
  EXPECT_THAT(names({"runs/ours/", "runs/rigid"}), ElementsAre("ours", "rigid"));
  EXPECT_THAT(names({"a/x/run", "b/x/run", "b/other"}), ElementsAre("a/x/run", "b/x/run", "other"));
  EXPECT_THAT(names({"run", "a/run"}), ElementsAre("run", "a/run"));
  EXPECT_THAT(names({"run", "./run", "b"}), ElementsAre("run (1)", "run (2)", "b"));
}

TEST(ComparisonFigure, RefusesAnotherEndingAndRunsWithoutValues) {
  const std::vector<Evaluation> evaluations = {EvaluationOfRun("a")};
  EXPECT_EQ(WriteComparisonFigure(evaluations, "a.gif").code(), ErrorCode::kInvalidArgument);
  Evaluation nothing;
  nothing.survival.frames = {{0, true, 0, 0}, {1, true, 0, 0}};
  const Status status = WriteComparisonFigure(std::vector{nothing, nothing}, "a.pdf");
  EXPECT_EQ(status.code(), ErrorCode::kInsufficient);
  EXPECT_THAT(status.message(), HasSubstr("nothing to draw"));
}

}  // namespace
}  // namespace pliant
