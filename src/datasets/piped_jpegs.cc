// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/piped_jpegs.h"

#include <cstdint>
#include <utility>

#include "datasets/image_file.h"
#include "datasets/stream_errors.h"

namespace pliant {

PipedJpegs::PipedJpegs(std::unique_ptr<StandardInput> input, std::span<const unsigned char> begin, double timeout_s,
                       std::function<bool()> is_stopped)
    : FrameGrabber("-"), input_(std::move(input)), timeout_s_(timeout_s), is_stopped_(std::move(is_stopped)) {
  Add(begin);
}

void PipedJpegs::Add(std::span<const unsigned char> bytes) {
  const std::int64_t before = jpegs_.broken();
  jpegs_.Add(bytes);
  CountDamaged(jpegs_.broken() - before);
}

Status PipedJpegs::AtEnd() const {
  if (input_->has_stalled()) return SentNothing(source(), timeout_s_);
  if (images() > 0) return Status::Ok();
  return jpegs_.IsWithinImage() && damaged() == 0 ? EndsWithinFirstImage(source()) : CannotBeDecoded(source());
}

std::optional<cv::Mat> PipedJpegs::Next() {
  while (!is_stopped_()) {
    while (const auto jpeg = jpegs_.Take()) {
      auto image = DecodeImage(*jpeg, "an image of standard input");
      if (image.ok()) return *std::move(image);
      CountDamaged(1);
    }
    const auto bytes = input_->Read(is_stopped_);
    if (!bytes.empty()) {
      Add(bytes);
      continue;
    }
    Fail(AtEnd());
    CountDamaged(jpegs_.IsWithinImage() ? 1 : 0);
    return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace pliant
