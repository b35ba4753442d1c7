// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/relocalization/relocalizer.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tracking/submap/submap.h"

namespace pliant {
namespace {

Camera SearchingCamera() { return *Camera::Create("PINHOLE", 320, 240, std::vector<double>{300, 300, 159.5, 119.5}); }

// A submap whose landmarks are at the corners of its last sharp image.
struct SeenOnce {
  TrackerOptions options;
  Relocalizer relocalizer{SearchingCamera(), options, TrackAbilities(), nullptr};
  Submap submap{0, SearchingCamera(), options};
  DescribedImage described;

  SeenOnce() {
    cv::Mat gray(240, 320, CV_8UC1);
    cv::RNG(1).fill(gray, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(gray, gray, cv::Size(), 2.5);
    cv::normalize(gray, gray, 0, 255, cv::NORM_MINMAX);
    submap.previous.gray = gray;
    described = Describe(gray, SupportMask(), options.corners, options.relocalization);
    for (std::size_t k = 0; k < described.pixels.size(); ++k) {
      const double distance = 40 + 3.0 * static_cast<double>(k % 7);
      submap.map.landmarks.push_back({.id = PointId{static_cast<int>(k)},
                                      .position = distance * *SearchingCamera().Unproject(described.pixels[k]),
                                      .pixel = described.pixels[k]});
    }
  }

  bool IsRecognized() const {
    return submap.descriptors.Recognize(described, SearchingCamera(), submap.map.landmarks).ok();
  }
};

TEST(Relocalizer, RemembersAsManyPosesInARowAsTheVelocityIsOf) {
  SeenOnce seen;
  const int length = seen.options.relocalization.velocity_frames + 1;
  for (int step = 0; step < 2 * length; ++step) {
    seen.submap.last_cam_from_world.translation.x() = step;
    seen.relocalizer.RememberPose(step, &seen.submap);
  }
  ASSERT_EQ(static_cast<int>(seen.submap.recent_poses.size()), length);
  EXPECT_EQ(seen.submap.recent_poses.front().first, length);
  EXPECT_EQ(seen.submap.recent_poses.back().second.translation.x(), 2 * length - 1);
  seen.relocalizer.RememberPose(2 * length + 1, &seen.submap);
  EXPECT_EQ(seen.submap.recent_poses.size(), 1U);
  // Backward in time; a turn in time begins anew.
  for (int step = 2 * length; step > length; --step) seen.relocalizer.RememberPose(step, &seen.submap);
  EXPECT_EQ(static_cast<int>(seen.submap.recent_poses.size()), length);
  seen.relocalizer.RememberPose(length + 2, &seen.submap);
  EXPECT_EQ(seen.submap.recent_poses.size(), 1U);
}

TEST(Relocalizer, DescribesTheLastViewUnlessItWasBlurred) {
  SeenOnce sharp;
  sharp.relocalizer.RememberLastView(&sharp.submap);
  EXPECT_TRUE(sharp.IsRecognized());
  SeenOnce blurred;
  blurred.submap.blurred_frames = 2;
  blurred.relocalizer.RememberLastView(&blurred.submap);
  EXPECT_FALSE(blurred.IsRecognized());
}

}  // namespace
}  // namespace pliant
