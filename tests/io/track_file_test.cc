// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/track_file.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/test_folder.h"
#include "support/text_pipe.h"
#include "support/tolerances.h"
#include "support/zip_file.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const float kNan = std::numeric_limits<float>::quiet_NaN();

// Two points in three frames: the second is hidden in frame 1, and not known there.
const std::vector<float> kPixels = {1.5F, 2.25F, 10, 20, 3.5F, 4.25F, kNan, kNan, 5.5F, 6.25F, 14, 24};
const std::string kVisible = {1, 1, 1, 0, 1, 1};

std::string Tracks() { return NpyFile("<f4", "3, 2, 2", BytesOf(kPixels)); }
std::string Visibility(const std::string& flags = kVisible) { return NpyFile("|b1", "3, 2", flags); }
std::string Npz(const std::string& tracks, const std::string& visibility, ZipMethod method = ZipMethod::kStored) {
  return ZipFile({{"tracks.npy", tracks}, {"visibility.npy", visibility}}, method);
}

void ExpectTheTwoPoints(const TrackFile& file) {
  ASSERT_THAT(file.tracks, SizeIs(2));
  ASSERT_THAT(file.tracks[0].pixels, SizeIs(3));
  ASSERT_THAT(file.tracks[1].pixels, SizeIs(2));
  EXPECT_EQ(file.tracks[0].id, PointId{0});
  EXPECT_EQ(file.tracks[0].pixels[1].frame_idx, 1);
  EXPECT_EQ(file.tracks[0].pixels[1].pixel, Eigen::Vector2d(3.5, 4.25));
  EXPECT_EQ(file.tracks[1].pixels[1].frame_idx, 2);
  EXPECT_EQ(file.tracks[1].pixels[1].pixel, Eigen::Vector2d(14, 24));
  EXPECT_THAT(file.notes, IsEmpty());
}

TrackFile Read(const std::string& path) {
  const auto file = ReadTrackFile(path);
  EXPECT_TRUE(file.ok()) << file.status().message();
  return file.ok() ? *file : TrackFile();
}

// The transposed arrays as np.savez stores them: the first axis varies fastest.
std::string NpzColumnsFirst() {
  std::vector<float> pixels;
  std::string visible;
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t point = 0; point < 2; ++point)
      for (std::size_t frame = 0; frame < 3; ++frame) pixels.push_back(kPixels[4 * frame + 2 * point + k]);
  for (std::size_t point = 0; point < 2; ++point)
    for (std::size_t frame = 0; frame < 3; ++frame) visible += kVisible[2 * frame + point];
  return Npz(NpyFile("<f4", "3, 2, 2", BytesOf(pixels), "True"), NpyFile("|b1", "3, 2", visible, "True"));
}

TEST(TrackFile, OfEveryFormIsRead) {
  const TestFolder folder;
  for (const std::string& path :
       {folder.Write("stored.npz", Npz(Tracks(), Visibility())),
        folder.Write("deflated.npz", Npz(Tracks(), Visibility(), ZipMethod::kDeflated)),
        folder.Write("columns_first.npz", NpzColumnsFirst()),
        folder.Write("batch.npz",
                     Npz(NpyFile("<f4", "1, 3, 2, 2", BytesOf(kPixels)), NpyFile("|b1", "1, 3, 2, 1", kVisible))),
        folder.Write("bytes.npz",
                     Npz(NpyFile("<f8", "3, 2, 2", BytesOf(std::vector<double>(kPixels.begin(), kPixels.end()))),
                         NpyFile("|u1", "3, 2", kVisible))),
        folder.Write(
            "floats.npz",
            Npz(Tracks(), NpyFile("<f4", "3, 2", BytesOf(std::vector<float>(kVisible.begin(), kVisible.end()))))),
        folder.Write("tracks.csv",
                     "frame,track_id,u_px,v_px\n0,0,1.5,2.25\n0,1,10,20\n1,0,3.5,4.25\n2,0,5.5,6.25\n"
                     "2,1,14,24"),
        folder.Write("other.csv",
                     "v_px,u_px,score,track_id,frame\r\n24,14,1,1,2\r\n20,10,1,1,0\r\n6.25,5.5,1,0,2\r\n"
                     "4.25,3.5,1,0,1\r\n2.25,1.5,1,0,0\r\n"),
        folder.Write(
            "blanks.csv",
            "frame, track_id, u_px, v_px\n0, 0, 1.5, 2.25\n0, 1, 10, 20\n1,\t0, 3.5, 4.25 \n \n2, 0, 5.5, 6.25\n"
            "2, 1, 14, 24\n"),
        folder.Write(
            "quotes.csv",
            "\"frame\",\"track_id\",\"u_px\",\"v_px\"\n\"0\",\"0\",\"1.5\",\"2.25\"\n0, \"1\",10,20\n1,0,3.5,4.25\n"
            "2,0,5.5,6.25\n2,1,14,24\n"),
        folder.Write("floats.csv",
                     "frame,track_id,u_px,v_px\n0.0,0.0,1.5,2.25\n0.0,1.0,10.0,20.0\n1.0,0.0,3.5,4.25\n"
                     "2.0,0.0,5.5,6.25\n2.0,1e0,14.0,24.0\n")}) {
    SCOPED_TRACE(path);
    ExpectTheTwoPoints(Read(path));
  }
}

