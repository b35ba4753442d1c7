// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Files whose every failure is a Status: written as a whole or not at all, read by lines with their numbers.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/base/text.h"

namespace pliant {

// Whether something is there that can be seen; never throws.
bool Exists(const std::string& path);

// Whether it is a regular file, or a link to one. Fails with kNotFound, and with kUnreadable for a folder, a pipe or a
// device. To be asked before a file is opened: opening a pipe waits for its other end, and a device may be endless.
Status CheckIsFile(const std::string& path);

// kUnwritable, for a file or folder that could not be written.
Status Unwritable(const std::filesystem::path& path);

// Whoever holds it is the only one that writes a file. It ends with this object, or with the process and the children
// that it was forked into, however these end. A file system that knows no locks grants every one.
class FileLock {
 public:
  FileLock() = default;  // of no file
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileLock& operator=(FileLock&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~FileLock();
  bool IsHeld() const { return descriptor_ >= 0; }

 private:
  int descriptor_ = -1;
};

// A file that is written from its beginning. Append hands everything to the system before it returns.
class OutputFile {
 public:
  static Result<OutputFile> Create(const std::string& path);
  // The same; while `lock` is held, also after Close, no other one that is created thus writes it. Fails with
  // kUnwritable where another one holds it.
  static Result<OutputFile> CreateAlone(const std::string& path, FileLock* lock);
  // A file that is there, cut to its first `size` bytes, at its end. Fails with kUnreadable where it has fewer, and
  // with kUnwritable.
  static Result<OutputFile> Continue(const std::string& path, std::int64_t size);
  Status Append(std::string_view text);
  // Hands `buffer` over and empties it when it has grown large.
  Status AppendWhenLarge(std::string* buffer);
  // What was written survives that the power goes.
  Status Sync();
  Status Close();
  std::int64_t size() const { return size_; }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  OutputFile(std::string path, std::FILE* file) : path_(std::move(path)), file_(file) {}
  Status Failure() const;

  std::int64_t size_ = 0;
  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
};

// A file or folder that is to be renamed.
struct Renaming {
  std::string from;
  std::string to;
};

// Renames all of them, or none: where one fails those before it are taken back, and the files that they replaced are
// there again. Between the renames a reader can see some of them. Fails with kUnwritable.
Status RenameTogether(const std::vector<Renaming>& renamings);

// Files that appear together or not at all: each is written under another name, and Commit renames them together. What
// is not committed is deleted.
class FileGroup {
 public:
  FileGroup() = default;
  FileGroup(const FileGroup&) = delete;
  FileGroup& operator=(const FileGroup&) = delete;
  ~FileGroup();

  // A new file of the group, which is to become `path`; the caller closes it before Commit. A device or a pipe that is
  // there is written into at once. Fails with kUnwritable where that cannot be, and while another group is writing it.
  Result<OutputFile> Create(const std::string& path);
  // Renames all files, or none. Fails with kUnwritable.
  Status Commit();

 private:
  std::vector<std::string> paths_;
  std::vector<FileLock> locks_;  // one a path
};

// The names of the files in a folder survive that the power goes. Fails with kUnwritable.
Status SyncFolder(const std::filesystem::path& folder);

// Replaces a whole file: a reader sees the old one or the new one.
Status WriteFileAtomically(const std::string& path, std::string_view text);
// Replaces the content of a file that is there, in its own blocks: for a full disk, where nothing new can be made.
Status OverwriteFile(const std::string& path, std::string_view text);
Result<std::string> ReadFile(const std::string& path);

// A file line by line, without its line ends (\n or \r\n).
class LineReader {
 public:
  static Result<LineReader> Open(const std::string& path);

  // False at the end, and where the file cannot be read to its end: End tells which.
  bool Next(std::string_view* line);
  // After Next was false: kUnreadable where lines are missing.
  Status End() const;
  // Of the line that Next gave: its number from 1, and whether a line end followed it.
  std::int64_t number() const { return number_; }
  bool ended() const { return ended_; }
  const std::string& path() const { return path_; }
  Status Error(const std::string& what) const {
    return {ErrorCode::kUnreadable, PathAndLine(path_, number_) + ": " + what};
  }

 private:
  LineReader(std::string path, std::ifstream stream) : path_(std::move(path)), stream_(std::move(stream)) {}

  std::string path_;
  std::ifstream stream_;
  std::string line_;
  std::int64_t number_ = 0;
  bool ended_ = true;
};

}  // namespace pliant
