// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// COLMAP's database as a file of tracks.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "colmap/sqlite.h"
#include "pliant/io/track_file.h"
#include "support/test_folder.h"
#include "support/zip_file.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

constexpr std::int64_t kPair = 2147483647;

class TrackDatabase : public testing::Test {
 protected:
  void SetUp() override {
    folder_.Write("a.db", "");
    auto opened = SqliteDatabase::Open(folder_.Path("a.db"));
    ASSERT_TRUE(opened.ok());
    ASSERT_TRUE(opened
                    ->Execute("CREATE TABLE cameras (camera_id INTEGER, model INTEGER, width INTEGER, height INTEGER);"
                              "CREATE TABLE images (image_id INTEGER, name TEXT, camera_id INTEGER);"
                              "CREATE TABLE keypoints (image_id INTEGER, rows INTEGER, cols INTEGER, data BLOB);"
                              "CREATE TABLE two_view_geometries (pair_id INTEGER, rows INTEGER, cols INTEGER, data "
                              "BLOB, config INTEGER);"
                              "INSERT INTO cameras VALUES (1, 1, 640, 480)")
                    .ok());
    for (const int image : {1, 2, 3}) {
      Insert("images", {"image_id", "name", "camera_id"},
             {std::int64_t{image}, "00000" + std::to_string(image) + ".png", std::int64_t{1}});
      // Columns x, y, scale and angle; the first keypoint of image k is at (k, k + 0.5) of COLMAP.
      const auto x = static_cast<float>(image);
      Insert("keypoints", {"image_id", "rows", "cols", "data"},
             {std::int64_t{image}, std::int64_t{2}, std::int64_t{4},
              SqliteBlob{BytesOf<float>({x, x + 0.5F, 1, 0, x + 100, 7.75F, 1, 0})}});
    }
  }
  void Insert(const std::string& table, const std::vector<std::string>& columns,
              const std::vector<SqliteValue>& values) {
    auto database = SqliteDatabase::Open(folder_.Path("a.db"));
    ASSERT_TRUE(database.ok());
    auto row = SqliteInsert::Create(*database, table, columns);
    ASSERT_TRUE(row.ok()) << row.status().message();
    ASSERT_TRUE(row->Add(values).ok());
  }
  void Match(int a, int b, const std::vector<std::uint32_t>& keypoints) {
    Insert("two_view_geometries", {"pair_id", "rows", "cols", "data", "config"},
           {kPair * a + b, static_cast<std::int64_t>(keypoints.size() / 2), std::int64_t{2},
            SqliteBlob{BytesOf(keypoints)}, std::int64_t{2}});
  }
  Result<TrackFile> Read() const { return ReadTrackFile(folder_.Path("a.db")); }

  TestFolder folder_;
};

TEST_F(TrackDatabase, JoinsKeypointsByTheirVerifiedMatches) {
  Match(1, 2, {0, 0, 1, 1});
  Match(2, 3, {0, 1});
  const auto file = Read();
  ASSERT_TRUE(file.ok()) << file.status().message();
  ASSERT_THAT(file->images, SizeIs(3));
  EXPECT_EQ(file->images[1].name, "000002.png");
  EXPECT_EQ(file->images[1].width, 640U);
  ASSERT_THAT(file->tracks, SizeIs(2));
  ASSERT_THAT(file->tracks[0].pixels, SizeIs(3));
  EXPECT_EQ(file->tracks[0].pixels[0].pixel, Eigen::Vector2d(0.5, 1));       // COLMAP's (1, 1.5)
  EXPECT_EQ(file->tracks[0].pixels[2].pixel, Eigen::Vector2d(102.5, 7.25));  // the other keypoint of image 3
  ASSERT_THAT(file->tracks[1].pixels, SizeIs(2));
  EXPECT_EQ(file->tracks[1].pixels[1].frame_idx, 1);
}

TEST_F(TrackDatabase, LeavesOutTracksWithTwoKeypointsInAnImage) {
  Match(1, 2, {0, 0, 1, 1});
  Match(2, 3, {0, 0});
  Match(1, 3, {1, 1});
  Insert(
      "two_view_geometries", {"pair_id", "rows", "cols", "data", "config"},
      {kPair * 1 + 3, std::int64_t{1}, std::int64_t{2}, SqliteBlob{BytesOf<std::uint32_t>({0, 1})}, std::int64_t{2}});
  EXPECT_THAT(Read().status().message(), HasSubstr("has no point that is seen"));
}

TEST_F(TrackDatabase, WithoutVerifiedMatchesSaysWhatMakesThem) {
  EXPECT_EQ(Read().status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(Read().status().message(), HasSubstr("has no verified matches; run a matcher of COLMAP"));
}

TEST_F(TrackDatabase, ThatIsDamagedIsRefused) {
  Match(1, 2, {0, 9});
  EXPECT_THAT(Read().status().message(), HasSubstr("the matches of the images 000001.png and 000002.png"));
  Insert("keypoints", {"image_id", "rows", "cols", "data"},
         {std::int64_t{2}, std::int64_t{5}, std::int64_t{4}, SqliteBlob{"short"}});
  EXPECT_EQ(Read().status().code(), ErrorCode::kUnreadable);
  EXPECT_THAT(Read().status().message(), HasSubstr("the keypoints of the image 000002.png"));
}

TEST_F(TrackDatabase, OfAnotherProgramIsRefused) {
  folder_.Write("b.db", "");
  auto database = SqliteDatabase::Open(folder_.Path("b.db"));
  ASSERT_TRUE(database.ok() && database->Execute("CREATE TABLE songs (title TEXT)").ok());
  const auto file = ReadTrackFile(folder_.Path("b.db"));
  EXPECT_EQ(file.status().code(), ErrorCode::kUnreadable);
  EXPECT_THAT(file.status().message(), HasSubstr("b.db' is none of COLMAP's: it has no table cameras"));
}

// What it answers may have no end, or be larger than any memory.
TEST_F(TrackDatabase, ThatComputesWhatItHoldsIsRefused) {
  Match(1, 2, {0, 0});
  ASSERT_TRUE(Read().ok());
  const std::string whole = folder_.Read("a.db");
  // Of 1000 rows here, so that this test ends.
  const std::string rows = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n LIMIT 1000) ";
  for (const auto& [table, made] :
       {std::pair("images",
                  "CREATE VIEW images AS " + rows + "SELECT i AS image_id, 'a' AS name, 1 AS camera_id FROM n"),
        std::pair("keypoints", "CREATE VIEW keypoints AS " + rows +
                                   "SELECT 1 AS image_id, 1 AS rows, 2 AS cols, '' AS data FROM n WHERE i < 0"),
        std::pair("keypoints", std::string("CREATE TABLE keypoints (image_id INTEGER, rows INTEGER, cols INTEGER, "
                                           "data BLOB AS (zeroblob(8 * rows)))"))}) {
    folder_.Write("a.db", whole);
    {
      auto database = SqliteDatabase::Open(folder_.Path("a.db"));
      ASSERT_TRUE(database.ok() && database->Execute("DROP TABLE " + std::string(table) + "; " + made).ok()) << made;
    }
    EXPECT_THAT(Read().status().message(), HasSubstr("it has no table " + std::string(table))) << made;
  }
}

TEST_F(TrackDatabase, WhoseImageComesTwiceIsRefused) {
  Insert("cameras", {"camera_id", "width", "height"}, {std::int64_t{1}, std::int64_t{8}, std::int64_t{8}});
  EXPECT_THAT(Read().status().message(), HasSubstr("image 1 comes twice, or has two cameras"));
}

}  // namespace
}  // namespace pliant
