// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// StereoMIS (Hayoz et al., IJCARS 2023): da Vinci recordings. One video, left eye on top of the right one;
// StereoCalibration.ini; groundtruth.txt, `frame tx ty tz qx qy qz qw`, world from left camera, meters, of the robot's
// kinematics; masks/NNNNNNl.png, 0 = an instrument, of some of the frames and not always of the video's size.
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "datasets/calibration_files.h"
#include "datasets/formats.h"
#include "datasets/set_files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCalibrationName = "StereoCalibration.ini";
constexpr double kMaxFrameNumber = 1e7;

Status AddPoses(const fs::path& file, DataSet* data_set) {
  const auto rows = ReadNumberRows(file, 8);
  if (!rows.ok()) return rows.status();
  std::map<int, Rigid3> poses;
  for (const NumberRow& row : *rows) {
    auto pose = PoseOfRow(file, row, {.tx = 1, .qx = 4, .qw = 7});
    if (!pose.ok()) return pose.status();
    pose->translation *= kMeter_mm;
    const double frame = row.numbers[0];
    if (!(frame >= 0 && frame < kMaxFrameNumber && frame == std::floor(frame)))
      return {ErrorCode::kUnreadable,
              PathAndLine(file.string(), row.line) + ": a line begins with the number of a frame"};
    poses[static_cast<int>(frame)] = *pose * data_set->raw_from_given;
  }
  if (poses.empty()) return Status::Ok();
  for (int idx = 0; idx <= poses.rbegin()->first; ++idx)
    data_set->world_from_cam.push_back(poses.contains(idx) ? std::optional(poses.at(idx)) : std::nullopt);
  return Status::Ok();
}

}  // namespace

bool IsStereoMis(const fs::path& path) { return IsFile(path / kCalibrationName) && !OnlyFile(path, ".mp4").empty(); }

std::string StereoMisLacks(const fs::path& path) {
  return IsFile(path / kCalibrationName) ? "one .mp4, and no other" : "";
}

Result<DataSet> OpenStereoMis(const SequenceRequest& request) {
  const fs::path& folder = request.image_path;
  auto video = StreamVideo(OnlyFile(folder, ".mp4"), request.video_index);
  if (!video.ok()) return video.status();
  const fs::path file = request.camera_path.empty() ? folder / kCalibrationName : request.camera_path;
  const auto calibration = ReadStereoIni(file);
  if (!calibration.ok()) return calibration.status();
  auto data_set = RectifiedHalves(*calibration, file, PairLayout::kTopBottom, *std::move(video));
  if (!data_set.ok()) return data_set.status();
  data_set->mask_path = request.mask_path;
  if (request.mask_path.empty()) data_set->raw_masks = NumberedFiles(folder / "masks", "", "l.png");
  if (IsFile(folder / "groundtruth.txt"))
    if (Status status = AddPoses(folder / "groundtruth.txt", &*data_set); !status.ok()) return status;
  return data_set;
}

}  // namespace pliant
