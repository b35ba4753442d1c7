// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/frame_list.h"

#include <algorithm>
#include <string>

#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant::cli {
namespace {

constexpr int kMostFrames = 10'000'000;

}  // namespace

Result<std::vector<int>> ParseFrameList(std::string_view option, std::string_view text) {
  std::vector<int> frames;
  if (text.empty()) return frames;
  const auto refused = [&](const std::string& advice) {
    return Status(ErrorCode::kInvalidArgument, std::string(option) + " is '" + std::string(text) + "'; " + advice);
  };
  for (const std::string_view field : Split(text, ',')) {
    const auto ends = Split(field, '-');
    int first = 0;
    int last = 0;
    if (ends.size() > 2 || !ParseInt(ends.front(), &first) || !ParseInt(ends.back(), &last) || first < 0 ||
        std::max(first, last) > kMostFrames)
      return refused("give frame numbers with commas between them, or 10-20 for all from 10 to 20");
    if (last < first)
      return refused("a range begins with the smaller number: give " + std::to_string(last) + "-" +
                     std::to_string(first));
    for (int frame = first; frame <= last; ++frame) frames.push_back(frame);
  }
  return frames;
}

}  // namespace pliant::cli
