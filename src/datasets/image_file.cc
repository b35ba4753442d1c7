// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/image_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <zlib.h>

#include "image/image_size.h"
#include "pliant/base/files.h"

namespace pliant {
namespace {

using Bytes = std::vector<unsigned char>;

Result<Bytes> ReadBytes(const std::filesystem::path& path) {
  if (Status status = CheckIsFile(path.string()); !status.ok()) return status;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return Status(ErrorCode::kUnreadable, "cannot open " + path.string() + "; check its permissions");
  Bytes bytes(static_cast<std::size_t>(file.tellg()));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file) return Status(ErrorCode::kUnreadable, "cannot read " + path.string() + " to its end; copy it again");
  return bytes;
}

bool StartsWith(const Bytes& bytes, std::string_view head) {
  return bytes.size() >= head.size() &&
         std::equal(head.begin(), head.end(), bytes.begin(),
                    [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; });
}

enum class Wholeness { kWhole, kTruncated, kDamaged };

// Every chunk is length (4, big-endian), type (4), data, checksum of type and data (4); the last one is IEND.
Wholeness PngWholeness(const Bytes& bytes) {
  const auto number = [&bytes](std::size_t at) {
    return (std::uint32_t{bytes[at]} << 24) | (std::uint32_t{bytes[at + 1]} << 16) |
           (std::uint32_t{bytes[at + 2]} << 8) | std::uint32_t{bytes[at + 3]};
  };
  std::size_t at = 8;
  while (at + 12 <= bytes.size()) {
    const std::size_t length = number(at);
    if (length > bytes.size() - at - 12) return Wholeness::kTruncated;
    const std::span<const unsigned char> checked(&bytes[at + 4], 4 + length);
    if (crc32_z(0, checked.data(), checked.size()) != number(at + 8 + length)) return Wholeness::kDamaged;
    constexpr std::string_view kEnd = "IEND";
    if (std::equal(kEnd.begin(), kEnd.end(), checked.begin())) return Wholeness::kWhole;
    at += 12 + length;
  }
  return Wholeness::kTruncated;
}

// Segments with a length come first (a thumbnail with its own end marker hides inside one); after the start of scan
// the end marker FF D9 cannot occur in the data, where FF is always followed by 00 or a restart marker.
bool JpegIsWhole(const Bytes& bytes) {
  constexpr std::array<unsigned char, 2> kEndOfImage = {0xFF, 0xD9};
  constexpr unsigned char kStartOfScan = 0xDA;
  std::size_t at = 2;
  while (at + 4 <= bytes.size() && bytes[at] == 0xFF) {
    if (bytes[at + 1] == 0xFF) {  // a fill byte
      ++at;
      continue;
    }
    if (bytes[at + 1] == kStartOfScan)
      return std::search(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(), kEndOfImage.begin(),
                         kEndOfImage.end()) != bytes.end();
    at += 2 + ((std::size_t{bytes[at + 2]} << 8) | std::size_t{bytes[at + 3]});
  }
  return false;
}

// The head says where the pixels begin and how large the image is; packed ones (compression not 0) have no fixed
// length.
bool BmpIsWhole(const Bytes& bytes) {
  if (bytes.size() < 54) return false;
  const auto number = [&bytes](std::size_t at, int count) {
    std::uint32_t value = 0;
    for (int i = count - 1; i >= 0; --i) value = (value << 8) | bytes[at + static_cast<std::size_t>(i)];
    return value;
  };
  if (number(30, 4) != 0) return true;
  const std::int64_t width = number(18, 4);
  const std::int64_t height = std::abs(std::int64_t{static_cast<std::int32_t>(number(22, 4))});  // negative: top down
  const std::int64_t row_bytes = (width * number(28, 2) + 31) / 32 * 4;
  const auto size = static_cast<std::int64_t>(bytes.size());
  return row_bytes <= size && number(10, 4) + row_bytes * height <= size;
}

bool IsPng(const Bytes& bytes) { return StartsWith(bytes, "\x89PNG\r\n\x1a\n"); }
bool IsBmp(const Bytes& bytes) { return StartsWith(bytes, "BM"); }
bool IsJpeg(const Bytes& bytes) { return StartsWith(bytes, "\xFF\xD8"); }

bool IsExr(const Bytes& bytes) { return StartsWith(bytes, "\x76\x2f\x31\x01"); }

struct DecodedImage {
  cv::Mat image;  // as stored: any depth, any number of channels
  bool lossy = false;
};

// `what` begins the sentence: "the image a.png".
Result<DecodedImage> Decode(const Bytes& bytes, const std::string& what) {
  const std::string advice = "; copy or export it again";
  if (bytes.empty()) return Status(ErrorCode::kUnreadable, what + " is empty" + advice);
  const Wholeness png = IsPng(bytes) ? PngWholeness(bytes) : Wholeness::kWhole;
  if (png == Wholeness::kDamaged)
    return Status(ErrorCode::kUnreadable, what + " is damaged: a checksum is wrong" + advice);
  if (png == Wholeness::kTruncated || (IsJpeg(bytes) && !JpegIsWhole(bytes)) || (IsBmp(bytes) && !BmpIsWhole(bytes)))
    return Status(ErrorCode::kUnreadable, what + " is truncated" + advice);
  if (const auto size = ImageSizeOf(bytes))
    if (Status status = CheckPixels(*size, what); !status.ok()) return status;
  DecodedImage decoded;
  try {
    decoded.image = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    decoded.image.release();
  }
  if (decoded.image.empty() && IsExr(bytes))
    return Status(ErrorCode::kUnreadable, what +
                                              " is an EXR that OpenCV cannot decode: it is damaged, or this OpenCV was "
                                              "built without OpenEXR (set OPENCV_IO_ENABLE_OPENEXR=1 where it is only "
                                              "switched off)");
  if (decoded.image.empty())
    return Status(ErrorCode::kUnreadable, what + " cannot be decoded (damaged, or not an image)" + advice);
  if (Status status = CheckPixels(decoded.image.size(), what); !status.ok()) return status;
  decoded.lossy = IsJpeg(bytes);
  return decoded;
}

Result<DecodedImage> Decode(const std::filesystem::path& path) {
  const Result<Bytes> bytes = ReadBytes(path);
  if (!bytes.ok()) return bytes.status();
  return Decode(*bytes, "the image " + path.string());
}

// Whether the last bytes have the end marker of a PNG or a JPEG; of other files they say nothing.
bool EndsAsAnImage(const std::filesystem::path& path) {
  constexpr std::streamoff kTail = 64;  // some programs write a little behind the marker
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file ? static_cast<std::streamoff>(file.tellg()) : 0;
  if (size <= kTail) return false;
  Bytes head(8);
  Bytes tail(static_cast<std::size_t>(kTail));
  file.seekg(0).read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
  file.seekg(size - kTail).read(reinterpret_cast<char*>(tail.data()), kTail);
  if (!file) return false;
  constexpr std::string_view kPngEnd = "IEND";
  constexpr std::array<unsigned char, 2> kJpegEnd = {0xFF, 0xD9};
  if (IsPng(head)) return std::search(tail.begin(), tail.end(), kPngEnd.begin(), kPngEnd.end()) != tail.end();
  if (IsJpeg(head)) return std::search(tail.begin(), tail.end(), kJpegEnd.begin(), kJpegEnd.end()) != tail.end();
  return true;
}

// Gray or BGR; what the fourth channel says is dropped.
cv::Mat WithoutAlpha(cv::Mat image) {
  if (image.channels() == 1 || image.channels() == 3) return image;
  cv::Mat result;
  if (image.channels() == 4)
    cv::cvtColor(image, result, cv::COLOR_BGRA2BGR);
  else
    cv::extractChannel(image, result, 0);
  return result;
}

Result<cv::Mat> WithEightBits(Result<DecodedImage> decoded, const std::string& what) {
  if (!decoded.ok()) return decoded.status();
  cv::Mat image = std::move(decoded->image);
  if (image.depth() == CV_8U) return WithoutAlpha(std::move(image));
  if (image.depth() != CV_16U)
    return Status(ErrorCode::kUnreadable, what + " is neither 8-bit nor 16-bit; export it as 8-bit PNG");
  cv::Mat result;
  image.convertTo(result, CV_8U, 1.0 / 257.0);
  image.release();  // there are not three of them at a time
  return WithoutAlpha(std::move(result));
}

}  // namespace