// np.save, np.savez and np.savez_compressed of NumPy 1.24, and Python's sqlite3.
TEST(TrackFile, ThatPythonWroteIsRead) {
  const std::string corpus = PLIANT_TRACK_FILES;
  for (const char* name : {"/npz", "/npz_compressed"}) {
    const TrackFile file = Read(corpus + name);
    ASSERT_THAT(file.tracks, SizeIs(2)) << name;
    EXPECT_EQ(file.frames, 2);
    EXPECT_THAT(file.tracks[1].pixels, SizeIs(1));
    EXPECT_EQ(file.tracks[0].pixels[1].pixel, Eigen::Vector2d(5, 6));
  }
  EXPECT_EQ(Read(corpus + "/npy").tracks.at(1).pixels.at(0).pixel, Eigen::Vector2d(3, 4));
  EXPECT_EQ(Read(corpus + "/database").tracks.at(0).pixels.at(1).pixel, Eigen::Vector2d(1, 1.5));
}

TEST(TrackFile, ArraysSayHowManyFramesThereAreAndWhereHiddenPointsAre) {
  const TestFolder folder;
  std::vector<float> pixels = kPixels;
  pixels[6] = 12.5F;
  pixels[7] = 22.5F;
  const TrackFile file = Read(folder.Write("a.npz", Npz(NpyFile("<f4", "3, 2, 2", BytesOf(pixels)), Visibility())));
  EXPECT_EQ(file.frames, 3);
  const TrackPixel* hidden = PixelIn(file.tracks.at(1), 1);
  ASSERT_NE(hidden, nullptr);
  EXPECT_FALSE(hidden->visible);
  EXPECT_EQ(hidden->pixel, Eigen::Vector2d(12.5, 22.5));
  EXPECT_EQ(PixelIn(file.tracks.at(1), 3), nullptr);
}

TEST(TrackFile, TracksAloneAreAllSeen) {
  const TestFolder folder;
  const TrackFile file = Read(folder.Write("a.npy", NpyFile("<f4", "2, 1, 2", BytesOf<float>({1.5F, 2, 3, 4}))));
  ASSERT_THAT(file.tracks, SizeIs(1));
  EXPECT_THAT(file.tracks[0].pixels, SizeIs(2));
}

TEST(TrackFile, StandardDeviationsAreRead) {
  const TestFolder folder;
  const std::string sigma = NpyFile("<f4", "3, 2", BytesOf<float>({0.5F, 1, 1, kNan, 1, 2}));
  for (const std::string& path :
       {folder.Write("a.npz",
                     ZipFile({{"tracks.npy", Tracks()}, {"visibility.npy", Visibility()}, {"sigma_px.npy", sigma}},
                             ZipMethod::kStored)),
        folder.Write("a.csv",
                     "frame,track_id,u_px,v_px,sigma_px\n0,0,1.5,2.25,0.5\n0,1,1,1,1\n1,1,1,1,1\n2,1,1,1,2\n")}) {
    const TrackFile file = Read(path);
    ASSERT_THAT(file.tracks, SizeIs(2));
    EXPECT_EQ(file.tracks[0].pixels[0].sigma_px, 0.5);
    EXPECT_EQ(file.tracks[1].pixels.back().sigma_px, 2);
  }
}

