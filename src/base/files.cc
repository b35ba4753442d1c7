// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/files.h"

#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace pliant {
namespace {

constexpr std::size_t kLargeBuffer = 1 << 20;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // of programs for Windows, before the first line

// The name under which a file is written before it is renamed.
std::string Beside(const std::string& path) { return path + ".tmp"; }

// The second name of a file that one called `name` replaces, until all renames are done.
std::string Former(const std::string& name) { return name + ".former"; }

std::string Reason(int error) { return std::generic_category().message(error); }

// The file at the path for this one alone, empty, or -1 with a reason. Where another one renamed what was opened before
// it could be locked, the path is another file.
int OpenAlone(const std::string& path, int* reason) {
  constexpr int kAttempts = 100;
  *reason = EWOULDBLOCK;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) {
      *reason = errno;
      return -1;
    }
    const bool is_taken = flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    struct stat opened = {};
    struct stat named = {};
    const bool is_named = fstat(descriptor, &opened) == 0 && stat(path.c_str(), &named) == 0 &&
                          opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
    if (is_named && !is_taken && (opened.st_size == 0 || ftruncate(descriptor, 0) == 0)) return descriptor;
    *reason = is_taken ? EWOULDBLOCK : errno;
    close(descriptor);
    if (is_named) return -1;
  }
  return -1;
}

Status Unreadable(const std::string& path, int error) {
  return {ErrorCode::kUnreadable,
          "cannot read " + Quoted(path) + ": " + Reason(error) + "; check the file and its folder"};
}

Status CannotCreate(const std::string& path, int error) {
  return {ErrorCode::kUnwritable,
          "cannot write " + Quoted(path) + ": " + Reason(error) + "; choose another path or change its permissions"};
}

}  // namespace

bool Exists(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

Status CheckIsFile(const std::string& path) {
  std::error_code error;
  const auto kind = std::filesystem::status(path, error);
  if (!std::filesystem::exists(kind))
    return {ErrorCode::kNotFound, "there is no file " + Quoted(path) + "; check the path"};
  if (std::filesystem::is_directory(kind))
    return {ErrorCode::kUnreadable, Quoted(path) + " is a folder; give a file in it"};
  if (!std::filesystem::is_regular_file(kind))  // which may be endless
    return {ErrorCode::kUnreadable, Quoted(path) + " is a pipe or a device; give a file"};
  return Status::Ok();
}

Status Unwritable(const std::filesystem::path& path) {
  return {ErrorCode::kUnwritable,
          "cannot write " + path.string() + "; is the folder writable and is there room on the disk?"};
}

Result<OutputFile> OutputFile::Create(const std::string& path) {
  errno = 0;
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return CannotCreate(path, errno);
  std::setvbuf(file, nullptr, _IONBF, 0);
  return OutputFile(path, file);
}

FileLock::~FileLock() {
  if (descriptor_ < 0) return;
  flock(descriptor_, LOCK_UN);  // a child of this process may hold the descriptor open
  close(descriptor_);
}

Result<OutputFile> OutputFile::CreateAlone(const std::string& path, FileLock* lock) {
  int reason = 0;
  const int descriptor = OpenAlone(path, &reason);
  if (descriptor < 0 && reason == EWOULDBLOCK)
    return Status(ErrorCode::kUnwritable,
                  Quoted(path) + " is being written by another program; wait for its end, or choose another path");
  if (descriptor < 0) return CannotCreate(path, reason);
  *lock = FileLock(fcntl(descriptor, F_DUPFD_CLOEXEC, 0));
  std::FILE* file = lock->IsHeld() ? fdopen(descriptor, "wb") : nullptr;
  if (file == nullptr) {
    reason = errno;
    unlink(path.c_str());
    close(descriptor);
    return CannotCreate(path, reason);
  }
  std::setvbuf(file, nullptr, _IONBF, 0);
  return OutputFile(path, file);
}

Result<OutputFile> OutputFile::Continue(const std::string& path, std::int64_t size) {
  std::error_code error;
  const auto there = std::filesystem::file_size(path, error);
  if (error || there < static_cast<std::uintmax_t>(size))
    return Status(ErrorCode::kUnreadable,
                  Quoted(path) + " is shorter than it was, or is not there; it cannot be continued");
  std::filesystem::resize_file(path, static_cast<std::uintmax_t>(size), error);
  errno = 0;
  std::FILE* file = error ? nullptr : std::fopen(path.c_str(), "ab");
  if (file == nullptr)
    return Status(ErrorCode::kUnwritable,
                  "cannot write " + Quoted(path) + ": " + (error ? error.message() : Reason(errno)));
  std::setvbuf(file, nullptr, _IONBF, 0);
  OutputFile continued(path, file);
  continued.size_ = size;
  return continued;
}

Status OutputFile::Failure() const {
  return {ErrorCode::kUnwritable,
          "cannot write " + Quoted(path_) + ": " + Reason(errno) + "; is there room on the disk?"};
}

Status OutputFile::Append(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) return Failure();
  size_ += static_cast<std::int64_t>(text.size());
  return Status::Ok();
}

Status OutputFile::AppendWhenLarge(std::string* buffer) {
  if (buffer->size() < kLargeBuffer) return Status::Ok();
  Status status = Append(*buffer);
  buffer->clear();
  return status;
}

Status OutputFile::Sync() {
  errno = 0;
  if (std::fflush(file_.get()) != 0 || fsync(fileno(file_.get())) != 0) return Failure();
  return Status::Ok();
}

