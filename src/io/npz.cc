// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The zip files that np.savez and np.savez_compressed write. Reference: PKWARE, APPNOTE.TXT 6.3.

#include <cstdint>
#include <cstring>
#include <optional>

#include <zlib.h>

#include "io/npy.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr std::uint32_t kLocalMagic = 0x04034b50;
constexpr std::uint32_t kCentralMagic = 0x02014b50;
constexpr std::uint32_t kEndMagic = 0x06054b50;
constexpr std::size_t kLocalSize = 30;
constexpr std::size_t kCentralSize = 46;
constexpr std::size_t kEndSize = 22;
constexpr std::size_t kMaxComment = 65535;
constexpr int kStored = 0;
constexpr int kDeflated = 8;
constexpr std::uint32_t kInZip64 = 0xffffffff;  // instead of a number that needs 8 bytes
// What is larger than this is not unpacked where it is so many times smaller in the file.
constexpr std::size_t kMaxPacked = std::size_t{64} << 20;
constexpr std::size_t kMaxUsualRatio = 50;
constexpr std::size_t kMaxRatio = 1032;  // of what deflate can make of a byte
constexpr std::uint32_t kDate = 0x21;    // 1980-01-01, the first that there is
constexpr std::string_view kNpyEnding = ".npy";

std::uint32_t Unsigned(std::string_view bytes, std::size_t offset, std::size_t width) {
  std::uint32_t value = 0;
  for (std::size_t k = width; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[offset + k]);
  return value;
}

// The part of the file that begins at `offset`; nothing where it would reach beyond the end.
std::optional<std::string_view> Part(std::string_view bytes, std::size_t offset, std::size_t size) {
  if (offset > bytes.size() || bytes.size() - offset < size) return std::nullopt;
  return bytes.substr(offset, size);
}

// Where the record of the end begins, which a comment may follow.
std::optional<std::size_t> FindEnd(std::string_view bytes) {
  if (bytes.size() < kEndSize) return std::nullopt;
  for (std::size_t comment = 0; comment <= kMaxComment && comment + kEndSize <= bytes.size(); ++comment) {
    const std::size_t at = bytes.size() - kEndSize - comment;
    if (Unsigned(bytes, at, 4) == kEndMagic && Unsigned(bytes, at + 20, 2) == comment) return at;
  }
  return std::nullopt;
}

struct ZipEntry {
  std::string name;
  std::uint32_t flags = 0;
  std::uint32_t method = 0;
  std::uint32_t crc = 0;
  std::uint32_t packed_size = 0;
  std::uint32_t size = 0;
  std::uint32_t offset = 0;  // of its local header
};

// The entry of the central directory at `*at`, which is moved behind it; nothing where it is cut off.
std::optional<ZipEntry> NextEntry(std::string_view bytes, std::size_t* at) {
  const auto fixed = Part(bytes, *at, kCentralSize);
  if (!fixed || Unsigned(*fixed, 0, 4) != kCentralMagic) return std::nullopt;
  ZipEntry entry;
  entry.flags = Unsigned(*fixed, 8, 2);
  entry.method = Unsigned(*fixed, 10, 2);
  entry.crc = Unsigned(*fixed, 16, 4);
  entry.packed_size = Unsigned(*fixed, 20, 4);
  entry.size = Unsigned(*fixed, 24, 4);
  entry.offset = Unsigned(*fixed, 42, 4);
  const std::size_t name_size = Unsigned(*fixed, 28, 2);
  const auto name = Part(bytes, *at + kCentralSize, name_size);
  if (!name) return std::nullopt;
  entry.name = *name;
  *at += kCentralSize + name_size + Unsigned(*fixed, 30, 2) + Unsigned(*fixed, 32, 2);
  return entry;
}

bool Inflate(std::string_view packed, std::string* out) {
  z_stream stream = {};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return false;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // zlib does not write to it
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(out->data());
  stream.avail_out = static_cast<uInt>(out->size());
  const int code = inflate(&stream, Z_FINISH);
  const bool whole = code == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  return whole;
}

std::uint32_t Crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// Empty: `out` is its content; else what is wrong with it.
std::string Unpack(std::string_view bytes, const ZipEntry& entry, std::string* out) {
  if (entry.flags & 1) return "is encrypted; save it with np.savez";
  if (entry.packed_size == kInZip64 || entry.size == kInZip64 || entry.offset == kInZip64)
    return "is larger than 4 GB; cut it into parts";
  const auto local = Part(bytes, entry.offset, kLocalSize);
  if (!local || Unsigned(*local, 0, 4) != kLocalMagic) return "is cut off or damaged";
  const std::size_t begin = entry.offset + kLocalSize + Unsigned(*local, 26, 2) + Unsigned(*local, 28, 2);
  const auto packed = Part(bytes, begin, entry.packed_size);
  if (!packed) return "is cut off";
  if (entry.method == kStored) {
    *out = *packed;
  } else if (entry.method == kDeflated) {
    if (entry.size > kMaxRatio * (packed->size() + 1)) return "is damaged";
    if (entry.size > kMaxPacked && entry.size > kMaxUsualRatio * packed->size())
      return "has " + std::to_string(entry.size >> 20) + " MB in " + std::to_string(packed->size() >> 10) +
             " kB, as no track has; save it with np.savez, or cut it into parts";
    out->resize(entry.size);
    if (!Inflate(*packed, out)) return "is damaged";
  } else {
    return "is compressed by method " + std::to_string(entry.method) + "; save it with np.savez";
  }
  if (out->size() != entry.size || Crc(*out) != entry.crc) return "is damaged: its checksum does not fit";
  return {};
}

