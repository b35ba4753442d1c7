// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Opens what a test wrote, and says what it expects of the frames.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "datasets/sequence_files.h"
#include "pliant/datasets/open_sequence.h"

namespace pliant {

inline constexpr double kVideoLoss = 3.0;  // gray levels a lossy codec may change a plain image by

class OpenSequenceTest : public SequenceFiles {
 protected:
  SequenceRequest Request(const std::string& name = "") const {
    SequenceRequest request;
    request.image_path = name.empty() ? root_ : Path(name);
    return request;
  }
  static std::unique_ptr<Sequence> Open(const SequenceRequest& request) {
    auto sequence = OpenSequence(request);
    EXPECT_TRUE(sequence.ok()) << sequence.status().message();
    return sequence.ok() ? *std::move(sequence) : nullptr;
  }
  static std::vector<int> Indices(Sequence& sequence) {
    std::vector<int> indices;
    while (true) {
      const auto frame = sequence.Next();
      EXPECT_TRUE(frame.ok()) << frame.status().message();
      if (!frame.ok() || !frame->has_value()) return indices;
      indices.push_back((*frame)->frame_idx);
      EXPECT_NEAR(cv::mean((*frame)->image)[0], Brightness((*frame)->frame_idx), kVideoLoss);
    }
  }
  // Opening fails with this code, and the sentence names this.
  static void ExpectRefused(const SequenceRequest& request, ErrorCode code, const std::string& named) {
    const auto sequence = OpenSequence(request);
    ASSERT_FALSE(sequence.ok());
    EXPECT_EQ(sequence.status().code(), code) << sequence.status().message();
    EXPECT_THAT(sequence.status().message(), testing::HasSubstr(named));
  }
  // Frame `bad` fails so, all others come.
  static void ExpectBadFrame(Sequence& sequence, int count, int bad, ErrorCode code, const std::string& named) {
    for (int idx = 0; idx < count; ++idx) {
      const auto frame = sequence.Next();
      ASSERT_EQ(frame.ok(), idx != bad) << idx << " " << frame.status().message();
      if (idx == bad) {
        EXPECT_EQ(frame.status().code(), code) << frame.status().message();
        EXPECT_THAT(frame.status().message(), testing::HasSubstr(named));
      } else {
        EXPECT_EQ((*frame)->frame_idx, idx);
      }
    }
    const auto end = sequence.Next();
    ASSERT_TRUE(end.ok());
    EXPECT_FALSE(end->has_value());
  }
};

}  // namespace pliant
