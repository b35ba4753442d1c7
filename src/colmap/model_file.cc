// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap/model_file.h"

#include <utility>

#include "colmap/rows.h"

namespace pliant::colmap {
namespace {

Status Put(std::optional<OutputFile>& file, std::string* buffer) {
  if (file) return file->AppendWhenLarge(buffer);
  buffer->clear();
  return Status::Ok();
}

Status End(std::optional<OutputFile>& file, const std::string& rest) {
  if (!file) return Status::Ok();
  if (Status status = file->Append(rest); !status.ok()) return status;
  return file->Close();
}

}  // namespace

Result<ModelFile> ModelFile::Create(FileGroup& group, const std::string& folder, const std::string& name,
                                    Format format) {
  ModelFile file;
  if (format != Format::kBinary) {
    auto text = group.Create(folder + "/" + name + ".txt");
    if (!text.ok()) return text.status();
    file.text_file_ = std::move(text).value();
  }
  if (format != Format::kText) {
    auto binary = group.Create(folder + "/" + name + ".bin");
    if (!binary.ok()) return binary.status();
    file.binary_file_ = std::move(binary).value();
  }
  return file;
}

void ModelFile::Begin(const std::string& header, std::uint64_t count) {
  text_ = header + "\n";
  AppendBytes(&binary_, count, 8);
}

Status ModelFile::Add(const Camera& camera) {
  AppendTextCamera(camera, &text_);
  AppendBinaryCamera(camera, &binary_);
  return Flush();
}

Status ModelFile::Add(const Image& image) {
  AppendTextImage(image, Digits::kRounded, &text_);
  AppendBinaryImage(image, &binary_);
  return Flush();
}

Status ModelFile::Add(const Point3D& point, std::span<const TrackElement> track) {
  AppendTextPoint(point, track, Digits::kRounded, &text_);
  AppendBinaryPoint(point, track, &binary_);
  return Flush();
}

Status ModelFile::Flush() {
  if (Status status = Put(text_file_, &text_); !status.ok()) return status;
  return Put(binary_file_, &binary_);
}

Status ModelFile::Close() {
  if (Status status = End(text_file_, text_); !status.ok()) return status;
  return End(binary_file_, binary_);
}

Status WriteCamera(FileGroup& group, const std::string& folder, Format format, const Camera& camera) {
  auto file = ModelFile::Create(group, folder, "cameras", format);
  if (!file.ok()) return file.status();
  file->Begin(CamerasHeader(1), 1);
  if (Status status = file->Add(camera); !status.ok()) return status;
  return file->Close();
}

}  // namespace pliant::colmap
