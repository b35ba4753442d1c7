// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The native sequence: camera.yaml, images/ and what may stand beside them (docs/formats.md).
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "datasets/depth_array.h"
#include "datasets/formats.h"
#include "datasets/image_file.h"
#include "datasets/image_list.h"
#include "datasets/set_files.h"
#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"
#include "pliant/datasets/frame_checks.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/io/camera_file.h"
#include "pliant/io/trajectory.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// A pose this near in time to an image is the image's: times are written to a microsecond, and rounded by hand.
constexpr double kSameTime_s = 1e-3;

Status WrongLineCount(const fs::path& file, const std::string& what, std::size_t lines, int images) {
  return {ErrorCode::kMismatch, "the file " + file.string() + " has " + std::to_string(lines) + " " + what + " for " +
                                    std::to_string(images) + " images; it needs one line an image" +
                                    (what == "poses" ? ", or the times of images in their lines" : "")};
}

// One time a line, seconds, growing; lines that start with # are comments.
Result<std::vector<double>> ReadTimes(const fs::path& file) {
  auto reader = LineReader::Open(file.string());
  if (!reader.ok()) return reader.status();
  std::vector<double> times_s;
  std::string_view line;
  while (reader->Next(&line)) {
    const std::string text = Trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    double time_s = 0;
    if (!ParseDouble(text, &time_s) || !std::isfinite(time_s))
      return reader->Error(Quoted(text) + " is not a time; a line has one number, in seconds");
    if (!times_s.empty() && !(time_s > times_s.back()))
      return reader->Error("the time is not after the line before; times grow");
    times_s.push_back(time_s);
  }
  if (Status status = reader->End(); !status.ok()) return status;
  return times_s;
}

// The images of one of the sequence's folders, by the names of its frames.
Result<CompanionImages> OpenCompanions(const std::string& what, const fs::path& folder, const ImageStream& images,
                                       CompanionKind kind = CompanionKind::kImages) {
  if (!IsFolder(folder))  // one image may mask every frame, but is not the depth of every frame
    return Status(ErrorCode::kUnreadable, folder.string() + " is a file where a folder of images is expected");
  return CompanionImages::Open(what, folder, Stems(images), CompanionImages::Counts::kMustAgree, kind);
}

// A line an image, in their order; fewer belong to the images of their times.
Status AddPoses(const fs::path& file, const std::vector<TimedPose>& poses, DataSet* data_set) {
  const auto count = static_cast<std::size_t>(data_set->images->count());
  const double unit_mm = data_set->calibration.unit_mm;
  if (poses.size() == count) {
    for (const auto& [time_s, pose] : poses)
      data_set->world_from_cam.emplace_back(Rigid3(pose.rotation, unit_mm * pose.translation));
    return Status::Ok();
  }
  std::vector<double> times_s = data_set->timestamps_s;
  for (std::size_t idx = times_s.size(); idx < count; ++idx)
    times_s.push_back(static_cast<double>(idx) / data_set->calibration.Fps());
  data_set->world_from_cam = PosesAt(times_s, poses, unit_mm, kSameTime_s);
  const auto found = std::count_if(data_set->world_from_cam.begin(), data_set->world_from_cam.end(),
                                   [](const auto& pose) { return pose.has_value(); });
  if (poses.empty() || static_cast<std::size_t>(found) != poses.size())
    return WrongLineCount(file, "poses", poses.size(), data_set->images->count());
  return Status::Ok();
}

