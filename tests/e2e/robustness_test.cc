// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What goes wrong in the middle of a run: what was computed is on disk and readable, and one sentence says what it was.
#include <atomic>
#include <csignal>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include "e2e/e2e_support.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr double kStandstill_mm = 0.05;        // what constant velocity and the solver's tolerance leave
constexpr std::size_t kPosesBeforeSignal = 6;  // the signal follows the eighth row; the last ones may be cut
constexpr int kShortFrames = 16;

// The run folder reads back and holds as many poses as the summary says.
void ExpectReadable(const std::string& path, std::int64_t poses) {
  const auto run = ReadRun(path);
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(static_cast<std::int64_t>(run->poses.size()), poses);
}

TEST(Robustness, ADamagedImageEndsTheRunAndTheFramesBeforeItStay) {
  const TestFolder folder;
  const SequenceCopy sequence(folder, kShortFrames);
  sequence.Damage(9);
  const RunSummary summary = TrackSequenceAt(sequence.path(), folder.Path("run"), DepthStart());
  EXPECT_EQ(summary.status, RunStatus::kFailed);
  EXPECT_EQ(EndOf(summary, folder.Path("run")).code(), ErrorCode::kUnreadable);
  EXPECT_THAT(summary.note, HasSubstr(FrameName(9)));
  EXPECT_EQ(summary.frames_tracked, 9);
  ExpectReadable(folder.Path("run"), 9);
  EXPECT_TRUE(std::filesystem::exists(folder.Path("run/sparse/points3D.bin")));
}

TEST(Robustness, ATruncatedImageIsNamedBeforeTheFirstFrame) {
  const TestFolder folder;
  const SequenceCopy sequence(folder, kShortFrames);
  std::filesystem::resize_file(sequence.Image(9), std::filesystem::file_size(sequence.Image(9)) / 2);
  RunRequest request;
  request.input.image_path = sequence.path();
  request.output_path = folder.Path("run");
  const auto summary = RunTrack(request, DepthStart(), {});
  EXPECT_EQ(summary.status().code(), ErrorCode::kUnreadable);
  EXPECT_THAT(summary.status().message(), HasSubstr(FrameName(9) + " is truncated"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("run")));
}

TEST(Robustness, AnImageOfAnotherSizeIsNamedBeforeTheFirstFrame) {
  for (const std::string extension : {".png", ".tif"}) {
    const TestFolder folder;
    const SequenceCopy sequence(folder, kShortFrames);
    const std::filesystem::path image = sequence.Image(5).replace_extension(extension);
    std::filesystem::remove(sequence.Image(5));
    ASSERT_TRUE(cv::imwrite(image.string(), cv::Mat(100, 200, CV_8UC3, cv::Scalar::all(90))));
    RunRequest request;
    request.input.image_path = sequence.path();
    request.output_path = folder.Path("run");
    const auto summary = RunTrack(request, DepthStart(), {});
    EXPECT_EQ(summary.status().code(), ErrorCode::kMismatch);
    EXPECT_THAT(summary.status().message(), HasSubstr(image.filename().string() + " is 200x100"));
    EXPECT_FALSE(std::filesystem::exists(folder.Path("run")));
  }
}

// What is done every Nth frame is done whatever the numbers of the frames are.
TEST(Robustness, EverySecondFrameAddsPointsFromAnOddOneOnToo) {
  const TestFolder folder;
  TrackOptions options = DepthStart();
  options.tracker.corners.max_corners = 250;
  options.tracker.growth.min_views = 4;
  for (const int start : {0, 1}) {
    RunRequest request;
    request.input.image_path = kSequence;
    request.input.start = start;
    request.input.stride = 2;
    request.output_path = folder.Path("run" + std::to_string(start));
    const auto summary = RunTrack(request, options, {});
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    const auto run = ReadRun(request.output_path);
    ASSERT_TRUE(run.ok()) << run.status().message();
    int added = 0;
    for (std::size_t k = 1; k < run->frames.size(); ++k) added += run->frames[k].added;
    EXPECT_GT(added, 10) << "begun at " << start;
  }
}

TEST(Robustness, BlackToTheEndIsLostAndSaysBlack) {
  const TestFolder folder;
  const SequenceCopy sequence(folder, kShortFrames);
  sequence.Fill(6, kShortFrames - 1, 0);
  const RunSummary summary = TrackSequenceAt(sequence.path(), folder.Path("run"), DepthStart());
  EXPECT_EQ(summary.status, RunStatus::kLost);
  EXPECT_THAT(summary.note, HasSubstr("the image is black"));
  ExpectReadable(folder.Path("run"), 6);
}

