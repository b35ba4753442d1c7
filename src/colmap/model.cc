// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/colmap/model.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "colmap/readers.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant::colmap {
namespace {

constexpr std::array kCameraModels = {CameraModelInfo{0, "SIMPLE_PINHOLE", 3, 1},
                                      CameraModelInfo{1, "PINHOLE", 4, 2},
                                      CameraModelInfo{2, "SIMPLE_RADIAL", 4, 1},
                                      CameraModelInfo{3, "RADIAL", 5, 1},
                                      CameraModelInfo{4, "OPENCV", 8, 2},
                                      CameraModelInfo{5, "OPENCV_FISHEYE", 8, 2},
                                      CameraModelInfo{6, "FULL_OPENCV", 12, 2},
                                      CameraModelInfo{7, "FOV", 5, 2},
                                      CameraModelInfo{8, "SIMPLE_RADIAL_FISHEYE", 4, 1},
                                      CameraModelInfo{9, "RADIAL_FISHEYE", 5, 1},
                                      CameraModelInfo{10, "THIN_PRISM_FISHEYE", 12, 2},
                                      CameraModelInfo{11, "RAD_TAN_THIN_PRISM_FISHEYE", 16, 2}};
constexpr std::array<std::string_view, 3> kFiles = {"cameras", "images", "points3D"};
constexpr std::string_view kReadTask = "read";
constexpr int kNumFiles = 3;

// What is missing of a format's three files; empty: nothing.
std::string MissingFile(const std::string& folder, std::string_view extension) {
  for (const std::string_view name : kFiles) {
    std::string path = folder + "/" + std::string(name) + std::string(extension);
    if (!Exists(path)) return path;
  }
  return {};
}

// Stores what was read.
template <class Value>
Status Put(Result<Value> read, Value* target) {
  if (!read.ok()) return read.status();
  *target = std::move(read).value();
  return Status::Ok();
}

// The first id that is there twice makes an error.
template <class Rows>
Status CheckIds(const Rows& rows, std::string_view what, const std::string& path) {
  std::set<decltype(rows.front().id)> seen;
  for (const auto& row : rows)
    if (!seen.insert(row.id).second)
      return {ErrorCode::kUnreadable,
              Quoted(path) + " has " + std::string(what) + " " + std::to_string(row.id) + " twice; ids must be unique"};
  return Status::Ok();
}

Status ReadRigs(const std::string& folder, Format format, Model* model) {
  const bool text = format == Format::kText;
  const std::string extension = text ? ".txt" : ".bin";
  const std::string rigs = folder + "/rigs" + extension;
  const std::string frames = folder + "/frames" + extension;
  if (Exists(rigs)) {
    if (Status status = Put(text ? ReadTextRigs(rigs) : ReadBinaryRigs(rigs), &model->rigs); !status.ok())
      return status;
    if (Status status = CheckIds(model->rigs, "rig", rigs); !status.ok()) return status;
  }
  if (Exists(frames)) {
    if (Status status = Put(text ? ReadTextFrames(frames) : ReadBinaryFrames(frames), &model->frames); !status.ok())
      return status;
    if (Status status = CheckIds(model->frames, "frame", frames); !status.ok()) return status;
  }
  return Status::Ok();
}

}  // namespace

const CameraModelInfo* FindCameraModel(int id) {
  return id >= 0 && static_cast<std::size_t>(id) < kCameraModels.size() ? &kCameraModels[static_cast<std::size_t>(id)]
                                                                        : nullptr;
}

const CameraModelInfo* FindCameraModel(std::string_view name) {
  const auto found =
      std::find_if(kCameraModels.begin(), kCameraModels.end(), [&](const auto& model) { return model.name == name; });
  return found == kCameraModels.end() ? nullptr : &*found;
}

std::string UnknownCameraModel(std::string_view name_or_number) {
  std::vector<std::string> names;
  for (const CameraModelInfo& model : kCameraModels) names.emplace_back(model.name);
  return "there is no camera model " + Quoted(name_or_number) + "; did you mean " +
         Quoted(NearestName(name_or_number, names)) + "? (" + names.front() + " is 0, " + names.back() + " " +
         std::to_string(names.size() - 1) + ")";
}

Result<Format> FindModel(const std::string& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error))
    return Status(ErrorCode::kNotFound, "there is no folder " + Quoted(folder) + "; give the folder of a COLMAP model");
  const std::string no_binary = MissingFile(folder, ".bin");
  const std::string no_text = MissingFile(folder, ".txt");
  if (no_binary.empty()) return no_text.empty() ? Format::kBoth : Format::kBinary;
  if (no_text.empty()) return Format::kText;
  const bool partly_text = !Exists(folder + "/cameras.bin") && Exists(folder + "/cameras.txt");
  return Status(ErrorCode::kNotFound, Quoted(folder) + " is not a COLMAP model: there is no " +
                                          Quoted(partly_text ? no_text : no_binary) +
                                          " (cameras, images and points3D, as .bin or .txt)");
}

Result<Model> ReadModel(const std::string& folder, Observations observations, const JobProgress& progress) {
  const auto format = FindModel(folder);
  if (!format.ok()) return format.status();
  return ReadModel(folder, *format == Format::kText ? Format::kText : Format::kBinary, observations, progress);
}

Result<Model> ReadModel(const std::string& folder, Format format, Observations observations,
                        const JobProgress& progress) {
  assert(format != Format::kBoth);
  const bool text = format == Format::kText;
  const auto path = [&](std::size_t file) {
    return folder + "/" + std::string(kFiles[file]) + (text ? ".txt" : ".bin");
  };
  Model model;
  Status status = Put(text ? ReadTextCameras(path(0)) : ReadBinaryCameras(path(0)), &model.cameras);
  if (status.ok()) status = CheckIds(model.cameras, "camera", path(0));
  if (status.ok()) status = Tell(progress, kReadTask, 1, kNumFiles);
  if (status.ok())
    status = Put(text ? ReadTextImages(path(1), observations) : ReadBinaryImages(path(1), observations), &model.images);
  if (status.ok()) status = CheckIds(model.images, "image", path(1));
  if (status.ok()) status = Tell(progress, kReadTask, 2, kNumFiles);
  if (status.ok())
    status =
        Put(text ? ReadTextPoints(path(2), observations) : ReadBinaryPoints(path(2), observations), &model.points3D);
  if (status.ok()) status = CheckIds(model.points3D, "point", path(2));
  if (status.ok()) status = Tell(progress, kReadTask, kNumFiles, kNumFiles);
  if (status.ok()) status = ReadRigs(folder, format, &model);
  if (!status.ok()) return status;
  return model;
}

Result<std::vector<Camera>> ReadCameras(const std::string& path) {
  auto cameras = std::filesystem::path(path).extension() == ".bin" ? ReadBinaryCameras(path) : ReadTextCameras(path);
  if (!cameras.ok()) return cameras.status();
  if (Status status = CheckIds(*cameras, "camera", path); !status.ok()) return status;
  return cameras;
}

}  // namespace pliant::colmap