Status AddTimesAndTruth(const fs::path& folder, DataSet* data_set) {
  const int count = data_set->images->count();
  if (const fs::path file = folder / native::kTimesFile; Exists(file)) {
    Result<std::vector<double>> times_s = ReadTimes(file);
    if (!times_s.ok()) return times_s.status();
    if (Status status = CheckFrameTimes(*times_s, "the times in " + file.string() + " are"); !status.ok())
      return {ErrorCode::kMismatch, status.message()};
    if (times_s->size() != static_cast<std::size_t>(count))
      return WrongLineCount(file, "times", times_s->size(), count);
    data_set->timestamps_s = *std::move(times_s);
  } else {
    WarnOfGaps(*data_set->images, &data_set->warnings);
  }
  if (const fs::path file = folder / native::kPosesFile; Exists(file)) {
    const Result<std::vector<TimedPose>> poses = ReadTumTrajectory(file.string());
    if (!poses.ok()) return poses.status();
    if (Status status = AddPoses(file, *poses, data_set); !status.ok()) return status;
  }
  return Status::Ok();
}

Status AddDepth(const fs::path& folder, DataSet* data_set) {
  if (!Exists(folder)) return Status::Ok();
  const Result<CompanionImages> depth = OpenCompanions("depth", folder, *data_set->images, CompanionKind::kDepthMaps);
  if (!depth.ok()) return depth.status();
  for (const std::string& stem : Stems(*data_set->images))
    data_set->depth_files.push_back(depth->Find(static_cast<int>(data_set->depth_files.size()), stem));
  data_set->read_depth = [scale = data_set->calibration.depth_scale.value_or(1.0)](const fs::path& file) {
    return file.extension() == ".npy" ? ReadDepthMap(file) : ReadDepthImage(file, scale);
  };
  return Status::Ok();
}

// Rectified right images, one a frame; without a baseline they say nothing of depth.
Status AddRight(const fs::path& folder, DataSet* data_set) {
  if (!Exists(folder)) return Status::Ok();
  if (!data_set->calibration.baseline_mm) {
    data_set->warnings.push_back("the right images in " + folder.string() +
                                 " are not read: " + data_set->calibration.path.string() + " says no baseline");
    return Status::Ok();
  }
  const Result<CompanionImages> right = OpenCompanions("right", folder, *data_set->images);
  if (!right.ok()) return right.status();
  std::vector<fs::path> files;
  for (int idx = 0; idx < data_set->images->count(); ++idx) {
    const Result<fs::path> file = right->Require(idx, data_set->images->Name(idx));
    if (!file.ok()) return file.status();
    files.push_back(*file);
  }
  data_set->right = StreamFiles(folder, std::move(files));
  return Status::Ok();
}

// What a calibration that was given in place of the sequence's own does not say: how its images and poses are stored.
void TakeStorage(const fs::path& own_file, SourceCalibration* calibration) {
  if (!Exists(own_file) || calibration->path == own_file) return;
  const auto own = ReadCameraFile(own_file.string());
  if (!own.ok()) return;
  calibration->unit_mm = own->unit_mm;
  if (!calibration->depth_scale) calibration->depth_scale = own->depth_scale;
  if (!calibration->baseline_mm) calibration->baseline_mm = own->baseline_mm;
  if (!calibration->fps) calibration->fps = own->fps;
}

}  // namespace

bool IsNativeSequence(const fs::path& path) { return IsFolder(path / native::kImageFolder); }

Result<DataSet> OpenNativeSequence(const SequenceRequest& request) {
  const fs::path& folder = request.image_path;
  Result<std::unique_ptr<ImageStream>> images = StreamFolder(folder / native::kImageFolder);
  if (!images.ok()) return images.status();
  Result<DataSet> data_set = Calibrated(request, *std::move(images));
  if (!data_set.ok()) return data_set.status();
  TakeStorage(folder / native::kCameraFile, &data_set->calibration);
  if (request.mask_path.empty() && Exists(folder / native::kMaskFolder))
    data_set->mask_path = folder / native::kMaskFolder;
  for (const Status& status :
       {AddTimesAndTruth(folder, &*data_set), AddDepth(folder / native::kDepthFolder, &*data_set),
        AddRight(folder / native::kRightFolder, &*data_set)})
    if (!status.ok()) return status;
  return data_set;
}

}  // namespace pliant