// The .npy files in the central directory by their names without .npy.
Result<std::map<std::string, ZipEntry>> ArchiveEntries(const std::string& path, std::string_view bytes) {
  const auto cut_off = [&] {
    return Status(ErrorCode::kUnreadable, path + " is a zip file that is cut off; copy it again");
  };
  const auto end = FindEnd(bytes);
  if (!end) return cut_off();
  const std::uint32_t count = Unsigned(bytes, *end + 10, 2);
  std::size_t at = Unsigned(bytes, *end + 16, 4);
  std::map<std::string, ZipEntry> entries;
  for (std::uint32_t k = 0; k < count; ++k) {
    auto entry = NextEntry(bytes, &at);
    if (!entry) return cut_off();
    if (!entry->name.ends_with(kNpyEnding)) continue;
    const std::string name = entry->name.substr(0, entry->name.size() - kNpyEnding.size());
    entries[name] = *std::move(entry);
  }
  return entries;
}

// What the local and the central header of an entry share, from the version on.
void AppendCommon(const std::string& name, std::string_view content, std::string* out) {
  AppendBytes(out, 20, 2);  // the version that is needed to read it: 2.0
  AppendBytes(out, 0, 2);
  AppendBytes(out, kStored, 2);
  AppendBytes(out, 0, 2);
  AppendBytes(out, kDate, 2);
  AppendBytes(out, Crc(content), 4);
  AppendBytes(out, content.size(), 4);
  AppendBytes(out, content.size(), 4);
  AppendBytes(out, name.size(), 2);
  AppendBytes(out, 0, 2);
}

}  // namespace

bool IsZip(std::string_view bytes) { return bytes.starts_with("PK\x03\x04") || bytes.starts_with("PK\x05\x06"); }

Result<std::set<std::string>> NpzNames(const std::string& path, std::string_view bytes) {
  const auto entries = ArchiveEntries(path, bytes);
  if (!entries.ok()) return entries.status();
  std::set<std::string> names;
  for (const auto& [name, entry] : *entries) names.insert(name);
  return names;
}

Result<std::map<std::string, std::string>> ParseNpz(const std::string& path, std::string_view bytes,
                                                    std::span<const std::string_view> names) {
  const auto entries = ArchiveEntries(path, bytes);
  if (!entries.ok()) return entries.status();
  std::map<std::string, std::string> files;
  for (const std::string_view name : names) {
    const auto entry = entries->find(std::string(name));
    if (entry == entries->end()) continue;
    std::string content;
    if (const std::string wrong = Unpack(bytes, entry->second, &content); !wrong.empty())
      return Status(ErrorCode::kUnreadable, "the array " + Quoted(entry->second.name) + " in " + path + " " + wrong);
    files[entry->first] = std::move(content);
  }
  return files;
}

std::string NpzBytes(const std::map<std::string, std::string>& npy_files) {
  std::string bytes;
  std::string central;
  for (const auto& [array, content] : npy_files) {
    const std::string name = array + std::string(kNpyEnding);
    const std::size_t offset = bytes.size();
    if (offset + content.size() >= kInZip64 - kMaxComment) return {};
    AppendBytes(&bytes, kLocalMagic, 4);
    AppendCommon(name, content, &bytes);
    bytes += name;
    bytes += content;
    AppendBytes(&central, kCentralMagic, 4);
    AppendBytes(&central, 20, 2);
    AppendCommon(name, content, &central);
    for (const int width : {2, 2, 2, 4}) AppendBytes(&central, 0, width);  // comment, disk, attributes
    AppendBytes(&central, offset, 4);
    central += name;
  }
  const std::size_t offset = bytes.size();
  bytes += central;
  AppendBytes(&bytes, kEndMagic, 4);
  AppendBytes(&bytes, 0, 4);
  AppendBytes(&bytes, npy_files.size(), 2);
  AppendBytes(&bytes, npy_files.size(), 2);
  AppendBytes(&bytes, central.size(), 4);
  AppendBytes(&bytes, offset, 4);
  AppendBytes(&bytes, 0, 2);
  return bytes;
}

}  // namespace pliant
