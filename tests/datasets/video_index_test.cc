// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Frames of a video that were read before are found again.
#include "datasets/video_index.h"

#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "datasets/image_stream.h"
#include "datasets/sequence_files.h"

namespace pliant {
namespace {

constexpr int kFrames = 600;
constexpr int kFar = 500;  // further than is decoded and dropped

class VideoIndexTest : public SequenceFiles {
 protected:
  void SetUp() override {
    SequenceFiles::SetUp();
    WriteVideo("clip.avi", kFrames);
  }

  cv::Mat Read(const std::shared_ptr<VideoIndex>& index, int idx) const {
    const auto video = StreamVideo(Path("clip.avi"), index);
    EXPECT_TRUE(video.ok()) << video.status().message();
    auto image = (*video)->Read(idx);
    return image.ok() && image->has_value() ? **image : cv::Mat();
  }
  // What is learned from all frames.
  std::shared_ptr<VideoIndex> Learned() const {
    auto index = std::make_shared<VideoIndex>();
    const auto video = StreamVideo(Path("clip.avi"), index);
    for (int idx = 0; idx < kFrames; ++idx) EXPECT_TRUE((*video)->Read(idx).ok());
    return index;
  }
  static bool AreEqual(const cv::Mat& one, const cv::Mat& other) {
    return one.size() == other.size() && cv::norm(one, other, cv::NORM_INF) == 0;
  }
};

TEST_F(VideoIndexTest, FindsTheFrameAndThoseAfterIt) {
  const auto index = Learned();
  ASSERT_TRUE(index->TimeMs(kFar));
  const auto without = StreamVideo(Path("clip.avi"));
  const auto with = StreamVideo(Path("clip.avi"), index);
  for (int idx = kFar; idx < kFrames; ++idx) {
    const auto expected = (*without)->Read(idx);
    const auto found = (*with)->Read(idx);
    ASSERT_TRUE(found.ok() && found->has_value()) << idx;
    ASSERT_TRUE(AreEqual(**found, **expected)) << idx;
    EXPECT_EQ((*with)->RecordedS(), (*without)->RecordedS());
  }
  EXPECT_FALSE((*with)->Read(kFrames)->has_value());
}

// An index that says of every frame what is true of the one ten frames later: the latter is given, so it was sought.
TEST_F(VideoIndexTest, IsBelievedWhereTheVideoGivesWhatItSays) {
  constexpr int kShift = 10;
  const auto learned = Learned();
  const auto shifted = std::make_shared<VideoIndex>();
  for (int idx = 0; idx + kShift < kFrames; ++idx) {
    shifted->Add(idx, *learned->TimeMs(idx + kShift));
    shifted->SetDigest(idx, *learned->Digest(idx + kShift));
  }
  EXPECT_TRUE(AreEqual(Read(shifted, kFar), Read(nullptr, kFar + kShift)));
}

TEST_F(VideoIndexTest, IsNotBelievedWhereTheVideoGivesAnotherFrame) {
  const auto learned = Learned();
  const auto wrong = std::make_shared<VideoIndex>();
  for (int idx = 0; idx + 1 < kFrames; ++idx) {
    wrong->Add(idx, *learned->TimeMs(idx + 1));
    wrong->SetDigest(idx, *learned->Digest(idx));
  }
  EXPECT_TRUE(AreEqual(Read(wrong, kFar), Read(nullptr, kFar)));
}

TEST_F(VideoIndexTest, KnowsNoTimeThatIsNotLater) {
  VideoIndex index;
  index.Add(0, 0.0);
  index.Add(1, 40.0);
  EXPECT_EQ(index.TimeMs(1), 40.0);
  index.Add(3, 120.0);
  EXPECT_FALSE(index.TimeMs(3)) << "frame 2 is not known";
  index.Add(2, 40.0);
  EXPECT_FALSE(index.TimeMs(2));
  EXPECT_EQ(index.TimeMs(1), 40.0);
  index.Add(3, 120.0);
  EXPECT_EQ(index.TimeMs(3), 120.0);
}

}  // namespace
}  // namespace pliant
