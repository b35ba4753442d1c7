// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/files.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "pliant/base/staged_folder.h"
#include "support/temporary_folder.h"
#include "support/text_pipe.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// Leaves so many file descriptors, as long as it lives.
class DescriptorsLeft {
 public:
  explicit DescriptorsLeft(int left) {
    getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit few = {static_cast<rlim_t>(64), before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &few);
    for (int fd = open("/dev/null", O_RDONLY); fd >= 0; fd = open("/dev/null", O_RDONLY)) taken_.push_back(fd);
    for (; left > 0 && !taken_.empty(); --left, taken_.pop_back()) close(taken_.back());
  }
  ~DescriptorsLeft() {
    for (const int fd : taken_) close(fd);
    setrlimit(RLIMIT_NOFILE, &before_);
  }
  DescriptorsLeft(const DescriptorsLeft&) = delete;
  DescriptorsLeft& operator=(const DescriptorsLeft&) = delete;

 private:
  rlimit before_ = {};
  std::vector<int> taken_;
};

TEST(Files, AreReadWithTheLastFileDescriptorAndNotWithoutOne) {
  const TemporaryFolder folder("files");
  const std::string path = folder.Path("file");
  ASSERT_TRUE(WriteFileAtomically(path, "content").ok());
  {
    const DescriptorsLeft one(1);
    const auto text = ReadFile(path);
    ASSERT_TRUE(text.ok()) << text.status().message();
    EXPECT_EQ(*text, "content");
  }
  const DescriptorsLeft none(0);
  const auto text = ReadFile(path);
  ASSERT_FALSE(text.ok());
  EXPECT_EQ(text.status().code(), ErrorCode::kUnreadable);
}

TEST(Files, AreToldFromWhatMayNotBeOpened) {
  const TemporaryFolder folder("files");
  const std::string file = folder.Path("file");
  ASSERT_TRUE(WriteFileAtomically(file, "content").ok());
  fs::create_symlink(file, folder.Path("link"));
  EXPECT_TRUE(CheckIsFile(file).ok());
  EXPECT_TRUE(CheckIsFile(folder.Path("link")).ok());
  EXPECT_EQ(CheckIsFile(folder.Path("nothing")).code(), ErrorCode::kNotFound);
  EXPECT_EQ(CheckIsFile(folder.Path("")).message(), "'" + folder.Path("") + "' is a folder; give a file in it");
  const TextPipe pipe(folder.Path("pipe"), "content");
  for (const std::string& path : {folder.Path("pipe"), std::string("/dev/zero")}) {
    const std::string sentence = "'" + path + "' is a pipe or a device; give a file";
    EXPECT_EQ(CheckIsFile(path).message(), sentence);
    EXPECT_EQ(ReadFile(path).status().message(), sentence);
    EXPECT_EQ(LineReader::Open(path).status().message(), sentence);
  }
  EXPECT_TRUE(pipe.IsUnread());
}

void Write(const std::string& path, const std::string& text) { ASSERT_TRUE(WriteFileAtomically(path, text).ok()); }

std::string Read(const std::string& path) {
  const auto text = ReadFile(path);
  return text.ok() ? *text : "(none)";
}

std::vector<std::string> NamesIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(Files, OfAGroupAppearTogetherOrNotAtAll) {
  const TemporaryFolder folder("files");
  Write(folder.Path("old"), "before");
  fs::create_directories(folder.Path("taken/by_a_file"));  // nothing can be renamed to it
  {
    FileGroup group;
    for (const char* name : {"new", "old", "taken"}) {
      auto file = group.Create(folder.Path(name));
      ASSERT_TRUE(file.ok()) << file.status().message();
      ASSERT_TRUE(file->Append("after").ok());
      ASSERT_TRUE(file->Close().ok());
    }
    const Status status = group.Commit();
    EXPECT_EQ(status.code(), ErrorCode::kUnwritable);
    EXPECT_NE(status.message().find("taken"), std::string::npos) << status.message();
  }
  EXPECT_EQ(NamesIn(folder.Path("")), (std::vector<std::string>{"old", "taken"}));
  EXPECT_EQ(Read(folder.Path("old")), "before");
  FileGroup group;
  for (const char* name : {"new", "old"}) ASSERT_TRUE(group.Create(folder.Path(name))->Append("after").ok());
  ASSERT_TRUE(group.Commit().ok());
  EXPECT_EQ(NamesIn(folder.Path("")), (std::vector<std::string>{"new", "old", "taken"}));
  EXPECT_EQ(Read(folder.Path("old")), "after");
}

