// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdlib>

#include "fuzz_input.h"
#include "pliant/io/trajectory.h"

using namespace pliant;  // NOLINT(google-build-using-namespace): a file that is one function

namespace {

bool IsPose(const Rigid3& pose) {
  return pose.rotation.coeffs().allFinite() && pose.translation.allFinite() &&
         std::abs(pose.rotation.norm() - 1) < 1e-6;
}

void CheckPaths(const Result<std::vector<TimedPose>>& poses) {
  if (!poses.ok()) return;
  for (std::size_t i = 0; i < poses->size(); ++i) {
    if (!IsPose((*poses)[i].world_from_cam)) std::abort();
    if (i > 0 && !((*poses)[i].timestamp_s > (*poses)[i - 1].timestamp_s)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FuzzInput input(data, size, 3);
  const std::string path = WriteFuzzFile("path.txt", input.bytes);
  if (input.choice == 0) CheckPaths(ReadTumTrajectory(path));
  if (input.choice == 1) CheckPaths(ReadEurocTrajectory(path));
  if (input.choice == 2)
    if (const auto poses = ReadKittiPoses(path); poses.ok())
      for (const Rigid3& pose : *poses)
        if (!IsPose(pose)) std::abort();
  return 0;
}