Result<cv::Size> SizeOfImageFile(const std::filesystem::path& path) {
  if (const auto size = ReadImageSize(path); size && EndsAsAnImage(path)) return *size;
  const Result<DecodedImage> decoded = Decode(path);
  return decoded.ok() ? Result(decoded->image.size()) : decoded.status();
}

std::string SizeText(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

Result<cv::Mat> ReadImage(const std::filesystem::path& path) {
  return WithEightBits(Decode(path), "the image " + path.string());
}

Result<cv::Mat> DecodeImage(const std::vector<unsigned char>& bytes, const std::string& what) {
  return WithEightBits(Decode(bytes, what), what);
}

Result<cv::Mat> ReadMaskImage(const std::filesystem::path& path) {
  const Result<DecodedImage> decoded = Decode(path);
  if (!decoded.ok()) return decoded.status();
  const int channels = decoded->image.channels() == 3 || decoded->image.channels() == 4 ? 3 : 1;
  cv::Mat mask;
  for (int k = 0; k < channels; ++k) {
    cv::Mat channel;
    cv::extractChannel(decoded->image, channel, k);
    const cv::Mat counts = channel > (decoded->lossy ? 127 : 0);
    mask = mask.empty() ? counts : cv::Mat(mask | counts);
  }
  return mask;
}

Result<cv::Mat> ReadStoredImage(const std::filesystem::path& path) {
  Result<DecodedImage> decoded = Decode(path);
  if (!decoded.ok()) return decoded.status();
  return decoded->image;
}

Result<cv::Mat> ReadDepthImage(const std::filesystem::path& path, double depth_scale) {
  const Result<DecodedImage> decoded = Decode(path);
  if (!decoded.ok()) return decoded.status();
  if (decoded->image.type() != CV_16UC1)
    return Status(ErrorCode::kMismatch, "the depth image " + path.string() + " has " +
                                            std::to_string(decoded->image.channels()) + " channel(s) of " +
                                            std::to_string(8 * decoded->image.elemSize1()) +
                                            " bits; write depth as 16-bit PNG with one channel");
  cv::Mat depth_mm;
  decoded->image.convertTo(depth_mm, CV_32F, depth_scale);
  return depth_mm;
}

Result<cv::Mat> ReadClampedDepthImage(const std::filesystem::path& path, double depth_scale) {
  constexpr double kLargest = 65535.0;
  Result<cv::Mat> depth_mm = ReadDepthImage(path, depth_scale);
  if (depth_mm.ok()) depth_mm->setTo(0, *depth_mm > (kLargest - 0.5) * depth_scale);
  return depth_mm;
}

}  // namespace pliant
