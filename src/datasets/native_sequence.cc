// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/native_sequence.h"

#include <cmath>
#include <fstream>
#include <utility>

#include "datasets/image_file.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"
#include "pliant/io/trajectory.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

Status CheckLineCount(const fs::path& file, const std::string& what, std::size_t lines, int images) {
  if (lines == static_cast<std::size_t>(images)) return Status::Ok();
  return {ErrorCode::kMismatch, "the file " + file.string() + " has " + std::to_string(lines) + " " + what + " for " +
                                    std::to_string(images) + " images; it needs one line an image"};
}

std::string Trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

// One time a line, seconds, growing; lines that start with # are comments.
Result<std::vector<double>> ReadTimes(const fs::path& file) {
  std::ifstream stream(file);
  std::error_code error;
  if (!stream || !fs::is_regular_file(file, error))
    return Status(ErrorCode::kUnreadable, "cannot open " + file.string() + "; check that it is a readable file");
  std::vector<double> times_s;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::string text = Trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    const std::string where = file.string() + ":" + std::to_string(number) + ": ";
    double time_s = 0;
    if (!ParseDouble(text, &time_s) || !std::isfinite(time_s))
      return Status(ErrorCode::kUnreadable, where + "'" + text + "' is not a time; a line has one number, in seconds");
    if (!times_s.empty() && !(time_s > times_s.back()))
      return Status(ErrorCode::kUnreadable, where + "the time is not after the line before; times grow");
    times_s.push_back(time_s);
  }
  return times_s;
}

}  // namespace

bool NativeSequence::IsAt(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(folder / "images", error);
}

Result<std::unique_ptr<NativeSequence>> NativeSequence::Open(const fs::path& folder,
                                                             const SourceCalibration& calibration,
                                                             const fs::path& mask_path, const FrameRange& range) {
  const fs::path masks = mask_path.empty() && Exists(folder / "masks") ? folder / "masks" : mask_path;
  Result<std::unique_ptr<ImageFolder>> images = ImageFolder::Open(folder / "images", calibration, masks, range);
  if (!images.ok()) return images.status();
  std::unique_ptr<NativeSequence> sequence(new NativeSequence(*std::move(images), calibration.depth_scale));
  const int count = sequence->images_->source_count();

  if (const fs::path file = folder / "times.txt"; Exists(file)) {
    Result<std::vector<double>> times_s = ReadTimes(file);
    if (!times_s.ok()) return times_s.status();
    if (Status status = CheckLineCount(file, "times", times_s->size(), count); !status.ok()) return status;
    sequence->images_->SetTimestamps(*std::move(times_s));
  }
  if (const fs::path file = folder / "groundtruth.txt"; Exists(file)) {
    const Result<std::vector<TimedPose>> poses = ReadTumTrajectory(file.string());
    if (!poses.ok()) return poses.status();
    if (Status status = CheckLineCount(file, "poses", poses->size(), count); !status.ok()) return status;
    for (const TimedPose& pose : *poses) sequence->world_from_cam_.push_back(pose.world_from_cam);
  }
  if (const fs::path depth_path = folder / "depth"; Exists(depth_path)) {
    if (!fs::is_directory(depth_path))  // one image may mask every frame, but is not the depth of every frame
      return Status(ErrorCode::kUnreadable, depth_path.string() + " is a file where a folder of images is expected");
    Result<CompanionImages> depth =
        CompanionImages::Open("depth", depth_path, sequence->stems_, CompanionImages::Counts::kMustAgree);
    if (!depth.ok()) return depth.status();
    sequence->depth_ = *std::move(depth);
  }
  return sequence;
}

Result<std::optional<cv::Mat>> NativeSequence::Depth(int frame_idx) const {
  if (!depth_ || frame_idx < 0 || frame_idx >= images_->source_count()) return std::optional<cv::Mat>();
  const fs::path file = depth_->Find(frame_idx, stems_[static_cast<std::size_t>(frame_idx)]);
  if (file.empty()) return std::optional<cv::Mat>();
  Result<cv::Mat> depth_mm = ReadDepthImage(file, depth_scale_);
  if (!depth_mm.ok()) return depth_mm.status();
  if (depth_mm->cols != camera().width() || depth_mm->rows != camera().height())
    return Status(ErrorCode::kMismatch, "the depth image " + file.string() + " is " + SizeText(*depth_mm) +
                                            ", but the images are " + SizeText(camera().width(), camera().height()) +
                                            "; depth has the images' size");
  return std::optional<cv::Mat>(*std::move(depth_mm));
}

std::optional<Rigid3> NativeSequence::WorldFromCamera(int frame_idx) const {
  if (frame_idx < 0 || frame_idx >= static_cast<int>(world_from_cam_.size())) return std::nullopt;
  return world_from_cam_[static_cast<std::size_t>(frame_idx)];
}

}  // namespace pliant
