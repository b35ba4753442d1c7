// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap/readers.h"
#include "colmap/rows.h"
#include "colmap_fuzz.h"

using namespace pliant;          // NOLINT(google-build-using-namespace): a file that is one function
using namespace pliant::colmap;  // NOLINT(google-build-using-namespace)

namespace {

template <class Rows, class Append>
std::string File(const Rows& rows, Append append) {
  std::string file;
  for (const auto& row : rows) append(row, &file);
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FuzzInput input(data, size, 5);
  const std::string path = WriteFuzzFile("file.txt", input.bytes);
  const auto images = [](const std::string& p) { return ReadTextImages(p, Observations::kRead); };
  const auto points = [](const std::string& p) { return ReadTextPoints(p, Observations::kRead); };
  switch (input.choice) {
    case 0:
      CheckComesBack(
          ReadTextCameras(path), [](const auto& rows) { return File(rows, AppendTextCamera); }, ReadTextCameras);
      break;
    case 1:
      CheckComesBack(
          images(path),
          [](const auto& rows) {
            return File(rows, [](const Image& row, std::string* out) { AppendTextImage(row, Digits::kExact, out); });
          },
          images);
      break;
    case 2:
      CheckComesBack(
          points(path),
          [](const auto& rows) {
            return File(rows, [](const Point3D& row, std::string* out) {
              AppendTextPoint(row, row.track, Digits::kExact, out);
            });
          },
          points);
      break;
    case 3:
      CheckComesBack(
          ReadTextRigs(path), [](const auto& rows) { return File(rows, AppendTextRig); }, ReadTextRigs);
      break;
    default:
      CheckComesBack(
          ReadTextFrames(path), [](const auto& rows) { return File(rows, AppendTextFrame); }, ReadTextFrames);
  }
  return 0;
}