Status OutputFile::Close() {
  errno = 0;
  if (std::fclose(file_.release()) != 0) return Failure();
  return Status::Ok();
}

Status RenameTogether(const std::vector<Renaming>& renamings) {
  std::error_code error;
  std::size_t done = 0;
  for (; done < renamings.size(); ++done) {
    const auto& [from, to] = renamings[done];
    // A second name for what is replaced. A file system without such names keeps no former file.
    std::error_code no_former;
    if (renamings.size() > 1) std::filesystem::create_hard_link(to, Former(from), no_former);
    std::filesystem::rename(from, to, error);
    if (error) break;
  }
  std::error_code ignored;
  if (!error) {
    if (renamings.size() > 1)
      for (const Renaming& renaming : renamings) std::filesystem::remove(Former(renaming.from), ignored);
    return Status::Ok();
  }
  std::filesystem::remove(Former(renamings[done].from), ignored);
  Status failure(ErrorCode::kUnwritable,
                 "cannot write " + Quoted(renamings[done].to) + ": " + error.message() + "; nothing was written");
  while (done-- > 0) {
    std::filesystem::rename(renamings[done].to, renamings[done].from, ignored);
    std::filesystem::rename(Former(renamings[done].from), renamings[done].to, ignored);
  }
  return failure;
}

FileGroup::~FileGroup() {
  std::error_code error;
  for (const std::string& path : paths_) std::filesystem::remove(Beside(path), error);
}

Result<OutputFile> FileGroup::Create(const std::string& path) {
  // A device or a pipe, such as /dev/stdout, is written into: to rename a file to its name would replace it.
  std::error_code error;
  const auto type = std::filesystem::status(path, error).type();
  if (type == std::filesystem::file_type::character || type == std::filesystem::file_type::fifo)
    return OutputFile::Create(path);
  // A link stays one: what it leads to is replaced.
  const bool is_link = std::filesystem::is_symlink(path, error);
  const std::string target = is_link ? std::filesystem::weakly_canonical(path, error).string() : path;
  if (error && is_link) return Unwritable(path);
  FileLock lock;
  auto file = OutputFile::CreateAlone(Beside(target), &lock);
  if (!file.ok()) return file;
  paths_.push_back(target);
  locks_.push_back(std::move(lock));
  return file;
}

Status FileGroup::Commit() {
  std::vector<Renaming> renamings;
  for (const std::string& path : paths_) renamings.push_back({Beside(path), path});
  Status status = RenameTogether(renamings);
  if (!status.ok()) return status;
  paths_.clear();
  locks_.clear();
  return status;
}

Status SyncFolder(const std::filesystem::path& folder) {
  errno = 0;
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  // A file system that cannot do this for a folder keeps its names by itself.
  const bool synced = descriptor >= 0 && (fsync(descriptor) == 0 || errno == EINVAL);
  const int reason = errno;
  if (descriptor >= 0) close(descriptor);
  if (synced) return Status::Ok();
  return {ErrorCode::kUnwritable, "cannot write into " + Quoted(folder.string()) + ": " + Reason(reason)};
}

Status WriteFileAtomically(const std::string& path, std::string_view text) {
  FileGroup group;
  auto file = group.Create(path);
  if (!file.ok()) return file.status();
  if (Status status = file->Append(text); !status.ok()) return status;
  if (Status status = file->Close(); !status.ok()) return status;
  return group.Commit();
}

Status OverwriteFile(const std::string& path, std::string_view text) {
  errno = 0;
  std::FILE* file = std::fopen(path.c_str(), "r+b");
  bool written = file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  if (file != nullptr) written = std::fclose(file) == 0 && written;
  std::error_code error;
  if (written) std::filesystem::resize_file(path, text.size(), error);
  if (written && !error) return Status::Ok();
  return {ErrorCode::kUnwritable, "cannot write " + Quoted(path) + ": " + Reason(errno)};
}

Result<std::string> ReadFile(const std::string& path) {
  if (Status status = CheckIsFile(path); !status.ok()) return status;
  errno = 0;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (file == nullptr) return Unreadable(path, errno);
  std::string text;
  std::size_t size = 0;
  do {
    text.resize(size + kLargeBuffer);
    size += std::fread(text.data() + size, 1, kLargeBuffer, file.get());
  } while (size == text.size());
  if (std::ferror(file.get()) != 0) return Unreadable(path, errno);
  text.resize(size);
  text.shrink_to_fit();
  return text;
}

Result<LineReader> LineReader::Open(const std::string& path) {
  if (Status status = CheckIsFile(path); !status.ok()) return status;
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return Unreadable(path, errno);
  return LineReader(path, std::move(stream));
}

Status LineReader::End() const {
  if (!stream_.bad()) return Status::Ok();
  return {ErrorCode::kUnreadable, "cannot read " + Quoted(path_) + " beyond line " + std::to_string(number_) +
                                      "; check the disk, or copy the file again"};
}

bool LineReader::Next(std::string_view* line) {
  if (!std::getline(stream_, line_)) return false;
  ++number_;
  ended_ = !stream_.eof();
  *line = line_;
  if (number_ == 1 && line->starts_with(kByteOrderMark)) line->remove_prefix(kByteOrderMark.size());
  if (line->ends_with('\r')) line->remove_suffix(1);
  return true;
}

}  // namespace pliant
