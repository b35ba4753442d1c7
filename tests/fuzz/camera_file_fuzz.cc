// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdlib>
#include <string>

#include "fuzz_input.h"
#include "pliant/io/camera_file.h"

using namespace pliant;  // NOLINT(google-build-using-namespace): a file that is one function

// camera.yaml, COLMAP's cameras.txt and cameras.bin, and OpenCV's YAML and XML are told apart by what they contain.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr const char* kNames[] = {"camera.yaml", "cameras.txt", "cameras.bin", "camera.xml"};
  const FuzzInput input(data, size, 4);
  const std::string path = WriteFuzzFile(kNames[input.choice], input.bytes);
  const auto file = ReadCameraFile(path);
  if (!file.ok() && file.status().message().empty()) std::abort();
  if (file.ok() && (file->camera.width() <= 0 || file->camera.height() <= 0)) std::abort();
  const auto pair = ReadStereoCalibration(path);
  if (!pair.ok() && pair.status().message().empty()) std::abort();
  return 0;
}