TEST(TrackFile, WholePixelsAreReadAndSaid) {
  const TestFolder folder;
  for (const std::string& path : {folder.Write("a.npy", NpyFile("<i4", "1, 2, 2", BytesOf<std::int32_t>({1, 2, 3, 4}))),
                                  folder.Write("a.csv", "frame,track_id,u_px,v_px\n0,0,1,2\n0,1,3,4\n")}) {
    const TrackFile file = Read(path);
    ASSERT_THAT(file.tracks, SizeIs(2));
    EXPECT_EQ(file.tracks[1].pixels[0].pixel, Eigen::Vector2d(3, 4));
    ASSERT_THAT(file.notes, SizeIs(1));
    EXPECT_THAT(file.notes[0], HasSubstr("are whole numbers"));
  }
}

TEST(TrackFile, PixelsThatWereRoundedAreSaidAlsoHalfAPixelFromWholeNumbers) {
  const TestFolder folder;
  const TrackFile rounded = Read(folder.Write("a.csv", "frame,track_id,u_px,v_px\n0,0,1.5,2.5\n0,1,3.5,7.5\n"));
  ASSERT_THAT(rounded.notes, SizeIs(1));
  EXPECT_THAT(rounded.notes[0], HasSubstr("are whole numbers and a half: rounded pixels are off by 0.29 px"));
  for (const char* rows : {"0,0,1.5,2.5\n0,1,3,7\n", "0,0,1.5,2.5\n0,1,3.5,7.25\n", "0,0,1.5,2\n0,1,3.5,7\n"})
    EXPECT_THAT(Read(folder.Write("a.csv", std::string("frame,track_id,u_px,v_px\n") + rows)).notes, IsEmpty()) << rows;
}

TEST(TrackFile, ThatIsWrittenIsReadAgain) {
  const TestFolder folder;
  const std::vector<PixelTrack> tracks = {{PointId{3}, {{0, {1.5, 2.25}}, {2, {3.125, 4}, 0, false}, {4, {5, 6.5}}}},
                                          {PointId{70}, {{1, {10, 20.5}}}}};
  ASSERT_TRUE(WriteTrackCsv(folder.Path("a.csv"), tracks).ok());
  ASSERT_TRUE(WriteTrackNpz(folder.Path("a.npz"), tracks, 6).ok());
  for (const char* name : {"a.csv", "a.npz"}) {
    const TrackFile file = Read(folder.Path(name));
    ASSERT_THAT(file.tracks, SizeIs(2)) << name;
    EXPECT_EQ(file.tracks[0].id, PointId{3});
    EXPECT_EQ(file.tracks[1].id, PointId{70});
    EXPECT_LT((PixelIn(file.tracks[0], 4)->pixel - Eigen::Vector2d(5, 6.5)).norm(), kFilePixel_px);
    EXPECT_EQ(PixelIn(file.tracks[1], 1)->pixel, Eigen::Vector2d(10, 20.5));
  }
  EXPECT_EQ(Read(folder.Path("a.npz")).frames, 6);
  EXPECT_FALSE(PixelIn(Read(folder.Path("a.npz")).tracks[0], 2)->visible);
  EXPECT_EQ(PixelIn(Read(folder.Path("a.csv")).tracks[0], 2), nullptr);
  const std::string first = folder.Read("a.npz");
  ASSERT_TRUE(WriteTrackNpz(folder.Path("a.npz"), tracks, 6).ok());
  EXPECT_EQ(folder.Read("a.npz"), first);
}

TEST(TrackFile, LargerThanFourGigabytesIsNotWritten) {
  const TestFolder folder;
  const std::vector<PixelTrack> tracks(1000);
  EXPECT_THAT(WriteTrackNpz(folder.Path("a.npz"), tracks, 1'000'000).message(), HasSubstr("larger than 4 GB"));
}

struct WrongTracks {
  std::string label, name, bytes, says;
  ErrorCode code = ErrorCode::kUnreadable;
};

