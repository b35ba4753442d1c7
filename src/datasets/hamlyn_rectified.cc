// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Hamlyn's videos as Recasens et al. rectified them (RA-L 2021): image01/ and image02/ (left, right), depth01/ of 16
// bits in mm, intrinsics.txt (3 x 3, or four numbers a line), extrinsics.txt, the [R | t] of the cameras as they were
// built, whose length is the baseline.
#include <cmath>

#include "datasets/formats.h"
#include "datasets/image_file.h"
#include "datasets/set_frames.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr const char* kIntrinsics = "intrinsics.txt";

std::map<int, fs::path> ImagesIn(const fs::path& folder) {
  for (const char* ending : {".jpg", ".png"})
    if (auto files = NumberedFiles(folder, "", ending); !files.empty()) return files;
  return {};
}

Result<double> ReadBaseline(const fs::path& file) {
  const auto rows = ReadNumberRows(file, 4);
  if (!rows.ok()) return rows.status();
  if (rows->size() < 3)
    return Status(ErrorCode::kUnreadable,
                  file.string() + " has " + std::to_string(rows->size()) + " lines; [R | t] has three of four numbers");
  double squares = 0;
  for (std::size_t row = 0; row < 3; ++row) squares += std::pow((*rows)[row].numbers[3], 2);
  return std::sqrt(squares);
}

Result<SourceCalibration> CameraOf(const fs::path& folder, const std::map<int, fs::path>& images) {
  const fs::path file = folder / kIntrinsics;
  const auto rows = ReadNumberRows(file, 3);
  if (!rows.ok()) return rows.status();
  if (rows->size() < 2)
    return Status(ErrorCode::kUnreadable,
                  file.string() + " has " + std::to_string(rows->size()) + " lines; a camera matrix has three");
  const auto size = StreamFiles(folder, {images.begin()->second})->SizeAt(0);
  if (!size) return Status(ErrorCode::kUnreadable, images.begin()->second.string() + " cannot be read; copy it again");
  const std::vector<double>& upper = (*rows)[0].numbers;
  const std::vector<double>& lower = (*rows)[1].numbers;
  auto camera = Camera::Create(CameraModelId::kPinhole, size->width, size->height,
                               std::vector<double>{upper[0], lower[1], upper[2], lower[2]});
  if (!camera.ok()) return Status(camera.status().code(), file.string() + ": " + camera.status().message());
  return SourceCalibration{*std::move(camera), file};
}

}  // namespace

bool IsHamlynRectified(const fs::path& path) { return IsFolder(path / "image01") && IsFile(path / kIntrinsics); }

std::string HamlynRectifiedLacks(const fs::path& path) { return IsFolder(path / "image01") ? kIntrinsics : ""; }

Result<DataSet> OpenHamlynRectified(const SequenceRequest& request) {
  const fs::path& folder = request.image_path;
  NumberedSet set{.folder = folder / "image01",
                  .images = ImagesIn(folder / "image01"),
                  .right = ImagesIn(folder / "image02"),
                  .baseline_hint = IsFile(folder / "extrinsics.txt") ? "" : "; extrinsics.txt would",
                  .depth = NumberedFiles(folder / "depth01", "", ".png"),
                  .read_depth = [](const fs::path& file) { return ReadDepthImage(file, 1.0); }};
  if (set.images.empty())
    return Status(ErrorCode::kNotFound, "the folder " + set.folder.string() + " holds no image; check the path");
  auto camera = CameraOf(folder, set.images);
  if (!camera.ok()) return camera.status();
  if (IsFile(folder / "extrinsics.txt")) {
    const auto baseline_mm = ReadBaseline(folder / "extrinsics.txt");
    if (!baseline_mm.ok()) return baseline_mm.status();
    camera->baseline_mm = *baseline_mm;
  }
  return OpenNumberedSet(request, std::move(set), *camera);
}

}  // namespace pliant
