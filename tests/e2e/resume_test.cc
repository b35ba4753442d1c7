// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs that are stopped and gone on with: the same bytes as those of a run that was not.
#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2e/e2e_support.h"
#include "pliant/io/checkpoint.h"
#include "pliant/io/track_file.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr int kResumedFrames = 40;
constexpr int kEvery = 4;  // frames from one checkpoint to the next

// Stops the run after this frame.
class Stopper : public TrackObserver {
 public:
  explicit Stopper(int after) : after_(after) {}
  void OnStart(int frames) override { remaining = frames; }
  void OnImage(int frame_idx, const cv::Mat&) override {
    first_frame_idx = first_frame_idx < 0 ? frame_idx : first_frame_idx;
    if (frame_idx >= after_) stop = true;
  }
  void OnFrame(const FrameReport&) override {}
  std::atomic<bool> stop = false;
  int remaining = -1;
  int first_frame_idx = -1;

 private:
  int after_;
};

// The tracks of a run.
class Tracks : public TrackObserver {
 public:
  void OnStart(int) override {}
  void OnFrame(const FrameReport& report) override {
    for (const PointObservation& seen : report.observations) pixels_[seen.id].push_back({report.frame_idx, seen.pixel});
  }
  std::vector<PixelTrack> Sorted() const {
    std::vector<PixelTrack> tracks;
    for (const auto& [id, pixels] : pixels_) tracks.push_back({id, pixels});
    return tracks;
  }

 private:
  std::map<PointId, std::vector<TrackPixel>> pixels_;
};

class ResumedRun : public testing::Test {
 protected:
  ResumedRun() {
    options_.timings = RunTimings::kNone;
    options_.checkpoint_frames = kEvery;
  }
  RunRequest Request(const std::string& run) const {
    RunRequest request;
    request.input.image_path = sequence_;
    request.input.end = kResumedFrames;
    request.output_path = folder_.Path(run);
    request.command_line = {"pliant", "track"};
    return request;
  }
  // Until frame `after`, or to the end.
  Result<RunSummary> Track(const std::string& run, bool resume, int after, Stopper* stopper = nullptr) const {
    Stopper own(after);
    Stopper& used = stopper != nullptr ? *stopper : own;
    RunRequest request = Request(run);
    request.resume = resume;
    request.stop = &used.stop;
    const std::vector<TrackObserver*> observers = {&used};
    return RunTrack(request, options_, observers);
  }
  // Stopped after each of these frames, and gone on with; compared with a run in one go.
  void ExpectSameAfterStops(const std::vector<int>& stops) {
    ASSERT_TRUE(Track("whole", false, 10 * kResumedFrames).ok());
    bool resume = false;
    for (const int after : stops) {
      const auto summary = Track("parts", std::exchange(resume, true), after);
      ASSERT_TRUE(summary.ok()) << summary.status().message();
      EXPECT_EQ(summary->status, RunStatus::kInterrupted) << after;
      options_.threads = 3 - options_.threads;  // one or two: they change nothing
    }
    Stopper last(10 * kResumedFrames);
    const auto summary = Track("parts", true, 10 * kResumedFrames, &last);
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    EXPECT_EQ(summary->status, RunStatus::kCompleted) << summary->note;
    const int done = (stops.back() + 1) / kEvery * kEvery;
    EXPECT_EQ(last.first_frame_idx, done);
    EXPECT_EQ(last.remaining, kResumedFrames - done);
    EXPECT_FALSE(std::filesystem::exists(folder_.Path("parts/checkpoint")));
    ExpectSameFiles();
  }
  // The number of threads is another one in the end.
  void ExpectSameFiles() const {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.Path("whole"))) {
      const std::string name = std::filesystem::relative(entry.path(), folder_.Path("whole")).string();
      EXPECT_TRUE(std::filesystem::exists(folder_.Path("parts/" + name))) << name;
      if (!entry.is_regular_file() || name == "config.yaml") continue;
      EXPECT_TRUE(folder_.Read("whole/" + name) == folder_.Read("parts/" + name)) << name;
    }
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.Path("parts"))) {
      const std::string name = std::filesystem::relative(entry.path(), folder_.Path("parts")).string();
      EXPECT_TRUE(std::filesystem::exists(folder_.Path("whole/" + name))) << name;
    }
  }

  const TestFolder folder_;
  std::string sequence_ = kSequence;
  TrackOptions options_;
};

// Before the first map, in the frame in which it is made, and while it is tracked.
TEST_F(ResumedRun, IsTheSameAsOneThatWasNotStopped) { ExpectSameAfterStops({1, 6, 10, 13, 14, 27, 38}); }

TEST_F(ResumedRun, IsTheSameWithMapsThatAreMadeBeside) {
  options_.tracker.handover_frames = 6;
  options_.tracker.init.window.refine_rigid = Switch::kOff;
  options_.tracker.growth.window = 15;
  options_.tracker.growth.reestimate_every = 5;
  ExpectSameAfterStops({8, 14, 23, 33});
}

// The view is lost in the middle: another map follows, or the first is found again.
TEST_F(ResumedRun, IsTheSameWhereTheViewWasLost) {
  const SequenceCopy copy(folder_, kResumedFrames);
  copy.Fill(18, 21, 128);
  sequence_ = copy.path();
  options_.tracker.max_lost_frames = 2;
  ExpectSameAfterStops({17, 20, 21, 25, 33});
}

TEST_F(ResumedRun, IsTheSameWithTracksOfAFile) {
  Tracks tracks;
  const std::vector<TrackObserver*> observers = {&tracks};
  ASSERT_TRUE(RunTrack(Request("own"), options_, observers).ok());
  ASSERT_TRUE(WriteTrackCsv(folder_.Path("tracks.csv"), tracks.Sorted()).ok());
  options_.track_file.path = folder_.Path("tracks.csv");
  ExpectSameAfterStops({9, 22, 30});
}

