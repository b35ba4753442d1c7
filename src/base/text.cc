// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "pliant/base/options.h"

namespace pliant {
namespace {

constexpr std::size_t kLargeBuffer = 1 << 20;

// The name under which a file is written before it is renamed.
std::string Beside(const std::string& path) { return path + ".tmp"; }

template <class Integer>
bool ParseWhole(std::string_view text, Integer* value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *value);
  return error == std::errc() && end == text.data() + text.size();
}

std::string Reason(int error) { return std::generic_category().message(error); }

}  // namespace

std::string Seconds(double seconds) { return FormatDouble(std::round(1e6 * seconds) / 1e6) + " s"; }

bool Exists(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

std::string At(const std::string& path, std::int64_t line) { return path + ":" + std::to_string(line); }

void AppendInt(std::string* out, std::int64_t value) {
  std::array<char, 24> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  out->append(buffer.data(), end);
}

void AppendFixed(std::string* out, double value, int decimals) {
  static constexpr std::array<std::int64_t, 10> kPowers = {1,      10,      100,      1000,      10000,
                                                           100000, 1000000, 10000000, 100000000, 1000000000};
  const std::int64_t power = kPowers[static_cast<std::size_t>(decimals)];
  const double scaled = value * static_cast<double>(power);
  if (!(std::abs(scaled) < 9e15)) {  // beyond the integers that a double holds
    std::array<char, 400> buffer;
    const auto [end, error] =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, decimals);
    out->append(buffer.data(), end);
    return;
  }
  const std::int64_t rounded = std::llround(scaled);
  const std::int64_t magnitude = std::abs(rounded);
  if (rounded < 0) out->push_back('-');
  AppendInt(out, magnitude / power);
  if (decimals == 0) return;
  std::array<char, 10> digits;
  std::int64_t rest = magnitude % power;
  for (int i = decimals; i > 0; --i, rest /= 10)
    digits[static_cast<std::size_t>(i)] = static_cast<char>('0' + rest % 10);
  digits[0] = '.';
  out->append(digits.data(), static_cast<std::size_t>(decimals) + 1);
}

void AppendExact(std::string* out, double value) {
  std::array<char, 40> buffer;
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, 17);
  out->append(buffer.data(), end);
}

void AppendBytes(std::string* out, std::uint64_t value, int num_bytes) {
  for (int i = 0; i < num_bytes; ++i) out->push_back(static_cast<char>((value >> (8 * i)) & 0xff));
}

void AppendDouble(std::string* out, double value) { AppendBytes(out, std::bit_cast<std::uint64_t>(value), 8); }

void AppendFloat(std::string* out, float value) { AppendBytes(out, std::bit_cast<std::uint32_t>(value), 4); }

Result<OutputFile> OutputFile::Create(const std::string& path) {
  errno = 0;
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr)
    return Status(ErrorCode::kUnwritable, "cannot write " + Quoted(path) + ": " + Reason(errno) +
                                              "; choose another path or change its permissions");
  std::setvbuf(file, nullptr, _IONBF, 0);
  return OutputFile(path, file);
}

Status OutputFile::Failure() const {
  return {ErrorCode::kUnwritable,
          "cannot write " + Quoted(path_) + ": " + Reason(errno) + "; what was written before stays"};
}

Status OutputFile::Append(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) return Failure();
  return Status::Ok();
}

Status OutputFile::AppendWhenLarge(std::string* buffer) {
  if (buffer->size() < kLargeBuffer) return Status::Ok();
  Status status = Append(*buffer);
  buffer->clear();
  return status;
}

Status OutputFile::Close() {
  errno = 0;
  if (std::fclose(file_.release()) != 0) return Failure();
  return Status::Ok();
}

FileGroup::~FileGroup() {
  std::error_code error;
  for (const std::string& path : paths_) std::filesystem::remove(Beside(path), error);
}

Result<OutputFile> FileGroup::Create(const std::string& path) {
  auto file = OutputFile::Create(Beside(path));
  if (file.ok()) paths_.push_back(path);
  return file;
}

Status FileGroup::Commit() {
  while (!paths_.empty()) {
    std::error_code error;
    std::filesystem::rename(Beside(paths_.front()), paths_.front(), error);
    if (error) return {ErrorCode::kUnwritable, "cannot write " + Quoted(paths_.front()) + ": " + error.message()};
    paths_.erase(paths_.begin());
  }
  return Status::Ok();
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
  auto reader = LineReader::Open(path);  // checks that it is there and a file
  if (!reader.ok()) return reader.status();
  std::ifstream stream(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (stream.bad()) return Status(ErrorCode::kUnreadable, "cannot read " + Quoted(path) + " to its end");
  return text;
}

Result<LineReader> LineReader::Open(const std::string& path) {
  std::error_code error;
  const auto kind = std::filesystem::status(path, error);
  if (!std::filesystem::exists(kind))
    return Status(ErrorCode::kNotFound, "there is no file " + Quoted(path) + "; check the path");
  if (std::filesystem::is_directory(kind))
    return Status(ErrorCode::kUnreadable, Quoted(path) + " is a folder; give a file in it");
  if (!std::filesystem::is_regular_file(kind))  // which may be endless
    return Status(ErrorCode::kUnreadable, Quoted(path) + " is a pipe or a device; give a file");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return Status(ErrorCode::kUnreadable, "cannot read " + Quoted(path) + "; check its permissions");
  return LineReader(path, std::move(stream));
}

bool LineReader::Next(std::string_view* line) {
  if (!std::getline(stream_, line_)) return false;
  ++number_;
  ended_ = !stream_.eof();
  *line = line_;
  if (line->ends_with('\r')) line->remove_suffix(1);
  return true;
}

std::vector<std::string_view> Split(std::string_view text, char separator) {
  const std::string_view separators = separator == ' ' ? " \t" : std::string_view(&separator, 1);
  std::vector<std::string_view> fields;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    if (separator != ' ' || end > begin) fields.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

std::vector<std::string_view> Words(std::string_view text) {
  constexpr std::string_view kSeparators = " \t\r\n,;[]";
  std::vector<std::string_view> words;
  std::size_t end = 0;
  while (true) {
    const std::size_t begin = text.find_first_not_of(kSeparators, end);
    if (begin == std::string_view::npos) return words;
    end = std::min(text.find_first_of(kSeparators, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
  }
}

std::optional<std::vector<double>> ParseNumbers(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string_view word : Words(text))
    if (!ParseFinite(word, &numbers.emplace_back())) return std::nullopt;
  return numbers;
}

bool ParseFinite(std::string_view text, double* value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return ParseDouble(text, value) && std::isfinite(*value);
}

bool ParseInt64(std::string_view text, std::int64_t* value) { return ParseWhole(text, value); }

bool ParseUint64(std::string_view text, std::uint64_t* value) { return ParseWhole(text, value); }

}  // namespace pliant
