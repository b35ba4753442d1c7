// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap/sqlite.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/test_folder.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// As COLMAP leaves one: with a journal beside it while it is open.
std::string WriteWithJournal(const TestFolder& folder) {
  std::string path = folder.Write("a folder with 100 %? #1.db", "");
  auto database = SqliteDatabase::Open(path);
  EXPECT_TRUE(database.ok());
  EXPECT_TRUE(database->Execute("PRAGMA journal_mode = WAL; CREATE TABLE cameras (camera_id INTEGER)").ok());
  return path;
}

// As on read-only media: nothing can be written beside it. (Permissions do not bind root.)
void LetNothingBeWrittenBeside(const std::string& path) { fs::create_directory(path + "-shm"); }

TEST(SqliteDatabase, IsReadWhereNothingCanBeWritten) {
  const TestFolder folder;
  const std::string path = WriteWithJournal(folder);
  LetNothingBeWrittenBeside(path);
  auto database = SqliteDatabase::Open(path, SqliteAccess::kRead);
  ASSERT_TRUE(database.ok()) << database.status().message();
  const auto columns = database->Columns("cameras");
  ASSERT_TRUE(columns.ok()) << columns.status().message();
  EXPECT_EQ(*columns, std::vector<std::string>{"camera_id"});
}

TEST(SqliteDatabase, IsNotReadWithoutWhatItsJournalHolds) {
  const TestFolder folder;
  const std::string path = WriteWithJournal(folder);
  const std::string copy = folder.Path("copy.db");
  {
    auto database = SqliteDatabase::Open(path);
    ASSERT_TRUE(database.ok() && database->Execute("CREATE TABLE images (image_id INTEGER)").ok());
    fs::copy_file(path, copy);
    fs::copy_file(path + "-wal", copy + "-wal");
  }
  LetNothingBeWrittenBeside(copy);
  auto database = SqliteDatabase::Open(copy, SqliteAccess::kRead);
  const auto columns = database.ok() ? database->Columns("images") : database.status();
  if (columns.ok())
    EXPECT_EQ(*columns, std::vector<std::string>{"image_id"});
  else
    EXPECT_EQ(columns.status().code(), ErrorCode::kUnreadable);
}

}  // namespace
}  // namespace pliant
