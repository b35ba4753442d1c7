// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Reads ahead on one background thread, so that decoding overlaps with tracking. The same frames and failures come in
// the same order as without it; an exception of the source is thrown again where its frame would have come. At most
// `ahead` frames wait and one is being read: memory does not grow with the sequence. It can be destroyed at any time
// and waits then for the one read under way.
#pragma once

#include <memory>
#include <optional>

#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"

namespace pliant {

class PrefetchedSequence final : public Sequence {
 public:
  static constexpr int kDefaultAhead = 3;

  // `source` is not null; `ahead` at least 1.
  explicit PrefetchedSequence(std::unique_ptr<Sequence> source, int ahead = kDefaultAhead);
  ~PrefetchedSequence() override;
  PrefetchedSequence(const PrefetchedSequence&) = delete;
  PrefetchedSequence& operator=(const PrefetchedSequence&) = delete;

  const Camera& camera() const override;
  int size() const override;
  // To be called from one thread. After the end it keeps answering that there is nothing more.
  Result<std::optional<SequenceFrame>> Next() override;

  // These wait for the read under way: the source is never used by two threads at once.
  Result<std::optional<cv::Mat>> Depth(int frame_idx) const override;
  std::optional<Rigid3> WorldFromCamera(int frame_idx) const override;
  std::optional<double> TimestampS(int frame_idx) const override;

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

}  // namespace pliant
