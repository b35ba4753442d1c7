// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/sequence_arguments.h"

#include "pliant/camera/assumed_camera.h"

namespace pliant::cli {
namespace {

constexpr const char* kUnknownCamera = "unknown";

}  // namespace

void SequenceArguments::AddTo(CommandLine* line) {
  constexpr int kMaxFrame = 2147483647;
  line->Add("image_path", &path, "PATH",
            "a data set: folder of images, native sequence, video or another (docs/datasets.md)", Need::kRequired,
            Positional::kYes);
  line->Renamed("path", "image_path");
  line->Renamed("input_path", "image_path");
  line->Add("camera", &camera_path, "FILE",
            "calibration; not needed where camera.yaml lies in the folder or beside the video; unknown: there is none",
            Need::kOptional);
  line->Add("fov_deg", &fov_deg, "of an unknown camera: horizontal field of view that is assumed, degrees", 10, 150);
  line->Add("mask_path", &mask_path, "PATH", "folder of masks, or one image for all frames; 0 = ignore this pixel",
            Need::kOptional);
  line->Add("start", &start, "first frame, by its number in the source", 0, kMaxFrame);
  line->Add("end", &end, "one past the last frame; -1: to the end", -1, kMaxFrame);
  line->Add("stride", &stride, "take every Nth frame", 1, kMaxFrame);
}

std::optional<int> SequenceArguments::Check(const CommandLine& line) const {
  if (fov_deg != SequenceArguments().fov_deg && camera_path != kUnknownCamera)
    return line.UsageError("--fov_deg is of a camera without a calibration; give --camera unknown with it");
  if (end == -1 || end > start) return std::nullopt;
  return line.UsageError("--end is " + std::to_string(end) + " and --start is " + std::to_string(start) +
                         "; --end is one past the last frame, or -1 for all");
}

SequenceRequest SequenceArguments::Request() const {
  return {.image_path = path,
          .camera_path = camera_path == kUnknownCamera ? AssumedCameraName(fov_deg) : camera_path,
          .mask_path = mask_path,
          .start = start,
          .end = end,
          .stride = stride};
}

void AddCameraOfRun(CommandLine* line, std::string* camera_path) {
  line->Add("camera", camera_path, "FILE",
            "their calibration, which has to be the run's; without it the one that belongs to them", Need::kOptional);
}

void AddSequenceOfKilledRun(CommandLine* line, std::string* sequence_path, std::string* camera_path) {
  line->Add("sequence", sequence_path, "PATH",
            "images of a run that has no sparse/; without it those that its run.json names", Need::kOptional);
  AddCameraOfRun(line, camera_path);
}

void AddMasksOfRun(CommandLine* line, std::string* mask_path) {
  line->Add("mask_path", mask_path, "PATH",
            "folder of masks, or one image for all frames (0 = ignore); without it the run's", Need::kOptional);
}

}  // namespace pliant::cli