class WrongTrackFile : public testing::TestWithParam<WrongTracks> {};

TEST_P(WrongTrackFile, IsRefusedWithItsReason) {
  const TestFolder folder;
  const auto file = ReadTrackFile(folder.Write(GetParam().name, GetParam().bytes));
  ASSERT_FALSE(file.ok());
  EXPECT_EQ(file.status().code(), GetParam().code) << file.status().message();
  EXPECT_THAT(file.status().message(), HasSubstr(GetParam().says));
  EXPECT_THAT(file.status().message(), HasSubstr(GetParam().name));
}

std::string Csv(const std::string& rows) { return "frame,track_id,u_px,v_px\n" + rows; }
std::string TracksAs(const std::string& type, const std::string& shape, const std::string& order = "False") {
  return NpyFile(type, shape, BytesOf(kPixels), order);
}

INSTANTIATE_TEST_SUITE_P(
    TrackFile, WrongTrackFile,
    testing::Values(
        WrongTracks{"SomethingElse", "a.png", "\x89PNG\r\n", "its first line is '?PNG'"},
        WrongTracks{"Empty", "a.csv", "", "is no file of tracks"},
        WrongTracks{"OtherColumns", "a.csv", "frame,id,x,y\n0,0,1,2\n", "is no file of tracks"},
        WrongTracks{"Semicolons", "a.csv", "frame;track_id;u_px;v_px\n0;0;1;2\n",
                    "its first line is 'frame;track_id;u_px;v_px'"},
        WrongTracks{"Comment", "a.csv", "# made by a tracker\nframe,track_id,u_px,v_px\n0,0,1,2\n",
                    "its first line is '# made by a tracker'"},
        WrongTracks{"LongLine", "a.csv", std::string(70, 'x') + "\n",
                    "its first line is '" + std::string(60, 'x') + "...'"},
        WrongTracks{"TwoColumnsOfOneName", "a.csv", "frame,track_id,u_px,u_px,v_px\n0,0,1,1,2\n",
                    "names u_px more than once"},
        WrongTracks{"HalfAFrame", "a.csv", Csv("0.5,0,1,2\n"), "'0.5' is not a frame's number"},
        WrongTracks{"NoRows", "a.csv", Csv(""), "has no point that is seen", ErrorCode::kInsufficient},
        WrongTracks{"TwiceInAFrame", "a.csv", Csv("0,0,1,2\n0,1,1,2\n0,0,3,4\n"), ":4: track 0 comes twice in frame 0"},
        WrongTracks{"NotANumber", "a.csv", Csv("0,0,nan,2\n"), ":2: 'nan' is not a finite number"},
        WrongTracks{"NegativeFrame", "a.csv", Csv("-1,0,1,2\n"), "is not a frame's number"},
        WrongTracks{"NegativeId", "a.csv", Csv("0,-4,1,2\n"), "is not a track_id"},
        WrongTracks{"CutRow", "a.csv", Csv("0,0,1,2\n1,0,1"), "this one has 3; the file is cut off"},
        WrongTracks{"NegativeSigma", "a.csv", "frame,track_id,u_px,v_px,sigma_px\n0,0,1,2,-1\n",
                    "is not a standard deviation"},
        WrongTracks{"AllHidden", "a.npz", Npz(Tracks(), Visibility(std::string(6, '\0'))),
                    "all of its visibility is False", ErrorCode::kInsufficient},
        WrongTracks{"VisibleButNotANumber", "a.npz", Npz(Tracks(), Visibility(std::string(6, '\1'))),
                    "the pixel of track 1 in frame 1 of"},
        WrongTracks{"WrongShape", "a.npz", Npz(TracksAs("<f4", "3, 4"), Visibility()), "have the shape (3, 4)"},
        WrongTracks{"ThreeCoordinates", "a.npz", Npz(TracksAs("<f4", "2, 2, 3"), Visibility()), "(frames, points, 2)"},
        WrongTracks{"OtherVisibility", "a.npz", Npz(Tracks(), NpyFile("|b1", "2, 3", kVisible)), "visibility in"},
        WrongTracks{"ScoresAsVisibility", "a.npz",
                    Npz(Tracks(), NpyFile("<f8", "3, 2", BytesOf<double>({1, 1, 1, 0, 0.25, 1}))),
                    "has the value 0.25, which is neither 0 nor 1; save bools"},
        WrongTracks{"MaskAsVisibility", "a.npz", Npz(Tracks(), NpyFile("|u1", "3, 2", {1, 1, 1, 0, '\xff', 1})),
                    "has the value 255, which is neither 0 nor 1; save bools"},
        WrongTracks{"CodesAsVisibility", "a.npz",
                    Npz(Tracks(), NpyFile("<i4", "3, 2", BytesOf<std::int32_t>({1, 1, 1, -1, 1, 1}))),
                    "has the value -1, which is neither 0 nor 1; save bools"},
        WrongTracks{"BigEndian", "a.npz", Npz(TracksAs(">f4", "3, 2, 2"), Visibility()), "is big-endian"},
        WrongTracks{"HalfPrecision", "a.npz", Npz(TracksAs("<f2", "3, 2, 2"), Visibility()), "of the type <f2"},
        WrongTracks{"Objects", "a.npy", TracksAs("|O", "3, 2, 2"), "holds Python objects"},
        WrongTracks{"CutArray", "a.npy", TracksAs("<f4", "4, 2, 2"), "is cut off"},
        WrongTracks{"AbsurdShape", "a.npy", TracksAs("<f4", "4294967296, 4294967296, 2"), "is damaged"},
        WrongTracks{"NoFrames", "a.npy", NpyFile("<f4", "0, 2147483647, 2", {}), "have no frame"},
        WrongTracks{"NoVisibility", "a.npz", ZipFile({{"tracks.npy", Tracks()}}, ZipMethod::kStored),
                    "has no array visibility"},
        WrongTracks{"NoTracks", "a.npz", ZipFile({{"points.npy", Tracks()}}, ZipMethod::kStored),
                    "has no array tracks"},
        WrongTracks{"CutZip", "a.npz", Npz(Tracks(), Visibility()).substr(0, 200), "is cut off"},
        WrongTracks{"ChangedZip", "a.npz",
                    [] {
                      std::string bytes = Npz(Tracks(), Visibility());
                      bytes[200] ^= 1;
                      return bytes;
                    }(),
                    "is damaged"},
        WrongTracks{"NoDatabase", "a.db", std::string("SQLite format 3\0nothing", 23), "cannot read the database"}),
    [](const auto& test) { return test.param.label; });

