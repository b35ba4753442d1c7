// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "image/image_size.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <istream>
#include <limits>
#include <sstream>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

// The first bytes of a file, or of a part of it; those beyond its end are 0.
class Head {
 public:
  Head(std::istream* file, std::streamoff at, std::size_t size) : bytes_(size) {
    file->clear();
    file->seekg(at);
    file->read(reinterpret_cast<char*>(bytes_.data()), static_cast<std::streamsize>(size));
    whole_ = file->gcount() == static_cast<std::streamsize>(size);
  }

  bool whole() const { return whole_; }
  unsigned char operator[](std::size_t at) const { return bytes_[at]; }
  bool StartsWith(std::string_view text) const { return Has(text, 0); }
  bool Has(std::string_view text, std::size_t at) const {
    return at + text.size() <= bytes_.size() &&
           std::equal(text.begin(), text.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(at),
                      [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; });
  }
  int BigEndian16(std::size_t at) const { return bytes_[at] << 8 | bytes_[at + 1]; }
  std::uint32_t BigEndian32(std::size_t at) const {
    return static_cast<std::uint32_t>(BigEndian16(at)) << 16 | static_cast<std::uint32_t>(BigEndian16(at + 2));
  }
  std::uint64_t LittleEndian(std::size_t at, std::size_t count) const {
    std::uint64_t value = 0;
    for (std::size_t i = count; i-- > 0;) value = value << 8 | bytes_[at + i];
    return value;
  }
  std::int32_t LittleEndian32(std::size_t at) const { return static_cast<std::int32_t>(LittleEndian(at, 4)); }
  std::string Text() const { return {bytes_.begin(), bytes_.end()}; }

 private:
  std::vector<unsigned char> bytes_;
  bool whole_ = false;
};