TEST(Robustness, WhiteToTheEndIsLostAndSaysWhite) {
  const TestFolder folder;
  const SequenceCopy sequence(folder, kShortFrames);
  sequence.Fill(6, kShortFrames - 1, 255);
  const RunSummary summary = TrackSequenceAt(sequence.path(), folder.Path("run"), DepthStart());
  EXPECT_EQ(summary.status, RunStatus::kLost);
  EXPECT_THAT(summary.note, HasSubstr("the image is white"));
  ExpectReadable(folder.Path("run"), 6);
}

TEST(Robustness, AFlashOfBlackIsSurvivedInTheSameMap) {
  const TestFolder folder;
  const SequenceCopy sequence(folder, kShortFrames);
  sequence.Fill(6, 7, 0);
  const RunSummary summary = TrackSequenceAt(sequence.path(), folder.Path("run"), DepthStart());
  EXPECT_EQ(summary.status, RunStatus::kCompleted);
  EXPECT_EQ(summary.frames_tracked, kShortFrames - 2);
  ExpectReadable(folder.Path("run"), kShortFrames - 2);
}

// A few points stay visible, too few to track: what was followed of them in the meantime must not stand in the way.
TEST(Robustness, AViewThatIsNearlyCoveredForAMomentIsSurvivedInTheSameMap) {
  const TestFolder folder;
  const SequenceCopy sequence(folder, kShortFrames);
  for (int i = 6; i <= 8; ++i) {
    const cv::Mat image = cv::imread(sequence.Image(i).string());
    cv::Mat covered(image.size(), image.type(), cv::Scalar::all(0));
    const cv::Rect gap(image.cols / 3, image.rows / 3, 60, 60);
    image(gap).copyTo(covered(gap));
    sequence.Replace(i, covered);
  }
  const RunSummary summary = TrackSequenceAt(sequence.path(), folder.Path("run"), DepthStart());
  EXPECT_EQ(summary.status, RunStatus::kCompleted);
  EXPECT_EQ(summary.frames_tracked, kShortFrames - 3);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_GT(run->frames[9].optimized, run->frames[5].optimized / 2);
}

TEST(Robustness, BlackFromTheBeginningHasNoReferenceAndSaysSo) {
  const TestFolder folder;
  const SequenceCopy sequence(folder, 4);
  sequence.Fill(0, 3, 0);
  const RunSummary summary = TrackSequenceAt(sequence.path(), folder.Path("run"), TrackOptions());
  EXPECT_EQ(summary.status, RunStatus::kFailed);
  EXPECT_THAT(summary.note, HasSubstr("the image is black"));
  ExpectReadable(folder.Path("run"), 0);
}

TEST(Robustness, AFrozenStretchIsTrackedWithACameraThatStandsStill) {
  const TestFolder folder;
  const SequenceCopy sequence(folder, kShortFrames);
  const cv::Mat still = cv::imread(sequence.Image(6).string());
  for (int i = 7; i <= 10; ++i) sequence.Replace(i, still);
  const RunSummary summary = TrackSequenceAt(sequence.path(), folder.Path("run"), DepthStart());
  EXPECT_EQ(summary.status, RunStatus::kCompleted);
  EXPECT_EQ(summary.frames_tracked, kShortFrames);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok());
  EXPECT_LT((run->poses[10].world_from_cam.translation - run->poses[8].world_from_cam.translation).norm(),
            kStandstill_mm);
}

TEST(Robustness, WarningsAboutTheRecordingAreInTheSummary) {
  const TestFolder folder;
  const SequenceCopy sequence(folder, kShortFrames);
  for (int i = 0; i < kShortFrames; i += 2) sequence.Replace(i + 1, cv::imread(sequence.Image(i).string()));
  const RunSummary summary = TrackSequenceAt(sequence.path(), folder.Path("run"), DepthStart());
  const auto repeats = testing::Contains(HasSubstr("images (50 %) repeat the one before"));
  EXPECT_THAT(summary.description.warnings, repeats);
  const auto written = ReadRunSummary(folder.Path("run/run.json"));
  ASSERT_TRUE(written.ok()) << written.status().message();
  EXPECT_THAT(written->description.warnings, repeats);
  EXPECT_EQ(written->note, summary.note);
}