TEST(TrackFile, ThatIsNotThereOrAFolderIsSaid) {
  const TestFolder folder;
  EXPECT_EQ(ReadTrackFile(folder.Path("nowhere.csv")).status().code(), ErrorCode::kNotFound);
  EXPECT_THAT(ReadTrackFile(folder.Path("")).status().message(), HasSubstr("is a folder"));
}

// Damaged, so that whatever unpacks it says so.
TEST(TrackFile, ArraysThatItDoesNotNeedAreNotUnpacked) {
  const TestFolder folder;
  const auto damaged = [](std::string bytes) {
    bytes[200] ^= 1;  // in the first array
    return bytes;
  };
  const std::string first = std::string(1000, 'a');
  const std::string archive =
      ZipFile({{"frames.npy", first}, {"tracks.npy", Tracks()}, {"visibility.npy", Visibility()}}, ZipMethod::kStored);
  ExpectTheTwoPoints(Read(folder.Write("a.npz", damaged(archive))));
  const std::string alone = ZipFile({{"tracks.npy", Tracks()}}, ZipMethod::kStored);
  EXPECT_THAT(ReadTrackFile(folder.Write("b.npz", damaged(alone))).status().message(),
              HasSubstr("has no array visibility"));
}

TEST(TrackFile, IsNoPipe) {
  const TestFolder folder;
  const TextPipe pipe(folder.Path("tracks"), "frame,track_id,u_px,v_px\n0,0,1.5,2\n");
  EXPECT_THAT(ReadTrackFile(folder.Path("tracks")).status().message(), HasSubstr("tracks' is a pipe or a device"));
  EXPECT_TRUE(pipe.IsUnread());
}

}  // namespace
}  // namespace pliant
