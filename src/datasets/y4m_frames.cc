// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/y4m_frames.h"

#include <algorithm>
#include <array>
#include <utility>

#include "datasets/stream_errors.h"
#include "image/image_size.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr std::string_view kVideo = "YUV4MPEG2 ";
constexpr std::string_view kFrame = "FRAME";
constexpr std::size_t kMaxLine = 1024;  // of a header

// How the planes of color are smaller than that of brightness.
struct Subsampling {
  std::string_view name;
  int x = 1;
  int y = 1;
  int planes = 2;
};

// FFmpeg's names; what follows them has no planes of its own. A longer name precedes its beginning.
constexpr std::array kSubsamplings = {Subsampling{"420", 2, 2}, Subsampling{"411", 4, 1},
                                      Subsampling{"422", 2, 1}, Subsampling{"444alpha", 1, 1, 3},
                                      Subsampling{"444", 1, 1}, Subsampling{"mono", 1, 1, 0}};
constexpr std::array<std::string_view, 4> kOneByte = {"", "jpeg", "mpeg2", "paldv"};  // a value
constexpr std::array<std::string_view, 9> kTwoBytes = {"p9", "p10", "p12", "p14", "p16", "9", "10", "12", "16"};

// Nothing for a format that FFmpeg does not decode.
std::optional<std::size_t> BytesOfFrame(cv::Size size, std::string_view format) {
  const auto found = std::ranges::find_if(kSubsamplings, [&](const auto& s) { return format.starts_with(s.name); });
  if (found == kSubsamplings.end()) return std::nullopt;
  const std::string_view depth = format.substr(found->name.size());
  const bool has_one = std::ranges::find(kOneByte, depth) != kOneByte.end();
  if (!has_one && std::ranges::find(kTwoBytes, depth) == kTwoBytes.end()) return std::nullopt;
  const auto area = [](int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  };
  const std::size_t color = area((size.width + found->x - 1) / found->x, (size.height + found->y - 1) / found->y);
  return (area(size.width, size.height) + static_cast<std::size_t>(found->planes) * color) * (has_one ? 1 : 2);
}

// The line at the beginning, without its end; nothing: it has none yet. `rest` begins like `begin` or fails to.
struct Line {
  bool is_damaged = false;
  std::optional<std::string_view> text;
};

Line FirstLine(std::string_view rest, std::string_view begin) {
  if (rest.substr(0, begin.size()) != begin.substr(0, rest.size())) return {true, {}};
  const std::size_t end = rest.substr(0, kMaxLine).find('\n');
  if (end == std::string_view::npos) return {rest.size() >= kMaxLine, {}};
  return {false, rest.substr(0, end)};
}

}  // namespace

Result<Y4mFrames::Kind> Y4mFrames::KindOf(std::string_view header) const {
  Kind kind{.size = {}, .format = "420"};
  bool is_number = true;
  while (!header.empty()) {
    const std::string_view field = header.substr(0, header.find(' '));
    header.remove_prefix(std::min(header.size(), field.size() + 1));
    const std::string_view value = field.substr(std::min<std::size_t>(1, field.size()));
    if (field.starts_with('W')) is_number = ParseInt(value, &kind.size.width) && is_number;
    if (field.starts_with('H')) is_number = ParseInt(value, &kind.size.height) && is_number;
    if (field.starts_with('C')) kind.format = value;
  }
  if (!is_number || kind.size.width <= 0 || kind.size.height <= 0)
    return Status(ErrorCode::kUnreadable,
                  "the header of the YUV4MPEG video on " + SourceName(source_) + " tells no size; send it again");
  if (Status status = CheckPixels(kind.size, "the video on " + SourceName(source_)); !status.ok()) return status;
  const auto bytes = BytesOfFrame(kind.size, kind.format);
  if (!bytes)
    return Status(ErrorCode::kUnreadable, "the video on " + SourceName(source_) + " has the pixel format " +
                                              Quoted(kind.format) +
                                              ", which is not decoded; convert it, as with ffmpeg -pix_fmt yuv420p");
  kind.bytes = *bytes;
  return kind;
}

Status Y4mFrames::CheckSame(const Kind& kind) const {
  if (kind.size != kind_->size) return ChangesSize(source_, kind_->size, kind.size, frames_);
  if (kind.format == kind_->format) return Status::Ok();
  return {ErrorCode::kMismatch, "the images of " + SourceName(source_) + " change their pixel format from " +
                                    kind_->format + " to " + kind.format + " after " + std::to_string(frames_) +
                                    " images; send all of them in one format"};
}

Status Y4mFrames::Damaged() const {
  return {ErrorCode::kUnreadable, "the video on " + SourceName(source_) + " is damaged after " +
                                      std::to_string(frames_) +
                                      " images: the next one does not begin with FRAME; send it again"};
}

Result<std::size_t> Y4mFrames::TakeHeader(std::string_view rest) {
  const Line line = FirstLine(rest, kVideo);
  if (line.is_damaged) return kind_ ? Damaged() : CannotBeDecoded(source_);
  if (!line.text) return std::size_t{0};
  auto kind = KindOf(line.text->substr(kVideo.size()));
  if (!kind.ok()) return kind.status();
  const std::size_t size = line.text->size() + 1;
  if (kind_) {
    if (Status status = CheckSame(*kind); !status.ok()) return status;
    return size;
  }
  kind_ = *std::move(kind);
  whole_.insert(whole_.end(), rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(size));
  return size;
}

Result<std::size_t> Y4mFrames::TakeFrame(std::string_view rest) {
  const Line line = FirstLine(rest, kFrame);
  if (line.is_damaged) return Damaged();
  const std::size_t size = line.text ? line.text->size() + 1 + kind_->bytes : 0;
  if (size == 0 || rest.size() < size) return std::size_t{0};
  whole_.insert(whole_.end(), rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(size));
  ++frames_;
  return size;
}

Status Y4mFrames::Add(std::span<const unsigned char> bytes) {
  rest_.insert(rest_.end(), bytes.begin(), bytes.end());
  std::string_view rest(reinterpret_cast<const char*>(rest_.data()), rest_.size());
  Result<std::size_t> taken = std::size_t{0};
  do {
    taken = kind_ && !rest.starts_with(kVideo.front()) ? TakeFrame(rest) : TakeHeader(rest);
    if (taken.ok()) rest.remove_prefix(*taken);
  } while (taken.ok() && *taken > 0);
  rest_.erase(rest_.begin(), rest_.end() - static_cast<std::ptrdiff_t>(rest.size()));
  return taken.ok() ? Status::Ok() : taken.status();
}

std::vector<unsigned char> Y4mFrames::TakeWhole() { return std::exchange(whole_, {}); }

}  // namespace pliant
