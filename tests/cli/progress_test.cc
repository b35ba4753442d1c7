// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/progress.h"

#include <algorithm>
#include <atomic>
#include <sstream>

#include <gtest/gtest.h>

#include "cli/track_progress.h"

namespace pliant::cli {
namespace {

using std::chrono::seconds;

TEST(Progress, LinesComeEveryTwentyFiveFramesAndAtTheEnd) {
  std::ostringstream out;
  {
    Progress progress(out, ProgressStyle::kLines, "track", 60);
    for (int i = 1; i <= 60; ++i) progress.Update(i, std::to_string(500 - i) + " points");
  }
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_NE(text.find("25/60"), std::string::npos);
  EXPECT_NE(text.find("50/60"), std::string::npos);
  EXPECT_NE(text.find("60/60"), std::string::npos);
  EXPECT_NE(text.find("440 points"), std::string::npos);
  EXPECT_EQ(text.find('\r'), std::string::npos);
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
}

TEST(Progress, TheRateIsFramesByTimeSinceTheStart) {
  std::ostringstream out;
  Progress progress(out, ProgressStyle::kLines, "track", 25);
  // The start is taken when the object is made, so that the rate is a little below 25 frames in 10 s.
  progress.Update(25, "", Progress::Clock::now() + seconds(10));
  EXPECT_NE(out.str().find("  2.5 frames/s"), std::string::npos) << out.str();
}

TEST(Progress, TheTimeLeftIsByTheRateSoFar) {
  std::ostringstream out;
  Progress progress(out, ProgressStyle::kBar, "track", 100);
  progress.Update(25, "", Progress::Clock::now() + seconds(10));
  EXPECT_NE(out.str().find("  30 s left"), std::string::npos) << out.str();
  progress.Update(100, "", Progress::Clock::now() + seconds(40));
  EXPECT_EQ(out.str().find(" left", out.str().rfind('\r')), std::string::npos) << out.str();
}

TEST(Progress, SharesOfTheWorkHaveNoRate) {
  std::ostringstream out;
  Progress progress(out, ProgressStyle::kLines, "refine", 100, "%");
  progress.Update(0, "rigid", Progress::Clock::now() + seconds(1));
  EXPECT_EQ(out.str(), "");  // nothing is said of what takes less than two seconds
  progress.Update(50, "rigid", Progress::Clock::now() + seconds(10));
  EXPECT_EQ(out.str(), "refine  50 %  10 s left  rigid\n");
  progress.Update(51, "rigid", Progress::Clock::now() + seconds(11));
  EXPECT_EQ(std::ranges::count(out.str(), '\n'), 1);
  progress.Update(52, "rigid", Progress::Clock::now() + seconds(13));
  EXPECT_EQ(std::ranges::count(out.str(), '\n'), 2) << "a slow step is told of after two seconds";
}

TEST(Progress, TheBarIsDrawnOverAndEndsItsLine) {
  std::ostringstream out;
  {
    Progress progress(out, ProgressStyle::kBar, "track", 4);
    const auto start = Progress::Clock::now();
    progress.Update(2, "9 points", start + seconds(1));
    progress.Update(4, "8 points", start + seconds(2));
  }
  const std::string text = out.str();
  EXPECT_NE(text.find("[============            ]  2/4"), std::string::npos) << text;
  EXPECT_NE(text.find("[========================]  4/4"), std::string::npos) << text;
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 2);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_EQ(text.back(), '\n');
}

TEST(Progress, ABarIsNotDrawnMoreOftenThanTheEyeNeeds) {
  std::ostringstream out;
  Progress progress(out, ProgressStyle::kBar, "track", 1000);
  const auto now = Progress::Clock::now();
  for (int i = 1; i < 1000; ++i) progress.Update(i, "", now);
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 1);
}

TEST(Progress, AnUnknownTotalShowsTheCountAlone) {
  std::ostringstream out;
  Progress progress(out, ProgressStyle::kBar, "track", 0);
  progress.Update(7, "");
  EXPECT_NE(out.str().find("track  7  "), std::string::npos) << out.str();
  EXPECT_EQ(out.str().find('['), out.str().find("[K")) << "no bar without a total";
}

TEST(Progress, NotesOfFramesHaveNoControlCharacters) {
  std::ostringstream out;
  Progress progress(out, ProgressStyle::kLines, "track", 25);
  progress.Note("frame a\x1b]0;b\n.png: lost");
  EXPECT_EQ(out.str(), "frame a?]0;b?.png: lost\n");
}

TEST(Progress, QuietSaysNothing) {
  std::ostringstream out;
  {
    Progress progress(out, ProgressStyle::kQuiet, "track", 25);
    progress.Update(25, "5 points");
    progress.Note("lost");
  }
  EXPECT_EQ(out.str(), "");
}

TEST(JobBars, SayNothingOfShortTasksAndEndTheJobOnRequest) {
  std::atomic<bool> stop = false;
  JobBars bars(stop);
  testing::internal::CaptureStderr();
  EXPECT_TRUE(bars("evaluate", 1, 2));
  EXPECT_TRUE(bars("images", 2, 2));
  stop = true;
  EXPECT_FALSE(bars("images", 2, 2));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

FrameReport Report(int frame_idx, TrackingState state, const std::string& note) {
  FrameReport report;
  report.frame_idx = frame_idx;
  report.name = std::to_string(frame_idx) + ".png";
  report.state = state;
  report.note = note;
  return report;
}

TEST(TrackProgress, ShowsAFrameWhenItIsProcessedAndNotAgainWhenItIsFinal) {
  testing::internal::CaptureStderr();
  {
    TrackProgress progress(ProgressStyle::kBar);
    progress.OnStart(4);
    progress.OnHeld(Report(0, TrackingState::kInitializing, "reference"));
    progress.OnHeld(Report(1, TrackingState::kInitializing, "parallax"));
    progress.OnFrame(Report(0, TrackingState::kTracking, "from the map"));
    progress.OnFrame(Report(1, TrackingState::kTracking, "from the map"));
    progress.OnFrame(Report(2, TrackingState::kTracking, "first map"));
    FrameReport merges = Report(3, TrackingState::kTracking, "two maps are one");
    merges.merge = SubmapMerge();
    progress.OnFrame(merges);
  }
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("frame 0.png: initializing (reference)\n"), std::string::npos) << text;
  EXPECT_NE(text.find("frame 2.png: tracking (first map)\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("from the map"), std::string::npos) << text;
  EXPECT_NE(text.find("1/4"), std::string::npos) << "a frame that waits moves the bar: " << text;
  EXPECT_NE(text.find("frame 3.png: tracking (two maps are one)\n"), std::string::npos) << text;
  EXPECT_NE(text.find("4/4"), std::string::npos) << text;
}

}  // namespace
}  // namespace pliant::cli
