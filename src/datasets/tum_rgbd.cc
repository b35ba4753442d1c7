// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// TUM RGB-D (Sturm et al., IROS 2012) and what is written like it: rgb.txt and depth.txt, `timestamp file` a line,
// depth of 16 bits, 5000 a meter; groundtruth.txt, world from camera, meters. Depth and poses belong to the image
// nearest in time, within 20 ms.
#include <cmath>
#include <map>
#include <utility>

#include "datasets/formats.h"
#include "datasets/image_file.h"
#include "datasets/set_files.h"
#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"
#include "pliant/io/trajectory.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr double kDepthUnit_mm = 0.2;

Result<std::map<double, fs::path>> ReadTimedFiles(const fs::path& file, std::vector<std::string>* warnings) {
  auto reader = LineReader::Open(file.string());
  if (!reader.ok()) return reader.status();
  std::map<double, fs::path> list;
  ListedFiles files;
  std::string_view line;
  while (reader->Next(&line)) {
    const auto fields = Split(line, ' ');
    if (fields.empty() || fields[0].starts_with('#')) continue;
    double time_s = 0;
    if (fields.size() < 2 || !ParseDouble(fields[0], &time_s) || !std::isfinite(time_s))
      return reader->Error("a line has a time and a file");
    const fs::path listed = file.parent_path() / fields[1];
    if (files.Has(listed)) list.emplace(time_s, listed);
  }
  if (Status status = reader->End(); !status.ok()) return status;
  files.WarnOfMissing(file, warnings);
  return list;
}

}  // namespace

bool IsTumRgbd(const fs::path& path) { return IsFile(path / "rgb.txt"); }

std::string TumRgbdLacks(const fs::path& path) {
  return IsFolder(path / "rgb") && IsFile(path / "depth.txt") ? "rgb.txt" : "";
}

Result<DataSet> OpenTumRgbd(const SequenceRequest& request) {
  const fs::path& folder = request.image_path;
  std::vector<std::string> warnings;
  const auto images = ReadTimedFiles(folder / "rgb.txt", &warnings);
  if (!images.ok()) return images.status();
  if (images->empty())
    return Status(ErrorCode::kNotFound,
                  (folder / "rgb.txt").string() + " names no image that is there; check the path");
  std::vector<fs::path> files;
  std::vector<double> times_s;
  for (const auto& [time_s, file] : *images) {
    files.push_back(file);
    times_s.push_back(time_s);
  }
  auto data_set = Calibrated(request, StreamFiles(folder, files));
  if (!data_set.ok()) return data_set.status();
  data_set->warnings.insert(data_set->warnings.end(), warnings.begin(), warnings.end());
  if (IsFile(folder / "depth.txt")) {
    const auto depths = ReadTimedFiles(folder / "depth.txt", &data_set->warnings);
    if (!depths.ok()) return depths.status();
    for (const double time_s : depths->empty() ? std::vector<double>() : times_s) {
      const fs::path* nearest = NearestInTime(*depths, time_s, kMaxDifference_s);
      data_set->depth_files.push_back(nearest != nullptr ? *nearest : fs::path());
    }
    data_set->read_depth = [unit_mm = data_set->calibration.depth_scale.value_or(kDepthUnit_mm)](const fs::path& file) {
      return ReadDepthImage(file, unit_mm);
    };
  }
  if (IsFile(folder / "groundtruth.txt")) {
    const auto poses = ReadTumTrajectory((folder / "groundtruth.txt").string());
    if (!poses.ok()) return poses.status();
    data_set->world_from_cam = PosesAt(times_s, *poses, kMeter_mm, kMaxDifference_s);
  }
  data_set->timestamps_s = std::move(times_s);
  return data_set;
}

}  // namespace pliant
