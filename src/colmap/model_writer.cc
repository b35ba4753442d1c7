// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>

#include "colmap/rows.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/colmap/model.h"

namespace pliant::colmap {
namespace {

constexpr int kRowsBetweenTold = 1000;

// What is written to, and who is told.
struct Output {
  FileGroup group = {};
  const JobProgress& progress;
};

// Writes one file: a header, and then every row by `append(row, buffer)`.
template <class Rows, class Append>
Status WriteRows(Output& output, const std::string& path, const std::string& header, const Rows& rows,
                 const Append& append) {
  auto file = output.group.Create(path);
  if (!file.ok()) return file.status();
  std::string buffer = header;
  int done = 0;
  for (const auto& row : rows) {
    append(row, &buffer);
    if (++done % kRowsBetweenTold == 0)
      if (Status status = Tell(output.progress, "write", done, static_cast<int>(rows.size())); !status.ok())
        return status;
    if (Status status = file->AppendWhenLarge(&buffer); !status.ok()) return status;
  }
  if (Status status = Tell(output.progress, "write", done, static_cast<int>(rows.size())); !status.ok()) return status;
  if (Status status = file->Append(buffer); !status.ok()) return status;
  return file->Close();
}

std::string BinaryCount(std::size_t count) {
  std::string bytes;
  AppendBytes(&bytes, count, 8);
  return bytes;
}

std::string Mean(std::size_t sum, std::size_t count) {
  std::string text;
  AppendExact(&text, count == 0 ? 0.0 : static_cast<double>(sum) / static_cast<double>(count));
  return text;
}

Status WriteText(Output& output, const std::string& folder, const Model& model, Rigs rigs) {
  std::size_t observations = 0;
  for (const Point3D& point : model.points3D) observations += point.track.size();
  Status status = WriteRows(output, folder + "/cameras.txt", CamerasHeader(model.cameras.size()) + "\n", model.cameras,
                            AppendTextCamera);
  if (status.ok())
    status = WriteRows(output, folder + "/images.txt",
                       ImagesHeader(model.images.size()) +
                           ", mean observations per image: " + Mean(observations, model.images.size()) + "\n",
                       model.images,
                       [](const Image& image, std::string* out) { AppendTextImage(image, Digits::kExact, out); });
  if (status.ok())
    status = WriteRows(output, folder + "/points3D.txt",
                       PointsHeader(model.points3D.size()) +
                           ", mean track length: " + Mean(observations, model.points3D.size()) + "\n",
                       model.points3D, [](const Point3D& point, std::string* out) {
                         AppendTextPoint(point, point.track, Digits::kExact, out);
                       });
  if (rigs == Rigs::kLeftOut || !status.ok()) return status;
  status = WriteRows(output, folder + "/rigs.txt", RigsHeader(model.rigs.size()) + "\n", model.rigs, AppendTextRig);
  if (!status.ok()) return status;
  return WriteRows(output, folder + "/frames.txt", FramesHeader(model.frames.size()) + "\n", model.frames,
                   AppendTextFrame);
}

Status WriteBinary(Output& output, const std::string& folder, const Model& model, Rigs rigs) {
  Status status =
      WriteRows(output, folder + "/cameras.bin", BinaryCount(model.cameras.size()), model.cameras, AppendBinaryCamera);
  if (status.ok())
    status =
        WriteRows(output, folder + "/images.bin", BinaryCount(model.images.size()), model.images, AppendBinaryImage);
  if (status.ok())
    status = WriteRows(output, folder + "/points3D.bin", BinaryCount(model.points3D.size()), model.points3D,
                       [](const Point3D& point, std::string* out) { AppendBinaryPoint(point, point.track, out); });
  if (rigs == Rigs::kLeftOut || !status.ok()) return status;
  status = WriteRows(output, folder + "/rigs.bin", BinaryCount(model.rigs.size()), model.rigs, AppendBinaryRig);
  if (!status.ok()) return status;
  return WriteRows(output, folder + "/frames.bin", BinaryCount(model.frames.size()), model.frames, AppendBinaryFrame);
}

Status CheckWritable(const Model& model) {
  for (const Camera& camera : model.cameras) {
    const CameraModelInfo* info = FindCameraModel(camera.model_id);
    if (info == nullptr || camera.params.size() != static_cast<std::size_t>(info->num_params))
      return {ErrorCode::kInvalidArgument,
              "camera " + std::to_string(camera.id) + " has an unknown model, or not as many parameters as its model"};
  }
  for (const Image& image : model.images)
    if (image.name.empty() || image.name.find_first_of(std::string_view("\0\r\n", 3)) != std::string::npos)
      return {ErrorCode::kInvalidArgument, "image " + std::to_string(image.id) +
                                               " has no name, or one with a line end; COLMAP's files cannot hold it"};
  return Status::Ok();
}

}  // namespace

Status CheckFolder(const std::string& folder, Format format, Rigs rigs) {
  if (rigs == Rigs::kLeftOut)
    for (const char* name : {"rigs.bin", "rigs.txt", "frames.bin", "frames.txt"}) {
      const std::string path = folder + "/" + name;
      if (Exists(path))
        return {ErrorCode::kInvalidArgument, "there is " + Quoted(path) +
                                                 ", of another model, which would be read with this one; delete it or "
                                                 "choose another folder"};
    }
  if (format == Format::kBoth) return Status::Ok();
  const std::string other = format == Format::kText ? ".bin" : ".txt";
  for (const char* name : {"cameras", "images", "points3D", "rigs", "frames"}) {
    const std::string path = folder + "/" + name + other;
    if (Exists(path))
      return {ErrorCode::kInvalidArgument, "there is " + Quoted(path) +
                                               ", of a model in another format, which would be read instead; delete it "
                                               "or choose another folder"};
  }
  return Status::Ok();
}

Status WriteModel(const std::string& folder, const Model& model, Format format, Rigs rigs,
                  const JobProgress& progress) {
  if (Status status = CheckWritable(model); !status.ok()) return status;
  if (Status status = CheckFolder(folder, format, rigs); !status.ok()) return status;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return {ErrorCode::kUnwritable, "cannot make the folder " + Quoted(folder) + ": " + error.message()};
  Output output{.progress = progress};
  if (format != Format::kBinary)
    if (Status status = WriteText(output, folder, model, rigs); !status.ok()) return status;
  if (format != Format::kText)
    if (Status status = WriteBinary(output, folder, model, rigs); !status.ok()) return status;
  return output.group.Commit();
}

}  // namespace pliant::colmap