TEST(Files, OfAStagedFolderAppearTogetherOrNotAtAll) {
  const TemporaryFolder folder("files");
  fs::create_directories(folder.Path("0/here"));
  Write(folder.Path("0/a"), "before");
  const auto stage = [&] {
    auto staged = StagedFolder::Create(folder.Path(""), {});
    EXPECT_TRUE(staged.ok() && staged->AddFolder("0").ok() && staged->AddFolder("1").ok());
    for (const char* name : {"0/a", "0/b", "1/a"}) Write(staged->Path(name).string(), "after");
    return staged;
  };
  {
    auto staged = stage();
    Write(staged->Path("0/here").string(), "a file, where there is a folder");
    EXPECT_EQ(staged->Commit().code(), ErrorCode::kUnwritable);
  }
  EXPECT_EQ(NamesIn(folder.Path("")), (std::vector<std::string>{"0"}));
  EXPECT_EQ(NamesIn(folder.Path("0")), (std::vector<std::string>{"a", "here"}));
  EXPECT_EQ(Read(folder.Path("0/a")), "before");
  {
    auto staged = stage();
    ASSERT_TRUE(staged->Commit().ok());
  }
  EXPECT_EQ(NamesIn(folder.Path("")), (std::vector<std::string>{"0", "1"}));
  EXPECT_EQ(NamesIn(folder.Path("0")), (std::vector<std::string>{"a", "b", "here"}));
  EXPECT_EQ(Read(folder.Path("0/a")), "after");
}

TEST(Files, OfAStagedFolderThatWasMadeNothingStaysWithoutCommit) {
  const TemporaryFolder folder("staged");
  for (const char* name : {"made", "was_there"}) {
    if (name == std::string("was_there")) fs::create_directories(folder.Path(name));
    auto staged = StagedFolder::Create(folder.Path(name), {});
    ASSERT_TRUE(staged.ok());
    Write(staged->Path("a").string(), "after");
  }
  {
    auto staged = StagedFolder::Create(folder.Path("used"), {});
    ASSERT_TRUE(staged.ok());
    Write(folder.Path("used/b"), "of another program");
  }
  EXPECT_EQ(NamesIn(folder.Path("")), (std::vector<std::string>{"used", "was_there"}));
  EXPECT_EQ(NamesIn(folder.Path("used")), (std::vector<std::string>{"b"}));
}

TEST(FileGroup, IsTheOnlyOneThatWritesAFile) {
  const TemporaryFolder folder("file_group_alone");
  {
    FileGroup group;
    auto file = group.Create(folder.Path("report"));
    ASSERT_TRUE(file.ok() && file->Append("first").ok() && file->Close().ok());
    const Status other = WriteFileAtomically(folder.Path("report"), "second");
    EXPECT_EQ(other.code(), ErrorCode::kUnwritable);
    EXPECT_NE(other.message().find("being written by another program"), std::string::npos) << other.message();
    ASSERT_TRUE(group.Commit().ok());
    EXPECT_EQ(Read(folder.Path("report")), "first");
    EXPECT_TRUE(WriteFileAtomically(folder.Path("report"), "third").ok());
  }
  EXPECT_EQ(Read(folder.Path("report")), "third");
  EXPECT_EQ(NamesIn(folder.Path("")), std::vector<std::string>{"report"});
}

TEST(FileGroup, WritesWhereALinkLeads) {
  const TemporaryFolder folder("file_group_link");
  ASSERT_TRUE(WriteFileAtomically(folder.Path("target.txt"), "before").ok());
  std::filesystem::create_symlink("target.txt", folder.Path("link.txt"));
  ASSERT_TRUE(WriteFileAtomically(folder.Path("link.txt"), "after").ok());
  EXPECT_TRUE(std::filesystem::is_symlink(folder.Path("link.txt")));
  EXPECT_EQ(*ReadFile(folder.Path("target.txt")), "after");
}

}  // namespace
}  // namespace pliant
