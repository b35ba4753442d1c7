// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdlib>

#include "fuzz_input.h"
#include "pliant/io/point_cloud.h"

using namespace pliant;  // NOLINT(google-build-using-namespace): a file that is one function

// NumPy's arrays, PLY in ASCII and binary, and text.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr const char* kNames[] = {"cloud.npy", "cloud.ply", "cloud.txt"};
  const FuzzInput input(data, size, 3);
  const auto points = ReadPointCloud(WriteFuzzFile(kNames[input.choice], input.bytes));
  if (!points.ok() && points.status().message().empty()) std::abort();
  if (points.ok() && points->empty()) std::abort();
  return 0;
}
