// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A surface folder whose surface.json is anything at all.
#include <cstdlib>
#include <string_view>

#include <opencv2/core.hpp>

#include "fuzz_input.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/image/texture.h"

using namespace pliant;  // NOLINT(google-build-using-namespace): a file that is one function

namespace {

constexpr int kWidth = 32;
constexpr int kHeight = 24;
constexpr std::string_view kCamera =
    "model: PINHOLE\nwidth: 32\nheight: 24\nparams: [30, 30, 15.5, 11.5]\ndepth_scale: 0.01\n";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  WriteFuzzFile("camera.yaml", {reinterpret_cast<const std::uint8_t*>(kCamera.data()), kCamera.size()});
  WriteFuzzFile(surface::kSummaryFile, {data, size});
  const auto folder = ReadSurfaceFolder(FuzzFolder());
  if (!folder.ok()) {
    if (folder.status().message().empty()) std::abort();
    return 0;
  }
  for (const SurfaceFolder::Frame& frame : folder->frames) {
    // None of the images is there, so each is refused.
    if (ReadSurfaceDepth(*folder, frame).ok() || !ReadSurfaceVertices(*folder, frame).ok()) std::abort();
  }
  if (folder->windows)
    TexturedPixels(cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(90)),
                   cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(255)), *folder->windows);
  return 0;
}
