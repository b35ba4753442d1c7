// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/image_size.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <vector>

namespace pliant {
namespace {

// The first bytes of a file, or of a part of it; those beyond its end are 0.
class Head {
 public:
  Head(std::ifstream* file, std::streamoff at, std::size_t size) : bytes_(size) {
    file->clear();
    file->seekg(at);
    file->read(reinterpret_cast<char*>(bytes_.data()), static_cast<std::streamsize>(size));
    whole_ = file->gcount() == static_cast<std::streamsize>(size);
  }

  bool whole() const { return whole_; }
  unsigned char operator[](std::size_t at) const { return bytes_[at]; }
  bool StartsWith(std::string_view text) const {
    return std::equal(text.begin(), text.end(), bytes_.begin(),
                      [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; });
  }
  int BigEndian16(std::size_t at) const { return bytes_[at] << 8 | bytes_[at + 1]; }
  std::uint32_t BigEndian32(std::size_t at) const {
    return static_cast<std::uint32_t>(BigEndian16(at)) << 16 | static_cast<std::uint32_t>(BigEndian16(at + 2));
  }
  std::int32_t LittleEndian32(std::size_t at) const {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | bytes_[at + i];
    return static_cast<std::int32_t>(value);
  }

 private:
  std::vector<unsigned char> bytes_;
  bool whole_ = false;
};

// In the first segment that begins a frame: SOF0 to SOF15, but for the three markers among them that hold tables.
std::optional<cv::Size> JpegSize(std::ifstream* file) {
  constexpr int kFillByte = 0xFF;
  constexpr int kStartOfScan = 0xDA;
  for (std::streamoff at = 2;;) {
    const Head segment(file, at, 9);
    const int marker = segment[1];
    if (!segment.whole() || segment[0] != 0xFF || marker == kStartOfScan) return std::nullopt;
    if (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC)
      return cv::Size(segment.BigEndian16(7), segment.BigEndian16(5));
    at += marker == kFillByte ? 1 : 2 + segment.BigEndian16(2);
  }
}

}  // namespace

std::optional<cv::Size> ReadImageSize(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const Head head(&file, 0, 26);
  if (!head.whole()) return std::nullopt;
  if (head.StartsWith("\xFF\xD8")) return JpegSize(&file);
  if (head.StartsWith("\x89PNG\r\n\x1a\n"))
    return cv::Size(static_cast<int>(head.BigEndian32(16)), static_cast<int>(head.BigEndian32(20)));
  if (head.StartsWith("BM")) return cv::Size(head.LittleEndian32(18), std::abs(head.LittleEndian32(22)));
  return std::nullopt;
}

}  // namespace pliant