// In the first segment that begins a frame: SOF0 to SOF15, but for the three markers among them that hold tables.
std::optional<cv::Size> JpegSize(std::istream* file) {
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

// No side that OpenCV decodes is larger.
cv::Size SizeOf(std::uint64_t width, std::uint64_t height) {
  constexpr std::uint64_t kMost = std::numeric_limits<int>::max();
  return {static_cast<int>(std::min(width, kMost)), static_cast<int>(std::min(height, kMost))};
}

// Of the first directory, whose entries 256 and 257 are the sides. BigTIFF has numbers of 8 bytes.
std::optional<cv::Size> TiffSize(std::istream* file, const Head& head) {
  const bool little = head[0] == 'I';
  const bool big_tiff = head[little ? 2 : 3] == 43;
  const auto number = [&](const Head& bytes, std::size_t at, std::size_t count) {
    if (little) return bytes.LittleEndian(at, count);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value = value << 8 | bytes[at + i];
    return value;
  };
  const std::size_t offset_bytes = big_tiff ? 8 : 4;
  const std::size_t count_bytes = big_tiff ? 8 : 2;
  const std::size_t entry_bytes = big_tiff ? 20 : 12;
  const std::uint64_t at = number(head, big_tiff ? 8 : 4, offset_bytes);
  if (at > std::numeric_limits<std::int64_t>::max() / 2) return std::nullopt;
  const std::uint64_t entries =
      std::min<std::uint64_t>(number(Head(file, static_cast<std::streamoff>(at), count_bytes), 0, count_bytes), 0xFFFF);
  const Head directory(file, static_cast<std::streamoff>(at + count_bytes), entries * entry_bytes);
  std::uint64_t sides[2] = {0, 0};
  for (std::uint64_t i = 0; i < entries; ++i) {
    const std::size_t entry = i * entry_bytes;
    const std::uint64_t tag = number(directory, entry, 2);
    if (tag != 256 && tag != 257) continue;
    const std::uint64_t type = number(directory, entry + 2, 2);
    const std::size_t bytes = type == 3 ? 2 : type == 16 ? 8 : 4;
    if (bytes <= offset_bytes) sides[tag - 256] = number(directory, entry + entry_bytes - offset_bytes, bytes);
  }
  return SizeOf(sides[0], sides[1]);
}

// The attribute dataWindow, a box of four integers, both ends included. Attributes are: name, type, both ended by a 0,
// number of bytes, bytes.
std::optional<cv::Size> ExrSize(std::istream* file) {
  constexpr std::size_t kHead = 1 << 16;
  const Head head(file, 0, kHead);
  const std::string text = head.Text();
  constexpr std::string_view kWindow{"dataWindow\0box2i\0", 17};
  const std::size_t found = text.find(kWindow);
  if (found == std::string::npos || found + kWindow.size() + 20 > text.size()) return std::nullopt;
  const std::size_t at = found + kWindow.size() + 4;
  const auto side = [&](std::size_t low) {
    const std::int64_t length = std::int64_t{head.LittleEndian32(low + 8)} - head.LittleEndian32(low) + 1;
    return static_cast<std::uint64_t>(std::max<std::int64_t>(0, length));
  };
  return SizeOf(side(at), side(at + 4));
}

// The canvas of an extended file, or the size of the one image: lossy, lossless.
std::optional<cv::Size> WebpSize(const Head& head) {
  if (head.Has("VP8X", 12)) return SizeOf(head.LittleEndian(24, 3) + 1, head.LittleEndian(27, 3) + 1);
  if (head.Has("VP8 ", 12)) return SizeOf(head.LittleEndian(26, 2) & 0x3FFF, head.LittleEndian(28, 2) & 0x3FFF);
  if (!head.Has("VP8L", 12)) return std::nullopt;
  const std::uint64_t sides = head.LittleEndian(21, 4);
  return SizeOf((sides & 0x3FFF) + 1, ((sides >> 14) & 0x3FFF) + 1);
}

// Of the code stream, which is all of the file or its box jp2c: behind its first marker and the second one with its
// length and capabilities the ends and, eight bytes on, the beginnings of the image.
std::optional<cv::Size> Jpeg2000Size(std::istream* file, bool in_boxes) {
  std::streamoff at = 0;
  for (int box = 0; in_boxes; ++box) {
    constexpr int kMaxBoxes = 100;
    const Head head(file, at, 8);
    if (!head.whole() || box == kMaxBoxes) return std::nullopt;
    const bool is_long = head.BigEndian32(0) == 1;
    if (head.Has("jp2c", 4)) {
      at += is_long ? 16 : 8;
      break;
    }
    if (is_long || head.BigEndian32(0) < 8) return std::nullopt;
    at += head.BigEndian32(0);
  }
  const Head head(file, at, 24);
  if (!head.whole() || !head.StartsWith("\xFF\x4F\xFF\x51")) return std::nullopt;
  const auto side = [&](std::size_t end) {
    return std::uint64_t{head.BigEndian32(end)} - std::min(head.BigEndian32(end), head.BigEndian32(end + 8));
  };
  return SizeOf(side(8), side(12));
}

// Words of a text head; # begins a comment.
class Words {
 public:
  Words(std::istream* file, std::streamoff at) : stream_(Head(file, at, 4096).Text()) {}

  std::string Next() {
    std::string word;
    while (stream_ >> word && word.front() == '#') stream_.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    return stream_ ? word : "";
  }
  std::uint64_t NextNumber() {
    std::int64_t number = 0;
    return ParseInt64(Next(), &number) && number > 0 ? static_cast<std::uint64_t>(number) : 0;
  }
  // Of the number that follows the word.
  std::uint64_t NumberAfter(std::string_view name) {
    for (std::string word = Next(); !word.empty(); word = Next())
      if (word == name) return NextNumber();
    return 0;
  }

 private:
  std::istringstream stream_;
};

std::optional<cv::Size> TextHeadSize(std::istream* file, const Head& head) {
  if (head.StartsWith("P7")) {
    Words words(file, 2);
    const std::uint64_t width = words.NumberAfter("WIDTH");
    return SizeOf(width, Words(file, 2).NumberAfter("HEIGHT"));
  }
  if (head[0] == 'P' && std::string_view("123456Ff").find(static_cast<char>(head[1])) != std::string_view::npos) {
    Words words(file, 2);
    const std::uint64_t width = words.NextNumber();
    return SizeOf(width, words.NextNumber());
  }
  if (!head.StartsWith("#?RADIANCE") && !head.StartsWith("#?RGBE")) return std::nullopt;
  Words words(file, 0);
  const std::uint64_t height = words.NumberAfter("-Y");
  return SizeOf(words.NumberAfter("+X"), height);
}

// What is in memory, as a stream.
class MemoryBuffer final : public std::streambuf {
 public:
  explicit MemoryBuffer(std::span<const unsigned char> bytes) {
    char* begin = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));  // it is only read
    setg(begin, begin, begin + bytes.size());
  }

 protected:
  pos_type seekpos(pos_type position, std::ios_base::openmode /*mode*/) override {
    const std::streamoff at = position;
    if (at < 0 || at > egptr() - eback()) return {-1};
    setg(eback(), eback() + at, egptr());
    return position;
  }
};

