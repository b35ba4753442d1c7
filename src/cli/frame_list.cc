// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/frame_list.h"

#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant::cli {
namespace {

constexpr int kMostFrames = 10'000'000;

}  // namespace

std::optional<std::vector<int>> ParseFrameList(std::string_view text) {
  std::vector<int> frames;
  if (text.empty()) return frames;
  for (const std::string_view field : Split(text, ',')) {
    const auto ends = Split(field, '-');
    int first = 0;
    int last = 0;
    if (ends.size() > 2 || !ParseInt(ends.front(), &first) || !ParseInt(ends.back(), &last) || first < 0 ||
        last < first || last > kMostFrames)
      return std::nullopt;
    for (int frame = first; frame <= last; ++frame) frames.push_back(frame);
  }
  return frames;
}

}  // namespace pliant::cli
