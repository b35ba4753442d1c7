// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap/readers.h"
#include "colmap/rows.h"
#include "colmap_fuzz.h"
#include "pliant/base/text.h"

using namespace pliant;          // NOLINT(google-build-using-namespace): a file that is one function
using namespace pliant::colmap;  // NOLINT(google-build-using-namespace)

namespace {

template <class Rows, class Append>
std::string File(const Rows& rows, Append append) {
  std::string file;
  AppendBytes(&file, rows.size(), 8);
  for (const auto& row : rows) append(row, &file);
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FuzzInput input(data, size, 5);
  const std::string path = WriteFuzzFile("file.bin", input.bytes);
  const auto images = [](const std::string& p) { return ReadBinaryImages(p, Observations::kRead); };
  const auto points = [](const std::string& p) { return ReadBinaryPoints(p, Observations::kRead); };
  switch (input.choice) {
    case 0:
      CheckComesBack(
          ReadBinaryCameras(path), [](const auto& rows) { return File(rows, AppendBinaryCamera); }, ReadBinaryCameras);
      break;
    case 1:
      CheckComesBack(
          images(path), [](const auto& rows) { return File(rows, AppendBinaryImage); }, images);
      break;
    case 2:
      CheckComesBack(
          points(path),
          [](const auto& rows) {
            return File(rows,
                        [](const Point3D& point, std::string* out) { AppendBinaryPoint(point, point.track, out); });
          },
          points);
      break;
    case 3:
      CheckComesBack(
          ReadBinaryRigs(path), [](const auto& rows) { return File(rows, AppendBinaryRig); }, ReadBinaryRigs);
      break;
    default:
      CheckComesBack(
          ReadBinaryFrames(path), [](const auto& rows) { return File(rows, AppendBinaryFrame); }, ReadBinaryFrames);
  }
  return 0;
}