std::optional<cv::Size> SizeIn(std::istream* file) {
  constexpr std::size_t kShortestHead = 20;
  if (!Head(file, 0, kShortestHead).whole()) return std::nullopt;
  const Head head(file, 0, 32);
  if (head.StartsWith("\xFF\xD8")) return JpegSize(file);
  if (head.StartsWith("\x89PNG\r\n\x1a\n")) return SizeOf(head.BigEndian32(16), head.BigEndian32(20));
  if (head.StartsWith("BM") && Head(file, 0, 26).whole()) {
    constexpr int kShortHead = 12;
    if (head.LittleEndian32(14) == kShortHead) return SizeOf(head.LittleEndian(18, 2), head.LittleEndian(20, 2));
    return SizeOf(head.LittleEndian(18, 4),
                  static_cast<std::uint64_t>(std::abs(std::int64_t{head.LittleEndian32(22)})));  // negative: top down
  }
  if (head.StartsWith(std::string_view("II*\0", 4)) || head.StartsWith(std::string_view("MM\0*", 4)) ||
      head.StartsWith(std::string_view("II+\0", 4)) || head.StartsWith(std::string_view("MM\0+", 4)))
    return TiffSize(file, head);
  if (head.StartsWith("\x76\x2f\x31\x01")) return ExrSize(file);
  if (head.StartsWith("RIFF") && head.Has("WEBP", 8)) return WebpSize(head);
  if (head.StartsWith(std::string_view("\0\0\0\x0CjP  ", 8))) return Jpeg2000Size(file, true);
  if (head.StartsWith("\xFF\x4F\xFF\x51")) return Jpeg2000Size(file, false);
  if (head.StartsWith("\x59\xA6\x6A\x95")) return SizeOf(head.BigEndian32(4), head.BigEndian32(8));
  return TextHeadSize(file, head);
}

}  // namespace

std::optional<cv::Size> ReadImageSize(const std::filesystem::path& path) {
  if (!CheckIsFile(path.string()).ok()) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return SizeIn(&file);
}

std::optional<cv::Size> ImageSizeOf(std::span<const unsigned char> file) {
  MemoryBuffer buffer(file);
  std::istream stream(&buffer);
  return SizeIn(&stream);
}

Status CheckPixels(const cv::Size& size, const std::string& what) {
  const double megapixels = 1e-6 * size.width * size.height;
  if (megapixels > 0 && megapixels <= kMaxImageMegapixels) return Status::Ok();
  const std::string text = what + " has " + std::to_string(size.width) + "x" + std::to_string(size.height) + " pixels";
  if (megapixels <= 0) return {ErrorCode::kUnreadable, text + "; it is damaged, copy or export it again"};
  return {ErrorCode::kUnreadable, text + ", more than 50 million; scale it down"};
}

}  // namespace pliant
