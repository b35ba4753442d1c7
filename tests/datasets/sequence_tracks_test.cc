// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/sequence_tracks.h"

#include <string>

#include <gmock/gmock.h>

#include "datasets/opened_sequence.h"
#include "pliant/io/track_file.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int kImages = 4;

class SequenceTracksTest : public OpenSequenceTest {
 protected:
  void SetUp() override {
    OpenSequenceTest::SetUp();
    WriteNative(kImages);
  }
  Result<SequenceTracks> Read(const std::string& rows, TrackFileOptions options = {}) {
    Text("tracks.csv", "frame,track_id,u_px,v_px,sigma_px\n" + rows);
    options.path = Path("tracks.csv").string();
    return ReadTracksOfSequence(options, Request());
  }
  // Rows of points over an image of this size, in all frames.
  static std::string Rows(double width, double height) {
    std::string rows;
    for (int frame = 0; frame < kImages; ++frame)
      for (int point = 0; point < 100; ++point) {
        const int column = point % 10;
        const int row = point / 10;
        rows += std::to_string(frame) + "," + std::to_string(point) + "," +
                std::to_string((column + 0.5) / 10 * width) + "," + std::to_string((row + 0.5) / 10 * height) + ",0\n";
      }
    return rows;
  }
  static void ExpectMismatch(const Result<SequenceTracks>& tracks, const std::string& says) {
    EXPECT_EQ(tracks.status().code(), ErrorCode::kMismatch);
    EXPECT_THAT(tracks.status().message(), HasSubstr(says));
  }
};

TEST_F(SequenceTracksTest, MayBeginWithAByteOrderMark) {
  Text("tracks.csv",
       "\xEF\xBB\xBF"
       "frame,track_id,u_px,v_px\r\n3,7,10.5,20.25\r\n");
  TrackFileOptions options;
  options.path = Path("tracks.csv").string();
  const auto tracks = ReadTracksOfSequence(options, Request());
  ASSERT_TRUE(tracks.ok()) << tracks.status().message();
  EXPECT_EQ(tracks->tracks.at(0).id, PointId{7});
}

TEST_F(SequenceTracksTest, AreThoseOfTheFileInOurPixels) {
  const std::string row = "3,7,10.5,20.25,0\n";
  const auto center = Read(row);
  ASSERT_TRUE(center.ok()) << center.status().message();
  EXPECT_EQ(center->tracks.at(0).id, PointId{7});
  EXPECT_EQ(center->tracks.at(0).pixels.at(0).pixel, Eigen::Vector2d(10.5, 20.25));
  EXPECT_THAT(center->notes, IsEmpty());
  const auto corner = Read(row, {.path = "", .pixel_origin = PixelOrigin::kCorner});
  ASSERT_TRUE(corner.ok()) << corner.status().message();
  EXPECT_EQ(corner->tracks.at(0).pixels.at(0).pixel, Eigen::Vector2d(10, 19.75));
}

TEST_F(SequenceTracksTest, FramesAreTheSourcesOwnWhateverPartIsRead) {
  Text("tracks.csv", "frame,track_id,u_px,v_px\n1,0,10.5,20\n3,0,11.5,20\n");
  SequenceRequest part = Request();
  part.start = 2;
  part.stride = 2;
  const auto tracks = ReadTracksOfSequence({.path = Path("tracks.csv").string()}, part);
  ASSERT_TRUE(tracks.ok()) << tracks.status().message();
  EXPECT_EQ(tracks->tracks.at(0).pixels.back().frame_idx, 3);
}

TEST_F(SequenceTracksTest, PixelsThatAreTooUncertainAreNotSeen) {
  const auto tracks = Read("0,0,10.5,20,1\n1,0,11.5,20,3\n0,1,10,20,5\n");
  ASSERT_TRUE(tracks.ok()) << tracks.status().message();
  ASSERT_THAT(tracks->tracks, SizeIs(1));
  EXPECT_TRUE(tracks->tracks[0].pixels[0].visible);
  EXPECT_FALSE(tracks->tracks[0].pixels[1].visible);
  EXPECT_EQ(Read("0,0,10.5,20,3\n").status().code(), ErrorCode::kInsufficient);
}

TEST_F(SequenceTracksTest, AFewPixelsOutsideTheImageAreLeftOutAndSaid) {
  const auto tracks = Read(Rows(kWidth, kHeight) + "0,200,-3,5,0\n1,200,5,5,0\n");
  ASSERT_TRUE(tracks.ok()) << tracks.status().message();
  ASSERT_THAT(tracks->notes, SizeIs(1));
  EXPECT_THAT(tracks->notes[0], HasSubstr("1 of the 402 pixels"));
  EXPECT_EQ(tracks->tracks.back().pixels.front().frame_idx, 1);
}

TEST_F(SequenceTracksTest, OfImagesOfAnotherSizeAreRefused) {
  ExpectMismatch(Read(Rows(2.0 * kWidth, 2.0 * kHeight)), "lie outside the images of 64x48 pixels");
  ExpectMismatch(Read(Rows(0.4 * kWidth, 0.4 * kHeight)), "lie in the upper left");
  ExpectMismatch(Read(Rows(1, 1)), "not from 0 to 1");
}

TEST_F(SequenceTracksTest, OfOtherFramesAreRefused) {
  ExpectMismatch(Read("4,0,10.5,20,0\n"), "has frame 4, and the images are the frames 0 to 3");
  const std::vector<PixelTrack> tracks = {{PointId{0}, {{0, {10.5, 20}}}}};
  ASSERT_TRUE(WriteTrackNpz(Path("tracks.npz").string(), tracks, kImages + 1).ok());
  ExpectMismatch(ReadTracksOfSequence({.path = Path("tracks.npz").string()}, Request()),
                 "have 5 frames and the images 4");
}

}  // namespace
}  // namespace pliant
