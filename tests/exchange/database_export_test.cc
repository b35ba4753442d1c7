// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// COLMAP's database, with a script in COLMAP's place that hands out the database which a test prepared: other versions'
// schemas, and what is none. tests/e2e has COLMAP itself.
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "colmap/sqlite.h"
#include "pliant/exchange/export.h"
#include "support/small_run.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::HasSubstr;

// What every version since 3.8 has; 3.8 had places for prior poses in `images` too.
constexpr const char* kTables =
    "CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY, model INTEGER NOT NULL, width INTEGER NOT NULL, height "
    "INTEGER "
    "NOT NULL, params BLOB, prior_focal_length INTEGER NOT NULL);"
    "CREATE TABLE images (image_id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, camera_id INTEGER NOT NULL);"
    "CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB);"
    "CREATE TABLE matches (pair_id INTEGER PRIMARY KEY, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB);"
    "CREATE TABLE two_view_geometries (pair_id INTEGER PRIMARY KEY, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data "
    "BLOB, config INTEGER NOT NULL, F BLOB, E BLOB, H BLOB, qvec BLOB, tvec BLOB);";
constexpr const char* kRigTables =
    "CREATE TABLE rigs (rig_id INTEGER PRIMARY KEY, ref_sensor_id INTEGER NOT NULL, ref_sensor_type INTEGER NOT NULL);"
    "CREATE TABLE frames (frame_id INTEGER PRIMARY KEY, rig_id INTEGER NOT NULL);"
    "CREATE TABLE frame_data (frame_id INTEGER NOT NULL, data_id INTEGER NOT NULL, sensor_id INTEGER NOT NULL, "
    "sensor_type INTEGER NOT NULL);";

class DatabaseExport : public testing::Test {
 protected:
  void SetUp() override {
    path_before_ = std::getenv("PATH");
    std::filesystem::create_directories(folder_.Path("bin"));
    WriteRun(folder_);
  }
  void TearDown() override { setenv("PATH", path_before_.c_str(), 1); }

