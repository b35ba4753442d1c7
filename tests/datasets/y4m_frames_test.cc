// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/y4m_frames.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pliant {
namespace {

using testing::HasSubstr;

const std::string kHeader = "YUV4MPEG2 W6 H4 F30:1 Ip C420jpeg\n";
constexpr std::size_t kBytes = 6 * 4 + 2 * 3 * 2;

// Of lines and marks, so that no pixel is taken for one.
std::string Frame(std::size_t bytes = kBytes, const std::string& parameters = "") {
  std::string pixels;
  while (pixels.size() < bytes) pixels += "FRAME\nYUV4MPEG2 ";
  return "FRAME" + parameters + "\n" + pixels.substr(0, bytes);
}

Status Add(const std::string& bytes, Y4mFrames* frames) {
  return frames->Add({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
}

std::string Taken(Y4mFrames* frames) {
  const auto whole = frames->TakeWhole();
  return {whole.begin(), whole.end()};
}

// What is said of a whole video.
std::string Sentence(const std::string& bytes) {
  Y4mFrames frames("-");
  return Add(bytes, &frames).message();
}

TEST(Y4mFrames, ArePassedOnAsTheyAreHoweverTheyAreCutIntoPieces) {
  const std::string video = kHeader + Frame() + Frame(kBytes, " Ip") + Frame();
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, video.size()}) {
    Y4mFrames frames("-");
    std::string taken;
    for (std::size_t at = 0; at < video.size(); at += piece) {
      ASSERT_TRUE(Add(video.substr(at, piece), &frames).ok());
      taken += Taken(&frames);
    }
    EXPECT_EQ(taken, video) << piece;
    EXPECT_EQ(frames.frames(), 3);
    EXPECT_FALSE(frames.IsWithinFrame());
  }
}

TEST(Y4mFrames, OneThatIsCutOffIsNotPassedOn) {
  Y4mFrames frames("-");
  const std::string last = Frame();
  ASSERT_TRUE(Add(kHeader + Frame() + last.substr(0, last.size() - 1), &frames).ok());
  EXPECT_EQ(Taken(&frames), kHeader + Frame());
  EXPECT_EQ(frames.frames(), 1);
  EXPECT_TRUE(frames.IsWithinFrame());
}

TEST(Y4mFrames, EveryPixelFormatHasItsSize) {
  const std::vector<std::pair<std::string, std::size_t>> formats = {
      {"", 27},           {" C420", 27}, {" C420mpeg2", 27}, {" C420p10", 54}, {" C422", 33},  {" C422p12", 66},
      {" C411", 15 + 12}, {" C444", 45}, {" C444alpha", 60}, {" C444p16", 90}, {" Cmono", 15}, {" Cmono16", 30}};
  for (const auto& [format, bytes] : formats) {
    Y4mFrames frames("-");
    EXPECT_TRUE(Add("YUV4MPEG2 W5 H3" + format + "\n" + Frame(bytes) + Frame(bytes), &frames).ok()) << format;
    EXPECT_EQ(frames.frames(), 2) << format;
    EXPECT_FALSE(frames.IsWithinFrame()) << format;
  }
  EXPECT_THAT(Sentence("YUV4MPEG2 W5 H3 C999\n"), HasSubstr("has the pixel format '999', which is not decoded"));
}

TEST(Y4mFrames, ADamagedMarkerIsSaidWithItsPlace) {
  Y4mFrames frames("-");
  const Status status = Add(kHeader + Frame() + Frame() + "FRAMM" + Frame(), &frames);
  EXPECT_EQ(status.code(), ErrorCode::kUnreadable);
  EXPECT_THAT(status.message(), HasSubstr("the video on standard input is damaged after 2 images"));
  EXPECT_EQ(Taken(&frames), kHeader + Frame() + Frame()) << "what comes before it counts";
  EXPECT_THAT(Sentence(kHeader + Frame() + "FRAME" + std::string(2000, ' ')), HasSubstr("is damaged after 1 images"));
}

TEST(Y4mFrames, ASecondVideoBelongsToTheFirstOneWhereItIsOfTheSameKind) {
  Y4mFrames frames("-");
  ASSERT_TRUE(Add(kHeader + Frame() + kHeader + Frame(), &frames).ok());
  EXPECT_EQ(Taken(&frames), kHeader + Frame() + Frame());
  EXPECT_THAT(Sentence(kHeader + Frame() + "YUV4MPEG2 W8 H2 C420jpeg\n"),
              HasSubstr("the images of standard input change their size from 6x4 to 8x2 after 1 images"));
  EXPECT_THAT(Sentence(kHeader + Frame() + "YUV4MPEG2 W6 H4 C422\n"),
              HasSubstr("change their pixel format from 420jpeg to 422 after 1 images"));
}

TEST(Y4mFrames, AHeaderWithoutASizeIsRefused) {
  for (const char* sides : {"", "W6", "W6 H", "W6 H0", "W-6 H4", "Wx H4"})
    EXPECT_THAT(Sentence("YUV4MPEG2 " + std::string(sides) + "\n"), HasSubstr("tells no size")) << sides;
  EXPECT_THAT(Sentence("YUV4MPEG2 W60000 H60000\n"), HasSubstr("the video on standard input"));
  EXPECT_THAT(Sentence("YUV4OTHER W6 H4\n"), HasSubstr("standard input is no video that can be decoded"));
  EXPECT_THAT(Sentence("YUV4MPEG2 " + std::string(2000, ' ')), HasSubstr("is no video that can be decoded"));
}

}  // namespace
}  // namespace pliant