TEST_F(ResumedRun, BeginsAnewWhereThereIsNoCheckpointYet) {
  ASSERT_TRUE(Track("parts", false, 2).ok());
  EXPECT_FALSE(HasCheckpoint(folder_.Path("parts")));
  Stopper stopper(10 * kResumedFrames);
  const auto summary = Track("parts", true, 0, &stopper);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(stopper.first_frame_idx, 0);
  EXPECT_EQ(summary->frames_tracked, kResumedFrames);
}

TEST_F(ResumedRun, OfARunThatHasEndedHasNothingToDo) {
  const auto whole = Track("parts", false, 10 * kResumedFrames);
  ASSERT_TRUE(whole.ok());
  const auto written = std::filesystem::last_write_time(folder_.Path("parts/run.json"));
  Stopper stopper(10 * kResumedFrames);
  const auto summary = Track("parts", true, 0, &stopper);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->frames_tracked, whole->frames_tracked);
  EXPECT_EQ(stopper.first_frame_idx, -1) << "no frame is read";
  options_.threads = 1;
  EXPECT_TRUE(Track("parts", true, 0).ok());
  options_.seed = 7;
  EXPECT_THAT(Track("parts", true, 0).status().message(), HasSubstr("has come to its end with other options"));
  options_.seed = 1;
  RunRequest shorter = Request("parts");
  shorter.resume = true;
  shorter.input.end = kResumedFrames - 1;
  EXPECT_THAT(RunTrack(shorter, options_, {}).status().message(),
              HasSubstr("has come to its end with other frames, --start 0 --end 40 --stride 1"));
  RunRequest masked = Request("parts");
  masked.resume = true;
  masked.input.mask_path = folder_.Path("masks");
  EXPECT_THAT(RunTrack(masked, options_, {}).status().message(), HasSubstr("has come to its end with other masks"));
  const SequenceCopy copy(folder_, kResumedFrames);
  sequence_ = copy.path();
  EXPECT_THAT(Track("parts", true, 0).status().message(),
              HasSubstr("has come to its end with other images, '" + kSequence));
  EXPECT_EQ(std::filesystem::last_write_time(folder_.Path("parts/run.json")), written);
}

TEST_F(ResumedRun, IsRefusedWithOtherOptionsFramesOrImages) {
  const SequenceCopy copy(folder_, kResumedFrames);
  sequence_ = copy.path();
  ASSERT_TRUE(Track("parts", false, 22).ok());
  const auto refused = [&](const RunRequest& request, const TrackOptions& options) {
    const auto summary = RunTrack(request, options, {});
    EXPECT_EQ(summary.status().code(), ErrorCode::kMismatch);
    EXPECT_TRUE(HasCheckpoint(folder_.Path("parts"))) << "nothing was changed";
    return summary.status().message();
  };
  RunRequest request = Request("parts");
  request.resume = true;
  TrackOptions other = options_;
  other.tracker.growth.grow = Switch::kOff;
  EXPECT_THAT(refused(request, other),
              HasSubstr("its options were 'Growth.grow on', and now they are 'Growth.grow off'"));
  other = options_;
  other.seed = 2;
  EXPECT_THAT(refused(request, other), HasSubstr("'General.seed 2'"));
  RunRequest longer = request;
  longer.input.end = kResumedFrames + 1;
  EXPECT_THAT(refused(longer, options_), HasSubstr("'--start 0 --end 41 --stride 1'"));
  const std::string image = folder_.Read("sequence/images/000019.png");
  copy.Fill(19, 19, 128);
  EXPECT_THAT(refused(request, options_), HasSubstr("its last frame was '000019.png'"));
  folder_.Write("sequence/images/000019.png", image);
  std::filesystem::rename(copy.Image(19), folder_.Path("sequence/images/000019b.png"));
  EXPECT_THAT(refused(request, options_), HasSubstr("its last frame was '000019.png'"));
}

TEST_F(ResumedRun, IsRefusedWhereTheCheckpointIsDamaged) {
  ASSERT_TRUE(Track("parts", false, 22).ok());
  const std::string rows = folder_.Read("parts/frames.csv");
  folder_.Write("parts/checkpoint/state", folder_.Read("parts/checkpoint/state") + "x");
  const auto summary = Track("parts", true, 10 * kResumedFrames);
  EXPECT_EQ(summary.status().code(), ErrorCode::kUnreadable);
  EXPECT_THAT(summary.status().message(), HasSubstr("is damaged; track the sequence anew, with --overwrite"));
  EXPECT_EQ(folder_.Read("parts/frames.csv"), rows);
}

// An image that cannot be read ends the run; once it is mended the run goes on.
TEST_F(ResumedRun, GoesOnAfterAnImageWasMended) {
  ASSERT_TRUE(Track("whole", false, 10 * kResumedFrames).ok());
  const SequenceCopy copy(folder_, kResumedFrames);
  sequence_ = copy.path();
  const std::string image = "sequence/images/" + FrameName(21);
  const std::string bytes = folder_.Read(image);
  copy.Damage(21);
  const auto failed = Track("parts", false, 10 * kResumedFrames);
  ASSERT_TRUE(failed.ok());
  EXPECT_EQ(failed->status, RunStatus::kFailed);
  folder_.Write(image, bytes);
  const auto summary = Track("parts", true, 10 * kResumedFrames);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  for (const char* name : {"frames.csv", "observations.csv", "trajectory.txt", "map.ply", "sparse/points3D.bin"})
    EXPECT_TRUE(folder_.Read("whole/" + std::string(name)) == folder_.Read("parts/" + std::string(name))) << name;
}

}  // namespace
}  // namespace pliant