  // `colmap` becomes this shell script; $3 is the database to make.
  void InstallColmap(const std::string& script) {
    const std::string path = folder_.Write("bin/colmap", "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    setenv("PATH", (folder_.Path("bin") + ":" + path_before_).c_str(), 1);
  }
  void InstallSchema(const std::string& sql) {
    const std::string prepared = folder_.Write("prepared.db", "");
    auto database = SqliteDatabase::Open(prepared);
    ASSERT_TRUE(database.ok());
    ASSERT_TRUE(database->Execute(sql).ok());
    InstallColmap("cp '" + prepared + "' \"$3\"");
  }
  Result<ExportSummary> Export() const {
    ExportOptions options;
    options.min_matches = 4;
    return ExportRun({folder_.Path("run"), "", "database", folder_.Path("out")}, options);
  }
  std::int64_t Number(const std::string& sql) const {
    sqlite3* database = nullptr;
    EXPECT_EQ(sqlite3_open(folder_.Path("out/database.db").c_str(), &database), SQLITE_OK);
    sqlite3_stmt* statement = nullptr;
    EXPECT_EQ(sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    const std::int64_t value = sqlite3_step(statement) == SQLITE_ROW ? sqlite3_column_int64(statement, 0) : -1;
    sqlite3_finalize(statement);
    sqlite3_close(database);
    return value;
  }
  // The sentence; nothing may be left in the folder but the log.
  Status Refused() const {
    Status status = Export().status();
    EXPECT_FALSE(std::filesystem::exists(folder_.Path("out/database.db")));
    EXPECT_FALSE(std::filesystem::exists(folder_.Path("out/.unfinished")));
    return status;
  }

  TestFolder folder_;
  std::string path_before_;
};

TEST_F(DatabaseExport, FillsTheTablesOfTheVersionThatIsInstalled) {
  for (const bool with_rigs : {false, true}) {
    InstallSchema(with_rigs ? std::string(kTables) + kRigTables : kTables);
    const auto summary = Export();
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    EXPECT_EQ(Number("SELECT count(*) FROM images"), kRunFrames);
    EXPECT_EQ(Number("SELECT image_id FROM images WHERE name = '12.png'"), 13);
    EXPECT_EQ(Number("SELECT sum(rows) FROM keypoints"), kRunObservations);
    EXPECT_EQ(Number("SELECT length(data) FROM keypoints WHERE image_id = 11"), 2 * 4 * kRunPoints);
    // Frames 1, 2 and 4 apart; the points of even number in odd frames.
    EXPECT_EQ(Number("SELECT count(*) FROM matches"), 4 + 3 + 1);
    EXPECT_EQ(Number("SELECT rows FROM two_view_geometries WHERE pair_id = 2147483647 * 11 + 19"), kRunPoints);
    EXPECT_EQ(Number("SELECT min(config) FROM two_view_geometries"), 2);
    if (with_rigs) {
      EXPECT_EQ(Number("SELECT count(*) FROM frames"), kRunFrames);
      EXPECT_EQ(Number("SELECT data_id FROM frame_data WHERE frame_id = 15"), 15);
    }
    EXPECT_FALSE(std::filesystem::exists(folder_.Path("out/database_creator.log")));
  }
}

TEST_F(DatabaseExport, OfAnUnknownSchemaIsRefusedAndTheOneBeforeStays) {
  InstallSchema(kTables);
  ASSERT_TRUE(Export().ok());
  InstallSchema("CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY, lens TEXT)");
  const Status status = Export().status();
  EXPECT_EQ(status.code(), ErrorCode::kMismatch);
  EXPECT_THAT(status.message(), HasSubstr("has no column model in a table cameras"));
  EXPECT_EQ(Number("SELECT count(*) FROM images"), kRunFrames);
}

TEST_F(DatabaseExport, ThatIsNoDatabaseIsRefused) {
  InstallColmap("echo 'this is a text that is as long as a page of a database has to be' > \"$3\"");
  EXPECT_EQ(Refused().code(), ErrorCode::kUnreadable);
  InstallColmap("exit 0");  // and makes nothing
  EXPECT_EQ(Refused().code(), ErrorCode::kUnwritable);
}

TEST_F(DatabaseExport, ColmapThatFailsIsToldWithItsLastWordsAndItsLogIsKept) {
  InstallColmap("echo 'half a database' > \"$3\"; echo 'out of memory'; exit 9");
  const Status status = Refused();
  EXPECT_THAT(status.message(), HasSubstr("'colmap database_creator' ended with 9: out of memory"));
  EXPECT_THAT(folder_.Read("out/database_creator.log"), HasSubstr("out of memory"));
}

TEST_F(DatabaseExport, NeedsColmap) {
  setenv("PATH", folder_.Path("bin").c_str(), 1);
  const Status status = Refused();
  EXPECT_EQ(status.code(), ErrorCode::kNotFound);
  EXPECT_THAT(status.message(), HasSubstr("install it"));
}

TEST_F(DatabaseExport, ADatabaseThatAnotherProgramHoldsOrThatIsReadOnlyIsSaid) {
  const std::string path = folder_.Write("held.db", "");
  auto holder = SqliteDatabase::Open(path);
  auto database = SqliteDatabase::Open(path);
  ASSERT_TRUE(holder.ok() && database.ok());
  ASSERT_TRUE(holder->Execute("CREATE TABLE t (x INTEGER); BEGIN EXCLUSIVE").ok());
  const Status locked = database->Execute("INSERT INTO t VALUES (1)");
  EXPECT_EQ(locked.code(), ErrorCode::kUnwritable);
  EXPECT_THAT(locked.message(), HasSubstr("another program has it open"));
  ASSERT_TRUE(holder->Execute("COMMIT; PRAGMA query_only = 1").ok());
  const Status read_only = holder->Execute("INSERT INTO t VALUES (1)");
  EXPECT_EQ(read_only.code(), ErrorCode::kUnwritable);
  EXPECT_THAT(read_only.message(), HasSubstr("readonly"));
}

}  // namespace
}  // namespace pliant