TEST(Robustness, AFrozenSequenceCarriesNoMapAndSaysFrozen) {
  const TestFolder folder;
  const SequenceCopy sequence(folder, 6);
  const cv::Mat still = cv::imread(sequence.Image(0).string());
  for (int i = 1; i < 6; ++i) sequence.Replace(i, still);
  const RunSummary summary = TrackSequenceAt(sequence.path(), folder.Path("run"), TrackOptions());
  EXPECT_EQ(summary.status, RunStatus::kFailed);
  EXPECT_EQ(EndOf(summary, folder.Path("run")).code(), ErrorCode::kInsufficient);
  EXPECT_THAT(summary.note, HasSubstr("frozen"));
}

TEST(Robustness, StoppedOnRequestTheRunSaysInterrupted) {
  class StopAtStart final : public TrackObserver {
   public:
    void OnStart(int /*frames*/) override { stop = true; }
    void OnFrame(const FrameReport& /*report*/) override {}
    std::atomic<bool> stop = false;
  } observer;
  const TestFolder folder;
  RunRequest request;
  request.input.image_path = kSequence;
  request.output_path = folder.Path("run");
  request.stop = &observer.stop;
  TrackObserver* const observers[] = {&observer};
  const auto summary = RunTrack(request, DepthStart(), observers);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->status, RunStatus::kInterrupted);
  EXPECT_EQ(EndOf(*summary, folder.Path("run")).code(), ErrorCode::kInterrupted);
  EXPECT_EQ(summary->frames_tracked, 1);
  ExpectReadable(folder.Path("run"), 1);
}

// A camera that stands still: every frame waits for a map that does not come.
class BeforeTheFirstMap : public testing::Test {
 protected:
  BeforeTheFirstMap() : sequence_(folder_, kWaiting) {
    const cv::Mat still = cv::imread(sequence_.Image(0).string());
    for (int i = 1; i < kWaiting; ++i) sequence_.Replace(i, still);
  }
  void ExpectInitializing(int frames) const {
    const auto run = ReadRun(folder_.Path("run"));
    ASSERT_TRUE(run.ok()) << run.status().message();
    ASSERT_EQ(static_cast<int>(run->frames.size()), frames);
    for (const auto& frame : run->frames) EXPECT_EQ(frame.state, TrackingState::kInitializing);
    EXPECT_TRUE(run->poses.empty());
  }

  static constexpr int kWaiting = 6;
  const TestFolder folder_;
  const SequenceCopy sequence_;
};

TEST_F(BeforeTheFirstMap, TheSequencesEndWritesTheFramesThatWait) {
  const RunSummary summary = TrackSequenceAt(sequence_.path(), folder_.Path("run"), TrackOptions());
  EXPECT_EQ(summary.status, RunStatus::kFailed);
  EXPECT_EQ(summary.frames_read, kWaiting);
  ExpectInitializing(kWaiting);
}

TEST_F(BeforeTheFirstMap, AStopOnRequestWritesTheFramesThatWait) {
  struct StopAtFourth : TrackObserver {
    void OnStart(int) override {}
    void OnFrame(const FrameReport& report) override { final_frames.push_back(report.frame_idx); }
    void OnHeld(const FrameReport& report) override {
      held_frames.push_back(report.frame_idx);
      stop = report.frame_idx == 3;
    }
    std::vector<int> held_frames;
    std::vector<int> final_frames;
    std::atomic<bool> stop = false;
  } observer;
  RunRequest request;
  request.input.image_path = sequence_.path();
  request.output_path = folder_.Path("run");
  request.stop = &observer.stop;
  const auto summary = RunTrack(request, TrackOptions(), std::array<TrackObserver*, 1>{&observer});
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->status, RunStatus::kInterrupted);
  EXPECT_THAT(summary->note, HasSubstr(FrameName(3)));
  EXPECT_THAT(observer.held_frames, testing::ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(observer.final_frames, testing::ElementsAre(0, 1, 2, 3));
  ExpectInitializing(4);
}

TEST_F(BeforeTheFirstMap, ADamagedImageWritesTheFramesThatWait) {
  sequence_.Damage(4);
  const RunSummary summary = TrackSequenceAt(sequence_.path(), folder_.Path("run"), TrackOptions());
  EXPECT_EQ(summary.status, RunStatus::kFailed);
  EXPECT_THAT(summary.note, HasSubstr(FrameName(4)));
  ExpectInitializing(4);
}

