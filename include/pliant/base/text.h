// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Text in and out: rows of numbers written fast, files whose every failure is a Status, lines with their numbers.
#pragma once

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/base/status.h"

namespace pliant {

inline std::string Quoted(std::string_view text) { return "'" + std::string(text) + "'"; }

// "1.25 s", to a microsecond.
std::string Seconds(double seconds);

// Whether something is there that can be seen; never throws.
bool Exists(const std::string& path);

// `path:line`, as compilers write it.
std::string At(const std::string& path, std::int64_t line);

void AppendInt(std::string* out, std::int64_t value);
// Rounded to `decimals` (at most 9) places after the point; never "-0.0".
void AppendFixed(std::string* out, double value, int decimals);
// With 17 significant digits, like C's %.17g: what is read back is the same number.
void AppendExact(std::string* out, double value);
// The bytes of a number, little-endian.
void AppendBytes(std::string* out, std::uint64_t value, int num_bytes);
void AppendDouble(std::string* out, double value);
void AppendFloat(std::string* out, float value);

// A file that is written from its beginning. Append hands everything to the system before it returns.
class OutputFile {
 public:
  static Result<OutputFile> Create(const std::string& path);
  Status Append(std::string_view text);
  // Hands `buffer` over and empties it when it has grown large.
  Status AppendWhenLarge(std::string* buffer);
  Status Close();

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  OutputFile(std::string path, std::FILE* file) : path_(std::move(path)), file_(file) {}
  Status Failure() const;

  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
};

// Files that appear together or not at all: each is written under another name, and Commit renames them. What is not
// committed is deleted. Between the renames of several files a reader can see some of them.
class FileGroup {
 public:
  FileGroup() = default;
  FileGroup(const FileGroup&) = delete;
  FileGroup& operator=(const FileGroup&) = delete;
  ~FileGroup();

  // A new file of the group, which is to become `path`; the caller closes it before Commit.
  Result<OutputFile> Create(const std::string& path);
  Status Commit();

 private:
  std::vector<std::string> paths_;
};

// Replaces a whole file: a reader sees the old one or the new one.
Status WriteFileAtomically(const std::string& path, std::string_view text);
// Replaces the content of a file that is there, in its own blocks: for a full disk, where nothing new can be made.
Status OverwriteFile(const std::string& path, std::string_view text);
Result<std::string> ReadFile(const std::string& path);

// A file line by line, without its line ends (\n or \r\n).
class LineReader {
 public:
  static Result<LineReader> Open(const std::string& path);

  // False at the end.
  bool Next(std::string_view* line);
  // Of the line that Next gave: its number from 1, and whether a line end followed it.
  std::int64_t number() const { return number_; }
  bool ended() const { return ended_; }
  const std::string& path() const { return path_; }
  Status Error(const std::string& what) const { return {ErrorCode::kUnreadable, At(path_, number_) + ": " + what}; }

 private:
  LineReader(std::string path, std::ifstream stream) : path_(std::move(path)), stream_(std::move(stream)) {}

  std::string path_;
  std::ifstream stream_;
  std::string line_;
  std::int64_t number_ = 0;
  bool ended_ = true;
};

// The fields between separators. With ' ', runs of blanks and tabs count as one and those at the ends as none.
std::vector<std::string_view> Split(std::string_view text, char separator);
// The words between blanks, line ends, commas, semicolons and brackets, any number of them.
std::vector<std::string_view> Words(std::string_view text);
// All words of "1, 2.5;-3" as finite numbers; nothing where one of them is not.
std::optional<std::vector<double>> ParseNumbers(std::string_view text);
// Finite numbers only.
bool ParseFinite(std::string_view text, double* value);
bool ParseInt64(std::string_view text, std::int64_t* value);
bool ParseUint64(std::string_view text, std::uint64_t* value);

}  // namespace pliant
