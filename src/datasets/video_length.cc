// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/video_length.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

namespace pliant {
namespace {

namespace fs = std::filesystem;

std::uint64_t BigEndian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (const char byte : bytes) value = value << 8 | static_cast<unsigned char>(byte);
  return value;
}

// The box `moov` of a file of MP4's family; empty where it has none.
std::string MovieBoxOf(const fs::path& file) {
  constexpr std::uint64_t kMostBytes = 1 << 28;
  std::ifstream in(file, std::ios::binary);
  std::string head(16, '\0');
  for (std::uint64_t at = 0; in.seekg(static_cast<std::streamoff>(at)) && in.read(head.data(), 8);) {
    const std::string_view type = std::string_view(head).substr(4, 4);
    std::uint64_t length = BigEndian(std::string_view(head).substr(0, 4));
    if (length == 1 && in.read(head.data() + 8, 8)) length = BigEndian(std::string_view(head).substr(8));
    if (length < 8 || length > std::numeric_limits<std::uint64_t>::max() - at) break;
    if (type == "moov") {
      std::string box(static_cast<std::size_t>(std::min(length, kMostBytes)), '\0');
      in.seekg(static_cast<std::streamoff>(at));
      in.read(box.data(), static_cast<std::streamsize>(box.size()));
      return in ? box : std::string();
    }
    at += length;
  }
  return {};
}

}  // namespace

bool CountsFrames(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string head(8, '\0');
  if (!in.read(head.data(), 8)) return false;
  return head.starts_with("RIFF") || !MovieBoxOf(file).empty();
}

std::optional<double> ShownSeconds(const fs::path& file) {
  const std::string movie = MovieBoxOf(file);
  const std::string_view view = movie;
  const auto number = [&](std::size_t at, std::size_t bytes) {
    return at + bytes <= view.size() ? BigEndian(view.substr(at, bytes)) : 0;
  };
  const std::size_t header = view.find("mvhd");
  if (header == std::string_view::npos) return std::nullopt;
  const double units_per_s = static_cast<double>(number(header + (number(header + 4, 1) == 1 ? 24 : 16), 4));
  double longest = 0.0;
  for (std::size_t list = view.find("elst"); list != std::string_view::npos; list = view.find("elst", list + 4)) {
    const std::size_t bytes = number(list + 4, 1) == 1 ? 8 : 4;  // of a number in it
    const std::uint64_t entries = std::min<std::uint64_t>(number(list + 8, 4), view.size());
    double shown = 0.0;
    std::size_t at = list + 12;
    for (std::uint64_t k = 0; k < entries && at < view.size(); ++k, at += 2 * bytes + 4) {
      const bool is_empty = number(at + bytes, 4) == 0xFFFFFFFF;  // a pause before the first frame
      if (!is_empty) shown += static_cast<double>(number(at, bytes));
    }
    longest = std::max(longest, shown);
  }
  return longest > 0.0 && units_per_s > 0.0 ? std::optional(longest / units_per_s) : std::nullopt;
}

}  // namespace pliant