TEST(Robustness, ADepthImageThatNothingNeedsAnyMoreMayBeBroken) {
  for (const int threads : {1, 2}) {
    const TestFolder folder;
    const SequenceCopy sequence(folder, 4);
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(sequence.path()) / "depth"))
      if (entry.path().stem() != "000000") std::ofstream(entry.path()) << "no image";
    TrackOptions options = DepthStart();
    options.threads = threads;
    const RunSummary summary = TrackSequenceAt(sequence.path(), folder.Path("run"), options);
    EXPECT_EQ(summary.status, RunStatus::kCompleted) << threads << " threads: " << summary.note;
  }
}

TEST(Robustness, ARunWithoutAMapNamesTheMethodThatWouldStart) {
  const TestFolder folder;
  TrackOptions options;
  WindowInitOptions& window = options.tracker.init.window;
  window.certain_depth_sigma = window.last_depth_sigma = window.max_depth_sigma = 1e-4;
  window.provisional = Switch::kOff;
  const RunSummary summary = TrackSequenceAt(kSequence, folder.Path("run"), options);
  EXPECT_EQ(summary.status, RunStatus::kFailed);
  EXPECT_THAT(summary.note, HasSubstr("--Init.method gated would have made a map by frame "));
  EXPECT_THAT(summary.note, HasSubstr("right only if the camera moves and the scene hardly deforms"));
  options.tracker.init.method = InitMethod::kGated;
  EXPECT_EQ(TrackSequenceAt(kSequence, folder.Path("gated"), options).status, RunStatus::kCompleted) << "it does";
}

TEST(Robustness, AStartFromDepthWithoutDepthSaysSo) {
  const TestFolder folder;
  const SequenceCopy sequence(folder, 4);
  std::filesystem::remove_all(std::filesystem::path(sequence.path()) / "depth");
  RunRequest request;
  request.input.image_path = sequence.path();
  request.output_path = folder.Path("run");
  const auto summary = RunTrack(request, DepthStart(), {});
  ASSERT_FALSE(summary.ok());
  EXPECT_EQ(summary.status().code(), ErrorCode::kNotFound);
  EXPECT_THAT(summary.status().message(), HasSubstr("a start from depth needs depth images"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("run")));
}

// Starts the program, lets it track some frames, and sends it a signal. Returns wait's status.
int SignalInMidRun(const std::string& run, int signal) {
  const pid_t child = fork();
  if (child == 0) {
    execl(PLIANT_PROGRAM, PLIANT_PROGRAM, "track", "--image_path", kSequence.c_str(), "--output_path", run.c_str(),
          "--Init.method", "depth", "--quiet", static_cast<char*>(nullptr));
    _exit(127);
  }
  const auto rows = [&] {
    std::ifstream frames(run + "/frames.csv");
    std::string line;
    int count = 0;
    while (std::getline(frames, line)) ++count;
    return count;
  };
  for (int i = 0; i < 2000 && rows() < 8; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  kill(child, signal);
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(Robustness, AfterCtrlCTheRunIsWholeAndSaysInterrupted) {
  const TestFolder folder;
  const int status = SignalInMidRun(folder.Path("run"), SIGINT);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->summary->status, RunStatus::kInterrupted);
  EXPECT_GE(run->poses.size(), kPosesBeforeSignal);
  EXPECT_TRUE(std::filesystem::exists(folder.Path("run/map.ply")));
}

TEST(Robustness, AfterTheTerminalIsClosedTheRunIsWholeAndSaysInterrupted) {
  const TestFolder folder;
  const int status = SignalInMidRun(folder.Path("run"), SIGHUP);
  ASSERT_TRUE(WIFEXITED(status));
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->summary->status, RunStatus::kInterrupted);
  EXPECT_TRUE(std::filesystem::exists(folder.Path("run/map.ply")));
}

TEST(Robustness, AfterKillMinusNineWhatWasComputedIsReadableAndCanBeEvaluated) {
  const TestFolder folder;
  const int status = SignalInMidRun(folder.Path("run"), SIGKILL);
  ASSERT_TRUE(WIFSIGNALED(status));
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->summary->status, RunStatus::kInterrupted);
  EXPECT_GE(run->poses.size(), kPosesBeforeSignal);
  EXPECT_GE(EvaluateRun(folder.Path("run"), kSequence, ErrorScale::kNone).surface->plain.frames.size(),
            kPosesBeforeSignal);
}

}  // namespace
}  // namespace pliant
